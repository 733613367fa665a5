"""Laws that hold for every workingstep."""

from dataclasses import replace
from random import Random

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from benchmarks.problems import random_problem
from optimiser.errors import Infeasible
from optimiser.modes import Mode
from optimiser.solver.problem import BoundSide, LimitName, Problem
from optimiser.solver.workingstep import Solution, solve, widened

seeds = st.integers(0, 10**9)
modes = st.sampled_from([Mode.TC, Mode.EC])
CAPS = (
    LimitName.MOTOR_POWER,
    LimitName.CUTTING_FORCE,
    LimitName.FEED_PER_TOOTH,
    LimitName.ROUGHNESS,
    LimitName.FEED_MECHANISM,
    LimitName.AXIAL_DEPTH,
)


def problem_of(seed: int, *, free_speed: bool) -> Problem:
    random = Random(seed)
    return random_problem(random, free_speed=free_speed, edge=seed % 3 == 0, helix=seed % 2 > 0)


def solution_of(problem: Problem, mode: Mode) -> Solution:
    """Best setting; a workingstep that has none proves nothing here."""
    try:
        return solve(problem, mode)
    except Infeasible:
        assume(False)
        raise


@given(seeds, modes, st.booleans())
def test_no_solution_exceeds_a_limit(seed: int, mode: Mode, free_speed: bool) -> None:
    solution = solution_of(problem_of(seed, free_speed=free_speed), mode)
    at = solution.setting
    for limit in solution.limits:
        assert limit.holds(at.feed, at.depth, at.speed), limit.name


@given(seeds, modes, st.booleans())
def test_speed_passes_and_depth_stay_within_what_is_free(
    seed: int, mode: Mode, free_speed: bool
) -> None:
    problem = problem_of(seed, free_speed=free_speed)
    at = solution_of(problem, mode).setting
    low, high = problem.speeds[0], problem.speeds[-1]
    assert low * (1.0 - 1e-12) <= at.speed <= high * (1.0 + 1e-12)
    assert problem.passes[0] <= at.passes <= problem.passes[1]
    assert at.passes * at.depth == pytest.approx(problem.total_depth)


@given(seeds, st.booleans())
def test_chip_never_gets_thinner_than_its_floor(seed: int, free_speed: bool) -> None:
    problem = problem_of(seed, free_speed=free_speed)
    at = solution_of(problem, Mode.TC).setting
    (floor,) = (limit for limit in problem.limits if limit.sense is BoundSide.AT_LEAST)
    assert floor.load.value(at.feed, at.depth, at.speed) >= floor.bound * (1.0 - 1e-9)


@given(seeds, st.sampled_from(CAPS), st.floats(1.0, 3.0), st.booleans())
def test_time_never_rises_when_a_bound_grows(
    seed: int, name: LimitName, factor: float, free_speed: bool
) -> None:
    problem = problem_of(seed, free_speed=free_speed)
    before = solution_of(problem, Mode.TC)
    after = solve(widened(problem, name, by_factor=factor), Mode.TC)
    assert after.time <= before.time * (1.0 + 1e-8)


@given(seeds, st.floats(0.1, 1.0), st.booleans())
def test_time_never_rises_when_a_floor_falls(
    seed: int, factor: float, free_speed: bool
) -> None:
    problem = problem_of(seed, free_speed=free_speed)
    before = solution_of(problem, Mode.TC)
    lower = widened(problem, LimitName.CHIP_THICKNESS, by_factor=factor)
    assert solve(lower, Mode.TC).time <= before.time * (1.0 + 1e-8)


@given(seeds, st.booleans())
def test_least_energy_is_never_more_than_that_of_least_time(
    seed: int, free_speed: bool
) -> None:
    problem = problem_of(seed, free_speed=free_speed)
    fast, frugal = solution_of(problem, Mode.TC), solution_of(problem, Mode.EC)
    assert frugal.energy <= fast.energy * (1.0 + 1e-8)
    assert fast.time <= frugal.time * (1.0 + 1e-8)


@given(seeds, modes, st.floats(0.0, 1.0))
def test_free_speed_is_never_worse_than_any_fixed_speed_of_its_range(
    seed: int, mode: Mode, share: float
) -> None:
    problem = problem_of(seed, free_speed=True)
    low, base, high = problem.speeds
    speed = low + share * (high - low)
    stretch = problem.stretches[0 if speed <= base else 1]
    fixed = solution_of(replace(problem, speeds=(speed,), stretches=(stretch,)), mode)
    free = solution_of(problem, mode)
    if mode is Mode.TC:
        assert free.time <= fixed.time * (1.0 + 1e-8)
    else:
        assert free.energy <= fixed.energy * (1.0 + 1e-8)


@given(seeds, modes)
def test_free_passes_are_never_worse_than_the_programmed_ones(seed: int, mode: Mode) -> None:
    problem = problem_of(seed, free_speed=False)
    given_passes = (problem.programmed.passes, problem.programmed.passes)
    fixed = solution_of(replace(problem, passes=given_passes), mode)
    free = solution_of(problem, mode)
    if mode is Mode.TC:
        assert free.time <= fixed.time * (1.0 + 1e-8)
    else:
        assert free.energy <= fixed.energy * (1.0 + 1e-8)


@given(seeds, modes)
def test_no_faster_feed_keeps_all_limits(seed: int, mode: Mode) -> None:
    """Quality costs no more time than it must: some limit is at its bound."""
    solution = solution_of(problem_of(seed, free_speed=False), mode)
    at = solution.setting
    faster = at.feed * (1.0 + 1e-6)
    broken = {
        limit.name for limit in solution.limits if not limit.holds(faster, at.depth, at.speed)
    }
    assert solution.active in broken


@given(seeds, st.booleans())
def test_fewest_passes_are_never_faster(seed: int, free_speed: bool) -> None:
    solution = solution_of(problem_of(seed, free_speed=free_speed), Mode.TC)
    assert solution.deepest_first_time >= solution.time


@given(seeds, modes, st.booleans())
def test_same_question_same_answer(seed: int, mode: Mode, free_speed: bool) -> None:
    problem = problem_of(seed, free_speed=free_speed)
    assert solution_of(problem, mode) == solution_of(problem, mode)
