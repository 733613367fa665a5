"""The exact optimum of one workingstep: one feed, depth, integer passes and spindle speed.

For k passes the depth is H/k and everything is monomial. Time and energy fall with the feed,
so at a given speed the best feed is its smallest cap: a closed form. When the speed is free
the best point of k is a vertex of the feasible polygon in (ln f, ln n), since along every edge
both costs fall with the feed; all vertices are tried.

The cost of the best point is a convex function of ln k (it is the value of a geometric
program), so trying k = k_min, k_min + 1, … may stop at the first rise: exact, no rounding of a
relaxed answer. Ties keep what was programmed.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import combinations
from math import exp, inf, log

from optimiser.caps import Caps, caps_at
from optimiser.errors import Infeasible, OptimisationError
from optimiser.limit import ROUNDING, Limit, LimitName, Sense
from optimiser.modes import Mode
from optimiser.problem import Problem, Setting

TIE = 1e-9
"""relative difference of cost below which two settings are equally good"""

BISECTIONS = 80
"""halvings that bring any bracket of ln n below the rounding of a float"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Solution:
    """The best setting and what holds it there."""

    setting: Setting
    time: float
    """s"""
    energy: float
    """J"""
    active: LimitName
    """name of the limit that holds the feed"""
    holding: Limit
    """that limit itself; several may have one name"""
    limits: tuple[Limit, ...]
    """all limits that apply at this setting"""
    deepest_first_time: float
    """s, had the fewest passes been chosen; equal to ``time`` when they are the best"""


def solve(problem: Problem, mode: Mode) -> Solution:
    """Best setting of a workingstep.

    Parameters
    ----------
    problem : Problem
    mode : Mode
        ``EC`` minimises energy; ``TC`` and ``QC`` minimise time (they differ in their limits).

    Returns
    -------
    Solution

    Raises
    ------
    Infeasible
        When no number of passes keeps all limits; names the two that conflict.
    OptimisationError
        When nothing limits the feed.
    """
    cost = cost_function(problem, mode)
    best: Setting | None = None
    first: Setting | None = None
    least = inf
    for setting in _best_by_passes(problem, cost):
        first = first or setting
        found = cost(setting)
        if found > least * (1.0 + TIE):
            break
        if found < least * (1.0 - TIE):
            best, least = setting, found
    given = problem.programmed
    kept = None
    if _may_keep(problem):
        kept = _best_at(
            problem, given.passes, given.depth, cost=cost, caps=_fixed_caps(problem)
        )
    if kept is not None and (best is None or cost(kept) <= least * (1.0 + TIE)):
        best = kept
    if best is None:
        raise conflict(problem)
    return settled(problem, best, first)


def cost_function(problem: Problem, mode: Mode) -> Callable[[Setting], float]:
    """Seconds or joules, whichever the mode wants least."""
    return problem.cost.energy if mode is Mode.EC else problem.cost.time


def limits_at(problem: Problem, speed: float) -> tuple[Limit, ...]:
    """All limits that apply at one spindle speed."""
    for index, limits in enumerate(problem.stretches):
        if index + 1 >= len(problem.speeds) or speed <= problem.speeds[index + 1]:
            return problem.limits + limits
    return problem.limits + problem.stretches[-1]


def conflict(problem: Problem) -> Infeasible:
    """The two limits that exclude each other at the depth that comes nearest to both."""
    passes, speed = problem.passes[1], problem.programmed.speed
    depth = problem.depth_at(passes)
    limits = limits_at(problem, speed)
    caps = [limit for limit in limits if limit.sense is Sense.AT_MOST]
    floors = [limit for limit in limits if limit.sense is Sense.AT_LEAST]
    for limit in caps:
        if limit.name is LimitName.AXIAL_DEPTH and not limit.holds(1.0, depth, speed):
            is_fixed = problem.passes[0] == problem.passes[1]
            why = "the depth is not free" if is_fixed else f"there are {passes} passes at most"
            return Infeasible(
                f"{told(limit, limit.load.value(1.0, depth, speed), speed)}, and {why}",
                limits=(limit.name,),
            )
    cap = min(caps, key=lambda limit: limit.feed_at_bound(depth, speed))
    floor = max(
        (limit for limit in floors if limit.load.feed_exponent),
        key=lambda limit: limit.feed_at_bound(depth, speed),
        default=cap,
    )
    highest, lowest = cap.feed_at_bound(depth, speed), floor.feed_at_bound(depth, speed)
    if highest <= 0.0:
        rest = cap.load.value(0.0, depth, speed)
        return Infeasible(
            f"{told(cap, rest, speed)}, however small the feed", limits=(cap.name,)
        )
    return Infeasible(
        f"{cap.words} allows a feed of at most {highest:.4g} mm/tooth"
        f" ({cap.sense} {cap.bound_at(speed) * cap.scale:.4g} {cap.unit}),"
        f" {floor.words} needs at least {lowest:.4g} mm/tooth"
        f" ({floor.sense} {floor.bound_at(speed) * floor.scale:.4g} {floor.unit}),"
        f" at a depth of {depth:.4g} mm in {passes} passes",
        limits=(cap.name, floor.name),
    )


