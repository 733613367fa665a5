"""Search for the best number of passes, each evaluated along its own tool path.

The closed form assumes that all passes are alike, but a path with other passes enters and
leaves elsewhere and meets the stock differently. So each number of passes whose lower bound
(:mod:`optimiser.planning.pass_bounds`) is below the best so far is tried along its path.

1. The programmed number is tried, and the least number that the depth limits allow. Until one
   is feasible, the closed form proposes others from the last path.
2. The other numbers follow, in the order of what the deepest path says of their cost. One
   whose bound is not below the best so far is passed over; if it is, its path is made and
   timed, and only if the bound is still below the best is the path tried in the stock.
3. A search ends after :data:`MOST_LEVELS` levels of paths. Numbers that might have been better
   are told.

The order does not depend on the programmed number, so that a search that begins with the result
of another ends with it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import inf

from optimiser.bounds.plunge_feed import CLOSE, PlungeOptimum, at_foot, best_plunge
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut
from optimiser.cuts.source import CutSource
from optimiser.errors import Infeasible
from optimiser.modes import Free, Mode
from optimiser.planning.formulate import LEAST_DEPTH, OptimisationTask, problem_of
from optimiser.planning.pass_bounds import PassCountBounds, are_alike, bounds_of
from optimiser.planning.reasons import remedy_for
from optimiser.solver import workingstep as exact
from optimiser.solver.least_cost import least_cost
from optimiser.solver.problem import (
    SCALES_WITH_FORCE,
    BoundSide,
    Limit,
    LimitName,
    Problem,
    Setting,
)
from stepnc_model.plurals import counted
from stepnc_model.programs.program import ResolvedWorkingstep

UNTIL_FEASIBLE = 10
"""Greatest number of paths tried while none keeps its limits.

Stock that was left above can make passes deeper than planned.
"""

MOST_LEVELS = 150
"""Greatest number of levels in the paths of one search, the first paths not counted.

A path of a hundred levels takes seconds to evaluate.
"""

WORTH = 0.004
"""Relative saving below which the programmed number of passes is kept, or else the fewest."""

TIE = 1e-4
"""Relative difference of costs that no further path is tried for."""


THIN = 1.25
"""Ratio of depths below which planned passes count as thin as they may be."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AdviceContext:
    """Inputs of one workingstep's advice besides its cut."""

    step: ResolvedWorkingstep
    at: CuttingConditions
    task: OptimisationTask
    cuts: CutSource


