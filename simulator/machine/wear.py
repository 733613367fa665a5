"""Wear of an edge while it cuts, and what it does to the force.

Straight in cutting time, without the quicker wear of the first minute: an edge is taken as worn
out, after the life that Taylor gives it, at a flank wear of 0.3 mm. Units s, mm.

References
----------
.. [1] F. W. Taylor, "On the art of cutting metals", 1907: ``v_c · T^n = C``.
.. [2] ISO 8688-2, "Tool life testing in milling": 0.3 mm of flank wear ends a tool's life.
"""

from dataclasses import dataclass

import numpy as np

from simulator.motion.segments import Floats
from simulator.physics.cutting import wear_factor
from simulator.physics.tool_life import wear_rate
from simulator.spec import Taylor

WORN_OUT = 0.3
"""mm of flank wear at the end of a tool's life, [2]_"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wear:
    """Flank wear of one edge."""

    flank: float = 0.0
    """mm now"""
    per_second: float = 0.0
    """mm of flank wear in one second of cutting"""

    @property
    def grows(self) -> bool:
        """Whether cutting makes it larger."""
        return self.per_second > 0.0

    def after(self, seconds: float) -> "Wear":
        """The edge after some seconds of cutting."""
        return Wear(flank=self.flank + self.per_second * seconds, per_second=self.per_second)

    def factor(self, seconds: float) -> float:
        """Factor on the cutting force after some seconds of cutting."""
        return wear_factor(self.flank + self.per_second * seconds)

    def factors(self, seconds: Floats) -> Floats:
        """Factors after (M,) seconds of cutting."""
        fresh, worn = self.factor(0.0), self.factor(1.0)
        return np.asarray(fresh + (worn - fresh) * seconds)


def wearing(flank: float, taylor: Taylor, cutting_speed: float) -> Wear:
    """An edge that cuts at a speed in mm/s: so much of its life goes by in a second, [1]_."""
    per_second = WORN_OUT * wear_rate(taylor, cutting_speed)
    return Wear(flank=flank, per_second=per_second)
