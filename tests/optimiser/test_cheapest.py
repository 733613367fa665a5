"""Least cost of one workingstep, against the closed form, a grid and a geometric program."""

from dataclasses import replace
from random import Random

import cvxpy as cp
import numpy as np
import pytest

from benchmarks.problems import random_problem
from optimiser.errors import Infeasible
from optimiser.modes import Mode
from optimiser.planning.formulate import cheapest_feed
from optimiser.solver.problem import (
    BoundSide,
    Cost,
    Limit,
    LimitName,
    Monomial,
    Problem,
    Setting,
)
from optimiser.solver.workingstep import limits_at, solve

RATE, CHANGE, PRICE = 75.0 / 3600.0, 120.0, 6.0


def priced(seed: int, *, free_speed: bool, feed_exponent: float) -> Problem:
    """Random workingstep whose edges last about 15 min at its programmed setting."""
    problem = random_problem(Random(seed), free_speed=free_speed)
    speed, feed = problem.programmed.speed, problem.programmed.feed
    wear = Monomial(
        coefficient=1.0 / (900.0 * speed**4.0 * feed**feed_exponent * 2.0**0.3),
        feed_exponent=feed_exponent,
        depth_exponent=0.3,
        speed_exponent=4.0,
    )
    cost = replace(
        problem.cost, wear_rate=wear, tool_change=CHANGE, machine_rate=RATE, edge_price=PRICE
    )
    return replace(problem, cost=cost)


def solved(problem: Problem) -> Setting:
    with_cap = replace(problem, limits=(*problem.limits, *cheapest_feed(problem.cost)))
    return solve(with_cap, Mode.CC).setting


def money(problem: Problem, feed: float, speed: float, passes: int) -> float:
    """Cost by its own formula: rate × time + (edge + rate × change) × lives."""
    cost, depth = problem.cost, problem.depth_at(passes)
    cutting = (passes * cost.length + cost.once_length) / (cost.teeth * feed * speed)
    wear = cost.wear_rate
    assert wear is not None
    used = cutting * wear.coefficient * feed**wear.feed_exponent * depth**0.3 * speed**4.0
    return float(RATE * (cutting + passes * cost.link_time) + (PRICE + RATE * CHANGE) * used)


def is_allowed(problem: Problem, feed: float, depth: float, speed: float) -> bool:
    return all(limit.holds(feed, depth, speed) for limit in limits_at(problem, speed))


@pytest.mark.slow
@pytest.mark.parametrize("feed_exponent", [0.8, 2.0])
@pytest.mark.parametrize("free_speed", [False, True])
def test_no_point_of_a_grid_is_cheaper(free_speed: bool, feed_exponent: float) -> None:
    tried = 0
    for seed in range(25):
        problem = priced(seed, free_speed=free_speed, feed_exponent=feed_exponent)
        try:
            best = solved(problem)
        except Infeasible:
            continue
        tried += 1
        assert is_allowed(problem, best.feed, best.depth, best.speed)
        least = money(problem, best.feed, best.speed, best.passes)
        speeds = np.geomspace(problem.speeds[0], problem.speeds[-1], 25 if free_speed else 1)
        for passes in range(1, min(problem.passes[1], 3 * best.passes + 2) + 1):
            depth = problem.depth_at(passes)
            for speed in speeds:
                for feed in np.geomspace(0.3 * best.feed, 3.0 * best.feed, 15):
                    if is_allowed(problem, feed, depth, speed):
                        assert money(problem, feed, speed, passes) >= least * (1.0 - 1e-9)
    assert tried > 15


