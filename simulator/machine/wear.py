"""Wear of an edge while it cuts. What it does to the force: :mod:`simulator.physics.flank`.

Straight in cutting time, without the quicker wear of the first minute: an edge is taken as worn
out, after the life that Taylor gives it, at a flank wear of 0.3 mm. Units s, mm.

References
----------
.. [1] F. W. Taylor, "On the art of cutting metals", 1907: ``v_c · T^n = C``.
.. [2] ISO 8688-2, "Tool life testing in milling": 0.3 mm of flank wear ends a tool's life.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from simulator.motion.segments import Floats, Segments
from simulator.physics.tool_life import LIFE_CRITERION, wear_rate
from simulator.removal.stations import Stations
from simulator.spec import Taylor


@dataclass(frozen=True, slots=True, kw_only=True)
class Wear:
    """Flank wear of one edge."""

    flank: float = 0.0
    """Flank, mm now"""
    per_second: float = 0.0
    """Per second, mm of flank wear in one second of cutting"""

    @property
    def grows(self) -> bool:
        """Whether cutting makes it larger."""
        return self.per_second > 0.0

    def after(self, seconds: float) -> "Wear":
        """The edge after some seconds of cutting."""
        return Wear(flank=self.flank + self.per_second * seconds, per_second=self.per_second)

    def flanks(self, seconds: Floats) -> Floats:
        """Flank wear in mm after (M,) seconds of cutting."""
        return np.asarray(self.flank + self.per_second * seconds)


def wearing(flank: float, taylor: Taylor, cutting_speed: float) -> Wear:
    """An edge that cuts at a speed in mm/s: so much of its life goes by in a second, [1]_."""
    per_second = LIFE_CRITERION * wear_rate(taylor, cutting_speed)
    return Wear(flank=flank, per_second=per_second)


def wearing_along(
    flank: float,
    taylor: Taylor,
    segments: Segments,
    stations: Stations,
    *,
    spindle_speed: Floats,
) -> Wear:
    """An edge along a path: its rate is the mean over the time with chips at commanded feed.

    Parameters
    ----------
    flank : float, mm
        When the path begins.
    taylor : Taylor
    segments : Segments
        N of them.
    stations : Stations
        What they meet.
    spindle_speed : (N,) array, rev/s
        Magnitude; while the spindle stands nothing wears.
    """
    row = stations.segment
    starts = np.cumsum(segments.length) - segments.length
    length = np.diff(starts[row] + stations.station, prepend=0.0)
    around = pi * stations.diameter * spindle_speed[row]
    cuts = (stations.section > 0.0) & (around > 0.0)
    seconds = np.where(cuts, length / segments.speed[row], 0.0)
    if not seconds.sum() > 0.0:
        return Wear(flank=flank)
    # In proportion to v_c^(1/n): one call of the law for all.
    fastest = float(around[cuts].max())
    share = np.where(cuts, around / fastest, 0.0) ** (1.0 / taylor.exponent)
    mean = float(seconds @ share / seconds.sum())
    worn = wearing(flank, taylor, fastest)
    return Wear(flank=flank, per_second=mean * worn.per_second)