@dataclass(frozen=True, slots=True, kw_only=True)
class Optimum:
    """Best setting with the shadow prices of its limits."""

    solution: exact.Solution
    prices: tuple[tuple[LimitName, float], ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class PassCountOptimum:
    """Best setting for one number of passes, with the cut along the resulting path."""

    cut: Cut
    problem: Problem
    optimum: Optimum
    untried: tuple[int, ...] = ()
    """Numbers of passes that might be better, but whose paths were not tried."""


@dataclass(slots=True, kw_only=True)
class PassCountSearch:
    """Search for the best number of passes of a workingstep (mutable state)."""

    cut: Cut
    context: AdviceContext
    optima: dict[int, PassCountOptimum] = field(default_factory=dict)
    """Best setting for each feasible number of passes that was tried."""
    bounds: dict[int, PassCountBounds] = field(default_factory=dict)
    """Bounds from each path that was tried, also from infeasible ones."""
    conflict: Infeasible | None = None
    """Why the last infeasible number of passes was infeasible."""

    @property
    def least(self) -> float:
        """Least cost so far, s or J; infinite without a feasible number of passes."""
        return min((self.cost(each) for each in self.optima.values()), default=inf)

    def chosen(self, programmed: int) -> int:
        """Number of passes to take: the given one, or the fewest near the least cost."""
        bound = self.least / (1.0 - WORTH)
        near = {n for n, each in self.optima.items() if self.cost(each) <= bound}
        return programmed if programmed in near else min(near)

    def cost(self, candidate: PassCountOptimum) -> float:
        """Cost of a number of passes along its own path, s or J."""
        cost = exact.cost_function(candidate.problem, self.context.task.mode)
        return cost(candidate.optimum.solution.setting)

    def try_passes(self, problem: Problem, passes: int) -> Problem:
        """Try a number of passes along its path, and return the problem of that path."""
        asked = self.context
        cut = _along_path(self.cut, problem, passes, asked)
        problem = problem_of(cut, asked.at, asked.task)
        self.bounds[passes] = bounds_of(cut, asked.at, asked.task, passes=passes)
        try:
            self.optima[passes] = _best_in(cut, problem, passes, asked)
        except Infeasible as conflict:
            if problem.passes[0] == problem.passes[1]:
                raise
            self.conflict = _both(self.conflict, conflict)
            return problem
        return self.optima[passes].problem

    @property
    def is_alike(self) -> bool:
        """True if the levels of all paths that were tried are alike."""
        return are_alike([each.cut for each in self.bounds.values()])

    def is_bounded(self, passes: int) -> bool:
        """True if bounds without a path tell that a number of passes is not worth a change."""
        is_alike = self.is_alike
        return any(
            each.at_least(passes, is_alike=is_alike) >= self.worthwhile
            for each in self.bounds.values()
        )

    def is_hopeless(self, problem: Problem, passes: int) -> bool:
        """True if bounds, also along its path, tell that a number of passes is no better."""
        if self.is_bounded(passes):
            return True
        depth, asked = problem.depth_at(passes), self.context

        def timed(cut: Cut, setting: Setting) -> Cut:
            return asked.cuts.timed(asked.step, cut, replace(setting, depth=depth))

        return any(
            each.along(passes, timed, is_alike=self.is_alike) >= self.worthwhile
            for each in self.bounds.values()
        )

    @property
    def worthwhile(self) -> float:
        """Bound below which another number of passes is tried, s or J."""
        return self.least * (1.0 - TIE)


def best_of(cut: Cut, problem: Problem, context: AdviceContext) -> PassCountOptimum:
    """Find the best number of passes, each evaluated along its own path.

    Raises
    ------
    Infeasible
        When no number of passes that was tried keeps all limits.
    """
    search = PassCountSearch(cut=cut, context=context)
    given = problem.programmed.passes
    last = search.try_passes(problem, given)
    untried: list[int] = []
    if problem.passes[0] != problem.passes[1]:
        deepest = problem.deepest()
        # A path in deeper passes may show that still deeper ones are allowed.
        while deepest not in search.bounds and deepest <= problem.passes[1]:
            last = search.try_passes(problem, deepest)
            deepest = min(deepest, last.deepest())
        last = _until_feasible(search, last)
        untried = _try_in_order(search, problem, deepest)
    if not search.optima:
        raise _infeasible_as_tooled(search, last)
    chosen = search.chosen(given)
    best = search.optima[chosen]
    if chosen != given:
        _require_sensible(best, given)
    # The next workingstep finds the stock as this path leaves it.
    cut = context.cuts.at(context.step, best.cut, best.optimum.solution.setting)
    return replace(_with_deepest(best, search), cut=cut, untried=tuple(untried))


def _both(conflict: Infeasible | None, other: Infeasible) -> Infeasible:
    """The later of two conflicts; a limit and the stock that keeps passes from changing."""
    if conflict is None or other.limits:
        return other
    return Infeasible(f"{conflict}; {other}", limits=conflict.limits)


def _require_candidate(cut: Cut, passes: int) -> None:
    """Refuse a number of passes that leaves other stock than the program does."""
    for refused in cut.refused_passes:
        if refused.passes == passes:
            raise Infeasible(refused.words, limits=())


def _until_feasible(search: PassCountSearch, problem: Problem) -> Problem:
    """Try what the closed form proposes for the last path, until a path is feasible.

    Returns the problem of the last path.
    """
    while not search.optima and len(search.bounds) < UNTIL_FEASIBLE:
        try:
            passes = _optimum(problem, search.context.task).solution.setting.passes
        except Infeasible:
            return problem
        if passes in search.bounds:
            return problem
        problem = search.try_passes(problem, passes)
    return problem


def _infeasible_as_tooled(search: PassCountSearch, problem: Problem) -> Infeasible:
    """Error that names the limits that conflict in any number of passes, and what helps."""
    conflict = search.conflict or exact.conflict(problem)
    try:
        _optimum(problem, search.context.task)
    except Infeasible as thinnest:
        # It tells of the thinnest passes, where the feed may be greatest.
        conflict = thinnest
    caps = conflict.limits[:1]
    return Infeasible(
        f"infeasible as tooled: {conflict}; passes thinner than {LEAST_DEPTH:g} mm are not "
        f"planned{remedy_for(caps)}",
        limits=conflict.limits,
    )


def _try_in_order(search: PassCountSearch, problem: Problem, deepest: int) -> list[int]:
    """Try numbers of passes, the most promising first; return what was left out.

    Numbers that were tried before count as tried in their turn, so that the numbers within
    reach are the same whatever the programmed number is. A path may show that levels are not
    alike, so that bounds are lower: then numbers that were passed over have another turn.
    """
    is_alike = None
    untried: list[int] = []
    while is_alike is not search.is_alike:
        is_alike, levels, untried = search.is_alike, 0, []
        for passes in _in_order(search, problem, deepest):
            levels += passes
            if passes in search.bounds:
                continue
            if levels > MOST_LEVELS:
                untried += [] if search.is_bounded(passes) else [passes]
            elif not search.is_hopeless(problem, passes):
                search.try_passes(problem, passes)
    return sorted(untried)


def _in_order(search: PassCountSearch, problem: Problem, deepest: int) -> list[int]:
    """Numbers of passes that may be best, by what the deepest path says of their cost."""
    if deepest not in search.bounds:
        return []
    bounds, is_alike = search.bounds[deepest], search.is_alike
    or_more = least_cost(bounds.shortest(is_alike=is_alike), search.context.task.mode)
    likely = {}
    for passes in range(deepest, problem.passes[1] + 1):
        if or_more(passes) > search.worthwhile:
            break
        likely[passes] = bounds.estimate(passes)
    return sorted(
        (each for each in likely if likely[each] < inf), key=lambda each: likely[each]
    )


def _require_sensible(best: PassCountOptimum, programmed: int) -> None:
    """Refuse passes that are as thin as they may be while a force still sets the feed."""
    solution = best.optimum.solution
    setting = solution.setting
    is_thinnest = setting.passes > programmed and setting.depth < THIN * LEAST_DEPTH
    if not is_thinnest or solution.active not in SCALES_WITH_FORCE:
        return
    raise Infeasible(
        f"infeasible as tooled: {solution.holding.words} still sets the feed in "
        f"{counted(setting.passes, 'pass', 'passes')} of {setting.depth:.3g} mm, which would "
        f"take {solution.time:.4g} s{remedy_for((solution.active,))}",
        limits=(solution.active,),
    )


def _with_deepest(best: PassCountOptimum, search: PassCountSearch) -> PassCountOptimum:
    """Optimum with the time of the fewest feasible passes that were tried."""
    fewest = search.optima[min(search.optima)].optimum.solution.time
    solution = best.optimum.solution
    solution = replace(solution, deepest_first_time=max(solution.time, fewest))
    return replace(best, optimum=replace(best.optimum, solution=solution))


def _along_path(cut: Cut, problem: Problem, passes: int, context: AdviceContext) -> Cut:
    """Cut along the path in a number of passes, at the programmed feed."""
    given = cut.programmed
    depth = given.depth if passes == given.passes else problem.depth_at(passes)
    return context.cuts.at(context.step, cut, replace(given, passes=passes, depth=depth))


def _best_in(
    cut: Cut, problem: Problem, passes: int, context: AdviceContext
) -> PassCountOptimum:
    """Best setting for a number of passes: first the limits, then the time at that feed."""
    task = context.task
    _require_candidate(cut, passes)
    found = _with_plunge(cut, passes, context)
    optimum, cut, plunging = found.optimum, found.cut, found.setting
    setting = optimum.solution.setting
    problem = _held(problem_of(cut, context.at, task), found.held)
    again = optimum if task.tool_change else _with_passes(problem, passes, task)
    if task.tool_change or again.solution.setting != setting:
        again = replace(optimum, solution=exact.settled(problem, setting))
    again = replace(again, solution=replace(again.solution, setting=plunging))
    return PassCountOptimum(cut=cut, problem=problem, optimum=again)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Plunging:
    """Optimum of the passes with its plunge feed, and the cut along its path."""

    optimum: Optimum
    cut: Cut
    setting: Setting
    held: Limit | None = None
    """Limit on the feed of the pass that the end of a ramp sets; None where it sets none."""


def _with_plunge(cut: Cut, passes: int, context: AdviceContext) -> _Plunging:
    """Optimum for a number of passes with the best plunge feed, where feeds are free."""
    task = context.task
    if Free.FEED not in task.free:
        optimum = _with_passes(problem_of(cut, context.at, task), passes, task)
        setting = replace(optimum.solution.setting, plunge_feed=cut.programmed.plunge_feed)
        cut = context.cuts.at(context.step, cut, setting)
        return _Plunging(optimum=optimum, cut=cut, setting=setting)
    plunging, found = _plunging(cut, passes, context)
    for _ in range(UNTIL_FEASIBLE):
        if found.excess <= 1.0 + CLOSE or found.limit is None:
            break
        held = at_foot(found.limit, plunging.setting.feed / found.excess)
        plunging, found = _plunging(cut, passes, context, held)
    if found.balanced_feed is None or found.limit is None:
        return plunging
    held = at_foot(found.limit, found.balanced_feed)
    slower, of_slower = _plunging(cut, passes, context, held)
    is_less = _time(slower, context) < _time(plunging, context)
    return slower if is_less and of_slower.excess <= 1.0 + CLOSE else plunging


def _plunging(
    cut: Cut, passes: int, context: AdviceContext, held: Limit | None = None
) -> tuple[_Plunging, PlungeOptimum]:
    """Optimum of the passes below a limit, with the best plunge feed before it."""
    at, task = context.at, context.task
    timed = partial(context.cuts.at, context.step)
    for _ in range(UNTIL_FEASIBLE):
        optimum = _with_passes(_held(problem_of(cut, at, task), held), passes, task)
        found = best_plunge(cut, at, optimum.solution.setting, timed)
        if _keeps(found.cut, optimum.solution.setting, context):
            break
        cut = found.cut
    plunging = _Plunging(optimum=optimum, cut=found.cut, setting=found.setting, held=held)
    return plunging, found


def _keeps(cut: Cut, setting: Setting, context: AdviceContext) -> bool:
    """True if a turned cut keeps the greatest loads also as timed at its setting.

    A spindle that follows the radius is late by another share at another speed or feed, so that
    the place of the greatest power has another power.
    """
    if not cut.kind.is_turned:
        return True
    problem = problem_of(cut, context.at, context.task)
    return all(
        limit.load.value(setting.feed, setting.depth, setting.speed)
        <= (1.0 + CLOSE) * limit.bound_at(setting.speed)
        for limit in exact.limits_at(problem, setting.speed)
        if limit.sense is BoundSide.AT_MOST
    )


def _time(plunging: _Plunging, context: AdviceContext) -> float:
    """Time or energy of a setting along its own path."""
    problem = problem_of(plunging.cut, context.at, context.task)
    return exact.cost_function(problem, context.task.mode)(plunging.setting)


def _held(problem: Problem, limit: Limit | None) -> Problem:
    """Problem with one more limit, if there is one."""
    return problem if limit is None else replace(problem, limits=(*problem.limits, limit))


def _with_passes(problem: Problem, passes: int, task: OptimisationTask) -> Optimum:
    """Optimum for a given number of passes."""
    given = problem.programmed
    if problem.passes[0] == problem.passes[1]:
        return _optimum(problem, task)
    if passes != given.passes:
        given = replace(given, passes=passes, depth=problem.depth_at(passes))
    why = f"the tool path has {counted(passes, 'pass', 'passes')}"
    held = replace(problem, passes=(passes, passes), programmed=given, why_held=why)
    return _optimum(held, task)


def _optimum(problem: Problem, task: OptimisationTask) -> Optimum:
    """Exact optimum, or that of the geometric program when tool wear counts."""
    if task.tool_change == 0.0 or task.mode is Mode.CC:
        return Optimum(solution=exact.solve(problem, task.mode))
    from optimiser.solver import geometric_program as general  # noqa: PLC0415 (cvxpy takes a second)

    found = general.solve(problem, task.mode)
    return Optimum(
        solution=exact.settled(problem, general.snapped(problem, found)),
        prices=tuple((name, price) for name, price in found.prices.items()),
    )


def untried_words(untried: Sequence[int], passes: int) -> list[str]:
    """Warning that names numbers of passes that might be better and were not tried."""
    if not untried:
        return []
    first, last = untried[0], untried[-1]
    told = f"from {first} to {last}" if len(untried) > 1 else f"{first}"
    return [
        f"{told} passes were not tried and might be better than {passes}: the search ends "
        f"after {MOST_LEVELS} levels of tool paths"
    ]
