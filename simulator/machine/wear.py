"""Wear of an edge while it cuts; its effect on forces is in :mod:`simulator.physics.flank`.

Wear grows linearly with cutting time, without the faster wear of the first minute: after its
Taylor life an edge has a flank wear of 0.3 mm and counts as worn out. Units s, mm.

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
    """Current flank wear, mm."""
    per_second: float = 0.0
    """Growth of flank wear per second of cutting, mm/s."""

    @property
    def grows(self) -> bool:
        """True if cutting increases the wear."""
        return self.per_second > 0.0

    def after(self, seconds: float) -> "Wear":
        """Wear of the edge after some seconds of cutting."""
        return Wear(flank=self.flank + self.per_second * seconds, per_second=self.per_second)

    def flanks(self, seconds: Floats) -> Floats:
        """Flank wear after given seconds of cutting, (M,), mm."""
        return np.asarray(self.flank + self.per_second * seconds)


def wearing(flank: float, taylor: Taylor, cutting_speed: float) -> Wear:
    """Wear of an edge that cuts at a constant speed in mm/s, with its rate by [1]_."""
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
    """Wear of an edge along a path, with its mean rate over the cutting time at full feed.

    Parameters
    ----------
    flank : float, mm
        Flank wear when the path begins.
    segments : Segments
        N segments of the path.
    stations : Stations
        Engagement along the segments.
    spindle_speed : (N,) array, rev/s
        Magnitude of the spindle speed; nothing wears at 0.
    """
    row = stations.segment
    starts = np.cumsum(segments.length) - segments.length
    length = np.diff(starts[row] + stations.station, prepend=0.0)
    around = pi * stations.diameter * spindle_speed[row]
    cuts = (stations.section > 0.0) & (around > 0.0)
    seconds = np.where(cuts, length / segments.speed[row], 0.0)
    if not seconds.sum() > 0.0:
        return Wear(flank=flank)
    # The rate is proportional to v_c^(1/n): one evaluation of the law is enough.
    fastest = float(around[cuts].max())
    share = np.where(cuts, around / fastest, 0.0) ** (1.0 / taylor.exponent)
    mean = float(seconds @ share / seconds.sum())
    worn = wearing(flank, taylor, fastest)
    return Wear(flank=flank, per_second=mean * worn.per_second)
