"""Build the optimisation problem of a cut, and evaluate settings of the cut.

Pareto front between time, roughness and energy of one workingstep.

Every point is an exact optimum: least time, or least energy, for a required roughness. Points
that another point equals or beats in all three are left out.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import inf, isfinite, pi
from types import MappingProxyType

from optimiser.advice import EvaluatedSetting, LimitLoad, ParetoPoint
from optimiser.bounds.holding import chuck_limits, holding_limits
from optimiser.bounds.limits import (
    drill_point,
    force_factor,
    force_load,
    limits_of,
    power_load,
    spindle_limits,
)
from optimiser.bounds.loads import scaled, thrust
from optimiser.bounds.plunge_feed import plunge_limits
from optimiser.bounds.roughness import (
    roughness_forecast,
    roughness_limit,
    roughness_load,
)
from optimiser.bounds.speed_limits import held_speed, speed_range
from optimiser.bounds.speed_stretch import segment_within, stretch_ends
from optimiser.bounds.stability import stability_limits
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut, CutKind
from optimiser.cuts.source import Source, along_paths
from optimiser.errors import Infeasible
from optimiser.modes import Free, Mode
from optimiser.safety import LEAST_SHARE, USUAL_QUANTILE, require_quantile, safety_factor
from optimiser.solver import workingstep as exact
from optimiser.solver.convex import TIE
from optimiser.solver.problem import (
    BoundSide,
    Cost,
    Limit,
    LimitName,
    Monomial,
    Problem,
    Setting,
)
from simulator.library import find_window
from simulator.physics.tool_life import assumed_life, tool_life
from simulator.spec import Machine, WorkMaterial

LEAST_DEPTH = 0.1
"""Least depth of a planned pass, mm, unless the program has thinner ones.

ISO 2768-m lets a surface lie 0.1 mm off where the program has it: a thinner pass may meet
nothing, or twice its depth.
"""

LEAST_SPEED_RATIO = 0.1
"""Least spindle speed over the greatest, when neither machine nor tool states one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimisationTask:
    """Optimisation task: mode, free variables and safety margin."""

    mode: Mode = Mode.TC
    free: frozenset[Free] = frozenset({Free.FEED, Free.DEPTH})
    roughness: float | None = None
    """Roughness Ra for all finished surfaces in place of the file's, mm; None: as in the
    file."""
    roughness_quantile: float = LEAST_SHARE
    """Share of real surfaces that must keep their roughness."""
    tool_change: float = 0.0
    """Time to change a worn tool, s; 0: tool life does not count."""
    force_factors: Mapping[str, float] = field(default_factory=dict, hash=False)
    """Accepted corrections of k_c by tool id; 1 for a tool that is not listed."""
    front: bool = False
    """Whether the Pareto front between time, roughness and energy is computed."""
    safety: float = USUAL_QUANTILE
    """Quantile of k_c at which loads must keep their bounds, 0.5 (nominal) to 0.999."""
    learned_safety_factors: Mapping[str, float] = field(default_factory=dict, hash=False)
    """k_c at the planned quantile over its accepted correction, by tool id.

    A tool that is not listed has the spread of its material.
    """
    centre_cutting: Mapping[str, bool] = field(default_factory=dict, hash=False)
    """Whether the end edges of a mill reach its axis, by tool id."""
    allow_plunge: bool = False
    """Whether mills that do not cut over centre may plunge straight into solid material."""
    wipers: frozenset[str] = frozenset()
    """Ids of the tools whose inserts have a wiper."""
    source: Source = along_paths
    """Factory of the source of cuts."""
    ignores_records: bool = False
    """Whether the limits of optimisation records in the file are ignored."""
    keep_going: bool = False
    """Whether a workingstep that cannot be advised is left as it is, and the rest advised."""

    def __post_init__(self) -> None:
        for tool, factor in self.force_factors.items():
            if not (isfinite(factor) and factor > 0.0):
                raise ValueError(
                    f"tool '{tool}': k_c factor must be finite and above 0, not {factor:g}"
                )
        require_quantile(self.safety)
        # Read-only copies, so that later changes by the caller cannot change the task.
        for name in ("force_factors", "learned_safety_factors", "centre_cutting"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))

    def force_factor(self, tool: str) -> float:
        """Accepted correction factor of k_c for a tool id."""
        return self.force_factors.get(tool, 1.0)

    def safety_factor(self, tool: str, machine: Machine, material: WorkMaterial) -> float:
        """k_c at the planned quantile relative to the nominal k_c, for a tool id."""
        if tool in self.learned_safety_factors:
            return self.learned_safety_factors[tool]
        if machine.only_stated_limits or material.spread is None:
            return 1.0
        return safety_factor(material.spread, self.safety)


