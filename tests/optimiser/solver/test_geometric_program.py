"""The geometric program as the judge of the closed form."""

from dataclasses import replace
from random import Random

import pytest

from benchmarks.problems import random_problem
from optimiser.errors import Infeasible
from optimiser.modes import Mode
from optimiser.solver import geometric_program as program
from optimiser.solver import workingstep
from optimiser.solver.problem import Limit, LimitName, Monomial
from tests.optimiser.solver.test_workingstep import with_lobes

CASES = 180


def cost_by_both(seed: int, mode: Mode) -> tuple[float, float] | None:
    """Cost by the closed form and by the solver, or None when both find no setting."""
    random = Random(seed)
    problem = random_problem(random, free_speed=seed % 3 == 0, edge=seed % 5 == 0)
    cost = workingstep.cost_function(problem, mode)
    try:
        judged = program.solve(problem, mode)
    except Infeasible:
        with pytest.raises(Infeasible):
            workingstep.solve(problem, mode)
        return None
    return cost(workingstep.solve(problem, mode).setting), judged.cost


@pytest.mark.parametrize("block", range(3))
def test_closed_form_equals_the_geometric_program(block: int) -> None:
    compared = 0
    for seed in range(block * CASES // 3, (block + 1) * CASES // 3):
        pair = cost_by_both(seed, Mode.EC if seed % 4 == 0 else Mode.TC)
        if pair is None:
            continue
        compared += 1
        closed, judged = pair
        assert closed == pytest.approx(judged, rel=1e-6), f"seed {seed}"
    assert compared > 50


@pytest.mark.parametrize("block", range(2))
def test_closed_form_equals_the_geometric_program_along_a_helix(block: int) -> None:
    """About the number of passes that the closed form found; all passes on every tenth."""
    compared = 0
    for seed in range(90 * block, 90 * (block + 1)):
        free_speed, mode = seed % 3 == 0, Mode.EC if seed % 4 == 0 else Mode.TC
        problem = random_problem(
            Random(seed), free_speed=free_speed, edge=seed % 5 == 0, helix=True
        )
        try:
            solution = workingstep.solve(problem, mode)
        except Infeasible:
            continue
        passes = solution.setting.passes
        if seed % 10:
            problem = replace(problem, passes=(max(1, passes - 1), min(passes + 1, 60)))
        compared += 1
        closed = workingstep.cost_function(problem, mode)(solution.setting)
        judged = program.solve(problem, mode).cost
        assert closed == pytest.approx(judged, rel=1e-6), f"seed {seed}"
    assert compared > 70


def test_prices_equal_finite_differences() -> None:
    problem = random_problem(Random(7))
    found = program.solve(problem, Mode.TC)
    solution = workingstep.solve(problem, Mode.TC)
    factor = 1.0 + 1e-4
    wider = workingstep.solve(
        workingstep.widened(problem, solution.active, by_factor=factor), Mode.TC
    )
    measured = (solution.time / wider.time - 1.0) / 1e-4
    assert found.prices[solution.active] == pytest.approx(measured, rel=1e-3)


def test_a_bound_just_above_the_floor_keeps_its_digits() -> None:
    """Ra 0.202 µm over a floor of 0.2 µm: 1 % of the bound is left for the feed."""
    drawn = random_problem(Random(7), free_speed=True)
    load = Monomial(coefficient=1.0 / 25.0, offset=0.2e-3, feed_exponent=2.0)
    fine = Limit(name=LimitName.ROUGHNESS, load=load, bound=0.202e-3, unit="µm")
    feeds = {LimitName.ROUGHNESS, LimitName.CHIP_THICKNESS}
    kept = tuple(limit for limit in drawn.limits if limit.name not in feeds)
    problem = replace(drawn, limits=(*kept, fine))
    solution = workingstep.solve(problem, Mode.TC)
    judged = program.solve(problem, Mode.TC)
    assert solution.active is LimitName.ROUGHNESS
    assert solution.time == pytest.approx(judged.cost, rel=1e-6)
    wider = workingstep.solve(
        workingstep.widened(problem, LimitName.ROUGHNESS, by_factor=1.0 + 1e-6), Mode.TC
    )
    measured = (solution.time / wider.time - 1.0) / 1e-6
    assert judged.prices[LimitName.ROUGHNESS] == pytest.approx(measured, rel=1e-3)


def test_both_agree_below_lobes() -> None:
    compared = 0
    for seed in range(12):
        problem = with_lobes(random_problem(Random(seed), free_speed=True), seed)
        try:
            judged = program.solve(problem, Mode.TC)
        except Infeasible:
            continue
        compared += 1
        found = workingstep.solve(problem, Mode.TC)
        cost = workingstep.cost_function(problem, Mode.TC)
        assert cost(found.setting) == pytest.approx(judged.cost, rel=1e-5), f"seed {seed}"
        lobes = problem.curved
        assert lobes is not None
        at = program.snapped(problem, judged)
        assert lobes.holds(at.feed, at.depth, at.speed)
    assert compared > 5
