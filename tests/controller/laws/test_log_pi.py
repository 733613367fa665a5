"""PI control in logarithms."""

from dataclasses import replace
from math import exp, log

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller.laws.law import Plant, Situation
from controller.laws.log_pi import LogPI
from tests.controller.trial import Trial, run, score

AT = Situation(
    force=800.0, set_point=800.0, override=1.0, actual=1.0, floor=0.01, ceiling=100.0
)


@given(st.floats(-0.02, 0.02))
def test_small_error_is_answered_by_the_velocity_form(error: float) -> None:
    """First step of ``Δ ln u = K_p·(e_k − e_{k−1}) + K_i·e_k`` from rest: ``(κ/p)·e``."""
    law = LogPI(plant=Plant(exponent=0.8, lag=3.0), closing=1.5)
    _, override = law.decide(law.begin(1.0), replace(AT, force=800.0 * exp(-error)))
    both = (1.0 - exp(-1.0 / 1.5)) / (1.0 - exp(-1.0 / 3.0)) / 0.8
    assert log(override) == pytest.approx(both * error, abs=0.001)


@pytest.mark.parametrize("closing", [1.5, 3.0])
def test_axes_reach_their_goal_with_the_wanted_time_constant(closing: float) -> None:
    """From the second revolution after a step the way left shrinks by exp(−1/T_c) each."""
    trial = Trial(depths=(2.0,) * 40 + (2.2,) * 20)
    done = run(LogPI(closing=closing), trial)
    goal = (800.0 / 1100.0) ** 1.25
    left = done.actual[42:48] - goal
    assert left[1:] / left[:-1] == pytest.approx(exp(-1.0 / closing), rel=0.01)


@pytest.mark.parametrize("lag", [1.5, 6.0])
def test_wrong_lag_makes_it_slower_or_quicker_but_never_swing(lag: float) -> None:
    done = run(LogPI(), Trial(lag=lag))
    assert done.error[80:119] == pytest.approx(0.0, abs=0.05)


def test_settles_as_quickly_as_published_trials() -> None:
    """FEEDS, "Closed loop": 11, 7 and 12 revolutions from entry, step up and step down."""
    entry, up, down = score(run(LogPI(), Trial())).settling
    assert entry <= 11
    assert up <= 7
    assert down <= 12
