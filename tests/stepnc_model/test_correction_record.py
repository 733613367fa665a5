"""Of the corrections of a tool the newest stands in the file, and what was accepted."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta, timezone
from math import exp, log
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stepnc_model.editing.outcome_record import (
    RecordedCorrection,
    read_outcomes,
    write_outcomes,
)
from stepnc_model.outcome import Context, LearnedCorrection
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program

PARTS = Path(__file__).parents[2] / "examples" / "parts"
BRACKET = (PARTS / "bracket.stpnc").read_bytes()
PAPER = (PARTS / "paper002.stpnc").read_bytes()

NOON = datetime(2026, 3, 1, 12, 0, tzinfo=timezone(timedelta(hours=1)))
CONTEXT = Context(machine="vmc15", material="C45", tool="END MILL 12MM")

CORRECTION = LearnedCorrection(
    context=CONTEXT,
    log_centre=log(1.31),
    log_scale=0.02,
    degrees=8.0,
    outcomes=9,
    confidence=0.97,
    proposed_at=NOON,
    accepted_by="planner",
    accepted_at=NOON + timedelta(hours=2),
)


def written(data: bytes, *corrections: LearnedCorrection) -> bytes:
    return write_outcomes(Program(Part21File.from_bytes(data)), [], corrections)


def corrections_of(data: bytes) -> tuple[RecordedCorrection, ...]:
    return read_outcomes(Program(Part21File.from_bytes(data))).corrections


def test_a_correction_becomes_one_line_with_its_factor() -> None:
    (line,) = [
        each for each in written(BRACKET, CORRECTION).splitlines(True) if b"CORRECTION(" in each
    ]
    assert line.partition(b"=")[2] == (
        b"CORRECTION('vmc15','C45','END MILL 12MM',1.31,0.97,'planner',"
        b"'2026-03-01T14:00:00+01:00');\n"
    )


def test_a_proposal_names_nobody_and_holds_since_it_was_made() -> None:
    proposal = replace(CORRECTION, accepted_by="", accepted_at=None)
    (found,) = corrections_of(written(BRACKET, proposal))
    assert found.accepted_by == ""
    assert found.valid_from == NOON


def test_a_newer_correction_takes_the_line_of_the_older() -> None:
    once = written(BRACKET, CORRECTION)
    newer = replace(CORRECTION, log_centre=log(1.2), accepted_at=NOON + timedelta(days=3))
    twice = written(once, newer)
    old, new = once.splitlines(), twice.splitlines()
    differing = [pair for pair in zip(old, new, strict=True) if pair[0] != pair[1]]
    assert len(differing) == 1
    (found,) = corrections_of(twice)
    assert found.factor == pytest.approx(1.2)


def test_an_older_correction_changes_nothing() -> None:
    once = written(BRACKET, CORRECTION)
    older = replace(CORRECTION, log_centre=0.0, accepted_at=NOON - timedelta(days=3))
    assert written(once, older) == once


def test_another_tool_has_a_correction_of_its_own() -> None:
    other = replace(CORRECTION, context=replace(CONTEXT, tool="END MILL 10MM"))
    data = written(BRACKET, CORRECTION, other)
    tools = [each.context.tool for each in corrections_of(data)]
    assert tools == ["END MILL 12MM", "END MILL 10MM"]


def test_a_proposal_leaves_what_was_accepted() -> None:
    proposal = replace(
        CORRECTION,
        log_centre=log(1.4),
        proposed_at=NOON + timedelta(days=1),
        accepted_by="",
        accepted_at=None,
    )
    once = written(BRACKET, CORRECTION, proposal)
    found = corrections_of(once)
    assert [(each.accepted_by, round(each.factor, 6)) for each in found] == [
        ("planner", 1.31),
        ("", 1.4),
    ]
    stale = replace(proposal, proposed_at=NOON)
    assert written(once, stale) == once


def test_acceptance_takes_the_place_of_the_proposal() -> None:
    proposal = replace(CORRECTION, accepted_by="", accepted_at=None)
    once = written(BRACKET, proposal)
    (found,) = corrections_of(written(once, CORRECTION))
    assert found.accepted_by == "planner"
    assert written(BRACKET, proposal, CORRECTION) == written(BRACKET, CORRECTION)


def test_corrections_that_somebody_wrote_twice_become_one() -> None:
    once = written(BRACKET, CORRECTION)
    (line,) = (each for each in once.splitlines(True) if b"CORRECTION(" in each)
    again = line.partition(b"=")[2]
    double = once.replace(line, line + b"#9999=" + again)
    newer = replace(CORRECTION, accepted_at=NOON + timedelta(days=3))
    assert len(corrections_of(written(double, newer))) == 1


def test_a_correction_that_is_too_short_is_replaced_whole() -> None:
    short = BRACKET.replace(
        b"ENDSEC;\nEND-ISO",
        b"#9999=CORRECTION('vmc15','C45','END MILL 12MM',1.1,0.5,'x');\nENDSEC;\nEND-ISO",
    )
    assert short != BRACKET
    (found,) = corrections_of(written(short, CORRECTION))
    assert found.factor == pytest.approx(1.31)


TIMES = st.datetimes(timezones=st.just(UTC))


@st.composite
def corrections(draw: st.DrawFn) -> LearnedCorrection:
    texts = st.sampled_from(["a", "it's", "Fräser Ø10"])
    accepted = draw(st.booleans())
    return replace(
        CORRECTION,
        context=Context(machine=draw(texts), material="C45", tool=draw(texts)),
        log_centre=draw(st.floats(-3.0, 3.0)),
        confidence=draw(st.floats(0.0, 1.0)),
        proposed_at=draw(TIMES),
        accepted_by="planner" if accepted else "",
        accepted_at=draw(TIMES) if accepted else None,
    )


@given(st.lists(corrections(), max_size=5))
@settings(max_examples=50)
def test_of_any_corrections_the_newest_of_each_context_stands(
    given: list[LearnedCorrection],
) -> None:
    data = written(PAPER, *given)
    assert written(data, *given) == data
    one_by_one = PAPER
    for each in given:
        one_by_one = written(one_by_one, each)
    found = corrections_of(data)
    apart = corrections_of(one_by_one)
    assert {each.context for each in apart} == {each.context for each in found}
    for context in {each.context for each in given}:
        accepted = [c for c in given if c.context == context and c.accepted_by]
        standing = [c for c in found if c.context == context and c.accepted_by]
        assert len(standing) == min(1, len(accepted))
        if accepted:
            newest = max(when(c) for c in accepted)
            assert standing[0].valid_from == newest
            factors = [exp(c.log_centre) for c in accepted if when(c) == newest]
            assert standing[0].factor == pytest.approx(factors[-1])


def when(correction: LearnedCorrection) -> datetime:
    assert correction.accepted_at is not None
    return correction.accepted_at
