"""Lower bound of the cost of a workingstep by number of passes, used to stop the search.

Limits of a workingstep at one spindle speed, reduced to what still depends on the depth.

Without an offset a limit caps the feed at ``f = ((b/c)·n^(δ−γ))^(1/α) · a^(−β/α)``: one power
of the depth. All caps that do not depend on the depth reduce to one number.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from math import exp, inf, log

from optimiser.errors import OptimisationError
from optimiser.modes import Mode
from optimiser.solver.problem import ROUNDING, BoundSide, Limit, LimitName, Problem

LARGE = 20.0
"""Logarithm of a number of passes beyond any that is tried."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedCaps:
    """Greatest and least feed per tooth as functions of the depth, at one spindle speed."""

    constant: float
    """Least of the caps that do not depend on the depth, mm."""
    powers: tuple[tuple[float, float], ...]
    """(factor, exponent) of each cap that is a power of the depth."""
    others: tuple[Limit, ...]
    """Limits that depend on the depth, but not as a power of it."""
    floor: float
    """Greatest of the lower limits that do not depend on the depth, mm."""
    floors: tuple[Limit, ...]
    """Lower limits that depend on the depth."""
    deepest: float
    """Greatest depth that the depth limits allow, mm."""
    speed: float
    """Spindle speed, rev/s."""
    cheapest: Limit | None = None
    """Feed beyond which wear costs more than the time saved; no bound, floors go before it."""

    def best(self, depth: float) -> float:
        """Greatest feed per tooth that all limits allow at a depth, mm; zero if none is.

        Raises
        ------
        OptimisationError
            When nothing limits the feed.
        """
        if depth > self.deepest * (1.0 + ROUNDING):
            return 0.0
        highest, lowest = self.constant, self.floor
        for factor, exponent in self.powers:
            feed = factor * depth**exponent
            if feed < highest:  # noqa: PLR1730 (a call of min would take most of the time)
                highest = feed
        for limit in self.others:
            highest = min(highest, limit.feed_at_bound(depth, self.speed))
        if highest == inf:
            raise OptimisationError(
                "nothing limits the feed: the machine, the material and the tool grade give "
                "no power, force, chip load or feed bound"
            )
        for limit in self.floors:
            lowest = max(lowest, limit.feed_at_bound(depth, self.speed))
        if highest < lowest * (1.0 - ROUNDING):
            return 0.0
        if self.cheapest is not None:
            wanted = self.cheapest.feed_at_bound(depth, self.speed)
            return min(highest, max(lowest, wanted))
        return highest

    def passes_to_constant(self, total_depth: float) -> float:
        """Number of passes from which on no power of the depth caps the feed; no integer."""
        if not 0.0 < self.constant < inf or total_depth <= 0.0:
            return 0.0
        # As a logarithm, since a small exponent makes a number of any size.
        least = min(
            (log(self.constant / factor) / exponent for factor, exponent in self.powers),
            default=inf,
        )
        return exp(min(log(total_depth) - least, LARGE))


def caps_at(limits: Iterable[Limit], speed: float) -> FeedCaps:
    """Collect the feed caps of all limits at one spindle speed in rev/s."""
    constant, floor, deepest = inf, 0.0, inf
    powers: list[tuple[float, float]] = []
    others: list[Limit] = []
    floors: list[Limit] = []
    at_least = BoundSide.AT_LEAST
    cheapest = None
    for limit in limits:
        load = limit.load
        if limit.name is LimitName.LEAST_COST:
            cheapest = limit
        elif load.feed_exponent == 0.0:
            if limit.is_of_depth:
                deepest = min(deepest, limit.greatest_depth(speed))
        elif limit.sense is at_least:
            if load.knows_depth:
                floors.append(limit)
            else:
                floor = max(floor, limit.feed_at_bound(1.0, speed))
        elif not load.knows_depth:
            constant = min(constant, limit.feed_at_bound(1.0, speed))
        elif load.offset == 0.0 and load.curve is None:
            exponent = -load.depth_exponent / load.feed_exponent
            powers.append((limit.feed_at_bound(1.0, speed), exponent))
        else:
            others.append(limit)
    return FeedCaps(
        constant=constant,
        powers=tuple(powers),
        others=tuple(others),
        floor=floor,
        deepest=deepest,
        floors=tuple(floors),
        speed=speed,
        cheapest=cheapest,
    )


def least_cost(problem: Problem, mode: Mode) -> Callable[[int], float]:
    """Return a function giving the least possible cost, s, J or currency, for k passes or more.

    Only feed limits that do not depend on the depth count. The time bound is the travel at the
    greatest feed rate plus the links between passes. The energy bound adds the idling of the
    spindle and the cutting work at the greatest feed per tooth, both of which fall with the
    feed. The bound of the money leaves out worn edges.
    """
    cost = problem.cost
    fastest = _greatest(problem, per_tooth=False)

    def time(passes: int) -> float:
        return cost.travel(passes) / (cost.teeth * fastest) + passes * cost.link_time

    if mode is Mode.CC:
        return lambda passes: cost.machine_rate * time(passes)
    if mode is not Mode.EC:
        return time
    feed, power = _greatest(problem, per_tooth=True), cost.motor_power
    idle = cost.standby_power_per_speed / (cost.teeth * feed)
    work = 0.0
    # The work per mm of path falls with the feed, and the work of all passes together does
    # not fall with their number, only if this condition holds.
    if power.feed_exponent <= 1.0 and power.depth_exponent <= 1.0 and power.curve is None:
        work = power.coefficient * feed ** (power.feed_exponent - 1.0) + power.offset / feed
        work *= problem.total_depth**power.depth_exponent * cost.length / cost.teeth
        work *= min(speed ** (power.speed_exponent - 1.0) for speed in problem.speeds)

    def energy(passes: int) -> float:
        cut = work * float(passes ** (1.0 - power.depth_exponent))
        return cost.standby_power * time(passes) + idle * cost.travel(passes) + cut

    return energy


def _greatest(problem: Problem, *, per_tooth: bool) -> float:
    """Greatest feed per tooth f, mm, or product f·n, mm/s, allowed at any speed.

    Only limits that do not depend on the depth count. Offsets aside, each limit is a power of
    the speed, so it allows the most at one end of a stretch.
    """

    def most(limit: Limit, speed: float) -> float:
        bare = replace(limit, load=replace(limit.load, offset=0.0))
        return bare.feed_at_bound(1.0, speed) * (1.0 if per_tooth else speed)

    def allowed(limits: tuple[Limit, ...], speeds: tuple[float, ...]) -> float:
        each = (
            max(most(limit, speed) for speed in speeds)
            for limit in limits
            if limit.load.feed_exponent > 0.0
            and not limit.load.knows_depth
            and limit.sense is BoundSide.AT_MOST
            and limit.name is not LimitName.LEAST_COST
        )
        return min(each, default=inf)

    return max(
        allowed(problem.limits + limits, problem.speeds[index : index + 2])
        for index, limits in enumerate(problem.stretches)
    )
