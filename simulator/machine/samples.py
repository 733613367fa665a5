"""Samples of the virtual machine's sensors, and the time spans from which they are taken.

There is one row per sample. Units mm, s, N, W, rev/s; :mod:`simulator.machine.timeline` defines
the names and units used outside.

An episode is a time span of the machine's run in closed form: all values are known at any time.
During an episode the tool, the coolant and the workingstep do not change, and the axes move
along one stretch of path or stand still.
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
    """Dwell, tool change, or waiting for the spindle."""
    PROGRAM_STOPPED = 3
    PROGRAM_COMPLETED = 4


class PathMode(IntEnum):
    """Mode of the path: rapid, feed or none."""

    NONE = 0
    RAPID = 1
    FEED = 2


class Condition(IntEnum):
    """Condition of the drives, as MTConnect names it."""

    NORMAL = 0
    WARNING = 1
    """Load above the continuous power or the permitted force."""
    FAULT = 2
    """Load above 1.5 times the continuous power or the permitted force."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Samples:
    """M sensor samples in order of time."""

    time: Floats
    """Time from the start of the program, (M,), s."""
    position: Floats
    """Position of the tool in program coordinates, (M, 3), mm."""
    velocity: Floats
    """Velocity of the tool, (M, 3), mm/s."""
    feed_programmed: Floats
    """Programmed feed, (M,), mm/s; 0 in rapid and at rest."""
    spindle_programmed: Floats
    """Programmed spindle speed, (M,), rev/s, positive clockwise."""
    spindle_speed: Floats
    """Actual spindle speed, (M,), rev/s, positive clockwise."""
    axis_power: Floats
    """Power of the axes X, Y and Z, (M, 3), W."""
    spindle_power: Floats
    """Power of the spindle drive, including cutting, (M,), W."""
    coolant_power: Floats
    """Power of the coolant pump, (M,), W."""
    base_power: Floats
    """Base power of the machine, (M,), W."""
    cutting_power: Floats
    """Cutting power at the edge, (M,), W."""
    cutting_force: Floats
    """Tangential cutting force, (M,), N."""
    feed_force: Floats
    """Force against the feed, (M,), N."""
    back_force: Floats
    """Force across the feed, away from the surface, (M,), N."""
    removal_rate: Floats
    """Removal rate, (M,), mm³/s."""
    chip_thickness: Floats
    """Mean chip thickness, (M,), mm."""
    thrust: Floats
    """Thrust along the axis of a drill or a plunging mill, (M,), N."""
    deflection: Floats
    """Deflection of an end mill while it generates a wall, (M,), mm."""
    axial_depth: Floats
    """Axial depth of cut, (M,), mm."""
    radial_width: Floats
    """Radial width of cut, (M,), mm."""
    execution: Ints
    """Execution state of the control, (M,), as :class:`Execution`."""
    path_mode: Ints
    """Mode of the path, (M,), as :class:`PathMode`."""
    coolant: Ints
    """Coolant state, (M,): 0 off, 1 on."""
    overload: Ints
    """Load condition of the spindle drive, (M,), as :class:`Condition`."""
    line: Ints
    """Program line, (M,)."""
    tool: Ints
    """Number of the tool, (M,); 0 for none."""
    workingstep: Ints
    """Number of the running workingstep, (M,), counted from 1; 0 for none."""

    def __len__(self) -> int:
        return len(self.time)

    @property
    def direction(self) -> Ints:
        """Direction of travel of the axes, (M, 3), as :class:`TravelDirection`."""
        return 1 + np.sign(self.velocity).astype(np.int64)

    @property
    def rotation(self) -> Ints:
        """Direction of rotation of the spindle, (M,), as :class:`Rotation`."""
        return 1 + np.sign(self.spindle_speed).astype(np.int64)

    @property
    def program(self) -> Ints:
        """Index of the running program, (M,); always 0, as there is only one."""
        return np.zeros(len(self), dtype=np.int64)

    @property
    def path_speed(self) -> Floats:
        """Speed along the path, (M,), mm/s."""
        speed: Floats = np.linalg.norm(self.velocity, axis=1)
        return speed

    @property
    def total_power(self) -> Floats:
        """Total power of all components, (M,), W."""
        x, y, z = self.axis_power.T
        total: Floats = x + y + z + self.spindle_power + self.coolant_power + self.base_power
        return total


def joined(parts: Sequence[Samples]) -> Samples:
    """Concatenate samples in time."""
    return Samples(**{
        field.name: np.concatenate([getattr(part, field.name) for part in parts])
        for field in fields(Samples)
    })


