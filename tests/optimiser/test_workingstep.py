"""The exact optimum of one workingstep, against closed forms, procedures and brute force."""

from dataclasses import replace
from math import pi
from random import Random

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.problems import random_problem
from optimiser.cut import Cut, CutKind
from optimiser.errors import Infeasible, OptimisationError
from optimiser.limit import Limit, LimitName, Monomial, Sense
from optimiser.limits import Conditions, limits_of, power_load, segment_at, spindle_limits
from optimiser.modes import Mode
from optimiser.problem import Cost, Problem, Setting
from optimiser.workingstep import (
    Solution,
    conflict,
    cost_function,
    limits_at,
    saving_of_one_more,
    solve,
    told,
    widened,
)
from simulator.library import load_machine, load_material
from simulator.physics.engagement import Engagement, bilateral, full_immersion, unidirectional
from simulator.spec import CuttingMaterial, ToolKind
from stepnc_model.tool import Tool
from stepnc_model.units import speed_from_m_min

Floats = NDArray[np.float64]

# Ridwan, Xu and Liu 2010, Table 2.
DIAMETER = 18.0  # mm
DEPTH = 3.0  # mm
LENGTH = 300.0  # mm
RESISTANCE = 1000.0  # N/mm²
MOTOR = 290.0  # W
EFFICIENCY = 0.9
GREATEST_FEED = 0.5  # mm per tooth
VELOCITY = speed_from_m_min(35.0)
SPINDLE = VELOCITY / (pi * DIAMETER)
FORCE = 1000.0 * MOTOR * EFFICIENCY / VELOCITY  # N

TEETH = (1, 2, 3, 4, 6, 8)
ARCS = {
    "full": full_immersion(),
    "three quarters": unidirectional(13.5, DIAMETER),
    "half": unidirectional(9.0, DIAMETER),
    "half in the middle": bilateral(9.0, DIAMETER),
    "quarter": unidirectional(4.5, DIAMETER),
    "0.4 mm with four teeth": unidirectional(0.2929 * DIAMETER, DIAMETER),
}


def paper_problem(
    arc: Engagement, teeth: int, *, total: float = DEPTH, deepest: float | None = None
) -> Problem:
    """Table 2 with a number of passes that is free when a deepest one is given."""
    tool = Tool(id="mill", keyword="TAPERED_ENDMILL", diameter=DIAMETER, teeth=teeth)
    cut = Cut(
        kind=CutKind.MILLING,
        tool=tool,
        tool_kind=ToolKind.ENDMILL,
        diameter=DIAMETER,
        programmed=Setting(feed=0.05, depth=total, passes=1, speed=SPINDLE),
        length=LENGTH,
        total_depth=total,
        is_depth_free=deepest is not None,
        engagement=arc,
        depth_bound=deepest,
    )
    at = Conditions(
        machine=load_machine("paper002"),
        material=load_material("paper002"),
        cutting_material=CuttingMaterial.HSS,
        grade=None,
        roughness=None,
    )
    return Problem(
        limits=limits_of(cut, at),
        cost=Cost(length=LENGTH, teeth=teeth, motor_power=power_load(cut, at)),
        total_depth=total,
        passes=(1, 1) if deepest is None else (1, 80),
        speeds=(SPINDLE,),
        programmed=cut.programmed,
        stretches=(spindle_limits(cut, at, segment_at(at, SPINDLE)),),
    )


def closed_form(arc: Engagement, teeth: int, depth: float = DEPTH) -> float:
    """2π·F_mt/(k_s·a·C·z), mm per tooth."""
    return 2.0 * pi * FORCE / (RESISTANCE * depth * arc.cosine_difference * teeth)


def stepped(
    arc: Engagement, teeth: int, *, step: float, total: float = DEPTH, deepest: float = DEPTH
) -> tuple[float, int] | None:
    """The paper's procedure: deepest cut, greatest feed, less feed until the motor can.

    Feed per tooth and number of passes; None when the steps lead past zero.
    """
    passes = 1
    while total / passes > deepest:
        passes += 1
    depth = total / passes
    for number in range(round(GREATEST_FEED / step)):
        feed = GREATEST_FEED - number * step
        force = RESISTANCE * depth * teeth * feed * arc.cosine_difference / (2.0 * pi)
        if force * VELOCITY / (1000.0 * EFFICIENCY) <= MOTOR:
            return feed, passes
    return None


