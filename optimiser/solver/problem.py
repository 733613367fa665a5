"""Optimisation problem of one workingstep: limits, cost, and what may be chosen.

Choose the feed per tooth f, the integer number of passes k (depth of one pass a = H/k) and,
when it is free, the spindle speed n. Units: mm, s, W, J, rev/s.

Limits are the only description of machining that the solver sees. The load of a limit is
``(c·f^α + e) · g(a) · n^γ``, where f is the feed per tooth (per revolution when nothing has
teeth), a the depth of one pass and n the spindle speed. Kienzle forces give ``e = 0``; the edge
term of the linear-edge model and the empirical floor of the roughness are ``e``. A limit keeps
a load below (or above) ``b·n^δ``; a stretch of the spindle's power curve gives ``δ``. A bound
that is not a power of the speed (stability lobes) is ``b`` times a :class:`SpeedCurve`; only a
load that depends on the depth alone may have one.

The load is in the canonical unit of its limit.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import pairwise
from math import ceil, inf


class LimitName(StrEnum):
    """Names of the limits as reported to the user."""

    MOTOR_POWER = "motor_power"
    SPINDLE_TORQUE = "spindle_torque"
    CUTTING_FORCE = "cutting_force"
    TOOL_DEFLECTION = "tool_deflection"
    SHANK_STRENGTH = "shank_strength"
    FEED_PER_TOOTH = "feed_per_tooth"
    CHIP_THICKNESS = "chip_thickness"
    CUTTING_SPEED = "cutting_speed"
    FEED_MECHANISM = "feed_mechanism"
    SPINDLE_SPEED = "spindle_speed"
    AXIAL_DEPTH = "axial_depth"
    STABILITY = "stability"
    CHUCK_TORQUE = "chuck_torque"
    TILTING_MOMENT = "tilting_moment"
    BAR_DEFLECTION = "bar_deflection"
    HOLDING_FORCE = "holding_force"
    ROUGHNESS = "roughness"
    PROGRAMMED_FEED = "programmed_feed"
    ALLOWANCE = "reaming_allowance"
    LEAST_COST = "least_cost"

    @property
    def words(self) -> str:
        """Name of the limit in words, without underscores."""
        return self.value.replace("_", " ")


class BoundSide(StrEnum):
    """Side of its bound on which a load must stay."""

    AT_MOST = "at most"
    AT_LEAST = "at least"


@dataclass(frozen=True, slots=True, kw_only=True)
class Monomial:
    """Load ``(c·f^α + e)·g(a)·n^γ``, c > 0, e ≥ 0, α ≥ 0; g(a) is a^β, β ≥ 0, or a curve."""

    coefficient: float
    offset: float = 0.0
    feed_exponent: float = 0.0
    depth_exponent: float = 0.0
    speed_exponent: float = 0.0
    curve: Callable[[float], float] | None = None
    """Positive function g of the depth where it is not a power, as along a helix."""

    def depth_factor(self, depth: float) -> float:
        """Depth factor ``g(a)`` at a depth in mm."""
        return depth**self.depth_exponent if self.curve is None else self.curve(depth)

    @property
    def knows_depth(self) -> bool:
        """True if the load depends on the depth."""
        return self.depth_exponent != 0.0 or self.curve is not None

    def value(self, feed: float, depth: float, speed: float) -> float:
        """Value of the load at a feed per tooth (mm), depth (mm) and spindle speed (rev/s)."""
        return float(
            (self.coefficient * feed**self.feed_exponent + self.offset)
            * self.depth_factor(depth)
            * speed**self.speed_exponent
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedCurve:
    """Bound as a piecewise linear function of spindle speed, infinite below its first point."""

    speeds: tuple[float, ...]
    """Spindle speeds of the points, ascending, at least two, rev/s."""
    bounds: tuple[float, ...]
    """Positive bounds at the points; the last one holds above the last speed."""

    def at(self, speed: float) -> float:
        """Bound at a spindle speed; infinite below the first point."""
        if speed < self.speeds[0]:
            return inf
        row = bisect_right(self.speeds, speed) - 1
        if row + 1 >= len(self.speeds):
            return self.bounds[-1]
        return self._between(row, speed)

    def peak(self, low: float, high: float) -> float:
        """Spindle speed of the greatest bound in a range, rev/s."""
        inner = [speed for speed in self.speeds if low < speed < high]
        return max((low, *inner, high), key=self.at)

    def allowing(self, load: float, low: float, high: float) -> Iterator[tuple[float, float]]:
        """Ranges of speed within [low, high] whose bound is at least the load, ascending."""
        inner = [speed for speed in self.speeds if low < speed < high]
        start: float | None = low if self.at(low) >= load else None
        for slower, faster in pairwise((low, *inner, high)):
            before, after = self.at(slower), self.at(faster)
            if before >= load > after:
                # Below its first point the curve has no bound, up to a step.
                end = faster if before == inf else _met(slower, faster, before, after, load)
                yield (slower if start is None else start), end
                start = None
            elif after >= load > before:
                start = _met(slower, faster, before, after, load)
        if start is not None:
            yield start, high

    def _between(self, row: int, speed: float) -> float:
        """Bound interpolated on the segment after a point."""
        low, high = self.speeds[row], self.speeds[row + 1]
        share = (speed - low) / (high - low)
        return self.bounds[row] + share * (self.bounds[row + 1] - self.bounds[row])


def _met(slower: float, faster: float, before: float, after: float, load: float) -> float:
    """Speed at which a linearly varying bound equals a load, rev/s."""
    return slower + (faster - slower) * (load - before) / (after - before)


USUAL_DIGITS, MOST_DIGITS = 4, 10
"""Significant digits in which a number is told, and at most, where two would look alike."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limit:
    """Limit of a cut: a load at most (or at least) ``b·n^δ``, b > 0."""

    name: LimitName
    load: Monomial
    bound: float
    """Bound on the nominal load: the full bound divided by the safety factor."""
    unit: str
    """Unit in which the user reads load and bound."""
    scale: float = 1.0
    """Factor from the canonical unit to the user's unit."""
    step: float = 1.0
    """Step by which the bound is widened to report savings, in the user's unit."""
    sense: BoundSide = BoundSide.AT_MOST
    bound_speed_exponent: float = 0.0
    label: str = ""
    """Name shown to the user instead of the default."""
    origin: str = ""
    """Origin of the bound, as the end of a sentence; empty where the name is enough."""
    curve: SpeedCurve | None = None
    """Factor on the bound as a function of spindle speed."""
    safety_factor: float = 1.0
    """Load at the planned quantile of k_c over the nominal load."""
    datum: str = ""
    """What would bring the bound of a source in place of this stand-in; empty if it is one."""
    stands_for: LimitName | None = None
    """Limit that this one takes the place of for want of a source."""

    @property
    def words(self) -> str:
        """Name of the limit in words, or its label."""
        return self.label or self.name.words

    def bound_at(self, speed: float) -> float:
        """Bound on the nominal load at one spindle speed, canonical unit; may be infinite."""
        factor = 1.0 if self.curve is None else self.curve.at(speed)
        return float(factor * self.bound * speed**self.bound_speed_exponent)

    def full_bound_at(self, speed: float) -> float:
        """Bound without the safety factor at one spindle speed, canonical unit."""
        return self.safety_factor * self.bound_at(speed)

    def load_text(self, load: float, digits: int = USUAL_DIGITS) -> str:
        """Text of a nominal load with its unit and safety factor."""
        words = f" ({self.safety_words})" if self.safety_words else ""
        return f"{load * self.scale:.{digits}g} {self.unit}{words}"

    @property
    def safety_words(self) -> str:
        """Text of the safety factor on the nominal load; empty without one."""
        if self.safety_factor == 1.0:
            return ""
        return f"× {self.safety_factor:.4g} for the spread of k_c"

    def bound_text(self, speed: float, digits: int = USUAL_DIGITS) -> str:
        """Text of the bound of a limit, with its unit."""
        return f"{self.full_bound_at(speed) * self.scale:.{digits}g} {self.unit}"

    def with_safety(self, factor: float) -> "Limit":
        """Copy with a safety factor, if the load scales with k_c."""
        if self.name not in SCALES_WITH_FORCE:
            return self
        return replace(self, bound=self.bound / factor, safety_factor=factor)

    @property
    def without_safety(self) -> "Limit":
        """Copy that limits the nominal load, without a safety factor."""
        return replace(self, bound=self.bound * self.safety_factor, safety_factor=1.0)

    @property
    def is_of_depth(self) -> bool:
        """True if the limit concerns only the depth of a pass."""
        return self.load.feed_exponent == 0.0 and self.load.depth_exponent > 0.0

    def greatest_depth(self, speed: float) -> float:
        """Depth at which the load of a depth limit reaches its bound, mm."""
        ratio = self.bound_at(speed) / self.load.coefficient
        return float(ratio ** (1.0 / self.load.depth_exponent))

    def feed_at_bound(self, depth: float, speed: float) -> float:
        """Feed per tooth at which load and bound are equal, mm.

        ``f = ((b·n^δ / (a^β·n^γ) − e) / c)^(1/α)``; infinite when the load does not depend on
        the feed, zero when the offset alone passes the bound.
        """
        load = self.load
        if load.feed_exponent == 0.0:
            return inf
        curve = load.curve
        rest = (
            self.bound
            * speed ** (self.bound_speed_exponent - load.speed_exponent)
            / (depth**load.depth_exponent if curve is None else curve(depth))
            - load.offset
        ) / load.coefficient
        return float(rest ** (1.0 / load.feed_exponent)) if rest > 0.0 else 0.0

    def at_depth(self, depth: float) -> "Limit":
        """Copy for a cut whose depth is given rather than chosen."""
        factor = self.load.depth_factor(depth)
        load = replace(
            self.load,
            coefficient=self.load.coefficient * factor,
            offset=self.load.offset * factor,
            depth_exponent=0.0,
            curve=None,
        )
        return replace(self, load=load)

    def holds(self, feed: float, depth: float, speed: float) -> bool:
        """True if the load of the limit keeps its bound, up to rounding."""
        load, bound = self.load.value(feed, depth, speed), self.bound_at(speed)
        slack = bound - load if self.sense is BoundSide.AT_MOST else load - bound
        return slack >= -ROUNDING * bound


