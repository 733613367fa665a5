"""Time and energy of a setting, and how few passes the depth allows."""

from dataclasses import replace

import pytest

from optimiser.solver.problem import (
    Cost,
    Limit,
    LimitName,
    Monomial,
    Problem,
    Setting,
    SpeedCurve,
)

POWER = Monomial(coefficient=40.0, feed_exponent=1.0, depth_exponent=1.0, speed_exponent=1.0)
COST = Cost(
    length=300.0,
    teeth=4,
    motor_power=POWER,
    link_time=0.5,
    standby_power=1000.0,
    standby_power_per_speed=4.0,
)
SETTING = Setting(feed=0.1, depth=2.0, passes=3, speed=25.0)


def depth_limit(bound: float) -> Limit:
    return Limit(
        name=LimitName.AXIAL_DEPTH,
        load=Monomial(coefficient=1.0, depth_exponent=1.0),
        bound=bound,
        unit="mm",
    )


def problem(*bounds: float, total: float = 10.0, passes: tuple[int, int] = (1, 60)) -> Problem:
    return Problem(
        limits=tuple(map(depth_limit, bounds)),
        cost=COST,
        total_depth=total,
        passes=passes,
        speeds=(25.0,),
        programmed=SETTING,
    )


def test_time_by_hand() -> None:
    """3·300 mm at 0.1·4·25 = 10 mm/s, and three links of 0.5 s."""
    assert COST.cutting_time(SETTING) == pytest.approx(90.0)
    assert COST.time(SETTING) == pytest.approx(91.5)


def test_energy_by_hand() -> None:
    """1000 W · 91.5 s + (4 W·s · 25/s + 40·0.1·2·25 W) · 90 s"""
    assert COST.energy(SETTING) == pytest.approx(91_500.0 + (100.0 + 200.0) * 90.0)


def test_floor_is_travelled_once_whatever_the_passes() -> None:
    cost = replace(COST, once_length=50.0)
    assert [cost.travel(passes) for passes in (1, 2, 3)] == [350.0, 650.0, 950.0]


def test_worn_tools_cost_their_share_of_a_change() -> None:
    """90 s of a life of 900 s: a tenth of 20 s."""
    cost = replace(COST, tool_change=20.0, wear_rate=Monomial(coefficient=1.0 / 900.0))
    assert cost.time(SETTING) == pytest.approx(91.5 + 2.0)


@pytest.mark.parametrize("feed", [0.01, 0.1, 0.4])
def test_time_and_energy_fall_with_the_feed(feed: float) -> None:
    slow, fast = replace(SETTING, feed=feed), replace(SETTING, feed=1.01 * feed)
    assert COST.time(fast) < COST.time(slow)
    assert COST.energy(fast) < COST.energy(slow)


@pytest.mark.parametrize(
    ("total", "bound", "passes"),
    [(10.0, 12.0, 1), (10.0, 10.0, 1), (10.0, 9.999, 2), (10.0, 2.5, 4), (0.3, 0.1, 3)],
)
def test_fewest_passes_keep_the_depth(total: float, bound: float, passes: int) -> None:
    assert problem(bound, total=total).deepest() == passes


def test_shallowest_depth_limit_counts() -> None:
    assert problem(6.0, 2.0, 4.0).deepest() == 5


def test_without_a_depth_limit_one_pass_may_do() -> None:
    assert problem().deepest() == 1


def test_never_fewer_passes_than_are_free() -> None:
    assert problem(5.0, passes=(3, 3)).deepest() == 3


LOBES = Limit(
    name=LimitName.STABILITY,
    load=Monomial(coefficient=1.0, depth_exponent=1.0),
    bound=1.0,
    unit="mm",
    curve=SpeedCurve(speeds=(10.0, 20.0, 30.0, 40.0), bounds=(1.0, 5.0, 2.0, 4.0)),
)


def branched(*speeds: float) -> Problem:
    """A problem with lobes whose speed may be chosen."""
    count = len(speeds) - 1
    return replace(
        problem(8.0),
        limits=(*problem(8.0).limits, LOBES),
        speeds=speeds,
        stretches=((),) * count,
    )


def test_parts_are_the_ranges_of_speed_that_are_stable_within_each_stretch() -> None:
    found = [part.speeds for part in branched(10.0, 18.0, 40.0).parts(3.0)]
    expected = [(15.0, 18.0), (18.0, 26.0 + 2.0 / 3.0), (35.0, 40.0)]
    assert len(found) == len(expected)
    for got, wanted in zip(found, expected, strict=True):
        assert got == pytest.approx(wanted, rel=2e-6)


def test_parts_keep_inside_what_is_stable() -> None:
    for part in branched(10.0, 40.0).parts(3.0):
        assert all(LOBES.holds(0.1, 3.0, speed) for speed in part.speeds)
        assert LOBES.holds(0.1, 3.0, 0.5 * sum(part.speeds))


def test_no_speed_is_left_where_no_lobe_is_high_enough() -> None:
    assert list(branched(10.0, 40.0).parts(5.5)) == []


def test_the_best_speed_says_how_few_passes_may_do() -> None:
    assert branched(10.0, 40.0).deepest() == 2
    assert branched(30.0, 40.0).deepest() == 3
    assert replace(branched(10.0, 40.0), speeds=(25.0,)).deepest() == 3
    assert branched(5.0, 40.0).deepest() == 2  # 8 mm: no lobe limits below 10 rev/s


def test_only_lobes_and_a_choice_of_speeds_make_branches() -> None:
    assert branched(10.0, 40.0).is_branched
    assert not replace(branched(10.0, 40.0), speeds=(25.0,)).is_branched
