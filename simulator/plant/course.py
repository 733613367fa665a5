"""What a program does at an override of 1, cell by cell: the ground on which the loop walks.

A control scales the time of a whole path by the override, and so does this: the axes follow
the planned motion faster or slower, and a cell is passed in its time over the override.
Accelerations then grow with its square, as they do in real controls; between 0 and 1.2 no
limit is passed by much. Within a cell all is constant; cells end with stretches, so that the
whole time is exact. Units mm, s, N, W, rad, rev/s.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields
from math import ceil, hypot

import numpy as np
from numpy.typing import NDArray

from simulator.machine.cutting import Edge, engaged_width
from simulator.machine.episode import Episode
from simulator.machine.samples import PathMode, Samples
from simulator.machine.sensing import sensed
from simulator.motion.segments import Bools, Floats, Ints
from simulator.physics import flank
from simulator.physics.milling import RADIAL_SHARE
from simulator.physics.spindle_motion import idle_power
from simulator.physics.tooth_means import Arcs
from simulator.plant.pattern import Teeth, peak_over_mean, wall_over_mean
from simulator.removal.stations import CutKind
from simulator.spec import Machine

INTERVAL = 0.01
"""s, a cell at most: a revolution at 6000 rpm"""

MOST = 65_536
"""cells made at once"""

Singles = NDArray[np.float32]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NominalCourse:
    """N cells, ascending in time; bulk columns in single precision for the sake of memory."""

    until: Floats
    """(N,) s from the start of the program at which each cell ends"""
    can_override: Bools
    """(N,) whether the feed override acts: not in rapid nor at rest"""
    position: Singles
    """(N, 3) mm, of the tool in the middle"""
    feed: Singles
    """(N,) mm/s along the path"""
    programmed: Singles
    """(N,) mm/s; 0 where nothing is programmed"""
    force: Singles
    """(N,) N, tangential, mean of a revolution"""
    land_force: Singles
    """(N,) N per mm of flank wear, tangential, mean; no feed changes it"""
    exponent: Singles
    """(N,) p of force over feed, 1 − m_c"""
    removal_rate: Singles
    """(N,) mm³/s"""
    axial_depth: Singles
    """(N,) mm"""
    idle_power: Singles
    """(N,) W of the main drive without the cut"""
    spindle_speed: Singles
    """(N,) rev/s, magnitude"""
    diameter: Singles
    """(N,) mm at which the cutting speed drives the force; 0 in air"""
    entry_angle: Singles
    """(N,) rad; both 0 where no arc is known"""
    exit_angle: Singles
    """(N,) rad"""
    peak: Singles
    """(N,) greatest force across the axis over the mean force; 1 where no arc is known"""
    wall: Singles
    """(N,) force normal to the wall that an edge makes, over the mean; 0 without a wall"""
    lag: Singles
    """(N,) rad by which the upper end of the edges in the cut is behind their tips"""
    teeth: Ints
    """(N,)"""
    tool: Ints
    """(N,) number of the tool"""
    workingstep: Ints
    """(N,) counted from 1; 0: none"""

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
        has_arc = stations.kind[rows] == CutKind.MILLING
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
    samples: Samples, entry: Floats, exit_: Floats, *, lag: Floats, edge: Edge | None
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
        Teeth(
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


def _exponent(edge: Edge | None) -> float:
    return 1.0 if edge is None else 1.0 - edge.kienzle.m_c


def _single(values: Floats) -> Singles:
    return values.astype(np.float32)
