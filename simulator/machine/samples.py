"""Samples of the virtual machine's sensors, and the stretches of time that they are taken from.

One row a sample. Units mm, s, N, W, rev/s; the names that the outside reads, and its units, are
those of :mod:`simulator.timeline`.

An episode is a stretch of time in the machine's run in closed form: everything at any time in
it. The tool, the coolant and the running workingstep do not change; the axes move along one
stretch of path, or stand.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from enum import IntEnum
from functools import cached_property

import numpy as np

from simulator.machine.cutting import CuttingEdge
from simulator.machine.spindle_course import SpindleCourse
from simulator.machine.tooth_loads import ToothOptions, wall_forces
from simulator.machine.wear import Wear
from simulator.motion.passing import Passing
from simulator.motion.segments import Floats, Ints, Kinematics, Motion, Segments
from simulator.removal.stations import Stations, stretch_lengths


class TravelDirection(IntEnum):
    """Direction in which an axis moves."""

    NEGATIVE = 0
    NONE = 1
    POSITIVE = 2


class Rotation(IntEnum):
    """Direction in which the spindle turns, as MTConnect names it; M3 is clockwise."""

    COUNTER_CLOCKWISE = 0
    NONE = 1
    CLOCKWISE = 2


class Execution(IntEnum):
    """Execution state of the control, as MTConnect names it."""

    READY = 0
    ACTIVE = 1
    WAIT = 2
    """dwell, tool change, waiting for the spindle"""
    PROGRAM_STOPPED = 3
    PROGRAM_COMPLETED = 4


class PathMode(IntEnum):
    """Mode of the path: rapid, feed or none."""

    NONE = 0
    RAPID = 1
    FEED = 2


class Condition(IntEnum):
    """Health of the drives."""

    NORMAL = 0
    WARNING = 1
    """above the continuous power or the permitted force"""
    FAULT = 2
    """half as much again"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Samples:
    """M samples, ascending in time."""

    time: Floats
    """Time, (M,) s from the start of the program"""
    position: Floats
    """Position, (M, 3) mm, of the tool in the program's coordinates"""
    velocity: Floats
    """Velocity, (M, 3) mm/s"""
    feed_programmed: Floats
    """Feed programmed, (M,) mm/s; 0 in rapid and at rest"""
    spindle_programmed: Floats
    """Spindle programmed, (M,) rev/s, signed: positive clockwise"""
    spindle_speed: Floats
    """Spindle speed, (M,) rev/s, signed"""
    axis_power: Floats
    """Axis power, (M, 3) W"""
    spindle_power: Floats
    """Spindle power, (M,) W, cutting included"""
    coolant_power: Floats
    """Coolant power, (M,) W"""
    base_power: Floats
    """Base power, (M,) W"""
    cutting_power: Floats
    """Cutting power, (M,) W at the edge"""
    cutting_force: Floats
    """Cutting force, (M,) N, tangential"""
    feed_force: Floats
    """Feed force, (M,) N"""
    back_force: Floats
    """Back force, (M,) N"""
    removal_rate: Floats
    """Removal rate, (M,) mm³/s"""
    chip_thickness: Floats
    """Chip thickness, (M,) mm, mean"""
    thrust: Floats
    """Thrust, (M,) N, along the axis, of a drill or of a mill that goes straight down"""
    deflection: Floats
    """Deflection, (M,) mm that an end mill gives way while it makes a wall"""
    axial_depth: Floats
    """Axial depth, (M,) mm"""
    radial_width: Floats
    """Radial width, (M,) mm"""
    execution: Ints
    """Execution, (M,) :class:`Execution`"""
    path_mode: Ints
    """Path mode, (M,) :class:`PathMode`"""
    coolant: Ints
    """Coolant, (M,) 0 off, 1 on"""
    overload: Ints
    """Overload, (M,) :class:`Condition` of the spindle drive"""
    line: Ints
    """Line, (M,) of the program"""
    tool: Ints
    """Tool, (M,) number of the tool, 0: none"""
    workingstep: Ints
    """Workingstep, (M,) which of the program's workingsteps runs, counted from 1; 0: none"""

    def __len__(self) -> int:
        return len(self.time)

    @property
    def direction(self) -> Ints:
        """(M, 3) :class:`TravelDirection` of the axes."""
        return 1 + np.sign(self.velocity).astype(np.int64)

    @property
    def rotation(self) -> Ints:
        """(M,) :class:`Rotation` of the spindle."""
        return 1 + np.sign(self.spindle_speed).astype(np.int64)

    @property
    def program(self) -> Ints:
        """(M,) which program runs: there is one."""
        return np.zeros(len(self), dtype=np.int64)

    @property
    def path_speed(self) -> Floats:
        """(M,) mm/s along the path."""
        speed: Floats = np.linalg.norm(self.velocity, axis=1)
        return speed

    @property
    def total_power(self) -> Floats:
        """(M,) W, of all components."""
        x, y, z = self.axis_power.T
        total: Floats = x + y + z + self.spindle_power + self.coolant_power + self.base_power
        return total


def joined(parts: Sequence[Samples]) -> Samples:
    """Samples one after another."""
    return Samples(**{
        field.name: np.concatenate([getattr(part, field.name) for part in parts])
        for field in fields(Samples)
    })


