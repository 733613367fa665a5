"""Axes that only the lag of the feed drives holds back."""

from dataclasses import replace
from math import exp, log

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import lsim

from controller.laws.axes import (
    moved,
    quickening,
    ran,
    resting,
    sent,
    shortfall,
    standing,
    within,
)
from controller.laws.law import Plant, Situation

overrides = st.floats(0.05, 3.0)
lags = st.floats(0.5, 10.0)


AT = Situation(force=800.0, set_point=800.0, override=1.0, actual=1.0, floor=0.1, ceiling=2.0)


@pytest.mark.parametrize("lag", [1.5, 3.0, 6.0])
def test_axes_move_like_a_first_order_lag(lag: float) -> None:
    """Against scipy's simulation of 1/(T·s + 1)."""
    times = np.linspace(0.0, 3.0, 3001)
    _, output, _ = lsim(([1.0], [lag, 1.0]), np.full(3001, -0.7), times)
    axes = resting(1.0)
    for revolution in range(3):
        axes = moved(axes, 0.3, lag=lag)
        rows = slice(1000 * revolution, 1000 * revolution + 1001)
        assert axes.last == pytest.approx(1.0 + output[1000 * (revolution + 1)], rel=1e-6)
        wanted = 1.0 + np.trapezoid(output[rows], times[rows])
        assert axes.mean == pytest.approx(wanted, rel=1e-6)


@given(start=overrides, goal=overrides, lag=lags, closing=lags)
def test_lead_moves_the_axes_with_the_wanted_time_constant(
    start: float, goal: float, lag: float, closing: float
) -> None:
    axes = resting(start)
    lead = quickening(Plant(lag=lag), closing)
    for revolution in range(1, 4):
        axes = moved(axes, sent(axes, goal, quickening=lead), lag=lag)
        left = (start - goal) * exp(-revolution / closing)
        assert axes.last - goal == pytest.approx(left, abs=1e-9)


@given(load=st.floats(0.2, 5.0), slow=st.floats(0.1, 2.0), lag=lags)
def test_force_is_judged_as_on_axes_that_follow(load: float, slow: float, lag: float) -> None:
    """Whatever a corner makes the axes run: ``F = load·F_ref·v^p`` tells the load."""
    at = replace(AT, force=800.0 * load * slow**0.8, actual=slow)
    axes = moved(resting(0.5), 1.0, lag=lag)
    found = shortfall(axes, at, exponent=0.8)
    assert found == pytest.approx(-log(load) - 0.8 * log(axes.mean))


def test_held_feed_starts_again_from_the_floor() -> None:
    assert standing(replace(AT, override=0.0)) == 0.1
    assert within(9.0, AT) == 2.0


def test_standing_axes_count_as_hardly_moving() -> None:
    assert ran(replace(AT, actual=0.0)) == pytest.approx(0.01)
    assert ran(replace(AT, actual=1e300)) == pytest.approx(20.0)
