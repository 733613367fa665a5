"""Advice in AP238 files: numbers in place, records as properties, the rest untouched."""

import difflib
import re

import pytest

from stepnc_model.ap238.view import AimView
from stepnc_model.editing import writeback
from stepnc_model.editing.cut_settings import edit_depth
from stepnc_model.editing.draft import Draft
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.editing.outcome_record import write_outcomes
from stepnc_model.editing.writeback import WorkingstepUpdate
from stepnc_model.errors import SchemaError
from stepnc_model.part21.values import Real, Ref
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import programmed
from tests.stepnc_model.ap238.long_form import deviations, schema
from tests.stepnc_model.ap238.samples import MILLING, exported, long_form, public, read
from tests.stepnc_model.written import RECORD

SAMPLES = ("bracket", "paper002", "shaft")


def advised(
    data: bytes, *, feed: float, profile: FileProfile = FileProfile.OPTIMISATION
) -> bytes:
    """File with another feed and a record in every workingstep that has a technology."""
    program = Program(read(data))
    changes = [
        WorkingstepUpdate(
            workingstep=step,
            programmed=programmed(program, step.technology_ref),
            record=RECORD,
            feed=feed,
        )
        for step in program.workingsteps
    ]
    return writeback.write(program, changes, profile)


def lines_of(one: bytes, other: bytes) -> tuple[list[str], list[str]]:
    """Lines that only the first, and that only the second of two files has."""
    changes = list(difflib.ndiff(one.decode().splitlines(), other.decode().splitlines()))
    return (
        [line[2:] for line in changes if line.startswith("- ")],
        [line[2:] for line in changes if line.startswith("+ ")],
    )


class TestNumbers:
    @pytest.mark.parametrize("name", SAMPLES)
    def test_a_feed_is_replaced_where_it_stands(self, name: str) -> None:
        data = exported(name)
        written = Program(read(advised(data, feed=0.0125)))
        for step in written.workingsteps:
            number = programmed(written, step.technology_ref).feed
            assert number.in_file(number.value) == 0.0125

    @pytest.mark.parametrize("name", SAMPLES)
    def test_geometry_and_workpiece_stay_byte_for_byte(self, name: str) -> None:
        gone, _ = lines_of(exported(name), advised(exported(name), feed=0.0125))
        kinds = {re.sub(r"^#\d+=\(?([A-Z_]+).*", r"\1", line) for line in gone}
        assert kinds <= {
            "LENGTH_MEASURE_WITH_UNIT",
            "MACHINING_TECHNOLOGY_RELATIONSHIP",
            "MEASURE_REPRESENTATION_ITEM",
        }

    def test_a_number_is_written_in_the_unit_that_it_has(self) -> None:
        program = Program(read(public(MILLING)))
        step = program.workingsteps[0]
        change = WorkingstepUpdate(
            workingstep=step,
            programmed=programmed(program, step.technology_ref),
            record=RECORD,
            feed=0.0125,
        )
        data = writeback.write(program, [change], FileProfile.OPTIMISATION)
        assert (
            b"#824=MEASURE_REPRESENTATION_ITEM('feed speed',NUMERIC_MEASURE(12.5),#833);"
            in data
        )

    def test_a_depth_within_a_complex_instance_keeps_its_other_parts(self) -> None:
        program = Program(read(public(MILLING)))
        draft = Draft(program)
        assert edit_depth(draft, program.workingsteps[3], 1.25)
        written = writeback._finished(draft)
        gone, new = lines_of(public(MILLING), written)
        assert gone == ["MEASURE_WITH_UNIT(LENGTH_MEASURE(2.5),#1601)"]
        assert new == ["MEASURE_WITH_UNIT(LENGTH_MEASURE(1.25),#1601)"]

    def test_a_measure_that_others_share_is_split(self) -> None:
        data = public(MILLING).replace(b"#2323=MACHINING_FEED_SPEED_REPRESENTATION", b"#2323=X")
        shared = data.replace(b"'milling',#2321,#2323)", b"'milling',#2321,#823)")
        assert shared != data
        program = Program(read(shared))
        face, drilling = program.workingsteps[0], program.workingsteps[1]
        change = WorkingstepUpdate(
            workingstep=face,
            programmed=programmed(program, face.technology_ref),
            record=RECORD,
            feed=0.0125,
        )
        written = Program(read(writeback.write(program, [change], FileProfile.OPTIMISATION)))
        feeds = [
            programmed(written, s.technology_ref).feed.value for s in written.workingsteps[:2]
        ]
        assert feeds == [pytest.approx(12.5), pytest.approx(0.04)]
        assert drilling.id == "WS DRILL HOLE1"


