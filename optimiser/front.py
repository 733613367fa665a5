"""Pareto front between time, roughness and energy of one workingstep.

Every point is an exact optimum: least time, or least energy, for a required roughness. Points
that another point equals or beats in all three are left out.
"""

from dataclasses import replace

from optimiser import workingstep as exact
from optimiser.advice import EvaluatedSetting, ParetoPoint
from optimiser.conditions import CuttingConditions
from optimiser.cut import Cut
from optimiser.errors import Infeasible
from optimiser.formulate import state_of
from optimiser.modes import Mode
from optimiser.problem import BoundSide, Limit, LimitName, Problem, Setting
from optimiser.roughness import roughness_limit, roughness_load

POINTS = 15
"""Number of roughness levels between the finest possible and the unconstrained optimum."""


def front_of(problem: Problem, cut: Cut, at: CuttingConditions) -> tuple[ParetoPoint, ...]:
    """Points of the Pareto front, the fastest first."""
    free = replace(problem, limits=_without_roughness(problem.limits))
    best = [state_of(cut, free, at, _best(free, mode)) for mode in (Mode.TC, Mode.EC)]
    points = [ParetoPoint(state=state, roughness_bound=None) for state in best]
    roughest = max(best, key=lambda state: state.roughness or 0.0)
    for level in _levels(free, cut, roughest):
        bounded = replace(free, limits=(*free.limits, roughness_limit(cut, level)))
        for mode in (Mode.TC, Mode.EC):
            try:
                setting = _best(bounded, mode)
            except Infeasible:
                continue
            state = state_of(cut, bounded, at, setting)
            points.append(ParetoPoint(state=state, roughness_bound=level))
    return tuple(sorted(_undominated(points), key=lambda point: point.state.time))


def _best(problem: Problem, mode: Mode) -> Setting:
    """Best setting: closed form, or the geometric program when tool wear counts."""
    has_wear = mode is not Mode.EC and problem.cost.tool_change > 0.0
    if not has_wear or len(problem.speeds) == 1:
        return exact.solve(problem, mode).setting
    from optimiser import program as general  # noqa: PLC0415 (cvxpy takes a second)

    return general.snapped(problem, general.solve(problem, mode))


def _without_roughness(limits: tuple[Limit, ...]) -> tuple[Limit, ...]:
    return tuple(limit for limit in limits if limit.name is not LimitName.ROUGHNESS)


def _levels(problem: Problem, cut: Cut, roughest: EvaluatedSetting) -> list[float]:
    """Ra levels, mm, from the roughest optimum down to the thinnest permitted chip."""
    load = roughness_load(cut)
    if load is None or roughest.roughness is None:
        return []
    setting = roughest.setting
    thinnest = max(
        (
            limit.feed_at_bound(setting.depth, setting.speed)
            for limit in problem.limits
            if limit.sense is BoundSide.AT_LEAST and limit.load.feed_exponent > 0.0
        ),
        default=setting.feed / POINTS,
    )
    steps = [index / (POINTS - 1) for index in range(POINTS)]
    feeds = [setting.feed * (thinnest / setting.feed) ** step for step in steps]
    return [load.value(feed, setting.depth, setting.speed) for feed in feeds]


def _undominated(points: list[ParetoPoint]) -> list[ParetoPoint]:
    """Points that no other point equals or beats in time, roughness and energy."""
    kept: list[ParetoPoint] = []
    for point in sorted(points, key=lambda point: _measures(point.state)):
        mine = _measures(point.state)
        if not any(_beats(_measures(other.state), mine) for other in kept):
            kept.append(point)
    return kept


def _measures(state: EvaluatedSetting) -> tuple[float, float, float]:
    return state.time, state.roughness or 0.0, state.energy


def _beats(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    """Whether the first point is nowhere worse than the second, up to rounding."""
    return all(a <= b * (1.0 + exact.TIE) for a, b in zip(one, other, strict=True))
