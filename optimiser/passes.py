"""Search for the best number of passes, each evaluated along its own tool path.

The closed form assumes that all passes are alike, but a path with other passes enters and
leaves elsewhere and meets the stock differently. So each proposal of the closed form is tried
along its path and solved again.
"""

from dataclasses import dataclass, replace
from functools import partial
from math import inf

from optimiser import workingstep as exact
from optimiser.conditions import CuttingConditions
from optimiser.cut import Cut
from optimiser.errors import Infeasible
from optimiser.formulate import OptimisationTask, problem_of
from optimiser.modes import Free
from optimiser.plunge_search import CLOSE, PlungeOptimum, at_foot, best_plunge
from optimiser.problem import Limit, LimitName, Problem, Setting
from optimiser.source import CutSource
from stepnc_model.program import ResolvedWorkingstep

ROUNDS = 4
"""Greatest number of paths tried for the depth of one workingstep."""

UNTIL_FEASIBLE = 10
"""Greatest number of paths tried while none keeps its limits.

Stock that was left above can make passes deeper than planned.
"""

MANY = 100
"""Number of passes above which the first feasible path is accepted.

A larger programmed number raises it. A path of hundreds of levels takes seconds to evaluate.
"""


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


def best_of(cut: Cut, problem: Problem, asked: AdviceContext) -> PassCountOptimum:
    """Find the best number of passes, each evaluated along its own path.

    The last optimum proposes the next number to try, until it proposes a number that was tried,
    or that by its own estimate is no better than the best so far; that path is not made. The
    programmed number is tried first, so that advice that was adopted is given again.
    """
    told: dict[int, PassCountOptimum] = {}
    tried: set[int] = set()
    given = problem.programmed.passes
    passes = given
    last: Infeasible | None = None
    while passes not in tried and len(tried) < (ROUNDS if told else UNTIL_FEASIBLE):
        tried.add(passes)
        try:
            told[passes] = _told(cut, problem, passes, asked)
            problem = told[passes].problem
        except Infeasible as conflict:
            if problem.passes[0] == problem.passes[1]:
                raise
            last = _both(last, conflict)
        if told and passes > max(MANY, given):
            break
        try:
            proposal = _optimum(problem, asked.task).solution.setting
        except Infeasible:
            if not told:
                raise
            break
        least = min((_cost(each, asked.task) for each in told.values()), default=inf)
        if exact.cost_function(problem, asked.task.mode)(proposal) >= least:
            break
        passes = proposal.passes
    best = min(told.values(), key=lambda each: _cost(each, asked.task), default=None)
    if best is None:
        raise last or exact.conflict(problem)
    # The next workingstep finds the stock as this path leaves it.
    cut = asked.cuts.at(asked.step, best.cut, best.optimum.solution.setting)
    return replace(best, cut=cut)


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


def _cost(told: PassCountOptimum, task: OptimisationTask) -> float:
    """Cost in seconds or joules of a number of passes along its own path."""
    return exact.cost_function(told.problem, task.mode)(told.optimum.solution.setting)


def _told(cut: Cut, problem: Problem, passes: int, asked: AdviceContext) -> PassCountOptimum:
    """Best setting for a number of passes: first the limits, then the time at that feed."""
    given, step, task = cut.programmed, asked.step, asked.task
    depth = given.depth if passes == given.passes else problem.depth_at(passes)
    cut = asked.cuts.at(step, cut, replace(given, passes=passes, depth=depth))
    _require_candidate(cut, passes)
    found = _with_plunge(cut, passes, asked)
    optimum, cut, plunging = found.optimum, found.cut, found.setting
    setting = optimum.solution.setting
    problem = _held(problem_of(cut, asked.at, task), found.held)
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


def _with_plunge(cut: Cut, passes: int, asked: AdviceContext) -> _Plunging:
    """Optimum for a number of passes with the best plunge feed, where feeds are free."""
    task = asked.task
    if Free.FEED not in task.free:
        optimum = _with_passes(problem_of(cut, asked.at, task), passes, task)
        setting = replace(optimum.solution.setting, plunge_feed=cut.programmed.plunge_feed)
        cut = asked.cuts.at(asked.step, cut, setting)
        return _Plunging(optimum=optimum, cut=cut, setting=setting)
    plunging, found = _plunging(cut, passes, asked)
    for _ in range(UNTIL_FEASIBLE):
        if found.excess <= 1.0 + CLOSE or found.limit is None:
            break
        held = at_foot(found.limit, plunging.setting.feed / found.excess)
        plunging, found = _plunging(cut, passes, asked, held)
    if found.balanced_feed is None or found.limit is None:
        return plunging
    held = at_foot(found.limit, found.balanced_feed)
    slower, of_slower = _plunging(cut, passes, asked, held)
    is_less = _time(slower, asked) < _time(plunging, asked)
    return slower if is_less and of_slower.excess <= 1.0 + CLOSE else plunging


def _plunging(
    cut: Cut, passes: int, asked: AdviceContext, held: Limit | None = None
) -> tuple[_Plunging, PlungeOptimum]:
    """Optimum of the passes below a limit, with the best plunge feed before it."""
    at, task = asked.at, asked.task
    optimum = _with_passes(_held(problem_of(cut, at, task), held), passes, task)
    timed = partial(asked.cuts.at, asked.step)
    found = best_plunge(cut, at, optimum.solution.setting, timed)
    plunging = _Plunging(optimum=optimum, cut=found.cut, setting=found.setting, held=held)
    return plunging, found


def _time(plunging: _Plunging, asked: AdviceContext) -> float:
    """Time or energy of a setting along its own path."""
    problem = problem_of(plunging.cut, asked.at, asked.task)
    return exact.cost_function(problem, asked.task.mode)(plunging.setting)


def _held(problem: Problem, limit: Limit | None) -> Problem:
    """Problem with one more limit, if there is one."""
    return problem if limit is None else replace(problem, limits=(*problem.limits, limit))


def _with_passes(problem: Problem, passes: int, task: OptimisationTask) -> Optimum:
    """Optimum for a given number of passes."""
    free = _optimum(problem, task)
    given = problem.programmed
    if free.solution.setting.passes == passes:
        return free
    if passes != given.passes:
        given = replace(given, passes=passes, depth=problem.depth_at(passes))
    why = f"the tool path has {passes} passes"
    held = replace(problem, passes=(passes, passes), programmed=given, why_held=why)
    return _optimum(held, task)


def _optimum(problem: Problem, task: OptimisationTask) -> Optimum:
    """Exact optimum, or that of the geometric program when tool wear counts."""
    if task.tool_change == 0.0:
        return Optimum(solution=exact.solve(problem, task.mode))
    from optimiser import program as general  # noqa: PLC0415 (cvxpy takes a second)

    found = general.solve(problem, task.mode)
    return Optimum(
        solution=exact.settled(problem, general.snapped(problem, found)),
        prices=tuple((name, price) for name, price in found.prices.items()),
    )