class TestRecords:
    @pytest.mark.parametrize("name", SAMPLES)
    def test_a_record_comes_back_as_it_was_written(self, name: str) -> None:
        written = Program(read(advised(exported(name), feed=0.0125)))
        found = writeback.records(written)
        assert len(found) == len({int(s.operation_ref) for s in written.workingsteps})
        assert set(found.values()) == {RECORD}

    @pytest.mark.parametrize("name", SAMPLES)
    def test_the_same_advice_twice_gives_the_same_bytes(self, name: str) -> None:
        once = advised(exported(name), feed=0.0125)
        assert advised(once, feed=0.0125) == once

    @pytest.mark.parametrize("name", SAMPLES)
    def test_other_advice_replaces_the_first(self, name: str) -> None:
        once = advised(exported(name), feed=0.0125)
        assert advised(once, feed=0.025) == advised(exported(name), feed=0.025)

    def test_a_record_is_an_action_property_with_units(self) -> None:
        data = advised(exported("paper002"), feed=0.0125)
        assert b"=ACTION_PROPERTY('optimisation record','1:ROUGH THE FACE',#" in data
        item = rb"_ITEM\('optimisation:cutting_force:1:ROUGH THE FACE',NUMERIC_MEASURE\(\d"
        assert re.search(item, data)
        assert b"SI_UNIT(*,$,.NEWTON.)" in data

    def test_every_profile_is_the_one_of_ap238(self) -> None:
        data = exported("paper002")
        written = {
            profile: advised(data, feed=0.0125, profile=profile) for profile in FileProfile
        }
        assert len(set(written.values())) == 1

    def test_without_changes_the_bytes_are_those_of_the_file(self) -> None:
        program = Program(read(public(MILLING)))
        assert writeback.write(program, [], FileProfile.OPTIMISATION) == public(MILLING)


class TestLongForm:
    @pytest.mark.parametrize("name", SAMPLES)
    def test_a_written_file_is_one_that_the_long_form_accepts(self, name: str) -> None:
        data = advised(exported(name), feed=0.0125)
        assert list(deviations(read(data), schema(long_form()))) == []

    def test_what_is_added_to_a_public_file_is_what_the_long_form_accepts(self) -> None:
        program = Program(read(public(MILLING)))
        changes = [
            WorkingstepUpdate(
                workingstep=step,
                programmed=programmed(program, step.technology_ref),
                record=RECORD,
                feed=0.0125,
            )
            for step in program.workingsteps[:3]
        ]
        data = writeback.write(program, changes, FileProfile.OPTIMISATION)
        entities = schema(long_form())
        before = set(deviations(read(public(MILLING)), entities))
        assert set(deviations(read(data), entities)) == before


class TestRefusals:
    def test_a_change_that_ap238_has_no_path_for_is_refused(self) -> None:
        program = Program(read(exported("paper002")))
        (ref, _) = next(
            program.model.of_type(type(program.get(program.workingsteps[0].tool_ref)))
        )
        draft = Draft(program)
        draft.put(ref, "tool_holder_diameter_for_spindle_orientation", Real(12.0))
        with pytest.raises(SchemaError, match="cannot be written into an AP238 file"):
            writeback._finished(draft)

    def test_no_outcome_is_lost_silently(self) -> None:
        program = Program(read(exported("paper002")))
        assert isinstance(program.file, AimView)
        assert write_outcomes(program, (), ()) == exported("paper002")

    def test_the_view_names_instances_as_the_file_does(self) -> None:
        program = Program(read(public(MILLING)))
        assert program.label(Ref(800)) == "#800 MILLING_TECHNOLOGY"
        assert program.line(Ref(800)) == 1 + public(MILLING)[
            : public(MILLING).index(b"#800=MACHINING_TECHNOLOGY")
        ].count(b"\n")