@pytest.mark.parametrize("arc", ARCS.values(), ids=ARCS.keys())
@pytest.mark.parametrize("teeth", TEETH)
def test_paper_002_has_the_feed_of_the_closed_form(arc: Engagement, teeth: int) -> None:
    solution = solve(paper_problem(arc, teeth), Mode.TC)
    feed = closed_form(arc, teeth)
    if feed < GREATEST_FEED:
        assert solution.setting.feed == pytest.approx(feed, rel=1e-12)
        assert solution.active is LimitName.MOTOR_POWER
    else:
        assert solution.setting.feed == pytest.approx(GREATEST_FEED)
        assert solution.active is LimitName.FEED_PER_TOOTH


@pytest.mark.parametrize(
    ("teeth", "feed"),
    [(1, 0.4685), (2, 0.2343), (3, 0.1562), (4, 0.1171), (6, 0.0781), (8, 0.0586)],
)
def test_paper_002_at_full_immersion_runs_at_290_mm_min(teeth: int, feed: float) -> None:
    setting = solve(paper_problem(full_immersion(), teeth), Mode.TC).setting
    assert setting.feed == pytest.approx(feed, abs=6e-5)
    feed_mm_min = setting.feed * teeth * setting.speed * 60.0
    assert feed_mm_min == pytest.approx(290.0)


@pytest.mark.parametrize("arc", ARCS.values(), ids=ARCS.keys())
def test_paper_002_removes_15_660_mm3_a_minute_wherever_the_motor_holds(
    arc: Engagement,
) -> None:
    """N_c = k_s·MRR/60e6: the immersion does not matter; a_e = C·D/2."""
    setting = solve(paper_problem(arc, 6), Mode.TC).setting
    width = 0.5 * arc.cosine_difference * DIAMETER
    removal = width * DEPTH * setting.feed * 6 * setting.speed * 60.0
    assert removal == pytest.approx(15_660.0, rel=1e-9)


@pytest.mark.parametrize("arc", ARCS.values(), ids=ARCS.keys())
@pytest.mark.parametrize("teeth", TEETH)
@pytest.mark.parametrize("step", [0.1, 0.01, 0.001])
def test_stepped_procedure_never_beats_the_closed_form_and_ends_within_a_step(
    arc: Engagement, teeth: int, step: float
) -> None:
    best = solve(paper_problem(arc, teeth), Mode.TC).setting.feed
    found = stepped(arc, teeth, step=step)
    if found is None:
        assert best < step
        return
    assert best - step < found[0] <= best * (1.0 + 1e-12)


def test_steps_of_0_1_mm_give_table_1_with_one_tooth_and_nothing_with_eight() -> None:
    found = stepped(full_immersion(), 1, step=0.1)
    assert found is not None
    assert found[0] == pytest.approx(0.4)
    assert stepped(full_immersion(), 8, step=0.1) is None


@pytest.mark.parametrize("total", [2.0, 3.0, 7.0, 11.0, 30.0])
@pytest.mark.parametrize("deepest", [0.4, 1.0, 3.0])
@pytest.mark.parametrize("arc", [ARCS["full"], ARCS["quarter"]], ids=["full", "quarter"])
def test_stepped_procedure_with_passes_comes_within_its_step_for_constant_resistance(
    arc: Engagement, total: float, deepest: float
) -> None:
    """Time goes with passes over feed; both choose the passes themselves."""
    problem = paper_problem(arc, 4, total=total, deepest=deepest)
    best = solve(problem, Mode.TC)
    found = stepped(arc, 4, step=1e-4, total=total, deepest=deepest)
    assert found is not None
    feed, passes = found
    per_second = 4 * SPINDLE
    time = passes * LENGTH / (feed * per_second)
    assert best.time <= time * (1.0 + 1e-9)
    assert best.time > passes * LENGTH / ((feed + 1e-4) * per_second)


def test_twice_the_motor_power_is_twice_the_feed() -> None:
    """d ln f / d ln N = 1 at the power limit."""
    problem = paper_problem(full_immersion(), 4)
    before = solve(problem, Mode.TC)
    after = solve(widened(problem, LimitName.MOTOR_POWER, by_factor=2.0), Mode.TC)
    assert after.setting.feed == pytest.approx(2.0 * before.setting.feed)
    assert after.time == pytest.approx(0.5 * before.time)


def problem_of(seed: int, *, free_speed: bool = False) -> Problem:
    return random_problem(Random(seed), free_speed=free_speed, edge=seed % 4 == 0)


def solved(problem: Problem, mode: Mode = Mode.TC) -> Solution | None:
    try:
        return solve(problem, mode)
    except Infeasible:
        return None


