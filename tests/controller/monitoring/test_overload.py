from math import isnan, nan

import numpy as np
import pytest

from controller.monitoring.overload import fresh, level, mean, noted, seen


def test_all_teeth_of_an_unknown_cutter_count_alike() -> None:
    assert level(fresh(4), 2, 100.0) == 100.0


def test_what_runout_gives_a_tooth_is_learnt() -> None:
    shares = fresh(2)
    for _ in range(200):
        shares = seen(seen(shares, 0, 150.0), 1, 50.0)
    assert level(shares, 0, 150.0) == pytest.approx(100.0, rel=1e-3)
    assert level(shares, 1, 50.0) == 50.0


def test_an_overload_in_one_period_shows_at_once() -> None:
    shares = seen(seen(fresh(2), 0, 100.0), 1, 100.0)
    shares = seen(shares, 0, 300.0)
    assert level(shares, 0, 300.0) == pytest.approx(300.0)


def test_a_tooth_that_cuts_nothing_does_not_turn_small_forces_into_overloads() -> None:
    shares = fresh(2)
    for _ in range(500):
        shares = seen(seen(shares, 0, 200.0), 1, 0.0)
    assert level(shares, 1, 10.0) == 10.0


def test_a_lost_period_teaches_nothing() -> None:
    shares = seen(fresh(2), 0, 80.0)
    assert seen(shares, 1, nan) == shares


def test_the_way_into_the_work_teaches_nothing() -> None:
    """One tooth in the cut, the other still in the air, over and over."""
    shares = fresh(2)
    for _ in range(100):
        for first, second in ((0.0, 0.0), (0.0, 300.0), (300.0, 0.0)):
            shares = seen(seen(shares, 0, first), 1, second)
    assert shares.usual == (1.0, 1.0)


def test_what_is_noted_in_the_air_teaches_nothing_and_is_remembered() -> None:
    shares = fresh(2)
    for _ in range(100):
        shares = noted(noted(shares, 0, 3.0), 1, -2.9)
    assert shares.usual == (1.0, 1.0)
    assert shares.seen == (3.0, -2.9)


def test_a_share_follows_slowly_so_that_a_broken_tooth_is_no_runout() -> None:
    shares = fresh(2)
    for _ in range(4):
        shares = seen(seen(shares, 0, 200.0), 1, 0.0)
    assert level(shares, 0, 200.0) > 170.0


def test_lost_samples_lie_between_their_neighbours() -> None:
    """The force of a tooth rises and falls: leaving them out would shift the mean."""
    force = np.array([10.0, 20.0, 30.0, 40.0, 40.0, 30.0, 20.0, 10.0])
    assert mean(force) == 25.0
    force[[2, 6]] = nan
    assert mean(force) == pytest.approx(25.0)


def test_less_than_half_of_the_samples_are_no_mean() -> None:
    assert isnan(mean(np.array([nan, nan, nan, 1.0])))
    assert isnan(mean(np.array([])))
    assert mean(np.array([nan, nan, 3.0, 1.0])) > 0.0