@pytest.mark.parametrize("feed_exponent", [0.8, 2.0])
@pytest.mark.parametrize("seed", [1, 2, 5, 8, 11])
def test_geometric_program_has_the_same_cost(seed: int, feed_exponent: float) -> None:
    problem = priced(seed, free_speed=True, feed_exponent=feed_exponent)
    best = solved(problem)
    cost, depth, wear = problem.cost, best.depth, problem.cost.wear_rate
    assert wear is not None
    travel = cost.travel(best.passes) / cost.teeth
    values = []
    for (low, high), limits in zip(
        zip(problem.speeds, problem.speeds[1:], strict=False), problem.stretches, strict=True
    ):
        feed, speed = cp.Variable(pos=True), cp.Variable(pos=True)
        used = wear.coefficient * depth**0.3 * feed ** (feed_exponent - 1.0) * speed**3.0
        total = travel * (RATE * feed**-1.0 * speed**-1.0 + (PRICE + RATE * CHANGE) * used)
        kept = [speed >= low, speed <= high]
        for limit in (*problem.limits, *limits):
            load = limit.load
            side = load.coefficient * feed**load.feed_exponent + max(load.offset, 1e-12)
            side = side * depth**load.depth_exponent * speed**load.speed_exponent
            bound = limit.bound * speed**limit.bound_speed_exponent
            if limit.sense is BoundSide.AT_MOST:
                kept.append(side <= bound)
            else:
                kept.append(load.coefficient * feed**load.feed_exponent >= limit.bound)
        program = cp.Problem(cp.Minimize(total), kept)
        program.solve(gp=True, solver=cp.CLARABEL)
        if program.status == cp.OPTIMAL:
            values.append(float(program.value))
    links = RATE * best.passes * cost.link_time
    assert money(problem, best.feed, best.speed, best.passes) - links == pytest.approx(
        min(values), rel=1e-5
    )


def test_speed_of_least_cost_is_that_of_gilbert() -> None:
    """v = C·(n/(1−n)·C_o/(C_o·t_t + C_t))^n: Gilbert 1950, economics of machining."""
    exponent, constant = 0.25, 400.0  # speed for a life of 1 s, rev/s
    wear = Monomial(coefficient=constant ** (-1.0 / exponent), speed_exponent=1.0 / exponent)
    cap = Limit(
        name=LimitName.FEED_PER_TOOTH,
        load=Monomial(coefficient=1.0, feed_exponent=1.0),
        bound=0.1,
        unit="mm",
    )
    problem = Problem(
        limits=(cap,),
        cost=Cost(
            length=500.0,
            teeth=2,
            motor_power=Monomial(coefficient=1.0),
            wear_rate=wear,
            tool_change=CHANGE,
            machine_rate=RATE,
            edge_price=PRICE,
        ),
        total_depth=2.0,
        passes=(1, 1),
        speeds=(1.0, 400.0),
        programmed=Setting(feed=0.1, depth=2.0, passes=1, speed=50.0),
        stretches=((),),
    )
    book = constant * (exponent / (1.0 - exponent) * RATE / (RATE * CHANGE + PRICE)) ** exponent
    assert solve(problem, Mode.CC).setting.speed == pytest.approx(book, rel=1e-6)


def test_floor_goes_before_the_feed_of_least_cost() -> None:
    problem = priced(3, free_speed=False, feed_exponent=2.0)
    dear = replace(problem, cost=replace(problem.cost, edge_price=1e9))
    best = solved(dear)
    floor = next(each for each in dear.limits if each.sense is BoundSide.AT_LEAST)
    assert best.feed == pytest.approx(floor.feed_at_bound(best.depth, best.speed))


def test_feed_of_least_cost_is_closed_form_where_it_is_no_cap() -> None:
    problem = priced(3, free_speed=False, feed_exponent=2.0)
    wear = problem.cost.wear_rate
    assert wear is not None
    dear = replace(problem, cost=replace(problem.cost, edge_price=400.0))
    best = solved(dear)
    at_one = wear.coefficient * best.depth**0.3 * best.speed**4.0
    book = (RATE / ((400.0 + RATE * CHANGE) * at_one)) ** 0.5
    assert best.feed == pytest.approx(book, rel=1e-9)
