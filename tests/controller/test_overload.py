from math import nan

import pytest

from controller.overload import fresh, level, seen


def test_all_teeth_of_an_unknown_cutter_count_alike() -> None:
    assert level(fresh(4), 2, 100.0) == 100.0


def test_what_runout_gives_a_tooth_is_learnt() -> None:
    shares = fresh(2)
    for _ in range(200):
        shares = seen(seen(shares, 0, 150.0), 1, 50.0)
    assert level(shares, 0, 150.0) == pytest.approx(100.0, rel=1e-3)
    assert level(shares, 1, 50.0) == pytest.approx(100.0, rel=1e-3)


def test_an_overload_in_one_period_shows_at_once() -> None:
    shares = seen(seen(fresh(2), 0, 100.0), 1, 100.0)
    shares = seen(shares, 0, 300.0)
    assert level(shares, 0, 300.0) == pytest.approx(300.0)


def test_a_tooth_that_cuts_nothing_does_not_turn_small_forces_into_overloads() -> None:
    shares = fresh(2)
    for _ in range(500):
        shares = seen(seen(shares, 0, 200.0), 1, 0.0)
    assert level(shares, 1, 10.0) == pytest.approx(25.0)


def test_a_lost_period_teaches_nothing() -> None:
    shares = seen(fresh(2), 0, 80.0)
    assert seen(shares, 1, nan) == shares
