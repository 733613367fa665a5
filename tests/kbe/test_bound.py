"""Measured force against the bound that it was to keep."""

from dataclasses import replace
from functools import reduce

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kbe.remarks import BoundUse, is_overplanned, is_wasted, share_of, time_to_win, used
from stepnc_model.outcome import EvaluatedQuantity, ProcessOutcome
from tests.kbe.cuts import SLOT


def cut(
    measured: float | None, *, predicted: float | None = 1000.0, bound: float | None = 1000.0
) -> ProcessOutcome:
    return replace(
        SLOT,
        force=EvaluatedQuantity(predicted=predicted, measured=measured),
        force_bound=bound,
        time=EvaluatedQuantity(predicted=60.0, measured=60.0),
    )


def use_of(*cuts: ProcessOutcome) -> BoundUse:
    return reduce(used, cuts, BoundUse())


def test_force_above_the_bound_by_more_than_five_percent_violates() -> None:
    found = use_of(cut(1049.0), cut(1051.0), cut(900.0))
    assert (found.known, found.violated, found.wasted) == (3, 1, 0)
    assert found.highest == pytest.approx(1.051)


def test_force_below_four_fifths_is_wasted_with_its_time() -> None:
    """At half the bound the feed could double: 30 of 60 s."""
    found = use_of(cut(500.0), cut(801.0))
    assert (found.wasted, found.violated) == (1, 0)
    assert found.time_to_win == pytest.approx(30.0)


def test_plan_that_something_else_holds_back_wastes_nothing() -> None:
    assert not is_wasted(cut(500.0, predicted=600.0))
    assert is_wasted(cut(500.0, predicted=800.0))
    assert is_wasted(cut(500.0, predicted=None))


@pytest.mark.parametrize(
    "outcome",
    [cut(None), cut(500.0, bound=None), cut(500.0, bound=0.0), cut(float("nan")), cut(-1.0)],
)
def test_without_bound_or_force_nothing_is_known(outcome: ProcessOutcome) -> None:
    assert share_of(outcome) is None
    assert not is_wasted(outcome)
    assert time_to_win(outcome) == 0.0
    assert use_of(outcome) == BoundUse()


def test_time_that_was_not_measured_cannot_be_won() -> None:
    assert time_to_win(replace(cut(500.0), time=EvaluatedQuantity())) == 0.0


@given(measured=st.floats(0.0, 5000.0))
def test_no_cut_is_violated_and_wasted(measured: float) -> None:
    found = use_of(cut(measured))
    assert found.violated + found.wasted <= 1
    assert 0.0 <= time_to_win(cut(measured)) <= 60.0


def test_plans_that_expect_to_pass_their_bound_are_counted() -> None:
    over, within = cut(900.0, predicted=1200.0), cut(900.0)
    assert is_overplanned(over)
    assert not is_overplanned(within)
    assert use_of(over, within).overplanned == 1