def problem_of(cut: Cut, at: CuttingConditions, task: OptimisationTask) -> Problem:
    """Formulate the optimisation problem of a cut."""
    limits = limits_of(cut, at) + stability_limits(cut, at) + holding_limits(cut, at)
    limits = _safe(limits, at)
    given = cut.programmed
    cost = _cost(cut, at, task)
    if task.mode is Mode.CC:
        limits += tuple(cheapest_feed(cost))
    if Free.FEED not in task.free:
        limits += tuple(_held_feed(given.feed, sense) for sense in BoundSide)
    passes = (given.passes, given.passes)
    if Free.DEPTH in task.free and cut.is_depth_free:
        passes = (1, max(given.passes, int(cut.total_depth / LEAST_DEPTH)))
    speeds, stretches = _stretches(cut, at, task)
    return Problem(
        limits=limits,
        cost=cost,
        total_depth=cut.total_depth,
        passes=passes,
        speeds=speeds,
        programmed=given,
        stretches=stretches,
    )


def _safe(limits: tuple[Limit, ...], at: CuttingConditions) -> tuple[Limit, ...]:
    """Limits with the safety factor of k_c applied."""
    return tuple(limit.with_safety(at.safety_factor) for limit in limits)


def _held_feed(feed: float, sense: BoundSide) -> Limit:
    """Limit that fixes the feed per tooth at its programmed value."""
    return Limit(
        name=LimitName.PROGRAMMED_FEED,
        load=Monomial(coefficient=1.0, feed_exponent=1.0),
        bound=feed,
        unit="mm",
        sense=sense,
        step=0.01,
    )


def _stretches(
    cut: Cut, at: CuttingConditions, task: OptimisationTask
) -> tuple[tuple[float, ...], tuple[tuple[Limit, ...], ...]]:
    """Spindle speeds to choose from, and the spindle limits on each stretch of its curve."""
    speed = held_speed(cut, at)
    low, high = speed_range(cut, at)
    if Free.SPEED not in task.free or not low < high < inf:
        return (speed,), (_between(cut, at, speed, speed),)
    least = max(low, LEAST_SPEED_RATIO * high)
    if at.roughness is not None:
        # The limit holds at the programmed speed: a slower surface is rougher.
        least = min(max(least, speed), high)
    if not least < high:
        return (speed,), (_between(cut, at, speed, speed),)
    ends = stretch_ends(cut, at, least, high)
    return ends, tuple(_between(cut, at, slow, fast) for slow, fast in pairwise(ends))


def _between(cut: Cut, at: CuttingConditions, slow: float, fast: float) -> tuple[Limit, ...]:
    """Limits of spindle and chuck on a range of spindle speeds."""
    spindle = spindle_limits(cut, at, segment_within(cut, at, slow, fast))
    return _safe((*spindle, *chuck_limits(cut, at, slow, fast)), at)


