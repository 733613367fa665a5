"""The exact optimum of one workingstep, against closed forms, procedures and brute force."""

from dataclasses import replace
from random import Random

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.problems import random_problem
from optimiser.errors import Infeasible, OptimisationError
from optimiser.modes import Mode
from optimiser.solver.convex import least_of_convex
from optimiser.solver.least_cost import least_cost
from optimiser.solver.problem import (
    BoundSide,
    Cost,
    Limit,
    LimitName,
    Monomial,
    Problem,
    Setting,
    SpeedCurve,
)
from optimiser.solver.workingstep import (
    Solution,
    conflict,
    cost_function,
    limits_at,
    saving_of_one_more,
    solve,
    violation_text,
    widened,
)

Floats = NDArray[np.float64]


def problem_of(seed: int, *, free_speed: bool = False, helix: bool = False) -> Problem:
    random = Random(seed)
    return random_problem(random, free_speed=free_speed, edge=seed % 4 == 0, helix=helix)


def solved(problem: Problem, mode: Mode = Mode.TC) -> Solution | None:
    try:
        return solve(problem, mode)
    except Infeasible:
        return None


def brute_cost(problem: Problem, mode: Mode, passes: Floats, speeds: Floats) -> Floats:
    """Least cost of every pair of passes and speed, infinite where nothing is allowed."""
    speed = np.broadcast_to(speeds, passes.shape)
    depth = problem.total_depth / passes
    each = [problem.depth_at(int(count)) for count in passes[:, 0]]
    highest, lowest = np.full(passes.shape, np.inf), np.zeros(passes.shape)
    allowed = np.ones(passes.shape, dtype=bool)
    second = problem.speeds[1] if len(problem.speeds) > 2 else np.inf
    stretches = [(limit, speed <= second) for limit in problem.stretches[0]]
    stretches += [(limit, speed > second) for part in problem.stretches[1:] for limit in part]
    everywhere = np.ones(passes.shape, dtype=bool)
    for limit, where in [(limit, everywhere) for limit in problem.limits] + stretches:
        load = limit.load
        room = limit.bound * speed**limit.bound_speed_exponent
        factor = depth**load.depth_exponent
        if load.curve is not None:
            factor = np.array([[load.curve(one)] for one in each])
        room /= factor * speed**load.speed_exponent
        if load.feed_exponent == 0.0:
            allowed &= ~where | (load.coefficient + load.offset <= room * (1.0 + 1e-9))
            continue
        rest = np.maximum((room - load.offset) / load.coefficient, 0.0)
        feed = rest ** (1.0 / load.feed_exponent)
        if limit.sense is BoundSide.AT_MOST:
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


@pytest.mark.parametrize("mode", [Mode.TC, Mode.EC])
@pytest.mark.parametrize("free_speed", [False, True])
def test_optimum_along_a_helix_equals_brute_force_over_all_passes(
    mode: Mode, free_speed: bool
) -> None:
    """Loads that are curves of the depth: no grid of passes, feed and speed beats it."""
    compared, bent, late = 0, 0, 0
    for seed in range(60):
        problem = problem_of(seed, free_speed=free_speed, helix=True)
        least = brute_force(problem, mode)
        solution = solved(problem, mode)
        if least == np.inf:
            assert free_speed or solution is None, f"seed {seed}"
            continue
        assert solution is not None, f"seed {seed}"
        compared += 1
        bent += solution.active in {LimitName.TOOL_DEFLECTION, LimitName.SHANK_STRENGTH}
        late += solution.setting.passes > problem.deepest() + 1
        cost = cost_function(problem, mode)(solution.setting)
        assert cost <= least * (1.0 + 1e-8), f"seed {seed}"
        # The grid of speeds is made finer about its best number of passes only.
        assert cost >= least * (1.0 - (1e-3 if free_speed else 1e-8)), f"seed {seed}"
    assert compared >= 48
    assert bent >= 16
    assert late >= 2


