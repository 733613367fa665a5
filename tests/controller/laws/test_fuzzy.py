"""Fuzzy control."""

from math import log

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller.laws.fuzzy import CHANGES, ERRORS, RULES, Fuzzy, inferred, memberships
from tests.controller.trial import Trial, run

numbers = st.floats(-10.0, 10.0)


@given(numbers)
def test_memberships_add_up_to_one(value: float) -> None:
    for peaks in (ERRORS, CHANGES):
        found = memberships(value, peaks)
        assert sum(found) == pytest.approx(1.0)
        assert all(0.0 <= each <= 1.0 for each in found)
        assert sum(each > 0.0 for each in found) <= 2


def test_at_the_peaks_one_rule_speaks() -> None:
    for error, row in zip(ERRORS, RULES, strict=True):
        for change, rule in zip(CHANGES, row, strict=True):
            assert inferred(error, change) == pytest.approx(rule)


def test_between_two_peaks_both_rules_have_their_share() -> None:
    """Half of "right" and half of "too little", and force that stays: mean of 0 and 0.07."""
    assert inferred(0.1, 0.0) == pytest.approx(0.035)


@given(error=numbers, change=numbers, more=st.floats(0.0, 5.0))
def test_more_room_never_asks_for_less_feed(error: float, change: float, more: float) -> None:
    known = inferred(error, change)
    assert inferred(error + more, change) >= known - 1e-9
    assert inferred(error, change + more) >= known - 1e-9


def test_rules_know_no_standing_error() -> None:
    assert inferred(0.0, 0.0) == 0.0
    assert run(Fuzzy(), Trial()).error[[59, 119]] == pytest.approx(0.0, abs=0.001)


def test_slows_down_faster_than_it_speeds_up() -> None:
    assert -inferred(-log(2.0), 0.0) > inferred(log(2.0), 0.0)
