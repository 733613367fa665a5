"""Linear PI control."""

from dataclasses import replace
from math import log

import numpy as np
import pytest

from controller.laws.law import Situation
from controller.laws.pi import PI, SLOWEST
from tests.controller.trial import Trial, run

AT = Situation(force=800.0, set_point=800.0, override=1.0, actual=1.0, floor=0.1, ceiling=2.0)


def override(force: float) -> float:
    law = PI()
    return law.decide(law.begin(1.0), replace(AT, force=force))[1]


def test_set_point_is_left_alone() -> None:
    assert override(800.0) == pytest.approx(1.0)


def test_too_much_is_answered_harder_than_too_little() -> None:
    """A force a quarter above the set point is off by 0.25, one a quarter below by 0.2."""
    assert 1.0 - override(1000.0) == pytest.approx(1.25 * (override(800.0 / 1.25) - 1.0))
    assert override(1e6) == override(1600.0) == SLOWEST


def test_small_error_dies_out_with_the_wanted_time_constant() -> None:
    """To a tenth within T_c·ln 10, and two revolutions of dead time; no swing beyond it."""
    error = run(PI(), Trial(depths=(2.0,) * 40 + (2.02,) * 30)).error[40:]
    allowed = 2.0 + PI().closing * log(10.0)
    assert np.abs(error[round(allowed) :]).max() < 0.1 * error[0]
    assert error.min() > -0.15 * error[0]
