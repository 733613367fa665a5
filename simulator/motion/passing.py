"""Times and speeds at which places along a path are passed: the motion by distance.

Units mm, s.

Speeds that the axes reach at places of a workingstep's tool path.

Where a path turns, begins or ends they are slower than the feed. Units mm, s.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from simulator.motion.segments import AxisLimits, ControlModel, Floats, Ints, Motion, Segments
from simulator.motion.tool_path import ToolPathRun


@dataclass(frozen=True, kw_only=True, eq=False)
class Passing:
    """A stretch from rest to rest, and what is known of its way."""

    segments: Segments
    motion: Motion

    @cached_property
    def offsets(self) -> Floats:
        """(N + 1,) mm of path before each segment."""
        return np.concatenate(([0.0], np.cumsum(self.segments.length)))

    @cached_property
    def clock(self) -> tuple[Floats, Floats]:
        """Times from the start, s, and mm of path behind: fine enough to be joined straight."""
        knots = np.unique(np.concatenate((self.motion.knots, self.motion.ends)))
        parts = np.array([0.25, 0.5, 0.75, 1.0])
        inside = knots[:-1, None] + np.diff(knots)[:, None] * parts
        times = np.concatenate((knots[:1], inside.ravel()))
        at = self.motion.at(times)
        along = self.offsets[at.segment] + at.station
        return times, np.maximum.accumulate(along)

    def times(self, places: Floats) -> Floats:
        """Times at which places, ascending along the path in mm, are passed."""
        times, along = self.clock
        guess = np.interp(places, along, times)
        at = self.motion.at(guess)
        speed = np.linalg.norm(at.velocity, axis=1)
        left = places - self.offsets[at.segment] - at.station
        # Within a phase the way is a parabola, s = v·t + a·t²/2; this form keeps its digits.
        moves = np.where(speed > 0.0, speed, 1.0)
        along_path = np.sum(at.acceleration * at.velocity, axis=1) / moves
        root = moves + np.sqrt(np.maximum(moves**2 + 2.0 * along_path * left, 0.0))
        step = np.where(speed > 0.0, 2.0 * left / root, 0.0)
        row = np.clip(np.searchsorted(along, places), 1, len(along) - 1)
        return np.maximum.accumulate(np.clip(guess + step, times[row - 1], times[row]))

    def speeds(self, segment: Ints, station: Floats) -> Floats:
        """(M,) mm/s along the path at places in mm along segments, ascending."""
        at = self.motion.at(self.times(self.offsets[segment] + station))
        return np.linalg.norm(at.velocity, axis=1)


def reached_speeds(
    run: ToolPathRun,
    control: ControlModel,
    limits: AxisLimits,
    *,
    segment: Ints,
    station: Floats,
) -> Floats:
    """(M,) mm/s that the axes reach at places of a path, which are ascending.

    Parameters
    ----------
    run : ToolPathRun
    control : ControlModel
    limits : AxisLimits
    segment : (M,) array of int
        Rows of the run.
    station : (M,) array, mm
        Along them.
    """
    speeds = np.zeros(len(segment))
    for leg in run.legs:
        at = slice(*np.searchsorted(segment, (leg.first, leg.last)))
        if at.stop > at.start:
            part = run.segments[leg.first : leg.last]
            passing = Passing(segments=part, motion=control.plan(part, limits))
            speeds[at] = passing.speeds(segment[at] - leg.first, station[at])
    return speeds
