"""Control with a fixed-time filter: each axis is smoothed by two moving averages.

This is common in commercial controls. The path runs at commanded speed, and averages over T1
and T2 seconds (finite impulse response) limit acceleration and jerk: a change Δv of an axis'
speed has an acceleration of at most ``|Δv|/T1``. Corners are rounded by ``e = v·(T1/4 +
T2²/(12·T1))·sin(φ/2)``, where φ is the angle by which the path turns, and arcs shrink. A run
takes ``Σ L/v + T1 + T2``. Before, after and between rapids the control waits until the filter
has settled. It reads blocks ahead: a block without length takes no time. Computing a state
takes time proportional to the number of pieces of path within one window.

The module also joins consecutive motions, each from rest to rest, into one. Units mm, s.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from simulator.motion.moving_average import averaged, states_at_ends
from simulator.motion.path_limits import PathLimits, is_stop, path_limits
from simulator.motion.segments import (
    AxisLimits,
    Floats,
    Ints,
    Kinematics,
    Motion,
    Segments,
    distinct,
)
from simulator.motion.sweep import ends_of_all, swept


@dataclass(frozen=True, kw_only=True, eq=False)
class Chain:
    """Consecutive motions of one stretch, joined to a single motion.

    Raises
    ------
    ValueError
        If there is no motion.
    """

    motions: Sequence[Motion]

    def __post_init__(self) -> None:
        if not self.motions:
            raise ValueError("a chain needs at least one motion")

    @cached_property
    def starts(self) -> Floats:
        """Start times of the motions, and the end of the last, (K + 1,), s."""
        durations = [motion.duration for motion in self.motions]
        return np.concatenate(([0.0], np.cumsum(durations)))

    @cached_property
    def first_rows(self) -> Ints:
        """First segment row of each motion, (K,)."""
        counts = [len(motion.ends) for motion in self.motions]
        return np.concatenate(([0], np.cumsum(counts)[:-1])).astype(np.int64)

    @property
    def duration(self) -> float:
        """Total duration of all motions, s."""
        return float(self.starts[-1])

    @cached_property
    def ends(self) -> Floats:
        """End time of each segment, (N,), s."""
        return self._after_one_another([motion.ends for motion in self.motions])

    @cached_property
    def knots(self) -> Floats:
        """Times between which speeds are smooth, (K,), s."""
        return distinct(self._after_one_another([motion.knots for motion in self.motions]))

    def at(self, times: Floats) -> Kinematics:
        """State of the axes at (M,) ascending times in s, between 0 and the duration."""
        which = np.searchsorted(self.starts[1:-1], times, side="right")
        bounds = np.searchsorted(which, np.arange(len(self.motions) + 1))
        parts = [
            self._part(row, times[begin:end])
            for row, (begin, end) in enumerate(pairwise(bounds.tolist()))
            if end > begin
        ]
        if len(parts) == 1:
            return parts[0]
        return Kinematics(
            position=np.concatenate([part.position for part in parts]),
            velocity=np.concatenate([part.velocity for part in parts]),
            acceleration=np.concatenate([part.acceleration for part in parts]),
            segment=np.concatenate([part.segment for part in parts]),
            station=np.concatenate([part.station for part in parts]),
        )

    def _part(self, row: int, times: Floats) -> Kinematics:
        """State of the axes at times that belong to one motion."""
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
        # A rounding error of a sum must not exceed the next time.
        return np.minimum(np.maximum.accumulate(np.concatenate(shifted)), self.starts[-1])


LEAST_CHANGE = 1e-3
"""Least change of speed for which a filter is designed, mm/s."""

SECOND_SHARE = 0.25
"""Ratio of T2 to T1 if no axis has a jerk limit; an assumption."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FixedTimeFilter:
    """Control that filters the position commands of its axes with two moving averages.

    Raises
    ------
    ValueError
        Unless T1 ≥ T2 > 0.
    """

    first: float
    """Time T1 of the first average, s; determines the acceleration."""
    second: float
    """Time T2 of the second average, s; determines the jerk."""

    def __post_init__(self) -> None:
        if not self.first >= self.second > 0.0:
            raise ValueError(f"T1 {self.first} s, T2 {self.second} s: T1 ≥ T2 > 0 is needed")

    @property
    def window(self) -> float:
        """Length of the filter window T1 + T2, s."""
        return self.first + self.second

    def plan(self, segments: Segments, limits: AxisLimits) -> Motion:
        """Plan the motion along segments, from rest to rest.

        Raises
        ------
        ValueError
            If there is no segment, or a segment's speed is unlimited.
        """
        return self.plan_within(segments, path_limits(segments, limits))

    def plan_within(self, segments: Segments, bounds: PathLimits) -> Motion:
        """Plan the motion along segments with known limits along the path."""
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
    """Path before the filter, as K lines, arcs and rests at constant speed."""

    segments: Segments
    """Segments of the path, all with a length."""
    speed: Floats
    """Speed of each segment, mm/s."""
    rests: Ints
    """Rows of segments before which the path rests, and the number of segments."""
    window: float
    """Duration of a rest, s: the filter window."""

    @cached_property
    def time(self) -> Floats:
        """Start times of the pieces, and the end of the last, (K+1,), s."""
        times = np.insert(self.segments.length / self.speed, self.rests, self.window)
        return np.append(0.0, np.cumsum(times)) - self.window

    @cached_property
    def columns(self) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """Pieces as arguments of :func:`simulator.motion.moving_average.averaged`."""
        segments, speed, rests = self.segments, self.speed, self.rests
        rows, zero = np.arange(len(segments)), np.zeros(len(segments))
        turning = segments.turn * speed / segments.length
        along = segments.direction(rows, zero) * speed[:, None]
        spin = np.where(turning[:, None] == 0.0, 0.0, along)
        spin[rows, segments.normal] = 0.0
        # The curvature times v², divided by the turning rate, gives the cross component.
        cross = segments.curvature(rows, zero) * (speed**2)[:, None]
        np.divide(cross, turning[:, None], out=cross, where=turning[:, None] != 0.0)
        moving = np.stack((along - spin, spin, cross), axis=1)
        at_rest = np.concatenate((segments.start[:1], segments.end[rests[1:] - 1]))
        start = np.insert(segments.start, rests, at_rest, axis=0)
        velocity, rate = np.insert(moving, rests, 0.0, axis=0), np.insert(turning, rests, 0.0)
        return self.time, start, velocity, rate, states_at_ends(self.time, velocity, rate)