SCALES_WITH_FORCE = frozenset({
    LimitName.MOTOR_POWER,
    LimitName.SPINDLE_TORQUE,
    LimitName.CUTTING_FORCE,
    LimitName.TOOL_DEFLECTION,
    LimitName.SHANK_STRENGTH,
    LimitName.STABILITY,
    LimitName.CHUCK_TORQUE,
    LimitName.TILTING_MOMENT,
    LimitName.BAR_DEFLECTION,
    LimitName.HOLDING_FORCE,
})
"""Limits that depend on k_c: loads in proportion to it, and the stable depth."""

ROUNDING = 1e-9
"""Relative slack within which a load counts as being at its bound."""


DIGITS = 12
"""Significant digits to which a depth is rounded."""

INSIDE = 1e-6
"""Margin by which a range of stable speeds is entered, to allow for rounding in files."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """Setting of a workingstep: feed, depth, passes and speed."""

    feed: float
    """Feed per tooth, mm, or feed per revolution for a tool without teeth."""
    depth: float
    """Depth of one pass, mm."""
    passes: int
    speed: float
    """Spindle speed, rev/s."""
    plunge_feed: float | None = None
    """Feed per tooth on the way down into the material, mm; None without a plunge feed.

    It is the best for the speed; neither the cost nor the limits of the problem depend on it.
    """


@dataclass(frozen=True, slots=True, kw_only=True)
class Cost:
    """Time and energy of a workingstep as functions of its setting.

    ``t = (k·L + L_0)/(z·f·n)·(1 + t_change/life(n)) + k·t_link`` and ``E = P_0·t + (P_1·n +
    P_motor(f, a, n))·(k·L + L_0)/(z·f·n)``. The idle power of the spindle is counted only while
    it cuts, so that the energy falls with the feed along every limit.
    """

    length: float
    """Length at cutting feed in one pass, approach and overrun included, mm."""
    teeth: int
    motor_power: Monomial
    """Motor power drawn by the cut, W."""
    once_length: float = 0.0
    """Length at cutting feed that does not depend on the number of passes, mm."""
    link_time: float = 0.0
    """Time per pass not at cutting feed, s."""
    standby_power: float = 0.0
    """Standby power while the workingstep runs, W."""
    standby_power_per_speed: float = 0.0
    """Standby power per spindle speed while cutting, W per rev/s."""
    tool_change: float = 0.0
    """Time to change a worn tool, s."""
    wear_rate: Monomial | None = None
    """Tool lives used per second of cutting."""
    machine_rate: float = 0.0
    """Cost of machine and operator, currency/s."""
    edge_price: float = 0.0
    """Cost of one worn edge, currency."""

    def cutting_time(self, at: Setting) -> float:
        """Machining time at cutting feed, s."""
        return self.travel(at.passes) / (self.teeth * at.feed * at.speed)

    def travel(self, passes: int) -> float:
        """Length at cutting feed in all passes, mm."""
        return passes * self.length + self.once_length

    def time(self, at: Setting) -> float:
        """Time from first cut to last retract, with the share of tool changes, s."""
        return self.time_of(at.feed, at.depth, at.passes, at.speed)

    def energy(self, at: Setting) -> float:
        """Energy drawn from the mains, J."""
        return self.energy_of(at.feed, at.depth, at.passes, at.speed)

    def lives(self, at: Setting) -> float:
        """Tool lives used by the workingstep; 0 where tool life is unknown."""
        return self._lives(at.feed, at.depth, at.passes, at.speed)

    def money(self, at: Setting) -> float:
        """Cost of machine time, worn edges and their changes, currency."""
        return self.money_of(at.feed, at.depth, at.passes, at.speed)

    # A search compares many settings, and making each would cost more than its time.

    def _lives(self, feed: float, depth: float, passes: int, speed: float) -> float:
        if self.wear_rate is None:
            return 0.0
        cutting = self.travel(passes) / (self.teeth * feed * speed)
        return cutting * self.wear_rate.value(feed, depth, speed)

    def money_of(self, feed: float, depth: float, passes: int, speed: float) -> float:
        """Cost of a setting that is given by its numbers, currency."""
        machine = self.machine_rate * self.time_of(feed, depth, passes, speed)
        return machine + self.edge_price * self._lives(feed, depth, passes, speed)

    def time_of(self, feed: float, depth: float, passes: int, speed: float) -> float:
        """Time of a setting that is given by its numbers, s."""
        cutting = (passes * self.length + self.once_length) / (self.teeth * feed * speed)
        if self.wear_rate is None:
            return cutting + passes * self.link_time
        changes = self.tool_change * (cutting * self.wear_rate.value(feed, depth, speed))
        return cutting + changes + passes * self.link_time

    def energy_of(self, feed: float, depth: float, passes: int, speed: float) -> float:
        """Energy of a setting that is given by its numbers, J."""
        idle = self.standby_power_per_speed * speed
        cut = self.motor_power.value(feed, depth, speed)
        cutting = self.travel(passes) / (self.teeth * feed * speed)
        return (
            self.standby_power * self.time_of(feed, depth, passes, speed)
            + (idle + cut) * cutting
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """Limits, cost and free variables of one workingstep."""

    limits: tuple[Limit, ...]
    cost: Cost
    total_depth: float
    """Total depth to remove in all passes, H, mm."""
    passes: tuple[int, int]
    """Least and greatest number of passes; equal when the depth is not free."""
    speeds: tuple[float, ...]
    """Ends of the usable stretches of the spindle's curve, ascending, rev/s.

    A single value when the speed is not free.
    """
    programmed: Setting
    why_held: str = "the depth is not free"
    """Why the number of passes cannot change, when it cannot."""
    stretches: tuple[tuple[Limit, ...], ...] = ((),)
    """Limits that hold on one stretch of the speed range only, one tuple per stretch."""

    def depth_at(self, passes: int) -> float:
        """Depth of each pass for a number of passes, mm, as it is written into a file.

        It is rounded, so that reading the file and solving again gives the same numbers.
        """
        if self.passes[0] == self.passes[1]:
            return self.programmed.depth
        return float(f"{self.total_depth / passes:.{DIGITS}g}")

    @property
    def depth_limits(self) -> list[Limit]:
        """Limits of the whole speed range that concern only the depth of a pass."""
        # Most limits are of the feed; asking each for its property would cost more.
        still = [limit for limit in self.limits if limit.load.feed_exponent == 0.0]
        return [limit for limit in still if limit.is_of_depth]

    @property
    def curved(self) -> Limit | None:
        """Depth limit whose bound is a curve of the speed; None if there is none."""
        return next((limit for limit in self.limits if limit.curve is not None), None)

    @property
    def is_branched(self) -> bool:
        """True if the permitted speeds at a depth form several ranges."""
        return self.curved is not None and len(self.speeds) > 1

    def parts(self, depth: float) -> Iterator["Problem"]:
        """Copies of the problem, one for each range of speeds that may be used at a depth.

        A range lies within one stretch of the spindle's curve, and within one stability lobe
        where a curve of the speed bounds the depth; that bound is kept in the whole range. A
        single speed has no range.
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
        depth = min(map(self._greatest_depth, self.depth_limits), default=self.total_depth)
        if depth == inf:
            return self.passes[0]
        return max(self.passes[0], ceil(self.total_depth / depth - ROUNDING))

    def _greatest_depth(self, limit: Limit) -> float:
        """Depth that a limit allows at its best speed, mm."""
        if limit.curve is None or len(self.speeds) == 1:
            return limit.greatest_depth(self.speeds[0])
        return limit.greatest_depth(limit.curve.peak(self.speeds[0], self.speeds[-1]))
