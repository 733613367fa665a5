"""Times and speeds at which points along a path are passed, for example on a tool path.

Speeds are lower than the feed where a path turns, begins or ends. Units mm, s.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from simulator.motion.segments import (
    AxisLimits,
    ControlModel,
    Floats,
    Ints,
    Motion,
    Segments,
    distinct,
)
from simulator.motion.tool_path import ToolPathRun


@dataclass(frozen=True, kw_only=True, eq=False)
class Passing:
    """Stretch of path from rest to rest, with its motion over distance."""

    segments: Segments
    motion: Motion

    @cached_property
    def offsets(self) -> Floats:
        """Length of path before each segment, (N + 1,), mm."""
        return np.concatenate(([0.0], np.cumsum(self.segments.length)))

    @cached_property
    def dense_times(self) -> Floats:
        """Times between which the path length is nearly linear, (4·K + 1,), s."""
        knots = self._knots
        parts = np.array([0.25, 0.5, 0.75, 1.0])
        inside = knots[:-1, None] + np.diff(knots)[:, None] * parts
        return np.concatenate((knots[:1], inside.ravel()))

    @cached_property
    def _knots(self) -> Floats:
        """Times between which speeds are smooth, with the ends of the segments, (K + 1,), s."""
        return distinct(np.concatenate((self.motion.knots, self.motion.ends)))

    @cached_property
    def clock(self) -> tuple[Floats, Floats]:
        """Times in s and path lengths in mm, dense enough for linear interpolation."""
        return self._clock_at(self.dense_times)

    def _clock_at(self, times: Floats) -> tuple[Floats, Floats]:
        at = self.motion.at(times)
        along = self.offsets[at.segment] + at.station
        return times, np.maximum.accumulate(along)

    def _clock_near(self, segment: Ints) -> tuple[Floats, Floats]:
        """Part of the clock in which some segments are passed.

        States of the axes cost most of the time, and few segments are looked at.
        """
        ends, knots = self.motion.ends, self._knots
        rows = distinct(segment)
        first = np.searchsorted(knots, np.where(rows > 0, ends[rows - 1], 0.0), "right") - 1
        last = np.searchsorted(knots, ends[rows])
        # One more stretch on either side allows for rounding.
        changes = np.zeros(len(knots) + 1, dtype=np.int64)
        np.add.at(changes, np.maximum(first - 1, 0), 1)
        np.add.at(changes, np.minimum(last + 1, len(knots) - 1), -1)
        is_near = np.cumsum(changes)[: len(knots) - 1] > 0
        is_kept = np.append(False, np.repeat(is_near, 4))
        is_kept[:-1:4] |= is_near
        return self._clock_at(self.dense_times[is_kept])

    def times(self, places: Floats) -> Floats:
        """Times at which points, given by ascending path length in mm, are passed, s."""
        return self._times_by(self.clock, places)

    def _times_by(self, clock: tuple[Floats, Floats], places: Floats) -> Floats:
        """Times of passing by a clock, improved by one step."""
        times, along = clock
        guess = np.interp(places, along, times)
        at = self.motion.at(guess)
        speed = np.linalg.norm(at.velocity, axis=1)
        left = places - self.offsets[at.segment] - at.station
        # Within a phase the way is a parabola, s = v·t + a·t²/2; this form stays accurate.
        moves = np.where(speed > 0.0, speed, 1.0)
        along_path = np.sum(at.acceleration * at.velocity, axis=1) / moves
        root = moves + np.sqrt(np.maximum(moves**2 + 2.0 * along_path * left, 0.0))
        step = np.where(speed > 0.0, 2.0 * left / root, 0.0)
        row = np.clip(np.searchsorted(along, places), 1, len(along) - 1)
        return np.maximum.accumulate(np.clip(guess + step, times[row - 1], times[row]))

    def speeds(self, segment: Ints, station: Floats) -> Floats:
        """Speed along the path at ascending positions on segments, (M,), mm/s."""
        return np.linalg.norm(self.velocities(segment, station), axis=1)

    def velocities(self, segment: Ints, station: Floats) -> Floats:
        """Velocity at ascending positions on segments, (M, 3), mm/s."""
        clock = self._clock_near(segment)
        return self.motion.at(self._times_by(clock, self.offsets[segment] + station)).velocity


@dataclass(frozen=True, kw_only=True, eq=False)
class RunMotion:
    """Motion of the axes along a run, planned once for all that is asked of it."""

    run: ToolPathRun
    passings: tuple[Passing | None, ...]
    """Motion of each leg; None for a leg without segments."""

    @property
    def duration(self) -> float:
        """Time from the start of the path to its end, including waits, s."""
        whole, speed = 0.0, None
        for leg, passing in zip(self.run.legs, self.passings, strict=True):
            moving = 0.0 if passing is None else passing.motion.duration
            if leg.ramp is not None and speed is not None:
                awaited = leg.ramp.time_from(speed) if leg.ramp.is_awaited else 0.0
                moving = max(moving, awaited)
                speed = leg.ramp.after(moving, speed)
            whole += moving + leg.wait
            speed = leg.spindle if leg.spindle is not None else speed
        return whole

    def velocities(self, segment: Ints, station: Floats) -> Floats:
        """Velocity that the axes reach at ascending positions, (M, 3), mm/s.

        Parameters
        ----------
        segment : (M,) array of int
            Row of the segment in the run.
        station : (M,) array, mm
            Position along the segment.
        """
        velocities = np.zeros((len(segment), 3))
        for leg, passing in zip(self.run.legs, self.passings, strict=True):
            at = slice(*np.searchsorted(segment, (leg.first, leg.last)))
            if passing is not None and at.stop > at.start:
                velocities[at] = passing.velocities(segment[at] - leg.first, station[at])
        return velocities


def motion_of(run: ToolPathRun, control: ControlModel, limits: AxisLimits) -> RunMotion:
    """Plan the motion of each leg of a run."""
    parts = (run.segments[leg.first : leg.last] for leg in run.legs)
    return RunMotion(
        run=run,
        passings=tuple(
            Passing(segments=part, motion=control.plan(part, limits)) if len(part) else None
            for part in parts
        ),
    )
