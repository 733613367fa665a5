"""Caps say what the limits they were made of say, at every depth."""

from random import Random

import pytest

from benchmarks.problems import random_problem
from optimiser.problem import BoundSide, Limit, LimitName, Monomial
from optimiser.workingstep import caps_at, limits_at
from tests.every_case import every_case


@every_case("seed", range(60))
def test_caps_equal_the_limits_one_by_one(seed: int) -> None:
    random = Random(seed)
    problem = random_problem(random, edge=seed % 2 == 0)
    speed = problem.speeds[0]
    limits = [limit for limit in limits_at(problem, speed) if limit.load.feed_exponent > 0.0]
    caps = caps_at(limits_at(problem, speed), speed)
    for _ in range(5):
        depth = random.uniform(0.1, caps.deepest)
        above = [
            limit.feed_at_bound(depth, speed)
            for limit in limits
            if limit.sense is BoundSide.AT_MOST
        ]
        below = [
            limit.feed_at_bound(depth, speed)
            for limit in limits
            if limit.sense is BoundSide.AT_LEAST
        ]
        assert caps.greatest(depth) == pytest.approx(min(above), rel=1e-12)
        assert caps.least(depth) == pytest.approx(max(below), rel=1e-12)


def test_no_feed_is_left_beyond_the_deepest_pass() -> None:
    limits = (
        Limit(
            name=LimitName.AXIAL_DEPTH,
            load=Monomial(coefficient=1.0, depth_exponent=1.0),
            bound=5.0,
            unit="mm",
        ),
        Limit(
            name=LimitName.FEED_PER_TOOTH,
            load=Monomial(coefficient=1.0, feed_exponent=1.0),
            bound=0.2,
            unit="mm",
        ),
    )
    caps = caps_at(limits, 10.0)
    assert caps.greatest(5.0) == 0.2
    assert caps.greatest(5.1) == 0.0


def test_a_floor_that_grows_with_depth_is_kept() -> None:
    rubbing = Limit(
        name=LimitName.CHIP_THICKNESS,
        load=Monomial(coefficient=1.0, feed_exponent=1.0, depth_exponent=-1.0),
        bound=0.01,
        unit="mm",
        sense=BoundSide.AT_LEAST,
    )
    caps = caps_at((rubbing,), 10.0)
    assert caps.least(2.0) == pytest.approx(0.02)