@pytest.mark.parametrize("mode", [Mode.TC, Mode.EC])
def test_least_cost_is_never_above_that_of_any_number_of_passes(mode: Mode) -> None:
    reached = 0.0
    for seed in range(150):
        problem = problem_of(seed, free_speed=seed % 2 == 0, helix=seed % 3 == 0)
        bound = least_cost(problem, mode)
        passes = np.arange(1.0, problem.passes[1] + 1.0)[:, None]
        speeds = np.geomspace(problem.speeds[0], problem.speeds[-1], 41)
        pairs = np.broadcast_to(passes, (passes.size, speeds.size))
        least = brute_cost(problem, mode, pairs, speeds).min(axis=1)
        bounds = np.array([bound(int(count)) for count in passes[:, 0]])
        assert (bounds <= least * (1.0 + 1e-9)).all(), f"seed {seed}"
        assert (np.diff(bounds) >= 0.0).all(), f"seed {seed}"
        reached = max(reached, float((bounds / least).max()))
    # It is no bound for show: some workingsteps attain it.
    assert reached > 0.999


def test_a_deeper_pass_may_cost_less_where_a_shallower_costs_more() -> None:
    """A load that falls with the depth for a while has two valleys; the second one is found."""

    def curve(depth: float) -> float:
        return {12.0: 3.0, 6.0: 8.0, 4.0: 8.0}.get(depth, 0.5)

    load = Monomial(coefficient=1000.0, feed_exponent=1.0, curve=curve)
    force = Limit(name=LimitName.CUTTING_FORCE, load=load, bound=300.0, unit="N")
    problem = simple(force, feed_limit(1.0), passes=1)
    assert solve(problem, Mode.TC).setting.passes == 4
    times = [
        problem.cost.time(Setting(feed=min(feed, 1.0), depth=1.0, passes=count, speed=20.0))
        for count, feed in ((1, 0.1), (2, 0.0375), (3, 0.0375), (4, 0.6))
    ]
    assert times[3] < times[0] < times[1] < times[2]


@pytest.mark.parametrize("guess", [-3, 1, 2, 5, 6, 7, 12, 40, 10**6])
@pytest.mark.parametrize("best", [2, 3, 6, 11, 12])
def test_the_least_of_a_convex_cost_is_found_from_any_guess(best: int, guess: int) -> None:
    least = least_of_convex(lambda passes: 1.0 + (passes - best) ** 2, 2, 12, guess=guess)
    assert least == best


@pytest.mark.parametrize("guess", [0, 3, 5, 6, 9])
def test_of_equal_costs_the_fewest_passes_are_taken(guess: int) -> None:
    costs = {1: float("inf"), 2: 9.0, 3: 4.0, 4: 4.0, 5: 4.0 * (1.0 + 1e-12), 6: 7.0}
    assert least_of_convex(costs.__getitem__, 2, 6, guess=guess) == 3


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


def feed_limit(bound: float, sense: BoundSide = BoundSide.AT_MOST) -> Limit:
    name = LimitName.FEED_PER_TOOTH if sense is BoundSide.AT_MOST else LimitName.CHIP_THICKNESS
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
    problem = simple(feed_limit(0.04), feed_limit(0.06, BoundSide.AT_LEAST))
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
    problem = simple(power, feed_limit(0.06, BoundSide.AT_LEAST), greatest=0)
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
        solve(simple(feed_limit(0.01, BoundSide.AT_LEAST)), Mode.TC)


def test_told_names_load_and_bound() -> None:
    assert violation_text(depth_limit(5.0), 6.0, 20.0) == "axial depth 6 mm exceeds 5 mm"
    floor = feed_limit(0.01, BoundSide.AT_LEAST)
    assert violation_text(floor, 0.004, 20.0) == "chip thickness 0.004 mm is below 0.01 mm"


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


