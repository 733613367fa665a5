"""The optimum goes into the file, and nothing else of the file changes."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

import stepnc
from service.verbs.optimise.program import advise_program as optimise
from stepnc_model.editing import writeback
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.editing.record import AdviceRecord
from stepnc_model.editing.writeback import SCHEMA
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.technology import programmed
from tests.asking import asked_advice
from tests.stepnc_model.written import (
    ADAPTIVE,
    BOTH_WAYS,
    OPERATION,
    PARTS_NAMES,
    PROFILES,
    SECOND,
    TECHNOLOGY,
    added,
    change_of,
    changed,
    converted,
    ex1,
    instances,
    optimised,
    part,
    program_of,
    stand_in_order,
    two_operations,
    untouched_lines,
    write_first,
)


class TestConversion:
    @pytest.mark.parametrize("name", PARTS_NAMES)
    @pytest.mark.parametrize(("profile", "other"), BOTH_WAYS)
    def test_there_and_back_gives_the_same_bytes(
        self, name: str, profile: FileProfile, other: FileProfile
    ) -> None:
        data = optimised(part(name), profile)
        there = converted(data, other)
        assert there != data
        assert converted(there, profile) == data

    @pytest.mark.parametrize(("profile", "other"), BOTH_WAYS)
    def test_ex1_there_and_back_gives_the_same_bytes(
        self, profile: FileProfile, other: FileProfile
    ) -> None:
        data = optimised(ex1(), profile)
        assert converted(converted(data, other), profile) == data

    @pytest.mark.parametrize("name", PARTS_NAMES)
    @pytest.mark.parametrize(("profile", "other"), BOTH_WAYS)
    def test_conversion_gives_what_the_other_profile_would_have_written(
        self, name: str, profile: FileProfile, other: FileProfile
    ) -> None:
        data = optimised(part(name), profile)
        assert converted(data, other) == optimised(part(name), other)

    @pytest.mark.parametrize("name", PARTS_NAMES)
    @pytest.mark.parametrize("profile", PROFILES)
    def test_into_the_same_profile_gives_the_same_bytes(
        self, name: str, profile: FileProfile
    ) -> None:
        data = optimised(part(name), profile)
        assert converted(data, profile) == data

    @pytest.mark.parametrize("name", PARTS_NAMES)
    @pytest.mark.parametrize(("profile", "other"), BOTH_WAYS)
    def test_the_records_stay_the_same(
        self, name: str, profile: FileProfile, other: FileProfile
    ) -> None:
        data = optimised(part(name), profile)
        records = writeback.records(program_of(data))
        assert records
        assert writeback.records(program_of(converted(data, other))) == records

    @pytest.mark.parametrize("name", PARTS_NAMES)
    def test_both_profiles_write_the_same_records(self, name: str) -> None:
        one, two = (
            writeback.records(program_of(optimised(part(name), profile)))
            for profile in PROFILES
        )
        assert one == two

    @pytest.mark.parametrize("profile", PROFILES)
    def test_a_file_without_records_keeps_its_bytes(self, profile: FileProfile) -> None:
        for name in PARTS_NAMES:
            assert converted(part(name), profile) == part(name)

    def test_the_verb_writes_what_the_model_converts(self, tmp_path: Path) -> None:
        data = optimised(part("paper002"), FileProfile.OPTIMISATION)
        source, target = tmp_path / "in.stpnc", tmp_path / "standard.stpnc"
        source.write_bytes(data)
        stepnc.convert(source, profile="standard", output=target)
        assert target.read_bytes() == converted(data, FileProfile.STANDARD)


class TestAgain:
    @pytest.mark.parametrize("name", PARTS_NAMES)
    @pytest.mark.parametrize("profile", PROFILES)
    @pytest.mark.parametrize("mode", ["TC", "EC"])
    def test_optimising_twice_gives_the_same_bytes(
        self, name: str, profile: FileProfile, mode: str
    ) -> None:
        once = optimised(part(name), profile, mode=mode)
        assert optimised(once, profile, mode=mode) == once

    @pytest.mark.parametrize("profile", PROFILES)
    def test_ex1_twice_gives_the_same_bytes(self, profile: FileProfile) -> None:
        once = optimised(ex1(), profile)
        assert optimised(once, profile) == once

    @pytest.mark.parametrize("profile", PROFILES)
    def test_writing_the_same_advice_twice_gives_the_same_bytes(
        self, profile: FileProfile
    ) -> None:
        for name in PARTS_NAMES:
            once = write_first(part(name), profile, feed=0.07)
            assert write_first(once, profile, feed=0.07) == once

    @pytest.mark.parametrize("name", PARTS_NAMES)
    @pytest.mark.parametrize("profile", PROFILES)
    @pytest.mark.parametrize("again", PROFILES)
    def test_the_first_programmed_values_survive(
        self, name: str, profile: FileProfile, again: FileProfile
    ) -> None:
        once = optimised(part(name), profile, mode="TC")
        twice = optimised(once, again, mode="EC")
        first, last = (writeback.records(program_of(data)) for data in (once, twice))
        assert first.keys() == last.keys()
        for id, record in first.items():
            assert last[id].mode == "EC"
            assert _programmed(last[id]) == _programmed(record)

    def test_the_first_programmed_values_are_those_of_the_file(self) -> None:
        data = optimised(part("paper002"), FileProfile.OPTIMISATION)
        (record,) = writeback.records(program_of(data)).values()
        assert record.programmed_cutspeed == pytest.approx(0.583333333333333, rel=1e-14)
        assert record.programmed_feedrate_per_tooth == 0.05
        assert record.programmed_axial_depth == 3.0
        assert (record.programmed_feedrate, record.programmed_spindle) == (None, None)

    def test_a_record_takes_the_place_of_the_old_one(self) -> None:
        once = write_first(part("paper002"), FileProfile.OPTIMISATION, feed=0.07)
        twice = write_first(once, FileProfile.OPTIMISATION, feed=0.08)
        assert len(instances(twice)) == len(instances(once))
        file = Part21File.from_bytes(twice)
        assert len(file.ids_of("TIME_CRITICAL_OPTIMISATION")) == 1
        assert file.schemas.count(SCHEMA) == 1


def _programmed(record: AdviceRecord) -> tuple[float | None, ...]:
    return (
        record.programmed_feedrate,
        record.programmed_feedrate_per_tooth,
        record.programmed_cutspeed,
        record.programmed_spindle,
        record.programmed_axial_depth,
    )


class TestOnlyWhatChanges:
    def test_ex1_differs_in_edited_and_added_instances_only(self) -> None:
        before = ex1()
        after = optimised(before, FileProfile.STANDARD)
        file = Part21File.from_bytes(before)
        allowed = {"MILLING_TECHNOLOGY"}
        for id, text in changed(before, after).items():
            keyword = file.keyword(id)
            assert keyword in allowed or keyword.endswith(("MILLING", "DRILLING", "REAMING"))
            assert text.startswith(b"#%d= %s(" % (id, keyword.encode()))
        assert instances(before).keys() < instances(after).keys()
        assert min(added(before, after)) > max(instances(before))

    @pytest.mark.parametrize("profile", PROFILES)
    def test_ex1_keeps_its_lines_and_comments_in_order(self, profile: FileProfile) -> None:
        before = ex1()
        after = optimised(before, profile)
        lines = untouched_lines(before, after)
        assert len(lines) > 150
        if profile is FileProfile.OPTIMISATION:
            lines = [line for line in lines if not line.startswith(b"FILE_SCHEMA")]
        assert stand_in_order(lines, after)

    @pytest.mark.parametrize("name", PARTS_NAMES)
    def test_a_standard_file_keeps_every_line_that_is_not_edited(self, name: str) -> None:
        before = part(name)
        after = optimised(before, FileProfile.STANDARD)
        assert stand_in_order(untouched_lines(before, after), after)

    @pytest.mark.parametrize("name", PARTS_NAMES)
    @pytest.mark.parametrize("profile", PROFILES)
    def test_what_is_added_stands_at_the_end(self, name: str, profile: FileProfile) -> None:
        before = part(name)
        after = optimised(before, profile)
        file = Part21File.from_bytes(after)
        new = added(before, after)
        assert list(file.ids())[-len(new) :] == sorted(new)
        assert after.endswith(b"\nENDSEC;\nEND-ISO-10303-21;\n")

    def test_only_the_technology_changes_when_only_the_feed_changes(self) -> None:
        before = part("paper002")
        after = write_first(before, FileProfile.STANDARD, feed=0.125)
        assert changed(before, after) == {41: TECHNOLOGY.replace(b",0.05,", b",0.125,")}

    def test_the_entities_are_one_surplus_parameter_of_the_operation(self) -> None:
        before = part("paper002")
        after = write_first(before, FileProfile.OPTIMISATION, feed=0.125)
        edits = changed(before, after)
        assert re.fullmatch(re.escape(OPERATION[:-2]) + rb", ?#\d+\);", edits.pop(40))
        assert list(edits) == [41]

    @pytest.mark.parametrize("profile", PROFILES)
    def test_an_advice_of_the_programmed_numbers_edits_no_technology(
        self, profile: FileProfile
    ) -> None:
        before = part("paper002")
        edited = {FileProfile.OPTIMISATION: [40], FileProfile.STANDARD: []}[profile]
        assert list(changed(before, write_first(before, profile))) == edited

    def test_only_a_spindle_changes_when_only_a_speed_changes(self) -> None:
        before = part("paper002")
        after = write_first(before, speed=0.75)
        assert changed(before, after)[41] == TECHNOLOGY.replace(b"0.583333333333333", b"0.75")

    def test_a_depth_goes_to_the_operation(self) -> None:
        before = part("paper002")
        edits = changed(before, write_first(before, depth=1.5))
        assert list(edits) == [40]
        assert edits[40].endswith(b",1.5,0.);")

    def test_twelve_digits_are_written(self) -> None:
        after = write_first(part("paper002"), feed=1.0 / 3.0)
        assert b",0.333333333333,.F." in after

    @pytest.mark.parametrize("profile", PROFILES)
    def test_crlf_is_kept(self, profile: FileProfile) -> None:
        before = part("paper002").replace(b"\n", b"\r\n")
        after = optimised(before, profile)
        assert after.count(b"\n") == after.count(b"\r\n") > before.count(b"\r\n")
        plain = optimised(part("paper002"), profile)
        assert after.replace(b"\r\n", b"\n") == plain


class TestForbidden:
    @pytest.mark.parametrize("profile", PROFILES)
    @pytest.mark.parametrize(
        ("name", "ids"),
        [("bracket", (214, 215, 312)), ("shaft", (205, 304, 313, 355))],
        ids=["reamed holes", "thread"],
    )
    def test_an_inhibited_feed_stays_byte_for_byte(
        self, profile: FileProfile, name: str, ids: tuple[int, ...]
    ) -> None:
        before = part(name)
        after = optimised(before, profile)
        old, new = instances(before), instances(after)
        assert [new[id] for id in ids] == [old[id] for id in ids]
        assert not writeback.records(program_of(after)).keys() & set(ids)

    def test_a_feed_that_may_not_adapt_stays_byte_for_byte(self) -> None:
        shared = two_operations()
        forbidden = ADAPTIVE.replace(b"#41=", b"#48=").replace(b"#46", b"#98")
        forbidden = forbidden.replace(b"#47", b"#99").replace(b"TOOTH(.T.", b"TOOTH(.F.")
        own = SECOND.replace(b"#50,#41", b"#50,#48")
        before = shared.replace(SECOND, own + b"\n" + forbidden)
        after = optimised(before, FileProfile.STANDARD)
        old, new = instances(before), instances(after)
        assert changed(before, after).keys() == {41}
        assert [new[id] for id in (45, 48, 98, 99)] == [old[id] for id in (45, 48, 98, 99)]


class TestShared:
    @pytest.mark.parametrize("profile", PROFILES)
    def test_the_other_operation_keeps_its_numbers(self, profile: FileProfile) -> None:
        before = two_operations()
        after = write_first(before, profile, feed=0.125, speed=0.75)
        assert instances(after)[41] == TECHNOLOGY
        assert instances(after)[45] == SECOND
        mine, other = program_of(after).workingsteps
        assert other.technology_ref == Ref(41)
        assert mine.technology_ref != Ref(41)
        numbers = programmed(program_of(after), mine.technology_ref)
        assert (numbers.feed.value, numbers.speed.value) == (0.125, 750.0)

    @pytest.mark.parametrize("profile", PROFILES)
    def test_the_last_operation_keeps_the_instance(self, profile: FileProfile) -> None:
        program = program_of(two_operations())
        one, two = program.workingsteps
        data = writeback.write(
            program,
            [change_of(program, one, feed=0.125), change_of(program, two, feed=0.2)],
            profile,
        )
        after = program_of(data)
        assert [
            programmed(after, step.technology_ref).feed.value for step in after.workingsteps
        ] == [0.125, 0.2]
        assert after.workingsteps[1].technology_ref == Ref(41)
        assert len(after.file.ids_of("MILLING_TECHNOLOGY")) == 2

    def test_an_operation_that_two_run_plunges_at_the_lower_feed(self) -> None:
        program = program_of(part("paper002"))
        (step,) = program.workingsteps
        changes = [
            replace(change, record=replace(change.record, plunge_feed_per_tooth=plunge))
            for change, plunge in (
                (change_of(program, step, feed=0.125), 0.05),
                (change_of(program, step, feed=0.2), 0.025),
                (change_of(program, step, feed=0.3), None),
            )
        ]
        data = writeback.write(program, changes, FileProfile.OPTIMISATION)
        (record,) = writeback.records(program_of(data)).values()
        assert record.plunge_feed_per_tooth == 0.025

    def test_shared_machine_functions_stay_as_they_are(self) -> None:
        before = two_operations()
        after = write_first(before, FileProfile.STANDARD, feed=0.125)
        assert instances(after)[42] == instances(before)[42]
        assert program_of(after).workingsteps[1].functions_ref == Ref(42)

    def test_an_optimised_sample_keeps_the_numbers_of_those_not_asked_for(
        self, tmp_path: Path
    ) -> None:
        source, output = tmp_path / "in.stpnc", tmp_path / "out.stpnc"
        source.write_bytes(part("bracket"))
        optimise(*asked_advice(file=source, output=output, workingsteps=("ROUGH CONTOUR",)))
        before, after = program_of(part("bracket")), program_of(output.read_bytes())
        for old, new in zip(before.workingsteps, after.workingsteps, strict=True):
            told = programmed(before, old.technology_ref), programmed(after, new.technology_ref)
            same = told[0].feed.value == told[1].feed.value
            assert same == (old.id != "ROUGH CONTOUR")

    def test_an_adaptive_technology_is_edited_in_its_own_instances(self) -> None:
        before = part("paper002").replace(TECHNOLOGY, ADAPTIVE)
        edits = changed(before, write_first(before, feed=0.125, speed=0.75))
        assert edits.keys() == {46, 47}
        assert edits[46] == b"#46=CUTSPEED(.T.,0.75);"
        assert edits[47] == b"#47=FEEDRATE_PER_TOOTH(.T.,0.125);"
