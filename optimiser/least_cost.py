"""Lower bound of the cost of a workingstep by number of passes, used to stop the search."""

from collections.abc import Callable
from dataclasses import replace
from math import inf

from optimiser.modes import Mode
from optimiser.problem import BoundSide, Limit, Problem


def least_cost(problem: Problem, mode: Mode) -> Callable[[int], float]:
    """Return a function giving the least possible cost, s or J, for k passes or more.

    Only feed limits that do not depend on the depth count. The time bound is the travel at the
    greatest feed rate plus the links between passes. The energy bound adds the idling of the
    spindle and the cutting work at the greatest feed per tooth, both of which fall with the
    feed.
    """
    cost = problem.cost
    fastest = _greatest(problem, per_tooth=False)

    def time(passes: int) -> float:
        return cost.travel(passes) / (cost.teeth * fastest) + passes * cost.link_time

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
        )
        return min(each, default=inf)

    return max(
        allowed(problem.limits + limits, problem.speeds[index : index + 2])
        for index, limits in enumerate(problem.stretches)
    )
