"""Outcomes and corrections go into the file and come back, and nothing else of it changes."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta, timezone
from math import log
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from service.verbs.optimise.program import advise_program as optimise
from stepnc_model.editing import writeback
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.editing.outcome_record import read_outcomes, write_outcomes
from stepnc_model.editing.writeback import SCHEMA
from stepnc_model.errors import SchemaError
from stepnc_model.outcome import (
    Context,
    EvaluatedQuantity,
    FeatureFacts,
    LearnedCorrection,
    ProcessOutcome,
)
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from tests.asking import asked_advice
from tests.every_case import every_case

PARTS = Path(__file__).parents[3] / "examples" / "parts"
BRACKET = (PARTS / "bracket.stpnc").read_bytes()
PAPER = (PARTS / "paper002.stpnc").read_bytes()

NOON = datetime(2026, 3, 1, 12, 0, tzinfo=timezone(timedelta(hours=1)))
CONTEXT = Context(machine="vmc15", material="C45", tool="END MILL 12MM")
NOTHING = EvaluatedQuantity()

OUTCOME = ProcessOutcome(
    context=CONTEXT,
    program="bracket.stpnc",
    workingstep="ROUGH POCKET",
    feature=FeatureFacts(id="POCKET", kind="closed_pocket"),
    is_finishing=False,
    mode="TC",
    specific_force=1500.0,
    cutting_speed=1666.0,
    step_depth=EvaluatedQuantity(predicted=4.0, measured=4.0),
    feed_per_tooth=NOTHING,
    immersion=None,
    strategy="contour_parallel",
    roughness=EvaluatedQuantity(measured=1.6e-3),
    time=EvaluatedQuantity(predicted=130.0, measured=131.5),
    force=EvaluatedQuantity(predicted=900.0, measured=950.0),
    feed=EvaluatedQuantity(measured=17.0),
    force_bound=1000.0,
    force_ratio=None,
    trace="runs/1.parquet",
    run="1",
    recorded_at=NOON,
    recorded_by="operator",
)

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


def program_of(data: bytes) -> Program:
    return Program(Part21File.from_bytes(data), name="part")


def written(data: bytes, *given: ProcessOutcome | LearnedCorrection) -> bytes:
    outcomes = [each for each in given if isinstance(each, ProcessOutcome)]
    corrections = [each for each in given if isinstance(each, LearnedCorrection)]
    return write_outcomes(program_of(data), outcomes, corrections)


def added(before: bytes, after: bytes) -> list[bytes]:
    """Lines that came; all others are as they were, but that FILE_SCHEMA has one name more."""
    old, new = before.splitlines(keepends=True), after.splitlines(keepends=True)
    name = f", '{SCHEMA}'".encode()
    is_new = name not in before
    kept = [
        line.replace(name, b"") if b"FILE_SCHEMA" in line and is_new else line for line in new
    ]
    first = len(old) - 2
    assert old[first:] == [b"ENDSEC;\n", b"END-ISO-10303-21;\n"]
    count = len(new) - len(old)
    assert kept[:first] + kept[first + count :] == old
    return new[first : first + count]


def test_an_outcome_becomes_one_line_in_the_units_of_the_file() -> None:
    """17 mm/s are 0.017 m/s, 1.6e-3 mm are 1.6 µm."""
    (line,) = added(BRACKET, written(BRACKET, OUTCOME))
    (step,) = (s for s in program_of(BRACKET).workingsteps if s.id == "ROUGH POCKET")
    number = line.partition(b"=")[0]
    assert line == (
        number
        + f"=OUTCOME({step.operation_ref!r},'2026-03-01T12:00:00+01:00',131.5,950.,0.017,1.6,"
        "'runs/1.parquet');\n".encode()
    )


def test_the_schema_is_named_once() -> None:
    data = written(written(BRACKET, OUTCOME), CORRECTION)
    assert Part21File.from_bytes(data).schemas.count(SCHEMA) == 1
    assert SCHEMA not in Part21File.from_bytes(BRACKET).schemas


def test_nothing_to_write_leaves_the_bytes() -> None:
    assert written(BRACKET) == BRACKET


def test_what_is_there_already_is_not_written_again() -> None:
    once = written(BRACKET, OUTCOME, CORRECTION)
    assert written(once, OUTCOME, CORRECTION) == once


def test_a_later_outcome_is_appended() -> None:
    later = replace(OUTCOME, recorded_at=NOON + timedelta(days=1))
    once = written(BRACKET, OUTCOME)
    twice = written(once, later)
    assert len(added(once, twice)) == 1
    times = [each.measured_at for each in read_outcomes(program_of(twice)).outcomes]
    assert times == [NOON, NOON + timedelta(days=1)]


def test_equal_outcomes_of_one_run_are_all_kept() -> None:
    """Two holes by one operation, measured alike to the last digit."""
    two = written(BRACKET, OUTCOME, OUTCOME)
    assert len(read_outcomes(program_of(two)).outcomes) == 2
    assert written(two, OUTCOME, OUTCOME) == two
    assert written(two, OUTCOME) == two


def test_holes_by_one_operation_are_both_named() -> None:
    data = BRACKET
    steps = program_of(data).workingsteps
    one, other = (step for step in steps if step.id in {"DRILL HOLE 1", "DRILL HOLE 2"})
    assert one.operation_ref != other.operation_ref
    shared = data.replace(
        f"{other.operation_ref!r},$);".encode(), f"{one.operation_ref!r},$);".encode()
    )
    assert shared != data
    found = read_outcomes(
        program_of(written(shared, replace(OUTCOME, workingstep="DRILL HOLE 2")))
    )
    assert found.outcomes[0].workingsteps == ("DRILL HOLE 1", "DRILL HOLE 2")
    assert found.outcomes[0].operation == one.operation_ref


def test_a_workingstep_may_be_named_by_its_instance() -> None:
    by_instance = replace(OUTCOME, workingstep="#16")
    assert written(BRACKET, by_instance) == written(BRACKET, OUTCOME)


def test_a_workingstep_of_another_program_is_refused() -> None:
    with pytest.raises(SchemaError, match="'NOPE' is not a workingstep of this program"):
        written(BRACKET, replace(OUTCOME, workingstep="NOPE"))


def test_an_id_of_two_operations_is_refused() -> None:
    twice = BRACKET.replace(b"'FINISH POCKET'", b"'ROUGH POCKET'")
    with pytest.raises(SchemaError, match="'ROUGH POCKET' belongs to 2 operations"):
        written(twice, OUTCOME)


@every_case(
    ("wrong", "message"),
    [
        (
            replace(OUTCOME, time=EvaluatedQuantity(measured=-1.0)),
            "invalid machining time: -1 s",
        ),
        (
            replace(OUTCOME, force=EvaluatedQuantity(measured=float("nan"))),
            "invalid cutting force: nan N",
        ),
        (replace(OUTCOME, feed=EvaluatedQuantity(measured=0.0)), "invalid feed: 0 m/s"),
        (
            replace(OUTCOME, roughness=EvaluatedQuantity(measured=0.0)),
            "invalid roughness: 0 µm",
        ),
        (replace(OUTCOME, recorded_at=NOON.replace(tzinfo=None)), "has no time zone"),
        (replace(CORRECTION, log_centre=1000.0), "invalid factor on k_c: inf"),
        (replace(CORRECTION, log_centre=-1000.0), "invalid factor on k_c: 0"),
        (
            replace(CORRECTION, context=replace(CONTEXT, tool="")),
            "a correction must name its machine, material and tool",
        ),
        (replace(CORRECTION, confidence=1.1), "a confidence of 1.1"),
        (replace(CORRECTION, confidence=float("nan")), "a confidence of nan"),
    ],
)
def test_numbers_that_the_schema_forbids_are_refused(
    wrong: ProcessOutcome | LearnedCorrection, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        written(BRACKET, wrong)


def test_what_is_not_complete_is_not_read() -> None:
    junk = (
        b"#9990=OUTCOME($,$,$,$,$,$,$);\n#9991=OUTCOME(#9992,$,$,$,$,$,$);\n"
        b"#9993=CORRECTION($,'C45','x',1.1,0.5,$,'2026-03-01');\n"
        b"#9994=CORRECTION('m','C45','x',-1.1,0.5,$,'2026-03-01');\n"
        b"#9995=CORRECTION('m','C45','x',1.1,0.5,$,'2026-03-01');\n"
    )
    data = BRACKET.replace(b"ENDSEC;\nEND-ISO", junk + b"ENDSEC;\nEND-ISO")
    found = read_outcomes(program_of(data))
    assert found.outcomes == ()
    (left,) = found.corrections
    assert (left.factor, left.valid_from) == (1.1, None)


class TestProfiles:
    def test_a_program_in_profile_standard_is_refused(self, tmp_path: Path) -> None:
        data = optimised(PAPER, tmp_path, profile="standard")
        outcome = replace(OUTCOME, workingstep=program_of(data).workingsteps[0].id)
        with pytest.raises(SchemaError, match="convert the program to profile 'optimisation'"):
            written(data, outcome)
        other = writeback.convert(program_of(data), FileProfile.OPTIMISATION)
        assert len(read_outcomes(program_of(written(other, outcome))).outcomes) == 1

    def test_a_program_with_outcomes_has_no_profile_standard(self, tmp_path: Path) -> None:
        data = written(BRACKET, OUTCOME)
        with pytest.raises(
            SchemaError, match="OUTCOME: cannot be written in profile 'standard'"
        ):
            writeback.convert(program_of(data), FileProfile.STANDARD)
        with pytest.raises(SchemaError, match="cannot be written in profile 'standard'"):
            optimised(written(PAPER, CORRECTION), tmp_path, profile="standard")

    def test_the_schema_stays_while_outcomes_do(self, tmp_path: Path) -> None:
        data = optimised(PAPER, tmp_path)
        outcome = replace(OUTCOME, workingstep=program_of(data).workingsteps[0].id)
        data = written(data, outcome)
        without = writeback.convert(program_of(data), FileProfile.OPTIMISATION)
        assert SCHEMA in Part21File.from_bytes(without).schemas
        assert len(read_outcomes(program_of(without)).outcomes) == 1


def optimised(data: bytes, folder: Path, *, profile: str = "optimisation") -> bytes:
    source, output = folder / "in.stpnc", folder / "out.stpnc"
    source.write_bytes(data)
    optimise(*asked_advice(file=source, output=output, profile=profile, machine=""))
    return output.read_bytes()


def test_optimise_keeps_what_was_measured_and_advises_the_same(tmp_path: Path) -> None:
    step = program_of(PAPER).workingsteps[0]
    outcome = replace(OUTCOME, workingstep=step.id)
    data = written(PAPER, outcome, CORRECTION)
    result = optimised(data, tmp_path)
    assert read_outcomes(program_of(result)) == read_outcomes(program_of(data))
    plain = optimised(PAPER, tmp_path)
    assert writeback.records(program_of(result)) == writeback.records(program_of(plain))
    assert optimised(result, tmp_path) == result
    assert writeback.records(program_of(written(plain, outcome))) == writeback.records(
        program_of(plain)
    )


MEASURED = st.none() | st.floats(1e-6, 1e6)
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
TIMES = st.datetimes(timezones=st.just(UTC))
STEPS = [step.id for step in program_of(BRACKET).workingsteps]


@st.composite
def outcomes(draw: st.DrawFn) -> ProcessOutcome:
    return replace(
        OUTCOME,
        workingstep=draw(st.sampled_from(STEPS)),
        time=EvaluatedQuantity(measured=draw(MEASURED)),
        force=EvaluatedQuantity(measured=draw(MEASURED)),
        feed=EvaluatedQuantity(measured=draw(MEASURED)),
        roughness=EvaluatedQuantity(measured=draw(MEASURED)),
        trace=draw(TEXTS),
        recorded_at=draw(TIMES),
    )


@given(st.lists(outcomes(), max_size=4))
@settings(max_examples=50)
def test_any_outcomes_come_back_in_their_order(given: list[ProcessOutcome]) -> None:
    data = written(BRACKET, *given)
    assert len(added(BRACKET, data)) == len(given)
    found = read_outcomes(program_of(data)).outcomes
    for one, other in zip(given, found, strict=True):
        assert other.workingsteps == (one.workingstep,)
        assert other.measured_at == one.recorded_at
        assert other.trace == one.trace
        assert other.time == close(one.time.measured)
        assert other.force == close(one.force.measured)
        assert other.feed == close(one.feed.measured)
        assert other.roughness == close(one.roughness.measured)
    assert written(data, *given) == data


def close(value: float | None) -> object:
    return None if value is None else pytest.approx(value, rel=1e-11)


def test_references_are_those_of_the_file() -> None:
    found = read_outcomes(program_of(written(BRACKET, OUTCOME)))
    assert isinstance(found.outcomes[0].operation, Ref)
    assert "OUTCOME" not in BRACKET.decode()
