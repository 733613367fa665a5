"""The geometric program as the judge of the closed form."""

from random import Random

import pytest

from benchmarks.problems import random_problem
from optimiser import program, workingstep
from optimiser.errors import Infeasible
from optimiser.modes import Mode

CASES = 540


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


@pytest.mark.parametrize("block", range(9))
def test_closed_form_equals_the_geometric_program(block: int) -> None:
    compared = 0
    for seed in range(block * CASES // 9, (block + 1) * CASES // 9):
        pair = cost_by_both(seed, Mode.EC if seed % 4 == 0 else Mode.TC)
        if pair is None:
            continue
        compared += 1
        closed, judged = pair
        assert closed == pytest.approx(judged, rel=1e-6), f"seed {seed}"
    assert compared > 50


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