def with_lobes(problem: Problem, seed: int) -> Problem:
    """The same problem, its depth bounded by made-up lobes over its speeds."""
    random = Random(seed)
    low, high = problem.speeds[0], problem.speeds[-1]
    speeds = np.geomspace(low, high, 40)
    floor = problem.total_depth * random.uniform(0.05, 0.4)
    bounds = floor * (1.0 + np.array([random.uniform(0.0, 4.0) ** 2 for _ in speeds]))
    lobes = Limit(
        name=LimitName.STABILITY,
        load=Monomial(coefficient=1.0, depth_exponent=1.0),
        bound=1.0,
        unit="mm",
        curve=SpeedCurve(speeds=tuple(speeds.tolist()), bounds=tuple(bounds.tolist())),
    )
    return replace(problem, limits=(*problem.limits, lobes))


def held_at(problem: Problem, speed: float) -> Problem:
    """The same problem at one speed."""
    second = problem.speeds[1] if len(problem.speeds) > 2 else np.inf
    stretch = problem.stretches[0] if speed <= second else problem.stretches[-1]
    return replace(problem, speeds=(speed,), stretches=(stretch,))


@pytest.mark.parametrize("mode", [Mode.TC, Mode.EC])
def test_optimum_below_lobes_equals_a_fine_grid_of_held_speeds(mode: Mode) -> None:
    compared = 0
    for seed in range(24):
        problem = with_lobes(problem_of(seed, free_speed=True), seed)
        found = solved(problem, mode)
        cost = cost_function(problem, mode)
        grid = np.geomspace(problem.speeds[0], problem.speeds[-1], 400)
        at_grid = [solved(held_at(problem, float(speed)), mode) for speed in grid]
        costs = [cost(each.setting) for each in at_grid if each is not None]
        if found is None:
            assert not costs
            continue
        compared += 1
        lobes = problem.curved
        assert lobes is not None
        setting = found.setting
        assert lobes.holds(setting.feed, setting.depth, setting.speed)
        assert cost(setting) <= min(costs, default=np.inf) * (1.0 + 1e-5)
        near = solved(held_at(problem, setting.speed), mode)
        assert near is not None
        assert cost(near.setting) == pytest.approx(cost(setting), rel=1e-9)
    assert compared > 12


def test_a_depth_that_is_unstable_at_the_held_speed_takes_more_passes() -> None:
    problem = with_lobes(problem_of(3, free_speed=True), 3)
    lobes = problem.curved
    assert lobes is not None
    for speed in np.geomspace(problem.speeds[0], problem.speeds[-1], 9).tolist():
        found = solved(held_at(problem, speed))
        if found is not None:
            assert found.setting.depth <= lobes.bound_at(speed) * (1.0 + 1e-9)


def test_an_unstable_depth_that_is_not_free_says_which_speeds_would_do() -> None:
    problem = with_lobes(problem_of(3, free_speed=True), 3)
    lobes = problem.curved
    assert lobes is not None
    assert lobes.curve is not None
    worst = min(lobes.curve.speeds, key=lobes.curve.at)
    deep = 1.5 * lobes.bound_at(worst)
    given = replace(problem.programmed, depth=deep, speed=worst, passes=1)
    held = replace(held_at(problem, worst), passes=(1, 1), programmed=given)
    with pytest.raises(
        Infeasible,
        match=r"stability allows .* mm at \d+ rpm, not .* mm, and the "
        r"depth is not free; .* mm would be stable from \d+ to \d+ rpm",
    ) as error:
        solve(held, Mode.TC)
    assert error.value.limits == (LimitName.STABILITY,)
    impossible = replace(given, depth=100.0 * max(lobes.curve.bounds))
    held = replace(held, limits=(lobes,))
    with pytest.raises(Infeasible, match=r"; .* mm would be stable at \d+ rpm"):
        solve(replace(held, programmed=impossible), Mode.TC)


def test_a_curve_that_begins_above_a_speed_is_no_limit_there() -> None:
    problem = with_lobes(problem_of(3, free_speed=True), 3)
    below = 0.9 * problem.speeds[0]
    assert LimitName.STABILITY not in {limit.name for limit in limits_at(problem, below)}
    assert LimitName.STABILITY in {
        limit.name for limit in limits_at(problem, problem.speeds[0])
    }
