"""Course of a program at an override of 1, cell by cell, for the closed loop.

A control scales the time of a whole path by the override, and so does this model: the axes
follow the planned motion faster or slower, and a cell takes its time divided by the override.
Accelerations grow with the square of the override, as in real controls; between 0 and 1.2 no
limit is exceeded by much. Values are constant within a cell; cells end with stretches, so that
the total time is exact.

The module also computes the force over a revolution of the cutter relative to its mean: the
teeth of :mod:`simulator.physics.tooth_forces` on one contact arc, along their helix, with
runout or with a broken tooth. Multiplied by the mean force of a revolution, which follows from
the power, this is what a dynamometer shows. Units mm, s, N, W, rad, rev/s.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields
from functools import lru_cache
from math import atan, ceil, cos, hypot, pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simulator.machine.cutting import CuttingEdge, engaged_width
from simulator.machine.samples import Episode, PathMode, Samples
from simulator.machine.sensing import sensed
from simulator.motion.segments import Bools, Floats, Ints
from simulator.physics import flank
from simulator.physics.flutes import CuttingEdges, ForceLaw
from simulator.physics.milling import RADIAL_SHARE
from simulator.physics.spindle import idle_power
from simulator.physics.tooth_forces import Places, forces, one_place, peak_resultant, wall_force
from simulator.physics.tooth_means import Arcs
from simulator.physics.uneven_teeth import Runout, eccentric_runout
from simulator.removal.stations import StationKind
from simulator.spec import Machine

SAMPLES = 8
"""Number of force samples per tooth period."""

PLACES = 32
"""Number of rotations averaged for one sample, so that narrow arcs are not missed."""

SUNKEN = 10.0
"""Distance of a broken tooth below the others, in feeds per tooth, so that it cuts nothing."""


class EngagedTeeth(NamedTuple):
    """Teeth of a cutter on one contact arc; a tuple, as one is looked up for each tooth."""

    number: int
    entry_angle: float
    exit_angle: float
    exponent: float
    """Exponent of force over chip thickness."""
    lag: float = 0.0
    """Lag of the upper end of the engaged edge behind its tip, rad."""
    runout: float = 0.0
    """Eccentricity over feed per tooth."""
    broken: int | None = None


@lru_cache(maxsize=4096)
def pattern(teeth: EngagedTeeth) -> Floats:
    """Force in each tooth period of a revolution, over the mean force of unbroken teeth.

    Returns
    -------
    (z, K) array
        Row j: the period in which tooth j is the last that has entered. The mean is 1; with a
        broken tooth it is less, because one double chip needs less force than two.
    """
    if not teeth.exit_angle > teeth.entry_angle:
        return np.ones((teeth.number, SAMPLES))
    runout = eccentric_runout(teeth.runout, teeth.number)
    force = _force(teeth, runout)
    mean = force.mean()
    if not mean > 0.0:
        return np.ones((teeth.number, SAMPLES))
    if teeth.broken is not None and teeth.number > 1:
        sunken = runout.copy()
        sunken[teeth.broken % teeth.number] -= SUNKEN
        force = _force(teeth, sunken)
    shape: Floats = (force / mean).reshape(teeth.number, SAMPLES, PLACES).mean(axis=2)
    shape.setflags(write=False)
    return shape


@lru_cache(maxsize=4096)
def peak_over_mean(teeth: EngagedTeeth) -> float:
    """Greatest force across the axis in a revolution, over the mean tangential force.

    The value is 1 if the arc is unknown, and less if teeth pull against each other. The mean
    follows from the power, with k_c at the mean chip, as in the optimiser: ``z·φ/2π · (C/φ)^q``
    over the force of one tooth at its thickest chip. Runout is neglected.
    """
    if not teeth.exit_angle > teeth.entry_angle:
        return 1.0
    found = peak_resultant(_edges(teeth), _place(teeth), ForceLaw(exponent=teeth.exponent))
    return float(found[0]) / _mean(teeth)


@lru_cache(maxsize=4096)
def wall_over_mean(teeth: EngagedTeeth) -> float:
    """Force normal to the wall as it is cut, over the mean tangential force; 0 if no wall."""
    if not teeth.exit_angle > teeth.entry_angle:
        return 0.0
    found = wall_force(_edges(teeth), _place(teeth), ForceLaw(exponent=teeth.exponent))
    return float(found[0]) / _mean(teeth)


def _mean(teeth: EngagedTeeth) -> float:
    contact = teeth.exit_angle - teeth.entry_angle
    chip = (cos(teeth.entry_angle) - cos(teeth.exit_angle)) / contact
    return float(teeth.number * contact / (2.0 * pi) * chip**teeth.exponent)


def _edges(teeth: EngagedTeeth) -> CuttingEdges:
    """Edges of a cutter of radius 1 with the given lag over a depth of 1."""
    return CuttingEdges(teeth=teeth.number, diameter=2.0, helix_angle=atan(teeth.lag))


def _place(teeth: EngagedTeeth) -> Places:
    return one_place(teeth.entry_angle, teeth.exit_angle, axial_depth=1.0)


def _force(teeth: EngagedTeeth, runout: Floats) -> Floats:
    """Sum of tangential forces through a revolution that begins where tooth 0 enters."""
    pitch = 2.0 * pi / teeth.number
    each = SAMPLES * PLACES
    middle = (np.arange(teeth.number * each) + 0.5) / each
    found = forces(
        _edges(teeth),
        _place(teeth),
        ForceLaw(exponent=teeth.exponent),
        rotation=(teeth.entry_angle + pitch * middle)[None, :],
        runout=Runout(offsets=runout, feed_per_tooth=np.ones(1)) if runout.any() else None,
    )
    force: Floats = found.tangential[0]
    return force


INTERVAL = 0.01
"""Longest duration of a cell, s: a revolution at 6000 rpm."""

MOST = 65_536
"""Largest number of cells computed at once."""

Singles = NDArray[np.float32]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NominalCourse:
    """Course of N cells, ascending in time; bulk columns in single precision to save memory."""

    until: Floats
    """End time of each cell from the start of the program, (N,), s."""
    can_override: Bools
    """Whether the feed override acts, (N,): not in rapid nor at rest."""
    position: Singles
    """Position of the tool in the middle of the cell, (N, 3), mm."""
    feed: Singles
    """Feed along the path, (N,), mm/s."""
    programmed: Singles
    """Programmed feed, (N,), mm/s; 0 if none is programmed."""
    force: Singles
    """Mean tangential force over a revolution, (N,), N."""
    land_force: Singles
    """Mean force of the wear land, (N,), N per mm of flank wear; independent of the feed."""
    exponent: Singles
    """Exponent p of force over feed, 1 − m_c, (N,)."""
    removal_rate: Singles
    """Removal rate, (N,), mm³/s."""
    axial_depth: Singles
    """Axial depth of cut, (N,), mm."""
    idle_power: Singles
    """Power of the main drive without the cut, (N,), W."""
    spindle_speed: Singles
    """Magnitude of the spindle speed, (N,), rev/s."""
    diameter: Singles
    """Diameter for cutting speed and force, (N,), mm; 0 in air."""
    entry_angle: Singles
    """Entry angle, (N,), rad; entry and exit are 0 if the arc is unknown."""
    exit_angle: Singles
    """Exit angle, (N,), rad."""
    peak: Singles
    """Greatest force across the axis over the mean force, (N,); 1 if the arc is unknown."""
    wall: Singles
    """Force normal to the wall being cut over the mean force, (N,); 0 without a wall."""
    lag: Singles
    """Lag of the upper end of the engaged edges behind their tips, (N,), rad."""
    teeth: Ints
    """Number of teeth, (N,)."""
    tool: Ints
    """Number of the tool, (N,)."""
    workingstep: Ints
    """Number of the workingstep, (N,), counted from 1; 0 for none."""
    line: Ints
    """Line of the program, (N,)."""

    def __post_init__(self) -> None:
        count = len(self.until)
        if count == 0 or not (np.diff(self.until, prepend=0.0) > 0.0).all():
            raise ValueError("a course needs at least one cell, and cells must ascend in time")
        for field in fields(self):
            if len(getattr(self, field.name)) != count:
                raise ValueError(f"{field.name} must have {count} rows")

    def __len__(self) -> int:
        return len(self.until)

    @property
    def arcs(self) -> Arcs:
        """Contact arcs of the cells, (N,)."""
        return Arcs(entry_angle=self.entry_angle, exit_angle=self.exit_angle, lag=self.lag)

    @property
    def duration(self) -> float:
        """Duration of the program at an override of 1, s."""
        return float(self.until[-1])


def course_of(episodes: Iterable[Episode], machine: Machine) -> NominalCourse:
    """Divide a run into cells.

    Parameters
    ----------
    episodes : iterable of Episode
        Episodes of the virtual machine, with forces as means over a revolution.

    Raises
    ------
    ValueError
        If nothing in the run takes time.
    """
    parts = [part for episode in episodes for part in _cells(episode, machine)]
    if not parts:
        raise ValueError("the program contains nothing that takes time")
    names = [field.name for field in fields(NominalCourse)]
    return NominalCourse(**{
        name: np.concatenate([getattr(part, name) for part in parts]) for name in names
    })


def _cells(episode: Episode, machine: Machine) -> Iterator[NominalCourse]:
    """Cells of one episode; none if it has no duration."""
    whole = episode.end - episode.begin
    if not whole > 0.0:
        return
    count = 1 if episode.course is None else ceil(whole / INTERVAL)
    for first in range(0, count, MOST):
        rows = np.arange(first, min(first + MOST, count))
        until = episode.begin + whole * (rows + 1.0) / count
        middle = episode.begin + whole * (rows + 0.5) / count
        yield _part(episode, machine, until=until, middle=middle)


def _part(
    episode: Episode, machine: Machine, *, until: Floats, middle: Floats
) -> NominalCourse:
    samples = sensed(episode, machine, middle)
    course, count = episode.course, len(until)
    diameter = entry = exit_ = land = np.zeros(count)
    if course is not None:
        at = course.motion.at(np.clip(middle - episode.begin, 0.0, course.motion.duration))
        stations, rows = course.stations, course.stations_at(at)
        diameter = np.where(samples.cutting_force > 0.0, stations.diameter[rows], 0.0)
        has_arc = stations.kind[rows] == StationKind.MILLING
        entry = np.where(has_arc, stations.entry_angle[rows], 0.0)
        exit_ = np.where(has_arc, stations.exit_angle[rows], 0.0)
        if course.edge is not None:
            width = engaged_width(stations, course.edge.teeth)[rows]
            land = flank.land_force(flank.CUTTING, 1.0, width) * (samples.cutting_force > 0.0)
    edge = None if course is None else course.edge
    flutes = None if edge is None else edge.flutes
    lag = (0.0 if flutes is None else flutes.lag) * samples.axial_depth
    peak, wall = _ratios(samples, entry, exit_, lag=lag, edge=edge)
    speed = np.abs(samples.spindle_speed)
    return NominalCourse(
        until=until,
        can_override=samples.path_mode == int(PathMode.FEED),
        position=_single(samples.position),
        feed=_single(samples.path_speed),
        programmed=_single(samples.feed_programmed),
        force=_single(samples.cutting_force),
        land_force=_single(land),
        exponent=_single(np.full(count, _exponent(edge))),
        removal_rate=_single(samples.removal_rate),
        axial_depth=_single(samples.axial_depth),
        idle_power=_single(idle_power(machine.spindle, speed)),
        spindle_speed=_single(speed),
        diameter=_single(diameter),
        entry_angle=_single(entry),
        exit_angle=_single(exit_),
        peak=_single(peak),
        wall=_single(wall),
        lag=_single(lag),
        teeth=np.full(count, 1 if edge is None else edge.teeth),
        tool=samples.tool,
        workingstep=samples.workingstep,
        line=samples.line,
    )


def _ratios(
    samples: Samples, entry: Floats, exit_: Floats, *, lag: Floats, edge: CuttingEdge | None
) -> tuple[Floats, Floats]:
    """Greatest force and wall force over the mean force, with arcs rounded to 0.01 rad.

    Limited to the force of all engaged teeth at their thickest chip: where the map knows a
    section but hardly an arc, as in a plunge, the ratio from the arc alone would be far too
    large.
    """
    peak, wall = np.ones(len(entry)), np.zeros(len(entry))
    cuts = np.flatnonzero((samples.cutting_force > 0.0) & (exit_ > entry))
    if edge is None or not len(cuts):
        return peak, wall
    keys = np.round(np.stack((entry[cuts], exit_[cuts], lag[cuts])), 2)
    arcs, row = np.unique(keys, axis=1, return_inverse=True)
    teeth = [
        EngagedTeeth(
            number=edge.teeth,
            entry_angle=begin,
            exit_angle=end,
            exponent=_exponent(edge),
            lag=behind,
        )
        for begin, end, behind in arcs.T.tolist()
    ]
    per_tooth = samples.path_speed[cuts] / (edge.teeth * np.abs(samples.spindle_speed[cuts]))
    contact = (exit_ - entry + lag)[cuts]
    together = np.ceil(contact * edge.teeth / (2.0 * np.pi))
    tooth = edge.factor * edge.kienzle.k_c11 * per_tooth ** _exponent(edge)
    whole = hypot(1.0, RADIAL_SHARE) * tooth
    most = whole * samples.axial_depth[cuts] * together / samples.cutting_force[cuts]
    greatest = np.array([peak_over_mean(each) for each in teeth])[row.ravel()]
    normal = np.array([wall_over_mean(each) for each in teeth])[row.ravel()]
    peak[cuts] = np.minimum(greatest, most)
    wall[cuts] = np.minimum(normal, most)
    return peak, wall


def _exponent(edge: CuttingEdge | None) -> float:
    return 1.0 if edge is None else 1.0 - edge.kienzle.m_c


def _single(values: Floats) -> Singles:
    return values.astype(np.float32)