def _cost(cut: Cut, at: CuttingConditions, task: OptimisationTask) -> Cost:
    """Time and energy of the cut on this machine as a cost function."""
    machine = at.machine
    spindle = machine.spindle
    wear = _wear_rate(cut, at) if task.tool_change > 0.0 else None
    rates, rate, price, change = machine.costs, 0.0, 0.0, task.tool_change
    if task.mode is Mode.CC and rates is not None:
        wear = full_wear_rate(cut, at)
        rate, price = rates.machine_rate, rates.edge_price(at.cutting_material)
        change = change or rates.edge_change
    # Energy is specific force times volume, so the peak factors of the power do not apply.
    mean = replace(cut, power_diameter=None, thickest=1.0)
    return Cost(
        length=cut.length,
        once_length=cut.floor.length if cut.floor is not None else 0.0,
        teeth=cut.tool.teeth,
        motor_power=scaled(power_load(mean, at), cut.load_share),
        link_time=cut.rest_time + (cut.link_length / machine.rapid if machine.rapid else 0.0),
        standby_power=machine.base_power + machine.coolant_power + spindle.idle_power,
        standby_power_per_speed=spindle.idle_power_per_speed,
        tool_change=change if wear is not None else 0.0,
        wear_rate=wear,
        machine_rate=rate,
        edge_price=price,
    )


def _wear_rate(cut: Cut, at: CuttingConditions) -> Monomial | None:
    """Tool lives used per second: ``1/T = (v_c/C)^(1/n)``; None when tool life is unknown."""
    window = find_window(at.material, cut.tool_kind, at.cutting_material)
    if window is None or window.taylor is None:
        return None
    exponent = 1.0 / window.taylor.exponent
    life = tool_life(window.taylor, pi * cut.diameter)
    return Monomial(coefficient=1.0 / life, speed_exponent=exponent)


def full_wear_rate(cut: Cut, at: CuttingConditions) -> Monomial | None:
    """Tool lives used per second, ``1/T = (v_c/C)^(1/n)·(f/f_0)^x·(a/a_0)^y``.

    None when tool life is unknown. A drill's life does not depend on the depth of its holes.
    """
    window = find_window(at.material, cut.tool_kind, at.cutting_material)
    law = None if window is None else window.taylor or assumed_life(window)
    if law is None:
        return None
    depth_exponent = 0.0 if cut.kind is CutKind.DRILLING else law.depth_exponent
    reference = law.feed**law.feed_exponent * law.depth**depth_exponent
    return Monomial(
        coefficient=1.0 / (tool_life(law, pi * cut.diameter) * reference),
        feed_exponent=law.feed_exponent,
        depth_exponent=depth_exponent,
        speed_exponent=1.0 / law.exponent,
    )


def cheapest_feed(cost: Cost) -> Iterator[Limit]:
    """Feed beyond which the wear of an edge costs more than the time that is saved.

    ``(r + q·w·f^x)/f`` is least where ``(x − 1)·q·w·f^x = r``; else it falls with f.
    """
    wear = cost.wear_rate
    worn = cost.machine_rate * cost.tool_change + cost.edge_price
    if wear is None or wear.feed_exponent <= 1.0 or worn == 0.0 or cost.machine_rate == 0.0:
        return
    share = (wear.feed_exponent - 1.0) * worn
    yield Limit(
        name=LimitName.LEAST_COST,
        load=replace(wear, coefficient=share * wear.coefficient),
        bound=cost.machine_rate,
        unit="per hour",
        scale=3600.0,
        label="feed of least cost",
    )


