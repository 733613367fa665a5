"""One side of a row."""

from dataclasses import replace
from math import exp, log

import pytest
from scipy import stats

from kbe.evaluation import TYPES, Knowledge, QuantityTally, Side, SideTally
from kbe.remarks import Action, EvaluationGrade
from kbe.statistics import Evaluated
from stepnc_model.entities.optimisation import FaceMillingImmersion
from stepnc_model.outcome import EvaluatedQuantity, ProcessOutcome
from tests.kbe.cuts import CONTEXT, SLOT, after, correction, deviating, in_run


def side_of(*outcomes: ProcessOutcome, knowledge: Knowledge | None = None) -> Side:
    tally = SideTally(CONTEXT)
    for outcome in outcomes:
        tally.add(outcome)
    return tally.side(knowledge or Knowledge())


def test_first_row_of_the_papers_table() -> None:
    found = side_of(SLOT)
    assert found.context.tool == "MILL 18"
    assert found.specific_force == 1000.0
    assert found.cutting_speed == 583.0
    assert found.step_depth.predicted == 3.0
    assert found.feed_per_tooth == EvaluatedQuantity(predicted=0.4, measured=0.33)
    assert [TYPES[each] for each in found.immersions] == ["d_s1"]
    assert found.strategies == ("unidirectional",)
    assert found.modes == ("TC",)
    assert (found.outcomes, found.runs) == (1, 1)
    assert found.grade is EvaluationGrade.UNKNOWN


def test_every_immersion_has_a_type() -> None:
    assert set(TYPES) == set(FaceMillingImmersion)
    assert len(set(TYPES.values())) == len(TYPES)


def test_numbers_are_means_and_names_are_all_that_occurred() -> None:
    other = replace(
        in_run(1),
        specific_force=1200.0,
        strategy="",
        mode="QC",
        immersion=FaceMillingImmersion.BILATERAL_PART_IMMERSION,
        cutting_speed=None,
    )
    found = side_of(in_run(0), other)
    assert found.specific_force == pytest.approx(1100.0)
    assert found.cutting_speed == 583.0
    assert found.strategies == ("unidirectional",)
    assert found.modes == ("QC", "TC")
    assert len(found.immersions) == 2
    assert found.latest == after(1)


def test_turning_has_no_type_of_face_milling() -> None:
    assert side_of(replace(SLOT, immersion=None)).immersions == ()


def test_workingsteps_of_a_run_are_one_run() -> None:
    found = side_of(in_run(0), in_run(0), in_run(1))
    assert (found.outcomes, found.runs) == (3, 2)


def test_deviations_grade_and_remarks_are_of_the_outcomes() -> None:
    proposed = correction(log(1.23))
    outcomes = [replace(in_run(run), force=deviating(0.23)) for run in range(12)]
    found = side_of(*outcomes, knowledge=Knowledge(proposed={CONTEXT: proposed}))
    assert found.deviations[Evaluated.FORCE].mean == pytest.approx(0.23)
    assert found.deviations[Evaluated.TIME].missing == 12
    assert found.grade is EvaluationGrade.D
    assert found.is_pending
    assert [each.action for each in found.remarks] == [Action.ACCEPT_FACTOR]
    assert "force 23 % above plan in 12 of 12 runs" in str(found.remarks[0])
    assert found.factor is not None
    assert found.factor.high == pytest.approx(1.23 * exp(0.05 * stats.t(8).ppf(0.95)))


def test_accepted_factor_is_compared_with_the_learned_one() -> None:
    same = {CONTEXT: correction(log(1.23))}
    found = side_of(SLOT, knowledge=Knowledge(proposed=same, accepted=same))
    assert not found.is_pending
    assert found.factor is not None


def test_force_above_its_bound_violates() -> None:
    outcome = replace(SLOT, force=deviating(0.1), force_bound=100.0)
    found = side_of(outcome)
    assert found.grade is EvaluationGrade.VIOLATED
    assert found.bound.highest == pytest.approx(1.1)


def test_outcomes_against_the_order_of_time_are_refused() -> None:
    with pytest.raises(ValueError, match=r"run 0 .* is older"):
        side_of(in_run(1), in_run(0))


def test_side_without_outcome_is_refused() -> None:
    with pytest.raises(ValueError, match="outcome"):
        side_of()


def test_like_is_compared_with_like() -> None:
    """A large cut that was only planned must not make the others look slow."""
    tally = QuantityTally()
    tally.add(EvaluatedQuantity(predicted=9.0))
    assert tally.quantity() == EvaluatedQuantity(predicted=9.0)
    tally.add(EvaluatedQuantity(predicted=0.4, measured=0.3))
    tally.add(EvaluatedQuantity(predicted=0.6, measured=0.5))
    found = tally.quantity()
    assert found.predicted == pytest.approx(0.5)
    assert found.measured == pytest.approx(0.4)
    assert QuantityTally().quantity() == EvaluatedQuantity()
