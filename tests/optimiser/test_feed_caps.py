"""Limits at one spindle speed, against the limits themselves."""

from random import Random

import pytest

from benchmarks.problems import random_problem
from optimiser.errors import OptimisationError
from optimiser.solver.least_cost import FeedCaps, caps_at
from optimiser.solver.problem import BoundSide, Limit
from optimiser.solver.workingstep import limits_at


def allowed(limits: tuple[Limit, ...], depth: float, speed: float) -> float:
    """Greatest feed of all limits, or zero."""
    feeds = [limit for limit in limits if limit.load.feed_exponent]
    floors = [limit for limit in feeds if limit.sense is BoundSide.AT_LEAST]
    feed = min(limit.feed_at_bound(depth, speed) for limit in feeds if limit not in floors)
    holds = all(limit.holds(feed, depth, speed) for limit in floors)
    deep = all(limit.holds(feed, depth, speed) for limit in limits if limit.is_of_depth)
    return feed if holds and deep else 0.0


@pytest.mark.parametrize("helix", [False, True])
def test_the_best_feed_is_the_greatest_that_all_limits_allow(helix: bool) -> None:
    random, found = Random(64), []
    for seed in range(40):
        problem = random_problem(random, edge=seed % 3 == 0, helix=helix)
        speed = problem.speeds[0]
        limits = limits_at(problem, speed)
        caps = caps_at(limits, speed)
        for passes in (1, 2, 3, 7, 20):
            depth = problem.depth_at(passes)
            expected = allowed(limits, depth, speed)
            assert caps.best(depth) == pytest.approx(expected, rel=1e-12)
            found.append(expected)
    assert 0.0 in found
    assert max(found) > 0.0


def caps(*powers: tuple[float, float], constant: float) -> FeedCaps:
    return FeedCaps(
        constant=constant,
        powers=powers,
        others=(),
        floor=0.0,
        floors=(),
        deepest=5.0,
        speed=1.0,
    )


def test_powers_of_the_depth_meet_the_constant_cap() -> None:
    # 0.2/a and 0.05/a² are 0.1 at a = 2 and at a = √0.5.
    both = caps((0.2, -1.0), (0.05, -2.0), constant=0.1)
    assert both.passes_to_constant(10.0) == pytest.approx(10.0 / 0.5**0.5)
    assert caps((0.2, -1.0), constant=0.1).passes_to_constant(10.0) == pytest.approx(5.0)


def test_caps_without_a_crossing_have_a_number_of_passes_too() -> None:
    assert caps(constant=0.1).passes_to_constant(10.0) == 0.0
    assert caps((0.2, -1.0), constant=float("inf")).passes_to_constant(10.0) == 0.0
    assert 60 < caps((1e-4, -0.001), constant=0.1).passes_to_constant(10.0) < float("inf")


def test_nothing_that_limits_the_feed_is_an_error() -> None:
    with pytest.raises(OptimisationError, match="nothing limits the feed"):
        caps(constant=float("inf")).best(1.0)
