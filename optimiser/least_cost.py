"""A lower bound of what a workingstep costs in so many passes or more: what ends the search."""

from collections.abc import Callable
from dataclasses import replace
from math import inf

from optimiser.modes import Mode
from optimiser.problem import BoundSide, Limit, Problem


def least_cost(problem: Problem, mode: Mode) -> Callable[[int], float]:
    """Cost that no setting in so many passes or more comes below, s or J.

    Of the limits on the feed only those count that no depth changes. Ways between passes and
    at the greatest feed rate take their time; the energy has besides what the spindle idles
    and cuts with at the greatest feed per tooth, as both fall with it.
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
    # Only then the work of one mm of path falls with the feed, and that of all passes together
    # does not fall with their number.
    if power.feed_exponent <= 1.0 and power.depth_exponent <= 1.0 and power.curve is None:
        work = power.coefficient * feed ** (power.feed_exponent - 1.0) + power.offset / feed
        work *= problem.total_depth**power.depth_exponent * cost.length / cost.teeth
        work *= min(speed ** (power.speed_exponent - 1.0) for speed in problem.speeds)

    def energy(passes: int) -> float:
        cut = work * float(passes ** (1.0 - power.depth_exponent))
        return cost.standby_power * time(passes) + idle * cost.travel(passes) + cut

    return energy


def _greatest(problem: Problem, *, per_tooth: bool) -> float:
    """Greatest f in mm, or f·n in mm/s, that limits without the depth allow at any speed.

    Each allows the most at one end of a stretch: offsets apart, it is a power of the speed.
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