ARC_STEP = 0.2
"""Angle of an arc, rad, over which the power of its axes counts as smooth."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EpisodeState:
    """State of the machine that is constant during an episode."""

    execution: Execution
    line: int
    tool: int = 0
    workingstep: int = 0
    coolant_on: bool = False
    spindle_programmed: float = 0.0
    """Programmed spindle speed, rev/s, positive clockwise."""
    is_way: bool = False
    """Whether the machine stands before the first feed move of the workingstep."""


@dataclass(frozen=True, kw_only=True, eq=False)
class EpisodeCourse:
    """Motion along a stretch of path, with its engagement and cutting edge."""

    segments: Segments
    motion: Motion
    spindle_programmed: Floats
    """Programmed spindle speed at the end of each segment, (N,), rev/s; NaN: unchanged."""
    stations: Stations
    edge: CuttingEdge | None
    """Cutting edge; None if the tool or stock is unknown and nothing is cut."""
    wear: Wear
    teeth: ToothOptions | None = None
    """Options for forces of single teeth; None for mean forces over a revolution."""
    way: int = 0
    """Number of segments at the beginning that lead to the path of the workingstep."""
    back: int = 0
    """Number of segments at the end that lead away from the path of the workingstep."""
    power_factor: Floats | None = None
    """Factor on the power of the motors in each segment, (N,); None: 1 everywhere."""

    @cached_property
    def passing(self) -> Passing:
        """Times at which points of the path are passed."""
        return Passing(segments=self.segments, motion=self.motion)

    @property
    def offsets(self) -> Floats:
        """Length of path before each segment, (N + 1,), mm."""
        return self.passing.offsets

    @cached_property
    def station_ends(self) -> Floats:
        """Length of path up to the end of each station, (M,), mm."""
        return self.offsets[self.stations.segment] + self.stations.station

    @cached_property
    def walls(self) -> Floats:
        """Wall forces, (2, M), of :func:`simulator.machine.tooth_loads.wall_forces`."""
        if self.edge is None:
            return np.zeros((2, len(self.stations)))
        return wall_forces(self.stations, self.edge)

    def stations_at(self, kinematics: Kinematics) -> Ints:
        """Index of the station that applies at each of the given times."""
        along = self.offsets[kinematics.segment] + kinematics.station
        rows = np.searchsorted(self.station_ends, along, side="left")
        # A segment waits at its start for the control's filter; the station there is the last
        # one of the segment before, which may be a rapid.
        first = self._first_stations
        return np.clip(rows, first[kinematics.segment], first[kinematics.segment + 1] - 1)

    def beyond(self, kinematics: Kinematics, rows: Ints) -> Floats:
        """Relative positions within stretches: -1/2 at the beginning, 1/2 at the end."""
        ends = self.stations.station[rows]
        lengths = self._stretches[rows]
        left = (ends - kinematics.station) / np.where(lengths > 0.0, lengths, 1.0)
        place: Floats = np.clip(0.5 - left, -0.5, 0.5)
        return place

    @cached_property
    def _first_stations(self) -> Ints:
        """Index of the first station of each segment, and the number of stations, (N + 1,)."""
        return np.searchsorted(self.stations.segment, np.arange(len(self.segments) + 1))

    @cached_property
    def _stretches(self) -> Floats:
        """Lengths of :func:`simulator.removal.stations.stretch_lengths`, (M,), mm."""
        return stretch_lengths(self.stations)

    @cached_property
    def nodes(self) -> Floats:
        """Times between which all powers are smooth, as far as known, (K,), s."""
        places = np.sort(np.concatenate((self.station_ends, self._arc_places())))
        known = (self.motion.knots, self.motion.ends, self.passing.times(places))
        return np.unique(np.concatenate(known))

    def _arc_places(self) -> Floats:
        """Path lengths at which the direction of arcs has changed noticeably, mm."""
        turn = np.abs(self.segments.turn)
        count = np.ceil(turn / ARC_STEP).astype(np.int64)
        rows = np.repeat(np.arange(len(turn)), count)
        first = np.repeat(np.cumsum(count) - count, count)
        part = (np.arange(len(rows)) - first) / np.maximum(count[rows], 1)
        return self.offsets[rows] + part * self.segments.length[rows]

    def worn(self, times: Floats) -> Floats:
        """Flank wear at times from the start of the stretch, mm."""
        if not self.wear.grows:
            return np.full(len(times), self.wear.flank)
        return self.wear.flanks(np.interp(times, *self._cut_clock))

    @property
    def cutting_seconds(self) -> float:
        """Time during which chips are cut, s."""
        return float(self._cut_clock[1][-1])

    def entry_times(self, times: Floats) -> Floats:
        """Start times of the cuts active at given times, s from the stretch's start."""
        ends, _ = self._cut_clock
        cuts = self.stations.section > 0.0
        begins = np.flatnonzero(cuts & ~np.concatenate(([False], cuts[:-1])))
        known = np.concatenate(([0.0], ends[begins]))
        return known[np.searchsorted(known, times, side="right") - 1]

    @cached_property
    def _cut_clock(self) -> tuple[Floats, Floats]:
        """End times of stations and cutting time up to each, (M + 1,), s."""
        ends = np.concatenate(([0.0], self.passing.times(self.station_ends)))
        seconds = np.cumsum(np.diff(ends) * (self.stations.section > 0.0))
        return ends, np.concatenate(([0.0], seconds))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Episode:
    """State, motion and spindle speed of the machine between two times."""

    begin: float
    """Begin of the episode, s from the start of the program."""
    end: float
    """End of the episode, s from the start of the program."""
    state: EpisodeState
    spindle: SpindleCourse
    """Spindle speed over time from the start of the program."""
    position: Floats
    """Position at rest or at the start of the stretch, (3,), mm."""
    course: EpisodeCourse | None = None
    """Motion along a stretch; None while the axes stand still."""

    def kinematics(self, times: Floats) -> Kinematics:
        """State of the axes at (M,) times, s from the start of the program."""
        if self.course is not None:
            since = np.clip(times - self.begin, 0.0, self.course.motion.duration)
            return self.course.motion.at(since)
        count = len(times)
        return Kinematics(
            position=np.tile(self.position, (count, 1)),
            velocity=np.zeros((count, 3)),
            acceleration=np.zeros((count, 3)),
            segment=np.zeros(count, dtype=np.int64),
            station=np.zeros(count),
        )

    def power_factor(self, kinematics: Kinematics) -> Floats:
        """Factor on the power of the motors at M times, (M,)."""
        if self.course is None or self.course.power_factor is None:
            return np.ones(len(kinematics.segment))
        return self.course.power_factor[kinematics.segment]
