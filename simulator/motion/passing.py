"""Times and speeds at which points along a path are passed, for example on a tool path.

Speeds are lower than the feed where a path turns, begins or ends. Units mm, s.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from simulator.motion.segments import AxisLimits, ControlModel, Floats, Ints, Motion, Segments
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
    def clock(self) -> tuple[Floats, Floats]:
        """Times in s and path lengths in mm, dense enough for linear interpolation."""
        knots = np.unique(np.concatenate((self.motion.knots, self.motion.ends)))
        parts = np.array([0.25, 0.5, 0.75, 1.0])
        inside = knots[:-1, None] + np.diff(knots)[:, None] * parts
        times = np.concatenate((knots[:1], inside.ravel()))
        at = self.motion.at(times)
        along = self.offsets[at.segment] + at.station
        return times, np.maximum.accumulate(along)

    def times(self, places: Floats) -> Floats:
        """Times at which points, given by ascending path length in mm, are passed, s."""
        times, along = self.clock
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
        return self.motion.at(self.times(self.offsets[segment] + station)).velocity


def reached_velocities(
    run: ToolPathRun,
    control: ControlModel,
    limits: AxisLimits,
    *,
    segment: Ints,
    station: Floats,
) -> Floats:
    """Velocity that the axes reach at ascending positions, (M, 3), mm/s.

    Parameters
    ----------
    run : ToolPathRun
    control : ControlModel
    limits : AxisLimits
    segment : (M,) array of int
        Row of the segment in the run.
    station : (M,) array, mm
        Position along the segment.
    """
    velocities = np.zeros((len(segment), 3))
    for leg in run.legs:
        at = slice(*np.searchsorted(segment, (leg.first, leg.last)))
        if at.stop > at.start:
            part = run.segments[leg.first : leg.last]
            passing = Passing(segments=part, motion=control.plan(part, limits))
            velocities[at] = passing.velocities(segment[at] - leg.first, station[at])
    return velocities
