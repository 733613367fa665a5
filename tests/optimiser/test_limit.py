"""A limit as a monomial."""

from math import inf
from random import Random

import pytest

from benchmarks.problems import random_problem
from optimiser.solver.problem import ROUNDING, BoundSide, Limit, LimitName, Monomial, SpeedCurve
from tests.every_case import every_case

FORCE = Monomial(coefficient=2000.0, offset=30.0, feed_exponent=0.75, depth_exponent=1.0)


def limit(
    load: Monomial = FORCE, *, bound: float = 500.0, sense: BoundSide = BoundSide.AT_MOST
) -> Limit:
    return Limit(name=LimitName.CUTTING_FORCE, load=load, bound=bound, unit="N", sense=sense)


def test_monomial_by_hand() -> None:
    """(2·0.25² + 1)·3·4²"""
    load = Monomial(
        coefficient=2.0,
        offset=1.0,
        feed_exponent=2.0,
        depth_exponent=1.0,
        speed_exponent=2.0,
    )
    assert load.value(0.25, 3.0, 4.0) == pytest.approx(1.125 * 3.0 * 16.0)


@every_case("depth", [0.1, 1.0, 7.5])
@every_case("speed", [1.0, 40.0])
def test_feed_at_bound_is_the_inverse_of_the_load(depth: float, speed: float) -> None:
    load = Monomial(
        coefficient=900.0,
        offset=5.0,
        feed_exponent=0.78,
        depth_exponent=1.2,
        speed_exponent=0.3,
    )
    held = Limit(
        name=LimitName.MOTOR_POWER,
        load=load,
        bound=400.0,
        unit="W",
        bound_speed_exponent=0.6,
    )
    feed = held.feed_at_bound(depth, speed)
    assert load.value(feed, depth, speed) == pytest.approx(held.bound_at(speed), rel=1e-12)


def test_feed_at_bound_is_the_inverse_for_all_limits_of_random_workingsteps() -> None:
    random = Random(1)
    compared = 0
    for _ in range(50):
        problem = random_problem(random, free_speed=True, edge=random.random() < 0.5)
        for each in (*problem.limits, *problem.stretches[0], *problem.stretches[1]):
            feed = each.feed_at_bound(2.0, 30.0)
            if 0.0 < feed < inf:
                compared += 1
                load = each.load.value(feed, 2.0, 30.0)
                assert load == pytest.approx(each.bound_at(30.0), rel=1e-9)
    assert compared > 250


def test_load_without_feed_leaves_the_feed_open() -> None:
    depth = limit(Monomial(coefficient=1.0, depth_exponent=1.0), bound=5.0)
    assert depth.feed_at_bound(4.0, 10.0) == inf


def test_offset_beyond_the_bound_leaves_no_feed() -> None:
    """30 N/mm of edge force at 20 mm are 600 N, above 500 N."""
    assert limit().feed_at_bound(20.0, 10.0) == 0.0


def test_bound_may_grow_with_the_speed() -> None:
    held = Limit(
        name=LimitName.MOTOR_POWER,
        load=FORCE,
        bound=200.0,
        unit="kW",
        bound_speed_exponent=1.0,
    )
    assert held.bound_at(25.0) == pytest.approx(5000.0)


@pytest.mark.parametrize("feed", [0.01, 0.1, 0.8])
def test_at_depth_keeps_the_load_of_that_depth_at_every_depth(feed: float) -> None:
    fixed = limit().at_depth(3.0)
    expected = FORCE.value(feed, 3.0, 10.0)
    assert fixed.load.value(feed, 0.5, 10.0) == pytest.approx(expected)
    assert fixed.load.value(feed, 12.0, 10.0) == pytest.approx(expected)


def test_at_depth_keeps_everything_but_the_load() -> None:
    held = limit()
    fixed = held.at_depth(3.0)
    assert fixed.feed_at_bound(99.0, 10.0) == pytest.approx(held.feed_at_bound(3.0, 10.0))
    assert (fixed.name, fixed.bound, fixed.unit, fixed.sense) == (
        held.name,
        held.bound,
        held.unit,
        held.sense,
    )


def test_load_of_no_depth_is_the_same_at_depth() -> None:
    feed = limit(Monomial(coefficient=1.0, feed_exponent=1.0), bound=0.2)
    assert feed.at_depth(7.0) == feed


@every_case(
    ("sense", "share", "holds"),
    [
        (BoundSide.AT_MOST, 0.999, True),
        (BoundSide.AT_MOST, 1.0 + 0.5 * ROUNDING, True),
        (BoundSide.AT_MOST, 1.001, False),
        (BoundSide.AT_LEAST, 1.001, True),
        (BoundSide.AT_LEAST, 1.0 - 0.5 * ROUNDING, True),
        (BoundSide.AT_LEAST, 0.999, False),
    ],
)
def test_bound_holds_on_its_side_up_to_rounding(
    sense: BoundSide, share: float, holds: bool
) -> None:
    feed = limit(Monomial(coefficient=1.0, feed_exponent=1.0), bound=0.2, sense=sense)
    assert feed.holds(0.2 * share, 1.0, 1.0) is holds


def test_names_are_told_in_words() -> None:
    assert LimitName.CHIP_THICKNESS.words == "chip thickness"
    assert all("_" not in name.words for name in LimitName)


CURVE = SpeedCurve(speeds=(10.0, 20.0, 30.0, 40.0), bounds=(1.0, 5.0, 2.0, 4.0))


def test_a_curve_is_straight_between_its_points_and_open_below_them() -> None:
    assert [CURVE.at(speed) for speed in (9.0, 10.0, 15.0, 30.0, 35.0, 40.0, 50.0)] == [
        inf, 1.0, 3.0, 2.0, 3.0, 4.0, 4.0,
    ]  # fmt: skip
    assert CURVE.peak(10.0, 40.0) == 20.0
    assert CURVE.peak(31.0, 36.0) == 36.0


@every_case(
    ("load", "between", "expected"),
    [
        (3.0, (10.0, 40.0), [(15.0, 26.0 + 2.0 / 3.0), (35.0, 40.0)]),
        (3.0, (5.0, 40.0), [(5.0, 10.0), (15.0, 26.0 + 2.0 / 3.0), (35.0, 40.0)]),
        (3.0, (16.0, 20.0), [(16.0, 20.0)]),
        (0.5, (5.0, 40.0), [(5.0, 40.0)]),
        (6.0, (10.0, 40.0), []),
        (6.0, (5.0, 40.0), [(5.0, 10.0)]),
    ],
)
def test_ranges_of_speed_that_allow_a_load(
    load: float, between: tuple[float, float], expected: list[tuple[float, float]]
) -> None:
    found = [pytest.approx(each) for each in CURVE.allowing(load, *between)]
    assert expected == found


def test_a_limit_with_a_curve_is_one_of_the_depth() -> None:
    limit = Limit(
        name=LimitName.STABILITY,
        load=Monomial(coefficient=2.0, depth_exponent=1.0),
        bound=1.0,
        unit="mm",
        curve=CURVE,
    )
    assert limit.is_of_depth
    assert limit.bound_at(20.0) == 5.0
    assert limit.greatest_depth(20.0) == 2.5
    assert limit.holds(0.1, 2.5, 20.0)
    assert not limit.holds(0.1, 2.6, 20.0)
    assert limit.holds(0.1, 100.0, 9.0)
