"""Course of a program at an override of 1, cell by cell, for the closed loop.

A control scales the time of a whole path by the override, and so does this: the axes follow
the planned motion faster or slower, and a cell is passed in its time over the override.
Accelerations then grow with its square, as they do in real controls; between 0 and 1.2 no
limit is passed by much. Within a cell all is constant; cells end with stretches, so that the
whole time is exact. Units mm, s, N, W, rad, rev/s.

Force over a revolution of the cutter, relative to its mean.

The teeth of :mod:`simulator.physics.tooth_forces` on one arc of contact, along their helix,
with runout or with a tooth that has broken. Times the mean force of a revolution, which is that
of the power, it is what a dynamometer shows. Units mm, rad.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields
from functools import lru_cache
from math import atan, ceil, cos, hypot, pi

import numpy as np
from numpy.typing import NDArray

from simulator.machine.cutting import CuttingEdge, engaged_width
from simulator.machine.samples import Episode, PathMode, Samples
from simulator.machine.sensing import sensed
from simulator.motion.segments import Bools, Floats, Ints
from simulator.physics import flank
from simulator.physics.flutes import CuttingEdges, ForceLaw
from simulator.physics.milling import RADIAL_SHARE
from simulator.physics.spindle_motion import idle_power
from simulator.physics.tooth_forces import Places, forces, one_place, peak_resultant, wall_force
from simulator.physics.tooth_means import Arcs
from simulator.physics.uneven_teeth import Runout, eccentric_runout
from simulator.removal.stations import StationKind
from simulator.spec import Machine

SAMPLES = 8
"""of a tooth period"""

PLACES = 32
"""places that make one sample: narrow arcs must not fall between two of them"""

SUNKEN = 10.0
"""feeds per tooth by which a broken tooth lies below the others: it meets nothing"""


@dataclass(frozen=True, slots=True, kw_only=True)
class EngagedTeeth:
    """Teeth on their arc."""

    count: int
    entry_angle: float
    exit_angle: float
    exponent: float
    """of force over chip thickness"""
    lag: float = 0.0
    """Lag, rad by which the upper end of the edge in the cut is behind its tip"""
    runout: float = 0.0
    """eccentricity over feed per tooth"""
    broken: int | None = None


@lru_cache(maxsize=4096)
def pattern(teeth: EngagedTeeth) -> Floats:
    """Force in each tooth period of a revolution over the mean force of whole teeth.

    Parameters
    ----------
    teeth : EngagedTeeth

    Returns
    -------
    (z, K) array
        Row j: while tooth j is the last that has entered. The mean is 1; with a broken tooth
        it is less, as two chips in one take less force than two.
    """
    if not teeth.exit_angle > teeth.entry_angle:
        return np.ones((teeth.count, SAMPLES))
    runout = eccentric_runout(teeth.runout, teeth.count)
    force = _force(teeth, runout)
    mean = force.mean()
    if not mean > 0.0:
        return np.ones((teeth.count, SAMPLES))
    if teeth.broken is not None and teeth.count > 1:
        sunken = runout.copy()
        sunken[teeth.broken % teeth.count] -= SUNKEN
        force = _force(teeth, sunken)
    shape: Floats = (force / mean).reshape(teeth.count, SAMPLES, PLACES).mean(axis=2)
    shape.setflags(write=False)
    return shape


@lru_cache(maxsize=4096)
def peak_over_mean(teeth: EngagedTeeth) -> float:
    """Greatest force across the axis in a revolution, over the mean tangential force.

    1 where no arc is known; less where teeth pull against each other. The mean is that of the
    power, with k_c at the mean chip, as the optimiser has it: ``z·φ/2π · (C/φ)^q`` over the
    force of one tooth at its thickest chip. Teeth without runout.
    """
    if not teeth.exit_angle > teeth.entry_angle:
        return 1.0
    found = peak_resultant(_edges(teeth), _place(teeth), ForceLaw(exponent=teeth.exponent))
    return float(found[0]) / _mean(teeth)


@lru_cache(maxsize=4096)
def wall_over_mean(teeth: EngagedTeeth) -> float:
    """Force normal to the wall while an edge makes it, over that mean; 0 without a wall."""
    if not teeth.exit_angle > teeth.entry_angle:
        return 0.0
    found = wall_force(_edges(teeth), _place(teeth), ForceLaw(exponent=teeth.exponent))
    return float(found[0]) / _mean(teeth)


def _mean(teeth: EngagedTeeth) -> float:
    contact = teeth.exit_angle - teeth.entry_angle
    chip = (cos(teeth.entry_angle) - cos(teeth.exit_angle)) / contact
    return float(teeth.count * contact / (2.0 * pi) * chip**teeth.exponent)


def _edges(teeth: EngagedTeeth) -> CuttingEdges:
    """Edges of a cutter of radius 1, which lag as they do over a depth of 1."""
    return CuttingEdges(teeth=teeth.count, diameter=2.0, helix_angle=atan(teeth.lag))


def _place(teeth: EngagedTeeth) -> Places:
    return one_place(teeth.entry_angle, teeth.exit_angle, axial_depth=1.0)


def _force(teeth: EngagedTeeth, runout: Floats) -> Floats:
    """Sum over the teeth through a revolution that begins where tooth 0 enters."""
    pitch = 2.0 * pi / teeth.count
    each = SAMPLES * PLACES
    middle = (np.arange(teeth.count * each) + 0.5) / each
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
"""s, a cell at most: a revolution at 6000 rpm"""

MOST = 65_536
"""cells made at once"""

Singles = NDArray[np.float32]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NominalCourse:
    """N cells, ascending in time; bulk columns in single precision for the sake of memory."""

    until: Floats
    """Until, (N,) s from the start of the program at which each cell ends"""
    can_override: Bools
    """(N,) whether the feed override acts: not in rapid nor at rest"""
    position: Singles
    """Position, (N, 3) mm, of the tool in the middle"""
    feed: Singles
    """Feed, (N,) mm/s along the path"""
    programmed: Singles
    """Programmed, (N,) mm/s; 0 where nothing is programmed"""
    force: Singles
    """Force, (N,) N, tangential, mean of a revolution"""
    land_force: Singles
    """Land force, (N,) N per mm of flank wear, tangential, mean; no feed changes it"""
    exponent: Singles
    """Exponent, (N,) p of force over feed, 1 − m_c"""
    removal_rate: Singles
    """Removal rate, (N,) mm³/s"""
    axial_depth: Singles
    """Axial depth, (N,) mm"""
    idle_power: Singles
    """Idle power, (N,) W of the main drive without the cut"""
    spindle_speed: Singles
    """Spindle speed, (N,) rev/s, magnitude"""
    diameter: Singles
    """Diameter, (N,) mm at which the cutting speed drives the force; 0 in air"""
    entry_angle: Singles
    """Entry angle, (N,) rad; both 0 where no arc is known"""
    exit_angle: Singles
    """Exit angle, (N,) rad"""
    peak: Singles
    """Peak, (N,) greatest force across the axis over the mean force; 1 where no arc is known"""
    wall: Singles
    """(N,) force normal to the wall that an edge makes, over the mean; 0 without a wall"""
    lag: Singles
    """Lag, (N,) rad by which the upper end of the edges in the cut is behind their tips"""
    teeth: Ints
    """Teeth, (N,)"""
    tool: Ints
    """Tool, (N,) number of the tool"""
    workingstep: Ints
    """Workingstep, (N,) counted from 1; 0: none"""

    def __post_init__(self) -> None:
        count = len(self.until)
        if count == 0 or not (np.diff(self.until, prepend=0.0) > 0.0).all():
            raise ValueError("cells must be at least one and ascend in time")
        for field in fields(self):
            if len(getattr(self, field.name)) != count:
                raise ValueError(f"{field.name} must have {count} rows")

    def __len__(self) -> int:
        return len(self.until)

    @property
    def arcs(self) -> Arcs:
        """(N,) arcs of contact."""
        return Arcs(entry_angle=self.entry_angle, exit_angle=self.exit_angle, lag=self.lag)

    @property
    def duration(self) -> float:
        """Of the program at an override of 1, s."""
        return float(self.until[-1])


def course_of(episodes: Iterable[Episode], machine: Machine) -> NominalCourse:
    """Cells of a run.

    Parameters
    ----------
    episodes : iterable of Episode
        As the virtual machine makes them, forces as means of a revolution.
    machine : Machine

    Raises
    ------
    ValueError
        When nothing in it takes time.
    """
    parts = [part for episode in episodes for part in _cells(episode, machine)]
    if not parts:
        raise ValueError("there is nothing that takes time")
    names = [field.name for field in fields(NominalCourse)]
    return NominalCourse(**{
        name: np.concatenate([getattr(part, name) for part in parts]) for name in names
    })


def _cells(episode: Episode, machine: Machine) -> Iterator[NominalCourse]:
    """Cells of one episode; one of no length has none."""
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
    )


def _ratios(
    samples: Samples, entry: Floats, exit_: Floats, *, lag: Floats, edge: CuttingEdge | None
) -> tuple[Floats, Floats]:
    """Greatest force and force at the wall over the mean; told apart are 0.01 rad.

    At most what the teeth in the cut take when each has its thickest chip: where the map knows
    a section but hardly an arc, as on the way down, the arc alone would tell far too much.
    """
    peak, wall = np.ones(len(entry)), np.zeros(len(entry))
    cuts = np.flatnonzero((samples.cutting_force > 0.0) & (exit_ > entry))
    if edge is None or not len(cuts):
        return peak, wall
    keys = np.round(np.stack((entry[cuts], exit_[cuts], lag[cuts])), 2)
    arcs, row = np.unique(keys, axis=1, return_inverse=True)
    teeth = [
        EngagedTeeth(
            count=edge.teeth,
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
