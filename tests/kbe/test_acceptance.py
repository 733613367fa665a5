"""When a correction may be accepted without a person."""

from dataclasses import replace
from math import log

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kbe.acceptance import AcceptanceBounds, ObjectionGround, objections
from stepnc_model.outcome import Context, LearnedCorrection
from tests.kbe.cuts import correction

GOOD = correction(log(1.3), confidence=0.9, outcomes=5)


def grounds(
    proposed: LearnedCorrection, accepted: LearnedCorrection | None = None
) -> list[ObjectionGround]:
    return [each.ground for each in objections(proposed, accepted)]


def test_sure_and_modest_correction_is_acceptable() -> None:
    assert objections(GOOD, None) == ()
    assert objections(GOOD, correction(log(1.2))) == ()


@pytest.mark.parametrize(
    ("proposed", "ground", "words"),
    [
        (
            replace(GOOD, confidence=0.79),
            ObjectionGround.CONFIDENCE,
            "confidence 0.790 below 0.8",
        ),
        (replace(GOOD, outcomes=2), ObjectionGround.OUTCOMES, "2 outcomes, fewer than 3"),
        (
            replace(GOOD, log_centre=log(2.1)),
            ObjectionGround.RANGE,
            "factor 2.10 outside 0.5 to 2",
        ),
        (
            replace(GOOD, log_centre=log(0.4)),
            ObjectionGround.RANGE,
            "factor 0.40 outside 0.5 to 2",
        ),
    ],
)
def test_each_bound_objects_with_its_number(
    proposed: LearnedCorrection, ground: ObjectionGround, words: str
) -> None:
    (found,) = objections(proposed, None)
    assert found.ground is ground
    assert words in str(found)


def test_unknown_confidence_is_none() -> None:
    assert grounds(replace(GOOD, confidence=float("nan"))) == [ObjectionGround.CONFIDENCE]


@pytest.mark.parametrize("before", [1.0, 1.7])
def test_leap_from_the_accepted_factor_is_for_a_person(before: float) -> None:
    (found,) = objections(GOOD, correction(log(before)))
    assert found.ground is ObjectionGround.CHANGE
    assert f"factor 1.30 differs by more than 25 % from the accepted {before:.2f}" in str(found)


@given(first=st.floats(0.55, 1.9), second=st.floats(0.55, 1.9))
def test_leap_up_is_as_great_as_the_leap_down(first: float, second: float) -> None:
    one, other = (replace(GOOD, log_centre=log(factor)) for factor in (first, second))
    assert grounds(one, other) == grounds(other, one)


def test_all_objections_are_told_at_once() -> None:
    wild = replace(GOOD, log_centre=log(3.0), confidence=0.1, outcomes=1)
    assert grounds(wild, GOOD) == list(ObjectionGround)


def test_bounds_are_the_callers() -> None:
    strict = AcceptanceBounds(least_confidence=0.95, fewest_outcomes=10)
    found = [each.ground for each in objections(GOOD, None, bounds=strict)]
    assert found == [ObjectionGround.CONFIDENCE, ObjectionGround.OUTCOMES]


def test_corrections_of_two_contexts_cannot_be_compared() -> None:
    other = Context(machine="lathe22", material="C45", tool="MILL 18")
    with pytest.raises(ValueError, match="lathe22"):
        objections(GOOD, replace(GOOD, context=other))
