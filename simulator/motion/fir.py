"""Fixed-time filter: the path at commanded speed, each axis smoothed by two moving averages.

The usual form in commercial controls. Averages over T1 and T2 seconds (finite impulse response)
bound acceleration and jerk: a change Δv of an axis' speed has an acceleration of at most
``|Δv|/T1``. Corners are rounded by ``e = v·(T1/4 + T2²/(12·T1))·sin(φ/2)``, φ the angle by
which the path turns, and arcs shrink. A run takes ``Σ L/v + T1 + T2``. Before, after and
between rapids the control waits until the filter has run out. It reads blocks ahead: one
without length takes no time. Units mm, s.

A state costs time in proportion to the pieces of path within one window.

Motions one after another, each from rest to rest, as one. Units mm, s.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from simulator.motion.moving_average import averaged, states_at_ends
from simulator.motion.path_limits import PathLimits, is_stop, path_limits
from simulator.motion.segments import AxisLimits, Floats, Ints, Kinematics, Motion, Segments
from simulator.motion.sweep import ends_of_all, swept


@dataclass(frozen=True, kw_only=True, eq=False)
class Chain:
    """Motions of consecutive rows of one stretch; a motion.

    Raises
    ------
    ValueError
        When there is no motion.
    """

    motions: Sequence[Motion]

    def __post_init__(self) -> None:
        if not self.motions:
            raise ValueError("a chain needs at least one motion")

    @cached_property
    def starts(self) -> Floats:
        """(K + 1,) s at which motions begin, and the last one ends."""
        durations = [motion.duration for motion in self.motions]
        return np.concatenate(([0.0], np.cumsum(durations)))

    @cached_property
    def first_rows(self) -> Ints:
        """(K,) row with which each motion begins."""
        counts = [len(motion.ends) for motion in self.motions]
        return np.concatenate(([0], np.cumsum(counts)[:-1])).astype(np.int64)

    @property
    def duration(self) -> float:
        """Time of all, s."""
        return float(self.starts[-1])

    @cached_property
    def ends(self) -> Floats:
        """(N,) s at which each segment ends."""
        return self._after_one_another([motion.ends for motion in self.motions])

    @cached_property
    def knots(self) -> Floats:
        """(K,) times between which speeds are smooth, s."""
        return np.unique(self._after_one_another([motion.knots for motion in self.motions]))

    def at(self, times: Floats) -> Kinematics:
        """State at (M,) times in s, ascending, between 0 and the duration."""
        which = np.searchsorted(self.starts[1:-1], times, side="right")
        bounds = np.searchsorted(which, np.arange(len(self.motions) + 1))
        parts = [
            self._part(row, times[begin:end])
            for row, (begin, end) in enumerate(pairwise(bounds.tolist()))
            if end > begin
        ]
        return Kinematics(
            position=np.concatenate([part.position for part in parts]),
            velocity=np.concatenate([part.velocity for part in parts]),
            acceleration=np.concatenate([part.acceleration for part in parts]),
            segment=np.concatenate([part.segment for part in parts]),
            station=np.concatenate([part.station for part in parts]),
        )

    def _part(self, row: int, times: Floats) -> Kinematics:
        """State at times that belong to one motion."""
        motion = self.motions[row]
        since = np.clip(times - self.starts[row], 0.0, motion.duration)
        at = motion.at(since)
        return Kinematics(
            position=at.position,
            velocity=at.velocity,
            acceleration=at.acceleration,
            segment=at.segment + self.first_rows[row],
            station=at.station,
        )

    def _after_one_another(self, times: Sequence[Floats]) -> Floats:
        shifted = [start + each for start, each in zip(self.starts[:-1], times, strict=True)]
        # Rounding of a sum must not pass what comes next.
        return np.minimum(np.maximum.accumulate(np.concatenate(shifted)), self.starts[-1])


LEAST_CHANGE = 1e-3
"""mm/s; a slower path is filtered as this one"""

SECOND_SHARE = 0.25
"""T2 over T1 where no axis has a jerk; our choice"""


@dataclass(frozen=True, slots=True, kw_only=True)
class FixedTimeFilter:
    """A control that filters the commands of its axes.

    Raises
    ------
    ValueError
        Unless T1 ≥ T2 > 0.
    """

    first: float
    """First, s, T1: sets the acceleration"""
    second: float
    """Second, s, T2: sets the jerk"""

    def __post_init__(self) -> None:
        if not self.first >= self.second > 0.0:
            raise ValueError(f"T1 {self.first} s, T2 {self.second} s: T1 ≥ T2 > 0 is needed")

    @property
    def window(self) -> float:
        """T1 + T2, s: how long a standstill takes to pass through."""
        return self.first + self.second

    def plan(self, segments: Segments, limits: AxisLimits) -> Motion:
        """Motion along segments, from rest to rest.

        Raises
        ------
        ValueError
            When there is no segment, or a segment's speed has no bound at all.
        """
        return self.plan_within(segments, path_limits(segments, limits))

    def plan_within(self, segments: Segments, bounds: PathLimits) -> Motion:
        """The same with the limits along the path, which are those of the axes."""
        rows = np.flatnonzero(segments.length > 0.0)
        if not len(rows):
            return swept(segments, rows, limits=bounds, corner=np.empty(0))
        moving, speed = segments, bounds.speed
        if len(rows) < len(segments):
            moving, speed = segments[rows], bounds.speed[rows]
        # The path rests for one window at its start, after each stop and at its end.
        rests = np.concatenate(([0], np.flatnonzero(is_stop(moving)) + 1, [len(rows)]))
        pieces = Pieces(segments=moving, speed=speed, rests=rests, window=self.window)
        return FilteredMotion(
            filter=self, segments=segments, speed=bounds.speed, rows=rows, pieces=pieces
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Pieces:
    """K lines, arcs and rests of the path before the filter, each at constant speed."""

    segments: Segments
    """all with length"""
    speed: Floats
    """Speed, mm/s, of each segment"""
    rests: Ints
    """rows of segments before which the path rests, and their number"""
    window: float
    """Window, s of a rest"""

    @cached_property
    def time(self) -> Floats:
        """(K+1,) s at which pieces begin and the last one ends."""
        times = np.insert(self.segments.length / self.speed, self.rests, self.window)
        return np.append(0.0, np.cumsum(times)) - self.window

    @cached_property
    def columns(self) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """Input of :func:`simulator.motion.moving_average.averaged`."""
        segments, speed, rests = self.segments, self.speed, self.rests
        rows, zero = np.arange(len(segments)), np.zeros(len(segments))
        turning = segments.turn * speed / segments.length
        along = segments.direction(rows, zero) * speed[:, None]
        spin = np.where(turning[:, None] == 0.0, 0.0, along)
        spin[rows, segments.normal] = 0.0
        # The change of direction per length, times v², is the cross part times the rate.
        cross = segments.curvature(rows, zero) * (speed**2)[:, None]
        np.divide(cross, turning[:, None], out=cross, where=turning[:, None] != 0.0)
        moving = np.stack((along - spin, spin, cross), axis=1)
        at_rest = np.concatenate((segments.start[:1], segments.end[rests[1:] - 1]))
        start = np.insert(segments.start, rests, at_rest, axis=0)
        velocity, rate = np.insert(moving, rests, 0.0, axis=0), np.insert(turning, rests, 0.0)
        return self.time, start, velocity, rate, states_at_ends(self.time, velocity, rate)


@dataclass(frozen=True, kw_only=True, eq=False)
class FilteredMotion:
    """N segments under a filter; a motion.

    Segment and station are those of the path before the filter, half a window earlier.
    """

    filter: FixedTimeFilter
    segments: Segments
    speed: Floats
    """Speed, (N,) mm/s before the filter"""
    rows: Ints
    """those that have length"""
    pieces: Pieces

    @cached_property
    def _piece(self) -> Ints:
        """Piece of each segment that has length."""
        order = np.arange(len(self.rows))
        return order + np.searchsorted(self.pieces.rests, order, "right")

    @cached_property
    def begin(self) -> Floats:
        """(N,) s at which the path before the filter enters a segment that has length."""
        begin = np.zeros(len(self.segments))
        begin[self.rows] = self.pieces.time[self._piece]
        return begin

    @cached_property
    def ends(self) -> Floats:
        """(N,) s at which each segment ends: half a window later, or a whole before a stop."""
        window = self.filter.window
        delay = np.full(len(self.rows), 0.5 * window)
        delay[self.pieces.rests[1:] - 1] = window
        ends = self.pieces.time[self._piece + 1] + delay
        return ends_of_all(len(self.segments), self.rows, ends)

    @property
    def duration(self) -> float:
        """Time of the whole stretch, s: up to the end of the last rest."""
        return float(self.pieces.time[-2] + self.filter.window)

    @property
    def knots(self) -> Floats:
        """(K,) times at which a corner enters or leaves one of the averages, s.

        And those half a window later, when the station comes to the corner.
        """
        first, second, window = self.filter.first, self.filter.second, self.filter.window
        delays = np.array([0.0, second, 0.5 * window, first, window])
        times = self.pieces.time[1:-1, None] + delays
        return np.unique(np.minimum(times, self.duration))

    def at(self, times: Floats) -> Kinematics:
        """State at (M,) times in s between 0 and the duration."""
        window, pieces = self.filter.window, self.pieces
        before = np.maximum(times - window, pieces.time[0])
        piece = np.searchsorted(pieces.time[1:-1], before, side="right")
        acceleration, velocity, position = averaged(
            before,
            piece,
            pieces.columns,
            self.filter.first,
            self.filter.second,
        )
        row = np.searchsorted(self.ends[:-1], times, side="right")
        passed = np.maximum(times - 0.5 * window - self.begin[row], 0.0)
        return Kinematics(
            position=position,
            velocity=velocity,
            acceleration=acceleration,
            segment=row,
            station=np.minimum(self.speed[row] * passed, self.segments.length[row]),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class FilterWithinLimits:
    """A control that takes for each run the shortest filter that the axes' limits allow.

    A run is what lies between two stops of the filter: feeds, or rapids. In a run of feeds the
    speed may turn round at its greatest feed; rapids begin and end at rest.
    """

    def plan(self, segments: Segments, limits: AxisLimits) -> Motion:
        """Motion along segments, from rest to rest.

        Raises
        ------
        ValueError
            When there is no segment, a segment's speed has no bound at all, or no axis limits
            acceleration.
        """
        bound = path_limits(segments, limits)
        moves = np.flatnonzero(np.diff(segments.is_rapid)) + 1
        bounds = [0, *moves.tolist(), len(segments)]
        motions = []
        for begin, end in pairwise(bounds):
            run = segments[begin:end]
            within = bound[begin:end]
            most = float(within.speed.max())
            is_rapid = bool(run.is_rapid[0])
            change = limits.rapid if is_rapid else np.full(3, 2.0 * most)
            motions.append(shortest_filter(limits, change).plan_within(run, within))
        return motions[0] if len(motions) == 1 else Chain(motions=motions)


def shortest_filter(limits: AxisLimits, change: Floats) -> FixedTimeFilter:
    """The shortest filter within which no change of speed passes an axis' limits.

    An axis that changes its speed by Δv needs ``T1 ≥ Δv/a`` and ``T1·T2 ≥ Δv/j``; both times
    equal where the jerk decides, a quarter of T1 for T2 where no jerk is known.

    Parameters
    ----------
    limits : AxisLimits
    change : (3,) array, mm/s
        Δv of each axis.

    Raises
    ------
    ValueError
        When no axis limits its acceleration, or a change is not finite there.
    """
    known = np.isfinite(limits.acceleration)
    wanted = np.maximum(change[known], LEAST_CHANGE)
    if not known.any() or not np.isfinite(wanted).all():
        raise ValueError("a filter needs axes with finite rapid, feed and acceleration")
    ramps = wanted / limits.acceleration[known]
    areas = wanted / limits.jerk[known]
    first = float(np.maximum(ramps, np.sqrt(areas)).max())
    second = min(first, float(areas.max()) / first) or SECOND_SHARE * first
    return FixedTimeFilter(first=first, second=second)
