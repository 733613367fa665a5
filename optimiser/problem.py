"""One workingstep as a mathematical problem: limits, cost, and what may be chosen.

Choose the feed per tooth f, the integer number of passes k (depth of one pass a = H/k) and,
when it is free, the spindle speed n. Units: mm, s, W, J, rev/s.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, inf

from optimiser.limit import ROUNDING, Limit, Monomial

DIGITS = 12
"""significant digits of a depth"""

INSIDE = 1e-6
"""share by which a range of stable speeds is entered: a speed in a file has its last digit"""


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
    plunge_feed: float | None = None
    """mm per tooth on the way down into the material; None: there is none of its own. No cost
    and no limit of the problem knows it: it is the best for the speed"""


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
    why_held: str = "the depth is not free"
    """why there is no other number of passes, where there is none"""
    stretches: tuple[tuple[Limit, ...], ...] = ((),)
    """limits that hold on one stretch of the curve only, one tuple for each stretch"""

    def depth_at(self, passes: int) -> float:
        """Depth of each of so many passes, mm, as it is written into a file.

        Rounded, so that reading what was written and solving again gives the same numbers.
        """
        if self.passes[0] == self.passes[1]:
            return self.programmed.depth
        return float(f"{self.total_depth / passes:.{DIGITS}g}")

    @property
    def curved(self) -> Limit | None:
        """The limit of the depth whose bound is a curve of the speed."""
        return next((limit for limit in self.limits if limit.curve is not None), None)

    @property
    def is_branched(self) -> bool:
        """Whether the speeds that a depth may have are several ranges."""
        return self.curved is not None and len(self.speeds) > 1

    def parts(self, depth: float) -> Iterator["Problem"]:
        """The same problem on each range of speeds that may be used at a depth.

        A range lies within one stretch of the spindle's curve, and within one lobe where the
        depth of a pass is bounded by a curve of the speed: that bound is kept in all of it.
        A single speed has no range.
        """
        curved = self.curved
        for (low, high), limits in zip(pairwise(self.speeds), self.stretches, strict=False):
            ranges: tuple[tuple[float, float], ...] = ((low, high),)
            if curved is not None and curved.curve is not None:
                load = curved.load.value(1.0, depth, 1.0) / curved.bound
                ranges = tuple(curved.curve.allowing(load, low, high))
            for slow, fast in ranges:
                inset = (
                    slow if slow == low else slow * (1.0 + INSIDE),
                    fast if fast == high else fast * (1.0 - INSIDE),
                )
                if inset[0] < inset[1]:
                    yield replace(self, speeds=inset, stretches=(limits,))

    def deepest(self) -> int:
        """Least number of passes that the depth limits allow."""
        depth = min(
            (self._greatest_depth(limit) for limit in self.limits if limit.is_of_depth),
            default=self.total_depth,
        )
        if depth == inf:
            return self.passes[0]
        return max(self.passes[0], ceil(self.total_depth / depth - ROUNDING))

    def _greatest_depth(self, limit: Limit) -> float:
        """Depth that a limit allows at its best speed, mm."""
        if limit.curve is None or len(self.speeds) == 1:
            return limit.greatest_depth(self.speeds[0])
        return limit.greatest_depth(limit.curve.peak(self.speeds[0], self.speeds[-1]))
