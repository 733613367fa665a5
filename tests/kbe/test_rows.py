"""Nouns and rows."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta, timezone
from math import inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kbe.rows import CORRECTION, EVALUATED, OUTCOME, outcome_row, utc
from stepnc_model.entities.optimisation import FaceMillingImmersion
from stepnc_model.outcome import (
    Context,
    EvaluatedQuantity,
    FeatureFacts,
    ForceRatio,
    LearnedCorrection,
    ProcessOutcome,
)

texts = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=9)
# Ratios of the extremes are no measurement; they are refused in a test of their own.
numbers = st.floats(-1e40, 1e40).filter(lambda value: value == 0.0 or abs(value) > 1e-40)
maybe = st.none() | numbers
zones = st.integers(-840, 840).map(lambda east: timezone(timedelta(minutes=east)))
times = st.datetimes(datetime(1971, 1, 1), datetime(2100, 1, 1), timezones=zones)
quantities = st.builds(EvaluatedQuantity, predicted=maybe, measured=maybe)
contexts = st.builds(Context, machine=texts, material=texts, tool=texts)
features = st.builds(
    FeatureFacts, id=texts, kind=texts, length=maybe, width=maybe, total_depth=maybe
)
ratios = st.builds(
    ForceRatio, log_mean=numbers, log_deviation=numbers, readings=st.integers(0, 2**40)
)
outcomes = st.builds(
    ProcessOutcome,
    context=contexts,
    program=texts,
    workingstep=texts,
    feature=features,
    is_finishing=st.booleans(),
    mode=texts,
    specific_force=maybe,
    cutting_speed=maybe,
    step_depth=quantities,
    feed_per_tooth=quantities,
    immersion=st.none() | st.sampled_from(FaceMillingImmersion),
    strategy=texts,
    roughness=quantities,
    time=quantities,
    force=quantities,
    feed=quantities,
    force_bound=maybe,
    force_ratio=st.none() | ratios,
    trace=texts,
    run=texts,
    recorded_at=times,
    recorded_by=texts,
)
corrections = st.builds(
    LearnedCorrection,
    context=contexts,
    log_centre=numbers,
    log_scale=numbers,
    degrees=numbers,
    outcomes=st.integers(0, 2**40),
    confidence=numbers,
    proposed_at=times,
    accepted_by=texts,
    accepted_at=st.none() | times,
)


@given(outcome=outcomes)
def test_outcome_comes_back_from_its_row(outcome: ProcessOutcome) -> None:
    assert OUTCOME.noun(list(OUTCOME.row(outcome).values())) == outcome


@given(correction=corrections)
def test_correction_comes_back_from_its_row(correction: LearnedCorrection) -> None:
    assert CORRECTION.noun(list(CORRECTION.row(correction).values())) == correction


@given(outcome=outcomes)
def test_deviations_are_those_of_the_noun(outcome: ProcessOutcome) -> None:
    row = outcome_row(outcome)
    found = [row[f"{name}_deviation"] for name in EVALUATED]
    nouns = (outcome.roughness, outcome.time, outcome.force, outcome.feed)
    assert found == [quantity.deviation for quantity in nouns]


def test_columns_of_numbers_carry_their_unit() -> None:
    """Every number has a unit, is a logarithm, or is counted."""
    bare = [
        leaf.name
        for leaf in OUTCOME.leaves
        if leaf.kind is float and not leaf.name.endswith(("_mm", "_n", "_s", "_mm_s", "_n_mm2"))
    ]
    assert bare == ["force_ratio_log_mean", "force_ratio_log_deviation"]
    names = {leaf.name for leaf in OUTCOME.leaves}
    assert {"k_c11_n_mm2", "force_measured_n", "feed_per_tooth_predicted_mm"} <= names


def test_no_two_attributes_share_a_column() -> None:
    names = [leaf.name for leaf in OUTCOME.leaves]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("value", [nan, inf, -inf])
def test_number_that_is_none_is_refused(outcome: ProcessOutcome, value: float) -> None:
    strange = replace(outcome, force=EvaluatedQuantity(predicted=value))
    with pytest.raises(ValueError, match="force_predicted_n"):
        outcome_row(strange)


def test_impossible_ratio_is_refused(outcome: ProcessOutcome) -> None:
    strange = replace(outcome, feed=EvaluatedQuantity(predicted=1e-300, measured=1e300))
    with pytest.raises(ValueError, match="feed: implausible deviation"):
        outcome_row(strange)


@pytest.mark.parametrize("text", ["a\0b", "\ud800"])
def test_text_that_no_database_takes_is_refused(outcome: ProcessOutcome, text: str) -> None:
    with pytest.raises(ValueError, match="trace"):
        outcome_row(replace(outcome, trace=text))


def test_count_beyond_64_bits_is_refused(outcome: ProcessOutcome) -> None:
    ratio = ForceRatio(log_mean=0.0, log_deviation=0.0, readings=2**63)
    with pytest.raises(ValueError, match="force_ratio_readings"):
        outcome_row(replace(outcome, force_ratio=ratio))


def test_time_without_zone_is_refused(outcome: ProcessOutcome) -> None:
    strange = replace(outcome, recorded_at=datetime(2026, 1, 1))
    with pytest.raises(ValueError, match="recorded_at: 2026-01-01 00:00:00 has no time zone"):
        outcome_row(strange)


def test_time_is_told_in_utc() -> None:
    east = datetime(2026, 1, 1, 2, 0, tzinfo=timezone(timedelta(hours=2)))
    assert utc("at", east).isoformat() == "2026-01-01T00:00:00+00:00"
    assert utc("at", east).tzinfo is UTC