def brute_cost(problem: Problem, mode: Mode, passes: Floats, speeds: Floats) -> Floats:
    """Least cost of every pair of passes and speed, infinite where nothing is allowed."""
    speed = np.broadcast_to(speeds, passes.shape)
    depth = problem.total_depth / passes
    highest, lowest = np.full(passes.shape, np.inf), np.zeros(passes.shape)
    allowed = np.ones(passes.shape, dtype=bool)
    second = problem.speeds[1] if len(problem.speeds) > 2 else np.inf
    stretches = [(limit, speed <= second) for limit in problem.stretches[0]]
    stretches += [(limit, speed > second) for part in problem.stretches[1:] for limit in part]
    everywhere = np.ones(passes.shape, dtype=bool)
    for limit, where in [(limit, everywhere) for limit in problem.limits] + stretches:
        load = limit.load
        room = limit.bound * speed**limit.bound_speed_exponent
        room /= depth**load.depth_exponent * speed**load.speed_exponent
        if load.feed_exponent == 0.0:
            allowed &= ~where | (load.coefficient + load.offset <= room * (1.0 + 1e-9))
            continue
        rest = np.maximum((room - load.offset) / load.coefficient, 0.0)
        feed = rest ** (1.0 / load.feed_exponent)
        if limit.sense is Sense.AT_MOST:
            highest = np.where(where, np.minimum(highest, feed), highest)
        else:
            lowest = np.where(where, np.maximum(lowest, feed), lowest)
    allowed &= (highest > 0.0) & (highest >= lowest * (1.0 - 1e-9))
    feed = np.where(allowed, highest, 1.0)
    cost, power = problem.cost, problem.cost.motor_power
    cutting = passes * cost.length / (cost.teeth * feed * speed)
    total = cutting + passes * cost.link_time
    if mode is Mode.EC:
        drawn = power.coefficient * feed**power.feed_exponent + power.offset
        drawn *= depth**power.depth_exponent * speed**power.speed_exponent
        total = cost.standby_power * total
        total += (cost.standby_power_per_speed * speed + drawn) * cutting
    return np.where(allowed, total, np.inf)


def brute_force(problem: Problem, mode: Mode) -> float:
    """Least cost over all passes, and over a grid of speeds made finer around its best."""
    passes = np.arange(1.0, problem.passes[1] + 1.0)[:, None]
    if len(problem.speeds) == 1:
        costs = brute_cost(problem, mode, passes, np.array(problem.speeds))
        return float(costs.min())
    low, high = problem.speeds[0], problem.speeds[-1]
    best = np.inf
    for _ in range(3):
        speeds = np.geomspace(low, high, 301)
        pairs = np.broadcast_to(passes, (passes.size, speeds.size))
        costs = brute_cost(problem, mode, pairs, speeds)
        if not np.isfinite(costs).any():
            break
        best = min(best, float(costs.min()))
        row, column = np.unravel_index(int(costs.argmin()), costs.shape)
        passes = passes[[row]]
        low = max(problem.speeds[0], float(speeds[max(int(column) - 1, 0)]))
        high = float(speeds[min(int(column) + 1, speeds.size - 1)])
    return best


@pytest.mark.parametrize("mode", [Mode.TC, Mode.EC])
def test_integer_optimum_equals_brute_force_over_all_passes(mode: Mode) -> None:
    compared = 0
    for seed in range(400):
        problem = problem_of(seed)
        solution = solved(problem, mode)
        least = brute_force(problem, mode)
        if solution is None:
            assert least == np.inf, f"seed {seed}"
            continue
        compared += 1
        cost = cost_function(problem, mode)(solution.setting)
        assert cost == pytest.approx(least, rel=1e-8), f"seed {seed}"
    assert compared >= 300


@pytest.mark.parametrize("mode", [Mode.TC, Mode.EC])
def test_optimum_of_a_free_speed_equals_a_fine_grid(mode: Mode) -> None:
    compared = 0
    for seed in range(350):
        problem = problem_of(seed, free_speed=True)
        least = brute_force(problem, mode)
        solution = solved(problem, mode)
        if least == np.inf:
            continue
        assert solution is not None, f"seed {seed}"
        compared += 1
        cost = cost_function(problem, mode)(solution.setting)
        assert cost <= least * (1.0 + 1e-8), f"seed {seed}"
        assert cost >= least * (1.0 - 1e-4), f"seed {seed}"
    assert compared >= 300


