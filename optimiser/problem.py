"""One workingstep as a mathematical problem: limits, cost, and what may be chosen.

Choose the feed per tooth f, the integer number of passes k (depth of one pass a = H/k) and,
when it is free, the spindle speed n. Units: mm, s, W, J, rev/s.
"""

from dataclasses import dataclass
from math import ceil

from optimiser.limit import ROUNDING, Limit, LimitName, Monomial

DIGITS = 12
"""significant digits of a depth"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """What a workingstep runs with."""

    feed: float
    """mm per tooth, or per revolution when the tool has no teeth to count"""
    depth: float
    """mm, one pass"""
    passes: int
    speed: float
    """rev/s"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cost:
    """Time and energy of a setting.

    ``t = (k·L + L_0)/(z·f·n)·(1 + t_change/life(n)) + k·t_link`` and
    ``E = P_0·t + (P_1·n + P_motor(f, a, n))·(k·L + L_0)/(z·f·n)``: what the
    spindle draws to idle is counted while it cuts, so that the energy falls with the feed
    along every limit.
    """

    length: float
    """mm at cutting feed in one pass, approach and overrun included"""
    teeth: int
    motor_power: Monomial
    """W drawn by the cut"""
    once_length: float = 0.0
    """mm at cutting feed whatever the number of passes"""
    link_time: float = 0.0
    """s in one pass not at cutting feed"""
    standby_power: float = 0.0
    """W while the workingstep runs"""
    standby_power_per_speed: float = 0.0
    """W per rev/s, while cutting"""
    tool_change: float = 0.0
    """s for one change of a worn tool"""
    wear_rate: Monomial | None = None
    """tool lives used in one second of cutting"""

    def cutting_time(self, at: Setting) -> float:
        """Seconds at cutting feed."""
        return self.travel(at.passes) / (self.teeth * at.feed * at.speed)

    def travel(self, passes: int) -> float:
        """Length at cutting feed, mm."""
        return passes * self.length + self.once_length

    def time(self, at: Setting) -> float:
        """Seconds from first cut to last retract, with the share of tool changes."""
        cutting = self.cutting_time(at)
        changes = 0.0
        if self.wear_rate is not None:
            lives = cutting * self.wear_rate.value(at.feed, at.depth, at.speed)
            changes = self.tool_change * lives
        return cutting + changes + at.passes * self.link_time

    def energy(self, at: Setting) -> float:
        """Joules drawn from the mains."""
        idle = self.standby_power_per_speed * at.speed
        cut = self.motor_power.value(at.feed, at.depth, at.speed)
        return self.standby_power * self.time(at) + (idle + cut) * self.cutting_time(at)


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """Limits, cost and freedom of one workingstep."""

    limits: tuple[Limit, ...]
    cost: Cost
    total_depth: float
    """H in mm"""
    passes: tuple[int, int]
    """least and greatest number that may be chosen; equal when the depth is not free"""
    speeds: tuple[float, ...]
    """ends of the stretches of the spindle's curve that may be used, ascending, rev/s; a
    single value when the speed is not free"""
    programmed: Setting
    stretches: tuple[tuple[Limit, ...], ...] = ((),)
    """limits that hold on one stretch of the curve only, one tuple for each stretch"""

    def depth_at(self, passes: int) -> float:
        """Depth of each of so many passes, mm, as it is written into a file.

        Rounded, so that reading what was written and solving again gives the same numbers.
        """
        if self.passes[0] == self.passes[1]:
            return self.programmed.depth
        return float(f"{self.total_depth / passes:.{DIGITS}g}")

    def deepest(self) -> int:
        """Least number of passes that the depth limits allow."""
        depth = min(
            (
                (limit.bound / limit.load.coefficient) ** (1.0 / limit.load.depth_exponent)
                for limit in self.limits
                if limit.name is LimitName.AXIAL_DEPTH
            ),
            default=self.total_depth,
        )
        return max(self.passes[0], ceil(self.total_depth / depth - ROUNDING))