@dataclass(frozen=True, kw_only=True, eq=False)
class FilteredMotion:
    """Motion along N segments as smoothed by a fixed-time filter.

    Segment and station refer to the path before the filter, half a window earlier.
    """

    filter: FixedTimeFilter
    segments: Segments
    speed: Floats
    """Speed of each segment before the filter, (N,), mm/s."""
    rows: Ints
    """Rows of the segments that have a length."""
    pieces: Pieces

    @cached_property
    def _piece(self) -> Ints:
        """Index of the piece for each segment that has a length."""
        order = np.arange(len(self.rows))
        return order + np.searchsorted(self.pieces.rests, order, "right")

    @cached_property
    def begin(self) -> Floats:
        """Times at which the unfiltered path enters each segment, (N,), s; 0 without length."""
        begin = np.zeros(len(self.segments))
        begin[self.rows] = self.pieces.time[self._piece]
        return begin

    @cached_property
    def ends(self) -> Floats:
        """End time of each segment, (N,), s: half a window late, a whole one before stops."""
        window = self.filter.window
        delay = np.full(len(self.rows), 0.5 * window)
        delay[self.pieces.rests[1:] - 1] = window
        ends = self.pieces.time[self._piece + 1] + delay
        return ends_of_all(len(self.segments), self.rows, ends)

    @property
    def duration(self) -> float:
        """Duration of the whole stretch, s, up to the end of the last rest."""
        return float(self.pieces.time[-2] + self.filter.window)

    @property
    def knots(self) -> Floats:
        """Times between which speeds are smooth, (K,), s.

        A corner enters or leaves one of the averages at each of them, or the station reaches
        it.
        """
        first, second, window = self.filter.first, self.filter.second, self.filter.window
        delays = np.array([0.0, second, 0.5 * window, first, window])
        times = self.pieces.time[1:-1, None] + delays
        return distinct(np.minimum(times, self.duration))

    def at(self, times: Floats) -> Kinematics:
        """State of the axes at (M,) times in s, between 0 and the duration."""
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
    """Control that uses for each run the shortest filter that the axis limits allow.

    A run is the part of the path between two stops of the filter: feed moves, or rapids. In a
    run of feed moves the velocity may reverse at its greatest feed; rapids begin and end at
    rest.
    """

    def plan(self, segments: Segments, limits: AxisLimits) -> Motion:
        """Plan the motion along segments, from rest to rest.

        Raises
        ------
        ValueError
            If there is no segment, a segment's speed is unlimited, or no axis limits the
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
    """Shortest filter with which a change of speed stays within the limits of each axis.

    An axis that changes its speed by Δv needs ``T1 ≥ Δv/a`` and ``T1·T2 ≥ Δv/j``. Both times
    are equal if the jerk decides; T2 is a quarter of T1 if no jerk limit is known.

    Parameters
    ----------
    change : (3,) array, mm/s
        Change Δv of the speed of each axis.

    Raises
    ------
    ValueError
        If no axis limits its acceleration, or a change is not finite for such an axis.
    """
    known = np.isfinite(limits.acceleration)
    wanted = np.maximum(change[known], LEAST_CHANGE)
    if not known.any() or not np.isfinite(wanted).all():
        raise ValueError("the FIR filter needs axes with finite rapid, feed and acceleration")
    ramps = wanted / limits.acceleration[known]
    areas = wanted / limits.jerk[known]
    first = float(np.maximum(ramps, np.sqrt(areas)).max())
    second = min(first, float(areas.max()) / first) or SECOND_SHARE * first
    return FixedTimeFilter(first=first, second=second)
