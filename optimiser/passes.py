"""Search for the best number of passes, each evaluated along its own tool path.

The closed form assumes that all passes are alike, but a path with other passes enters and
leaves elsewhere and meets the stock differently. So each proposal of the closed form is tried
along its path and solved again.
"""

from dataclasses import dataclass, replace
from math import inf

from optimiser import workingstep as exact
from optimiser.conditions import CuttingConditions
from optimiser.cut import Cut
from optimiser.errors import Infeasible
from optimiser.formulate import OptimisationTask, problem_of
from optimiser.modes import Free
from optimiser.plunge_feed import with_plunge_feed
from optimiser.problem import LimitName, Problem, Setting
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
    optimum = _with_passes(problem_of(cut, asked.at, task), passes, task)
    setting = optimum.solution.setting
    plunging = _with_plunge(cut, setting, asked)
    cut = asked.cuts.at(step, cut, plunging)
    problem = problem_of(cut, asked.at, task)
    again = optimum if task.tool_change else _with_passes(problem, passes, task)
    if task.tool_change or again.solution.setting != setting:
        again = replace(optimum, solution=exact.settled(problem, setting))
    again = replace(again, solution=replace(again.solution, setting=plunging))
    return PassCountOptimum(cut=cut, problem=problem, optimum=again)


def _with_plunge(cut: Cut, setting: Setting, asked: AdviceContext) -> Setting:
    """Setting with the best plunge feed, where feeds are free."""
    if Free.FEED not in asked.task.free:
        return replace(setting, plunge_feed=cut.programmed.plunge_feed)
    return with_plunge_feed(cut, asked.at, setting)


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
