"""Bounds from one path are never above the cost of another number of passes."""

from dataclasses import replace

import pytest

from optimiser.errors import Infeasible
from optimiser.modes import Free, Mode
from optimiser.planning.formulate import OptimisationTask, problem_of
from optimiser.planning.pass_bounds import are_alike, bounds_of
from optimiser.solver import workingstep as exact
from simulator.spec import Kienzle
from tests.optimiser.sample_cuts import CARBIDE, CUT

DEEP = replace(CUT, total_depth=12.0, rest_time=3.0, volume=36_000.0)
LEFT = replace(DEEP, depth_share=1.2)
"""A path above which stock was left."""


def held(passes: int, task: OptimisationTask) -> float:
    """Cost of a number of passes along its own path; infinite where it is infeasible."""
    given = replace(DEEP.programmed, passes=passes, depth=12.0 / passes)
    problem = problem_of(replace(DEEP, programmed=given), CARBIDE, task)
    try:
        found = exact.solve(replace(problem, passes=(passes, passes)), task.mode).setting
    except Infeasible:
        return float("inf")
    return exact.cost_function(problem, task.mode)(found)


@pytest.mark.parametrize("mode", [Mode.TC, Mode.EC])
@pytest.mark.parametrize("free", [frozenset({Free.FEED, Free.DEPTH}), frozenset(Free)])
@pytest.mark.parametrize("tried", [1, 3, 8])
def test_no_bound_is_above_the_cost(mode: Mode, free: frozenset[Free], tried: int) -> None:
    task = OptimisationTask(mode=mode, free=free)
    bounds = bounds_of(LEFT, CARBIDE, task, passes=tried)
    for passes in range(1, 25):
        cost = held(passes, task)
        assert bounds.at_least(passes, is_alike=True) <= cost
        assert bounds.at_least(passes, is_alike=False) <= cost
        assert bounds.along(passes, lambda cut, _: cut, is_alike=True) <= cost


def test_bounds_along_a_longer_way_are_higher() -> None:
    bounds = bounds_of(DEEP, CARBIDE, OptimisationTask(), passes=2)
    as_long = bounds.along(3, lambda cut, _: cut, is_alike=True)
    longer = bounds.along(3, lambda cut, _: replace(cut, rest_time=9.0), is_alike=True)
    assert longer == pytest.approx(as_long + 3 * 6.0)


def test_levels_that_differ_in_length_or_volume_are_not_alike() -> None:
    assert are_alike([DEEP, replace(DEEP, length=0.95 * DEEP.length)])
    assert not are_alike([DEEP, replace(DEEP, length=0.8 * DEEP.length)])
    assert not are_alike([DEEP, replace(DEEP, volume=30_000.0)])


def test_where_levels_are_not_alike_no_load_bounds_them() -> None:
    """A wall that leans leaves less to some levels: they may be cut faster."""
    hard = replace(
        CARBIDE, material=replace(CARBIDE.material, kienzle=Kienzle(k_c11=9000.0, m_c=0.25))
    )
    bounds = bounds_of(DEEP, hard, OptimisationTask(), passes=2)
    alike, unlike = (bounds.at_least(2, is_alike=each) for each in (True, False))
    assert unlike < 0.9 * alike