def state_of(
    cut: Cut, problem: Problem, at: CuttingConditions, setting: Setting
) -> EvaluatedSetting:
    """Evaluate a cut at one setting: time, energy, forces, roughness and loads."""
    point = (setting.feed, setting.depth, setting.speed)
    passes, ways_in = list(_passes(cut, setting)), list(_ways_in(cut, setting))
    parts = passes + ways_in
    along = [part for part in parts if part.cut.kind is CutKind.DRILLING]
    plunges = along if cut.kind is CutKind.MILLING else []
    roughness = [
        load.value(*point)
        for each in (cut, cut.floor)
        if each is not None and (load := roughness_load(each)) is not None
    ]
    surface = roughness_forecast(cut, at, feed=setting.feed, speed=setting.speed)
    priced = _cost(cut, at, OptimisationTask(mode=Mode.CC))
    is_priced = at.machine.costs is not None
    return EvaluatedSetting(
        setting=setting,
        feed=setting.feed * cut.tool.teeth * setting.speed,
        time=problem.cost.time(setting),
        energy=problem.cost.energy(setting),
        motor_power=_greatest(power_load, parts, at, setting.speed),
        cutting_force=_greatest(force_load, _across(cut, passes), at, setting.speed),
        ramp_force=_greatest(force_load, _across(cut, ways_in), at, setting.speed),
        pass_power=_greatest(power_load, _across(cut, passes), at, setting.speed),
        ramp_power=_greatest(power_load, _across(cut, ways_in), at, setting.speed),
        plunge_power=_greatest(power_load, plunges, at, setting.speed),
        thrust=_greatest(_thrust_load, along, at, setting.speed),
        roughness=max(roughness, default=None),
        surface=surface if cut.is_finishing else None,
        loads=limit_loads(exact.limits_at(problem, setting.speed), point),
        money=priced.money(setting) if is_priced else None,
        lives=None if not is_priced or priced.wear_rate is None else priced.lives(setting),
        plunge_loads=_plunge_loads(cut, at, setting),
    )


def _plunge_loads(cut: Cut, at: CuttingConditions, setting: Setting) -> tuple[LimitLoad, ...]:
    """Loads at the plunge feed; empty without a plunge feed."""
    if setting.plunge_feed is None:
        return ()
    point = (setting.plunge_feed, setting.depth, setting.speed)
    return limit_loads(plunge_limits(cut, at, setting.speed), point)


def limit_loads(
    limits: tuple[Limit, ...], point: tuple[float, float, float]
) -> tuple[LimitLoad, ...]:
    """Loads of limits at one feed per tooth, depth and spindle speed."""
    return tuple(
        LimitLoad(
            limit=limit, value=limit.load.value(*point), bound=limit.full_bound_at(point[2])
        )
        for limit in limits
    )


@dataclass(frozen=True, slots=True)
class _Part:
    """Part of a cut with its own feed and depth."""

    cut: Cut
    feed: float
    """Feed per tooth, mm."""
    depth: float
    """Axial depth of cut, mm."""


def _passes(cut: Cut, setting: Setting) -> Iterator[_Part]:
    """Parts at the feed of the cut: walls, swept floor and straight plunges.

    The loads of a plunge do not depend on the depth.
    """
    feed, depth = setting.feed, setting.depth
    yield _Part(cut, feed, depth)
    if cut.floor is not None:
        yield _Part(cut.floor, feed, cut.floor.total_depth)
    if cut.plunge is not None:
        yield _Part(cut.plunge, feed, depth)


def _ways_in(cut: Cut, setting: Setting) -> Iterator[_Part]:
    """Parts at the plunge feed: straight plunges and ramps."""
    way_in, feed = cut.way_in, setting.plunge_feed
    if way_in is None or feed is None:
        return
    for drilled in way_in.drilled:
        yield _Part(drilled, feed, setting.depth)
    if way_in.ramp is not None:
        yield _Part(way_in.ramp, feed, setting.depth)


def _across(cut: Cut, parts: Iterable[_Part]) -> list[_Part]:
    """Parts without those that a mill drills."""
    return [part for part in parts if part.cut.kind is cut.kind]


def _thrust_load(cut: Cut, at: CuttingConditions) -> Monomial:
    """Axial force of a drilled part, N."""
    return thrust(cut, at.material.kienzle, force_factor(at), drill_point(at))


def _greatest(
    load: Callable[[Cut, CuttingConditions], Monomial],
    parts: Iterable[_Part],
    at: CuttingConditions,
    speed: float,
) -> float:
    """Greatest value of a load over the parts; 0 without parts."""
    return max(
        (load(part.cut, at).value(part.feed, part.depth, speed) for part in parts),
        default=0.0,
    )


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
    from optimiser.solver import geometric_program as general  # noqa: PLC0415 (cvxpy takes a second)

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
    """True if the first point is nowhere worse than the second, up to rounding."""
    return all(a <= b * (1.0 + TIE) for a, b in zip(one, other, strict=True))