def told(limit: Limit, load: float, speed: float) -> str:
    """One limit with its numbers: 'axial depth 6 mm exceeds 5 mm'."""
    verb = "exceeds" if limit.sense is Sense.AT_MOST else "is below"
    return (
        f"{limit.words} {load * limit.scale:.4g} {limit.unit} {verb} "
        f"{limit.bound_at(speed) * limit.scale:.4g} {limit.unit}"
    )


def widened(problem: Problem, name: LimitName, *, by_factor: float) -> Problem:
    """The same problem with the bound of one limit multiplied."""

    def wider(limit: Limit) -> Limit:
        if limit.name is not name:
            return limit
        return replace(limit, bound=limit.bound * by_factor)

    return replace(
        problem,
        limits=tuple(map(wider, problem.limits)),
        stretches=tuple(tuple(map(wider, limits)) for limits in problem.stretches),
    )


def saving_of_one_more(problem: Problem, mode: Mode, solution: Solution) -> float:
    """Seconds saved if the bound of the active limit were one step wider; 0 when none."""
    speed = solution.setting.speed
    active = solution.holding
    factor = 1.0 + active.step / (active.scale * active.bound_at(speed))
    wider = widened(problem, active.name, by_factor=factor)
    return max(0.0, solution.time - solve(wider, mode).time)


def _may_keep(problem: Problem) -> bool:
    """Whether the programmed depth itself keeps the depth limits."""
    at = problem.programmed
    return all(
        limit.holds(at.feed, at.depth, at.speed)
        for limit in problem.limits
        if limit.name is LimitName.AXIAL_DEPTH
    )


def _best_by_passes(problem: Problem, cost: Callable[[Setting], float]) -> Iterator[Setting]:
    """Best setting of each feasible number of passes, fewest first."""
    caps = _fixed_caps(problem)
    for passes in range(problem.deepest(), problem.passes[1] + 1):
        depth = problem.depth_at(passes)
        setting = _best_at(problem, passes, depth, cost=cost, caps=caps)
        if setting is not None:
            yield setting


def _fixed_caps(problem: Problem) -> Caps | None:
    """Caps at the only speed there is, or None when the speed may be chosen."""
    if len(problem.speeds) > 1:
        return None
    speed = problem.speeds[0]
    return caps_at(limits_at(problem, speed), speed)


def _best_at(
    problem: Problem,
    passes: int,
    depth: float,
    *,
    cost: Callable[[Setting], float],
    caps: Caps | None,
) -> Setting | None:
    """Best feed and speed at one depth, or None when no feed keeps all limits."""
    if caps is not None:
        return _setting(caps, passes, depth)
    best: Setting | None = None
    for speed in _speed_candidates(problem, depth):
        setting = _setting(caps_at(limits_at(problem, speed), speed), passes, depth)
        if setting is not None and (best is None or cost(setting) < cost(best)):
            best = setting
    return best


def _setting(caps: Caps, passes: int, depth: float) -> Setting | None:
    """The greatest feed at one depth and speed, or None when none keeps all limits."""
    highest, lowest = caps.greatest(depth), caps.least(depth)
    if highest == inf:
        raise OptimisationError(
            "nothing limits the feed: the machine, the material and the tool grade give "
            "no power, force, chip load or feed bound"
        )
    if highest < lowest * (1.0 - ROUNDING) or highest <= 0.0:
        return None
    return Setting(feed=highest, depth=depth, passes=passes, speed=caps.speed)


def _speed_candidates(problem: Problem, depth: float) -> Iterator[float]:
    """Spindle speeds at which the best point of this depth can lie."""
    if len(problem.speeds) == 1:
        yield problem.speeds[0]
        return
    for low, high in zip(problem.speeds, problem.speeds[1:], strict=False):
        yield low
        yield high
        bounding = [
            limit for limit in limits_at(problem, high) if limit.load.feed_exponent > 0.0
        ]
        for first, second in combinations(bounding, 2):
            crossing = _crossing(first, second, depth=depth, between=(low, high))
            if crossing is not None:
                yield crossing


def _crossing(
    first: Limit, second: Limit, *, depth: float, between: tuple[float, float]
) -> float | None:
    """Speed at which two limits allow the same feed, or None within the stretch.

    ``ln f_i`` is linear in ln n for Kienzle limits and monotone for all, so halving the
    bracket of the difference finds the only crossing to the last digit.
    """

    def difference(speed: float) -> float:
        one = first.feed_at_bound(depth, speed)
        other = second.feed_at_bound(depth, speed)
        return log(one / other) if one > 0.0 and other > 0.0 else one - other

    low, high = between
    at_low, at_high = difference(low), difference(high)
    if at_low * at_high >= 0.0:
        return None
    low, high = log(low), log(high)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if difference(exp(middle)) * at_low > 0.0:
            low = middle
        else:
            high = middle
    return exp(0.5 * (low + high))


def settled(problem: Problem, best: Setting, first: Setting | None = None) -> Solution:
    """Solution at a setting: the limit that holds its feed, and what it costs."""
    limits = limits_at(problem, best.speed)
    active = min(
        (limit for limit in limits if limit.sense is Sense.AT_MOST),
        key=lambda limit: limit.feed_at_bound(best.depth, best.speed),
    )
    time = problem.cost.time(best)
    return Solution(
        setting=best,
        time=time,
        energy=problem.cost.energy(best),
        active=active.name,
        holding=active,
        limits=limits,
        deepest_first_time=max(time, problem.cost.time(first or best)),
    )
