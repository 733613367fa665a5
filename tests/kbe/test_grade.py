"""Grades of groups."""

from dataclasses import replace
from math import hypot

from hypothesis import given
from hypothesis import strategies as st

from kbe.remarks import BoundUse, EvaluationGrade, grade
from kbe.statistics import DeviationStatistics, DeviationTally, Evaluated
from tests.every_case import every_case

NOTHING = DeviationTally().statistics()
NO_BOUND = BoundUse()


def group(
    which: Evaluated, mean: float, deviation: float | None = None
) -> dict[Evaluated, DeviationStatistics]:
    """One quantity measured, the others not."""
    known = replace(NOTHING, count=9, mean=mean, deviation=deviation)
    return {each: known if each is which else NOTHING for each in Evaluated}


@every_case(
    ("mean", "wanted"),
    [
        (0.0, EvaluationGrade.A),
        (0.049, EvaluationGrade.A),
        (-0.06, EvaluationGrade.B),
        (0.11, EvaluationGrade.C),
        (-0.19, EvaluationGrade.C),
        (0.21, EvaluationGrade.D),
        (5.0, EvaluationGrade.D),
    ],
)
def test_letters_are_of_the_deviation(mean: float, wanted: EvaluationGrade) -> None:
    assert grade(group(Evaluated.FORCE, mean), NO_BOUND) is wanted


def test_scatter_about_a_right_mean_is_no_good_prediction() -> None:
    assert grade(group(Evaluated.TIME, 0.0, 0.15), NO_BOUND) is EvaluationGrade.C
    assert hypot(0.08, 0.08) > 0.1
    assert grade(group(Evaluated.TIME, 0.08, 0.08), NO_BOUND) is EvaluationGrade.C


def test_worst_quantity_counts() -> None:
    mixed = group(Evaluated.FEED, 0.01) | {
        Evaluated.TIME: group(Evaluated.TIME, 0.15)[Evaluated.TIME]
    }
    assert grade(mixed, NO_BOUND) is EvaluationGrade.C


def test_smoother_than_planned_is_no_fault() -> None:
    assert grade(group(Evaluated.ROUGHNESS, -0.4), NO_BOUND) is EvaluationGrade.A
    assert grade(group(Evaluated.ROUGHNESS, 0.4), NO_BOUND) is EvaluationGrade.D


def test_nothing_measured_is_no_grade() -> None:
    assert grade(dict.fromkeys(Evaluated, NOTHING), NO_BOUND) is EvaluationGrade.UNKNOWN


def test_one_violation_is_enough_and_one_waste_of_many_is_not() -> None:
    good = group(Evaluated.FORCE, 0.0)
    assert grade(good, BoundUse(known=100, violated=1, wasted=99)) is EvaluationGrade.VIOLATED
    assert grade(good, BoundUse(known=9, wasted=5)) is EvaluationGrade.WASTED
    assert grade(good, BoundUse(known=9, wasted=4)) is EvaluationGrade.A


@given(near=st.floats(0.0, 1.0), more=st.floats(0.0, 1.0))
def test_greater_deviation_has_no_better_grade(near: float, more: float) -> None:
    worst_first = list(EvaluationGrade)
    one, other = (grade(group(Evaluated.FORCE, mean), NO_BOUND) for mean in (near, near + more))
    assert worst_first.index(other) <= worst_first.index(one)