def test_deepest_pass_first_is_often_not_the_best_and_never_better() -> None:
    worse = 0
    for seed in range(300):
        problem = problem_of(seed)
        solution = solved(problem)
        if solution is None:
            continue
        assert solution.deepest_first_time >= solution.time
        worse += solution.deepest_first_time > 1.001 * solution.time
    assert worse >= 15


def test_deepest_first_time_is_that_of_the_fewest_feasible_passes() -> None:
    compared = 0
    for seed in range(200):
        problem = problem_of(seed)
        solution = solved(problem)
        if solution is None:
            continue
        passes = np.arange(1.0, problem.passes[1] + 1.0)[:, None]
        times = brute_cost(problem, Mode.TC, passes, np.array(problem.speeds)).ravel()
        compared += 1
        fewest = float(times[np.isfinite(times)][0])
        assert solution.deepest_first_time == pytest.approx(fewest, rel=1e-8), f"seed {seed}"
    assert compared > 100


def force_limit(bound: float = 600.0, exponent: float = 1.0) -> Limit:
    load = Monomial(coefficient=1000.0, feed_exponent=exponent, depth_exponent=1.0)
    return Limit(name=LimitName.CUTTING_FORCE, load=load, bound=bound, unit="N")


def depth_limit(bound: float) -> Limit:
    load = Monomial(coefficient=1.0, depth_exponent=1.0)
    return Limit(name=LimitName.AXIAL_DEPTH, load=load, bound=bound, unit="mm")


def feed_limit(bound: float, sense: Sense = Sense.AT_MOST) -> Limit:
    name = LimitName.FEED_PER_TOOTH if sense is Sense.AT_MOST else LimitName.CHIP_THICKNESS
    load = Monomial(coefficient=1.0, feed_exponent=1.0)
    return Limit(name=name, load=load, bound=bound, unit="mm", sense=sense, step=0.01)


def simple(*limits: Limit, total: float = 12.0, passes: int = 3, greatest: int = 40) -> Problem:
    power = Monomial(
        coefficient=50.0, feed_exponent=1.0, depth_exponent=1.0, speed_exponent=1.0
    )
    return Problem(
        limits=limits,
        cost=Cost(length=100.0, teeth=2, motor_power=power, standby_power=500.0),
        total_depth=total,
        passes=(1, greatest) if greatest else (passes, passes),
        speeds=(20.0,),
        programmed=Setting(feed=0.02, depth=total / passes, passes=passes, speed=20.0),
    )


@pytest.mark.parametrize("passes", [1, 2, 3, 5, 12])
def test_ties_keep_the_programmed_passes_and_depth(passes: int) -> None:
    """A force that grows with feed times depth makes all numbers of passes equal."""
    solution = solve(simple(force_limit(), passes=passes), Mode.TC)
    assert solution.setting.passes == passes
    assert solution.setting.depth == 12.0 / passes
    assert solution.time == pytest.approx(solution.deepest_first_time)


def test_programmed_depth_that_is_no_even_part_is_kept_where_only_the_feed_counts() -> None:
    """5 + 5 + 2 mm take the same three passes as 4 + 4 + 4."""
    problem = simple(feed_limit(0.1), depth_limit(5.5))
    problem = replace(problem, programmed=replace(problem.programmed, depth=5.0))
    setting = solve(problem, Mode.TC).setting
    assert (setting.passes, setting.depth) == (3, 5.0)


def test_programmed_depth_beyond_the_bound_is_not_kept() -> None:
    problem = simple(feed_limit(0.1), depth_limit(4.5))
    problem = replace(problem, programmed=replace(problem.programmed, depth=5.0))
    setting = solve(problem, Mode.TC).setting
    assert (setting.passes, setting.depth) == (3, 4.0)


def test_passes_that_are_not_free_stay() -> None:
    setting = solve(simple(feed_limit(0.1), passes=4, greatest=0), Mode.TC).setting
    assert (setting.passes, setting.depth) == (4, 3.0)


def test_depth_limit_with_fixed_passes_is_infeasible_and_says_why() -> None:
    with pytest.raises(Infeasible) as caught:
        solve(simple(feed_limit(0.1), depth_limit(3.5), greatest=0), Mode.TC)
    assert caught.value.limits == (LimitName.AXIAL_DEPTH,)
    assert "axial depth 4 mm exceeds 3.5 mm" in str(caught.value)
    assert "the depth is not free" in str(caught.value)


def test_depth_limit_with_free_passes_takes_one_more_pass() -> None:
    assert solve(simple(feed_limit(0.1), depth_limit(3.5)), Mode.TC).setting.passes == 4


