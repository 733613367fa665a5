"""Shares of the teeth, and by what they err."""

from dataclasses import replace
from math import nan
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller.signals.preview import Expected
from controller.signals.tooth_shares import LEAST_CHIP, ToothShares, force_ratio, shares_of
from tests.controller.cutter import EXPONENT, Cutter, shown
from tests.controller.shown import SPINDLE_SPEED

CUTTER = Cutter()
ERROR = np.array([0.0, 40.0, 0.0, 0.0])
"""N by which the expected force of a tooth period may err"""


def seen(factor: float = 1.0, *, expected: Expected = CUTTER.expected) -> ToothShares:
    revolution = shown(factor * CUTTER.forces())
    return shares_of(revolution, expected, exponent=EXPONENT, change=0.0)


@given(factor=st.floats(0.1, 10.0))
def test_shares_know_neither_depth_nor_k_c(factor: float) -> None:
    np.testing.assert_allclose(seen(factor).taken, seen().taken, rtol=1e-12)


def test_equal_teeth_take_what_is_expected_of_each() -> None:
    force = np.array([100.0, 200.0, 300.0, 200.0])
    shares = seen(expected=replace(CUTTER.expected, force=force))
    np.testing.assert_allclose(shares.of(np.zeros((1, 4)))[0], force / 200.0, rtol=1e-12)


def test_what_one_tooth_may_err_by_moves_the_shares_of_all() -> None:
    """Their sum stays: an error of one period is one of the mean."""
    uneven = replace(CUTTER.expected, change=2.0 * ERROR)
    error = seen(expected=uneven).noise - seen().noise
    assert (np.diag(error) > 0.0).all()
    np.testing.assert_allclose(error.sum(axis=1), 0.0, atol=1e-15)


def test_a_period_that_was_expected_wrongly_is_within_the_errors() -> None:
    """A corner that comes a tooth period late."""
    late = replace(CUTTER.expected, change=2.0 * ERROR, force=CUTTER.expected.force + ERROR)
    shares = seen(expected=late)
    error = shares.taken - shares.of(np.zeros((1, 4)))[0]
    assert error @ np.linalg.inv(shares.noise) @ error < 4.0


@pytest.mark.parametrize(
    "lacking",
    [
        {"samples": 1},
        {"force": 0.0},
        {"tooth_means": np.array([nan, 400.0, 400.0, 400.0])},
        {"tooth_means": np.zeros(4)},
        {"tooth_feeds": np.full(4, 4.0 * SPINDLE_SPEED * LEAST_CHIP)},
    ],
    ids=["one sample", "no force", "a tooth lost", "nothing taken", "edges rub"],
)
def test_a_revolution_that_lacks_something_is_not_compared(lacking: dict[str, Any]) -> None:
    revolution = shown(CUTTER.forces())
    assert force_ratio(revolution, CUTTER.expected) == pytest.approx(1.0)
    assert force_ratio(revolution._replace(**lacking), CUTTER.expected) is None


def test_nothing_is_compared_without_an_arc() -> None:
    revolution = shown(CUTTER.forces())
    assert force_ratio(revolution, None) is None
    assert force_ratio(revolution, replace(CUTTER, arc=0.0).expected) is None
