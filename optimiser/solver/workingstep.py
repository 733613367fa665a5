"""Exact optimum of one workingstep: feed, depth, integer number of passes and spindle speed.

For k passes the depth is H/k and everything is monomial. Time and energy fall with the feed,
so at a given speed the best feed is its smallest cap: a closed form. When the speed is free
the best point for k is a vertex of the feasible polygon in (ln f, ln n), since along every edge
both costs fall with the feed; all vertices are tried.

Where every load is a power of the depth, the cost of the best point is a convex function of
ln k (it is the value of a geometric program): a number of passes whose neighbours cost no less
is the best. At one speed the search starts where the caps that do not depend on the depth take
over, which is seldom more than one pass off; else it tries k = k_min, k_min + 1, … and stops at
the first rise. Along a helix loads are curves of the depth, and where lobes bound the depth the
permitted speeds are a union of ranges, whose vertices are all tried. In these cases k rises
until the limits that do not depend on the depth, and the links between passes, already cost
more than the best so far. The result is exact, not a rounded relaxation. Ties keep the
programmed setting.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import combinations
from math import ceil, exp, inf, log

from optimiser.errors import Infeasible
from optimiser.modes import Mode
from optimiser.solver.convex import TIE, least_of_convex, least_within
from optimiser.solver.least_cost import FeedCaps, caps_at, least_cost
from optimiser.solver.problem import (
    MOST_DIGITS,
    ROUNDING,
    USUAL_DIGITS,
    BoundSide,
    Limit,
    LimitName,
    Problem,
    Setting,
)
from stepnc_model.plurals import counted
from stepnc_model.units import rpm_from_rev_s

BISECTIONS = 80
"""Halvings that bring any bracket of ln n below the rounding of a float."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Solution:
    """Best setting of a workingstep and the limit that sets its feed."""

    setting: Setting
    time: float
    """Machining time, s."""
    energy: float
    """Energy that the machine draws, J."""
    active: LimitName
    """Name of the limit that sets the feed."""
    holding: Limit
    """Limit that sets the feed; several limits may share a name."""
    limits: tuple[Limit, ...]
    """All limits that apply at this setting."""
    deepest_first_time: float
    """Time with the fewest feasible passes, s; equal to ``time`` when they are the best."""