ARC_STEP = 0.2
"""rad of an arc over which the power of its axes counts as smooth"""


@dataclass(frozen=True, slots=True, kw_only=True)
class EpisodeState:
    """State that is constant during an episode."""

    execution: Execution
    line: int
    tool: int = 0
    workingstep: int = 0
    coolant_on: bool = False
    spindle_programmed: float = 0.0
    """Spindle programmed, rev/s, signed"""
    is_way: bool = False
    """at rest, before the first feed of the workingstep"""


@dataclass(frozen=True, kw_only=True, eq=False)
class EpisodeCourse:
    """The way along a stretch, what it meets, and what cuts."""

    segments: Segments
    motion: Motion
    spindle_programmed: Floats
    """Spindle programmed, (N,) rev/s at the end of each segment; NaN: what it is"""
    stations: Stations
    edge: CuttingEdge | None
    """None: nothing is known of tool or stock, all is air"""
    wear: Wear
    teeth: ToothOptions | None = None
    """None: forces are means over a revolution"""
    way: int = 0
    """segments at the beginning that lead to the path of the workingstep"""
    back: int = 0
    """segments at the end that lead away from it"""

    @cached_property
    def passing(self) -> Passing:
        """Times at which places of the path are passed."""
        return Passing(segments=self.segments, motion=self.motion)

    @property
    def offsets(self) -> Floats:
        """(N + 1,) mm of path before each segment."""
        return self.passing.offsets

    @cached_property
    def station_ends(self) -> Floats:
        """(M,) mm of path at which each station ends."""
        return self.offsets[self.stations.segment] + self.stations.station

    @cached_property
    def walls(self) -> Floats:
        """(2, M) of :func:`simulator.machine.tooth_loads.wall_forces`."""
        if self.edge is None:
            return np.zeros((2, len(self.stations)))
        return wall_forces(self.stations, self.edge)

    def stations_at(self, kinematics: Kinematics) -> Ints:
        """Index of the station that applies at each of some times."""
        along = self.offsets[kinematics.segment] + kinematics.station
        rows = np.searchsorted(self.station_ends, along, side="left")
        return np.minimum(rows, len(self.stations) - 1)

    def beyond(self, kinematics: Kinematics, rows: Ints) -> Floats:
        """Places in the stretches of stations: -1/2 at the beginning, 1/2 at the end."""
        ends = self.stations.station[rows]
        lengths = self._stretches[rows]
        left = (ends - kinematics.station) / np.where(lengths > 0.0, lengths, 1.0)
        place: Floats = np.clip(0.5 - left, -0.5, 0.5)
        return place

    @cached_property
    def _stretches(self) -> Floats:
        """(M,) mm, of :func:`simulator.removal.stations.stretch_lengths`."""
        return stretch_lengths(self.stations)

    @cached_property
    def nodes(self) -> Floats:
        """(K,) times between which all powers are smooth, as far as that is known."""
        places = np.sort(np.concatenate((self.station_ends, self._arc_places())))
        return np.unique(np.concatenate((self.motion.knots, self.passing.times(places))))

    def _arc_places(self) -> Floats:
        """Mm of path at which the directions of arcs have changed noticeably."""
        turn = np.abs(self.segments.turn)
        count = np.ceil(turn / ARC_STEP).astype(np.int64)
        rows = np.repeat(np.arange(len(turn)), count)
        first = np.repeat(np.cumsum(count) - count, count)
        part = (np.arange(len(rows)) - first) / np.maximum(count[rows], 1)
        return self.offsets[rows] + part * self.segments.length[rows]

    def worn(self, times: Floats) -> Floats:
        """Flank wear in mm at times from the start of the stretch."""
        if not self.wear.grows:
            return np.full(len(times), self.wear.flank)
        return self.wear.flanks(np.interp(times, *self._cut_clock))

    @property
    def cutting_seconds(self) -> float:
        """Time with chips, s."""
        return float(self._cut_clock[1][-1])

    def entry_times(self, times: Floats) -> Floats:
        """Start of the cut that runs at some times; all from the start of the stretch, s."""
        ends, _ = self._cut_clock
        cuts = self.stations.section > 0.0
        begins = np.flatnonzero(cuts & ~np.concatenate(([False], cuts[:-1])))
        known = np.concatenate(([0.0], ends[begins]))
        return known[np.searchsorted(known, times, side="right") - 1]

    @cached_property
    def _cut_clock(self) -> tuple[Floats, Floats]:
        """(M + 1,) times at which stations end, and s with chips until then."""
        ends = np.concatenate(([0.0], self.passing.times(self.station_ends)))
        seconds = np.cumsum(np.diff(ends) * (self.stations.section > 0.0))
        return ends, np.concatenate(([0.0], seconds))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Episode:
    """The machine between two times."""

    begin: float
    """Begin, s"""
    end: float
    """End, s"""
    state: EpisodeState
    spindle: SpindleCourse
    """by time from the start of the program"""
    position: Floats
    """Position, (3,) mm where the tool stands, or where the stretch begins"""
    course: EpisodeCourse | None = None
    """None: the axes stand"""
