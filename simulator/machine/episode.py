"""One stretch of time in the machine's run, in closed form: everything at any time in it.

During an episode the tool, the coolant and the running workingstep do not change; the axes move
along one stretch of path, or stand. Units mm, s, rev/s.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from simulator.machine.cutting import Edge
from simulator.machine.samples import Execution
from simulator.machine.spindle_course import SpindleCourse
from simulator.machine.tooth_loads import Teeth, wall_forces
from simulator.machine.wear import Wear
from simulator.motion.motion import Kinematics, Motion
from simulator.motion.passing import Passing
from simulator.motion.segments import Floats, Ints, Segments
from simulator.removal.stations import Stations, stretch_lengths

ARC_STEP = 0.2
"""rad of an arc over which the power of its axes counts as smooth"""


@dataclass(frozen=True, slots=True, kw_only=True)
class State:
    """What does not change during an episode."""

    execution: Execution
    line: int
    tool: int = 0
    workingstep: int = 0
    coolant_on: bool = False
    spindle_programmed: float = 0.0
    """rev/s, signed"""
    is_way: bool = False
    """at rest, before the first feed of the workingstep"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Course:
    """The way along a stretch, what it meets, and what cuts."""

    segments: Segments
    motion: Motion
    spindle_programmed: Floats
    """(N,) rev/s at the end of each segment; NaN: what it is"""
    stations: Stations
    edge: Edge | None
    """None: nothing is known of tool or stock, all is air"""
    wear: Wear
    teeth: Teeth | None = None
    """None: forces are means over a revolution"""
    way: int = 0
    """segments at the beginning that lead to the path of the workingstep"""
    back: int = 0
    """segments at the end that lead away from it"""

    @cached_property
    def passing(self) -> Passing:
        """When places of the way are passed."""
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
        """Which station holds at each of some times."""
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
        """When the cut that runs at some times began; all from the start of the stretch, s."""
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
    """s"""
    end: float
    """s"""
    state: State
    spindle: SpindleCourse
    """by time from the start of the program"""
    position: Floats
    """(3,) mm where the tool stands, or where the stretch begins"""
    course: Course | None = None
    """None: the axes stand"""