def solve(problem: Problem, mode: Mode) -> Solution:
    """Find the best setting of a workingstep.

    Parameters
    ----------
    mode : Mode
        ``EC`` minimises energy, ``CC`` cost; ``TC`` and ``QC`` minimise time (they differ in
        their limits).

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
    caps = _caps(problem, problem.speeds[0]) if len(problem.speeds) == 1 else None
    best_in = _search(problem, cost, caps, has_inner=mode is Mode.CC)
    if caps is not None and is_posynomial(problem):
        first, best = _ends_of_descent(problem, mode, caps)
    else:
        first, best = _ends_of_trials(problem, mode, best_in)
    given = problem.programmed
    # At one speed the caps know the depth limits.
    if caps is not None or _may_keep(problem):
        kept = best_in(given.passes, given.depth)
        if kept is not None and (best is None or cost(kept) <= cost(best) * (1.0 + TIE)):
            best = kept
    if best is None:
        raise conflict(problem)
    return settled(problem, best, first)


Ends = tuple[Setting | None, Setting | None]
"""Best settings with the fewest feasible passes and with the best number of them."""


def _ends_of_descent(problem: Problem, mode: Mode, caps: FeedCaps) -> Ends:
    """Search down a cost that is convex in ln k, at the only spindle speed."""
    cost_of = _cost_of_numbers(problem, mode)
    speed, (fewest, most) = caps.speed, problem.passes
    fewest = max(fewest, ceil(problem.total_depth / caps.deepest - ROUNDING))
    first = None
    while fewest <= most:
        first = _setting(caps, fewest, problem.depth_at(fewest))
        if first is not None:
            break
        fewest += 1
    if first is None:
        return None, None

    def cost(passes: int) -> float:
        depth = problem.depth_at(passes)
        feed = caps.best(depth)
        return cost_of(feed, depth, passes, speed) if feed > 0.0 else inf

    # With more passes than these no cap grows, so the cost seldom falls.
    guess = ceil(caps.passes_to_constant(problem.total_depth)) - 1
    passes = least_of_convex(cost, fewest, most, guess=guess)
    if passes == fewest:
        return first, first
    return first, _setting(caps, passes, problem.depth_at(passes))


def _ends_of_trials(
    problem: Problem, mode: Mode, best_in: Callable[[int], Setting | None]
) -> Ends:
    """Try one number of passes after the other until more cannot be better."""
    cost = cost_function(problem, mode)
    best: Setting | None = None
    first: Setting | None = None
    least = inf
    is_convex = is_posynomial(problem) and not problem.is_branched
    bound = least_cost(problem, mode)
    for passes in range(problem.deepest(), problem.passes[1] + 1):
        if not is_convex and bound(passes) > least * (1.0 + TIE):
            break
        setting = best_in(passes)
        if setting is None:
            continue
        first = first or setting
        found = cost(setting)
        if is_convex and found > least * (1.0 + TIE):
            break
        if found < least * (1.0 - TIE):
            best, least = setting, found
    return first, best


def cost_function(problem: Problem, mode: Mode) -> Callable[[Setting], float]:
    """Cost function that the mode minimises: time in s, energy in J, or money in currency."""
    if mode is Mode.CC:
        return problem.cost.money
    return problem.cost.energy if mode is Mode.EC else problem.cost.time


def _cost_of_numbers(
    problem: Problem, mode: Mode
) -> Callable[[float, float, int, float], float]:
    """Cost that the mode minimises, of feed, depth, passes and speed."""
    if mode is Mode.CC:
        return problem.cost.money_of
    return problem.cost.energy_of if mode is Mode.EC else problem.cost.time_of


def limits_at(problem: Problem, speed: float) -> tuple[Limit, ...]:
    """All limits that apply at one spindle speed; a curve may begin above it."""
    always = problem.limits
    if problem.curved is not None:
        always = tuple(limit for limit in always if limit.bound_at(speed) < inf)
    for index, limits in enumerate(problem.stretches):
        if index + 1 >= len(problem.speeds) or speed <= problem.speeds[index + 1]:
            return always + limits
    return always + problem.stretches[-1]


def conflict(problem: Problem) -> Infeasible:
    """Build the error that names the two limits that contradict each other."""
    passes, speed = problem.passes[1], problem.programmed.speed
    depth = problem.depth_at(passes)
    limits = limits_at(problem, speed)
    caps = [
        limit
        for limit in limits
        if limit.sense is BoundSide.AT_MOST and limit.name is not LimitName.LEAST_COST
    ]
    floors = [limit for limit in limits if limit.sense is BoundSide.AT_LEAST]
    for limit in caps:
        if limit.is_of_depth and not limit.holds(1.0, depth, speed):
            is_fixed = problem.passes[0] == problem.passes[1]
            why = (
                problem.why_held
                if is_fixed
                else f"no more than {counted(passes, 'pass', 'passes')} can be taken"
            )
            load = limit.load.value(1.0, depth, speed)
            return Infeasible(
                f"{violation_text(limit, load, speed)}, and {why}{_elsewhere(limit, load)}",
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
            f"{violation_text(cap, rest, speed)}, however small the feed", limits=(cap.name,)
        )
    return Infeasible(
        f"{cap.words} allows a feed of at most {highest:.4g} mm/tooth"
        f" ({cap.sense} {cap.bound_text(speed)}{_with_safety(cap)}),"
        f" {floor.words} needs at least {lowest:.4g} mm/tooth"
        f" ({floor.sense} {floor.bound_text(speed)}),"
        f" at a depth of {depth:.4g} mm in {counted(passes, 'pass', 'passes')}",
        limits=(cap.name, floor.name),
    )


def _with_safety(limit: Limit) -> str:
    """Text on the safety factor for the spread of k_c; empty without one."""
    return f", {limit.safety_words}" if limit.safety_words else ""


def _elsewhere(limit: Limit, load: float) -> str:
    """Text with the speed at which a stability bound allows more; empty for other bounds."""
    curve = limit.curve
    if curve is None:
        return ""
    low, high = curve.speeds[0], curve.speeds[-1]
    wide = max(
        curve.allowing(load / limit.bound, low, high),
        key=lambda found: found[1] - found[0],
        default=None,
    )
    if wide is not None:
        slow, fast = (rpm_from_rev_s(speed) for speed in wide)
        return (
            f"; {load * limit.scale:.4g} {limit.unit} would be stable "
            f"from {slow:.0f} to {fast:.0f} rpm"
        )
    best = curve.peak(low, high)
    return (
        f"; {limit.bound_at(best) * limit.scale:.4g} {limit.unit} would be stable "
        f"at {rpm_from_rev_s(best):.0f} rpm"
    )


def violation_text(limit: Limit, load: float, speed: float) -> str:
    """Sentence on one violated limit: 'axial depth 6 mm exceeds 5 mm'."""
    if limit.curve is not None:
        return (
            f"{limit.words} allows {limit.bound_text(speed)} "
            f"at {rpm_from_rev_s(speed):.0f} rpm, not {limit.load_text(load)}"
        )
    verb = "exceeds" if limit.sense is BoundSide.AT_MOST else "is below"
    digits = next(
        (
            digits
            for digits in range(USUAL_DIGITS, MOST_DIGITS)
            if limit.load_text(load, digits) != limit.bound_text(speed, digits)
        ),
        MOST_DIGITS,
    )
    bound = limit.bound_text(speed, digits)
    return f"{limit.words} {limit.load_text(load, digits)} {verb} {bound}"


def widened(problem: Problem, name: LimitName, *, by_factor: float) -> Problem:
    """Copy of the problem with the bound of one limit multiplied by a factor."""

    def wider(limit: Limit) -> Limit:
        if limit.name is not name:
            return limit
        return replace(limit, bound=limit.bound * by_factor)

    return replace(
        problem,
        limits=tuple(map(wider, problem.limits)),
        stretches=tuple(tuple(map(wider, limits)) for limits in problem.stretches),
    )


def without_safety(problem: Problem) -> Problem:
    """Copy of the problem without safety factors."""
    return replace(
        problem,
        limits=tuple(limit.without_safety for limit in problem.limits),
        stretches=tuple(
            tuple(limit.without_safety for limit in limits) for limits in problem.stretches
        ),
    )


def cost_of_safety(problem: Problem, mode: Mode, solution: Solution) -> float:
    """Time that the safety factors of the limits cost, s; 0 when there are none."""
    if all(limit.safety_factor == 1.0 for limit in solution.limits):
        return 0.0
    return max(0.0, solution.time - solve(without_safety(problem), mode).time)


def saving_of_one_more(problem: Problem, mode: Mode, solution: Solution) -> float:
    """Time saved if the bound of the active limit were one step wider, s."""
    speed = solution.setting.speed
    active = solution.holding
    factor = 1.0 + active.step / (active.scale * active.full_bound_at(speed))
    wider = widened(problem, active.name, by_factor=factor)
    return max(0.0, solution.time - solve(wider, mode).time)


def _may_keep(problem: Problem) -> bool:
    """True if the programmed depth keeps the depth limits."""
    at = problem.programmed
    return all(
        limit.holds(at.feed, at.depth, at.speed)
        for limit in problem.depth_limits
        if limit.curve is None
    )


def is_posynomial(problem: Problem) -> bool:
    """True if every load is a power of the depth, so that the cost is convex in ln k."""
    for limits in (problem.limits, *problem.stretches):
        for limit in limits:
            if limit.load.curve is not None:
                return False
    return True


def at_depth(problem: Problem, depth: float) -> Problem:
    """Copy of the problem with its curves of the depth replaced by their values."""
    if is_posynomial(problem):
        return problem

    def numbers(limits: tuple[Limit, ...]) -> tuple[Limit, ...]:
        return tuple(
            limit if limit.load.curve is None else limit.at_depth(depth) for limit in limits
        )

    return replace(
        problem,
        limits=numbers(problem.limits),
        stretches=tuple(map(numbers, problem.stretches)),
    )


def _search(
    problem: Problem,
    cost: Callable[[Setting], float],
    caps: FeedCaps | None,
    *,
    has_inner: bool,
) -> Callable[..., Setting | None]:
    """Return a solver for a number of passes; it returns None if no setting is feasible.

    The caps are those at the only speed, None when the speed may be chosen. Time and energy are
    least at a speed where limits meet; with ``has_inner`` the cost may be least between two.
    """

    def best(passes: int, depth: float | None = None) -> Setting | None:
        depth = problem.depth_at(passes) if depth is None else depth
        if caps is not None:
            return _setting(caps, passes, depth)
        flat = at_depth(problem, depth)

        def at(speed: float) -> Setting | None:
            return _setting(_caps(flat, speed), passes, depth)

        found = [
            setting
            for part in flat.parts(depth)
            for setting in _best_speeds(at, _speed_candidates(part, depth), cost, has_inner)
        ]
        return min(found, key=cost, default=None)

    return best


def _caps(problem: Problem, speed: float) -> FeedCaps:
    """Feed caps of all limits at one speed."""
    return caps_at(limits_at(problem, speed), speed)


def _setting(caps: FeedCaps, passes: int, depth: float) -> Setting | None:
    """Setting with the greatest feed at one depth and speed, or None if infeasible."""
    feed = caps.best(depth)
    if feed <= 0.0:
        return None
    return Setting(feed=feed, depth=depth, passes=passes, speed=caps.speed)


def _best_speeds(
    at: Callable[[float], Setting | None],
    speeds: Iterator[float],
    cost: Callable[[Setting], float],
    has_inner: bool,
) -> Iterator[Setting]:
    """Yield settings of one stretch of speeds among which its best one is."""
    if not has_inner:
        yield from (setting for speed in speeds if (setting := at(speed)) is not None)
        return
    settings = [(speed, at(speed)) for speed in sorted(set(speeds))]
    # The ends of the feasible speeds are crossings too, so all between these are feasible.
    feasible = [setting for _, setting in settings if setting is not None]
    if not feasible:
        return
    place = min(range(len(feasible)), key=lambda row: cost(feasible[row]))
    yield feasible[place]
    ends = feasible[max(place - 1, 0)].speed, feasible[min(place + 1, len(feasible) - 1)].speed

    def cost_at(speed: float) -> float:
        setting = at(speed)
        return inf if setting is None else cost(setting)

    inner = at(least_within(cost_at, *ends))
    if inner is not None:
        yield inner


def _speed_candidates(part: Problem, depth: float) -> Iterator[float]:
    """Spindle speeds of one stretch at which limits meet, and its ends."""
    low, high = part.speeds
    yield low
    yield high
    bounding = [limit for limit in limits_at(part, high) if limit.load.feed_exponent > 0.0]
    for first, second in combinations(bounding, 2):
        crossing = _crossing(first, second, depth=depth, between=(low, high))
        if crossing is not None:
            yield crossing


def _crossing(
    first: Limit, second: Limit, *, depth: float, between: tuple[float, float]
) -> float | None:
    """Speed at which two limits allow the same feed, or None if not within the stretch.

    ``ln f_i`` is linear in ln n for Kienzle limits and monotone for all, so bisection of the
    difference finds the only crossing to the last digit.
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
    """Solution at a setting: its time and energy, and the limit that sets its feed."""
    limits = limits_at(problem, best.speed)
    at_most, depth, speed = BoundSide.AT_MOST, best.depth, best.speed
    caps = [limit for limit in limits if limit.sense is at_most]
    feeds = [limit.feed_at_bound(depth, speed) for limit in caps]
    active = caps[feeds.index(min(feeds))]
    time = problem.cost.time(best)
    with_first = time if first is None or first is best else problem.cost.time(first)
    return Solution(
        setting=best,
        time=time,
        energy=problem.cost.energy(best),
        active=active.name,
        holding=active,
        limits=limits,
        deepest_first_time=max(time, with_first),
    )