def test_conflict_names_cap_and_floor_with_numbers_and_units() -> None:
    """Ra bound to 0.04 mm of feed against a chip of at least 0.06 mm."""
    problem = simple(feed_limit(0.04), feed_limit(0.06, Sense.AT_LEAST))
    with pytest.raises(Infeasible) as caught:
        solve(problem, Mode.TC)
    text = str(caught.value)
    assert set(caught.value.limits) == {LimitName.FEED_PER_TOOTH, LimitName.CHIP_THICKNESS}
    for part in ("feed per tooth", "chip thickness", "at most 0.04 mm", "at least 0.06 mm"):
        assert part in text


def test_conflict_tells_numbers_in_the_users_unit() -> None:
    power = Limit(
        name=LimitName.MOTOR_POWER,
        load=Monomial(coefficient=1e6, feed_exponent=1.0),
        bound=290.0,
        unit="kW",
        scale=1e-3,
    )
    problem = simple(power, feed_limit(0.06, Sense.AT_LEAST), greatest=0)
    assert "0.29 kW" in str(conflict(problem))


def test_every_conflict_of_random_workingsteps_names_two_limits() -> None:
    impossible = [seed for seed in range(3000) if solved(problem_of(seed)) is None]
    assert len(impossible) >= 5
    for seed in impossible:
        with pytest.raises(Infeasible) as caught:
            solve(problem_of(seed), Mode.TC)
        assert len(set(caught.value.limits)) == 2
        for name in caught.value.limits:
            assert LimitName(name).words in str(caught.value)


def test_more_passes_may_resolve_a_conflict() -> None:
    """The edge's share of 400 N/mm leaves no feed at 4 mm and 0.2 mm at 2 mm."""
    load = Monomial(coefficient=500.0, offset=400.0, feed_exponent=1.0, depth_exponent=1.0)
    force = Limit(name=LimitName.CUTTING_FORCE, load=load, bound=1000.0, unit="N")
    assert force.feed_at_bound(4.0, 20.0) == 0.0
    setting = solve(simple(force, passes=3), Mode.TC).setting
    assert setting.depth <= 2.0


def test_nothing_that_limits_the_feed_is_an_error() -> None:
    with pytest.raises(OptimisationError, match="nothing limits the feed"):
        solve(simple(depth_limit(5.0)), Mode.TC)


def test_a_floor_alone_does_not_limit_the_feed() -> None:
    with pytest.raises(OptimisationError, match="nothing limits the feed"):
        solve(simple(feed_limit(0.01, Sense.AT_LEAST)), Mode.TC)


def test_told_names_load_and_bound() -> None:
    assert told(depth_limit(5.0), 6.0, 20.0) == "axial depth 6 mm exceeds 5 mm"
    floor = feed_limit(0.01, Sense.AT_LEAST)
    assert told(floor, 0.004, 20.0) == "chip thickness 0.004 mm is below 0.01 mm"


def test_widened_touches_one_limit_only() -> None:
    problem = problem_of(3, free_speed=True)
    wider = widened(problem, LimitName.MOTOR_POWER, by_factor=1.5)
    assert wider.limits == problem.limits
    for before, after in zip(problem.stretches, wider.stretches, strict=True):
        assert after[0].bound == pytest.approx(1.5 * before[0].bound)


def test_saving_of_one_more_step_by_hand() -> None:
    """100·3/(2·20·0.1) s at 0.1 mm, and at 0.11 mm."""
    problem = simple(feed_limit(0.1), greatest=0)
    saving = saving_of_one_more(problem, Mode.TC, solve(problem, Mode.TC))
    assert saving == pytest.approx(75.0 - 75.0 / 1.1)


def test_limits_at_follows_the_stretches_of_the_spindle() -> None:
    problem = problem_of(3, free_speed=True)
    low, base, high = problem.speeds
    first, second = problem.stretches
    assert limits_at(problem, low)[-1:] == first
    assert limits_at(problem, base)[-1:] == first
    assert limits_at(problem, 1.01 * base)[-1:] == second
    assert limits_at(problem, 2.0 * high)[-1:] == second


def test_active_limit_is_at_its_bound() -> None:
    for seed in range(100):
        solution = solved(problem_of(seed, free_speed=seed % 2 == 0))
        if solution is None:
            continue
        at = solution.setting
        active = [limit for limit in solution.limits if limit.name is solution.active]
        ratios = [
            limit.load.value(at.feed, at.depth, at.speed) / limit.bound_at(at.speed)
            for limit in active
        ]
        assert max(ratios) == pytest.approx(1.0, rel=1e-6)
