"""The optimum goes into the file, and nothing else of the file changes."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from service.usecases import Request, convert, optimise
from stepnc_model import writeback
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program, Workingstep
from stepnc_model.record import PREFIX, Record
from stepnc_model.record_edit import RECORD_KEYWORDS
from stepnc_model.technology import programmed
from stepnc_model.writeback import SCHEMA, Change, Profile

PARTS = Path(__file__).parents[2] / "examples" / "parts"
EX1 = Path(__file__).parents[3] / "shared" / "corpus" / "iso14649" / "ex1.stp"

PARTS_NAMES = ("bracket", "paper002", "shaft")
PROFILES = tuple(Profile)
BOTH_WAYS = (PROFILES, PROFILES[::-1])

RECORD = Record(
    mode="TC",
    id="OP",
    description="as fast as it goes",
    machine="vmc15",
    material="c45",
    generator="stepnc-optimiser",
    active_limit="motor power",
    number_of_passes=1,
    feed_per_tooth=0.1,
    axial_depth=3.0,
    machine_power=7.5,
    cutting_power=4.0,
    spindle_speed=-10.0,
    specific_cutting_resistance=2000.0,
    machining_time=30.0,
    motor_power=5.0,
    cutting_force=800.0,
    energy=1e5,
    programmed_cutspeed=0.58,
    programmed_feedrate_per_tooth=0.05,
)

OPERATION = (
    b"#40=PLANE_ROUGH_MILLING($,$,'ROUGH THE FACE',10.,$,#50,#41,#42,$,#43,#43,#44,3.,0.);"
)
SECOND = OPERATION.replace(b"#40=", b"#45=")
TECHNOLOGY = b"#41=MILLING_TECHNOLOGY($,.TCP.,0.583333333333333,$,0.05,.F.,.F.,.F.,$);"
ADAPTIVE = (
    b"#41=MILLING_TECHNOLOGY(#46,#47,.F.,.F.,.F.);\n"
    b"#46=CUTSPEED(.T.,0.58);\n#47=FEEDRATE_PER_TOOTH(.T.,0.05);"
)


def part(name: str) -> bytes:
    return (PARTS / f"{name}.stpnc").read_bytes()


def ex1() -> bytes:
    if not EX1.exists():
        pytest.skip("ex1.stp is not beside the project")
    return EX1.read_bytes()


def two_operations() -> bytes:
    """Paper 002's part, with a second operation that shares tool, technology, functions."""
    data = part("paper002")
    data = data.replace(b"(#3),$,#20,$", b"(#3,#4),$,#20,$")
    steps = b"#3=MACHINING_WORKINGSTEP('ROUGH THE FACE',#22,#30,#40,$);"
    data = data.replace(steps, steps + b"\n#4=MACHINING_WORKINGSTEP('AGAIN',#22,#30,#45,$);")
    return data.replace(OPERATION, OPERATION + b"\n" + SECOND)


def program_of(data: bytes) -> Program:
    return Program(Part21File.from_bytes(data))


def optimised(data: bytes, folder: Path, profile: Profile, **options: str) -> bytes:
    """What ``optimise`` makes of a file."""
    source, output = folder / "in.stpnc", folder / "out.stpnc"
    source.write_bytes(data)
    optimise(Request(file=source, output=output, profile=profile.value, **options))  # type: ignore[arg-type]
    return output.read_bytes()


def converted(data: bytes, profile: Profile) -> bytes:
    return writeback.convert(program_of(data), profile)


def change_of(
    program: Program,
    step: Workingstep,
    *,
    feed: float | None = None,
    speed: float | None = None,
    depth: float | None = None,
) -> Change:
    conditions = programmed(program, step.technology_ref)
    return Change(
        workingstep=step,
        programmed=conditions,
        record=RECORD,
        feed=conditions.feed.in_file(conditions.feed.value) if feed is None else feed,
        speed=speed,
        depth=depth,
    )


def write_first(data: bytes, profile: Profile = Profile.STANDARD, **numbers: float) -> bytes:
    """Change of the first workingstep alone."""
    program = program_of(data)
    change = change_of(program, program.workingsteps[0], **numbers)
    return writeback.write(program, [change], profile)


def instances(data: bytes) -> dict[int, bytes]:
    """Text of every instance."""
    file = Part21File.from_bytes(data)
    return {id: data[slice(*file.span(id))] for id in file.ids()}


def changed(before: bytes, after: bytes) -> dict[int, bytes]:
    """Instances of the input that have another text in the output."""
    old, new = instances(before), instances(after)
    return {id: new[id] for id, text in old.items() if new[id] != text}


def added(before: bytes, after: bytes) -> dict[int, bytes]:
    old = instances(before)
    return {id: text for id, text in instances(after).items() if id not in old}


def without_functions(text: bytes) -> bytes:
    """An operation with its eighth parameter, the machine functions, left out."""
    parameters = text.split(b",")
    return b",".join([*parameters[:7], *parameters[8:]])


def untouched_lines(before: bytes, after: bytes) -> list[bytes]:
    """Lines of the input that belong to no edited instance."""
    file = Part21File.from_bytes(before)
    spans = [file.span(id) for id in changed(before, after)]
    lines, place = [], 0
    for line in before.splitlines(keepends=True):
        end = place + len(line)
        if not any(start < end and place < stop for start, stop in spans):
            lines.append(line)
        place = end
    return lines


def stand_in_order(lines: list[bytes], data: bytes) -> bool:
    """Whether all lines are there, in order."""
    rest: Iterator[bytes] = iter(data.splitlines(keepends=True))
    return all(line in rest for line in lines)


class TestConversion:
    @pytest.mark.parametrize("name", PARTS_NAMES)
    @pytest.mark.parametrize(("profile", "other"), BOTH_WAYS)
    def test_there_and_back_gives_the_same_bytes(
        self, name: str, profile: Profile, other: Profile, tmp_path: Path
    ) -> None:
        data = optimised(part(name), tmp_path, profile)
        there = converted(data, other)
        assert there != data
        assert converted(there, profile) == data

    @pytest.mark.parametrize(("profile", "other"), BOTH_WAYS)
    def test_ex1_there_and_back_gives_the_same_bytes(
        self, profile: Profile, other: Profile, tmp_path: Path
    ) -> None:
        data = optimised(ex1(), tmp_path, profile)
        assert converted(converted(data, other), profile) == data

    @pytest.mark.parametrize("name", PARTS_NAMES)
    @pytest.mark.parametrize(("profile", "other"), BOTH_WAYS)
    def test_conversion_gives_what_the_other_profile_would_have_written(
        self, name: str, profile: Profile, other: Profile, tmp_path: Path
    ) -> None:
        data = optimised(part(name), tmp_path, profile)
        assert converted(data, other) == optimised(part(name), tmp_path, other)

    @pytest.mark.parametrize("name", PARTS_NAMES)
    @pytest.mark.parametrize("profile", PROFILES)
    def test_into_the_same_profile_gives_the_same_bytes(
        self, name: str, profile: Profile, tmp_path: Path
    ) -> None:
        data = optimised(part(name), tmp_path, profile)
        assert converted(data, profile) == data

    @pytest.mark.parametrize("name", PARTS_NAMES)
    @pytest.mark.parametrize(("profile", "other"), BOTH_WAYS)
    def test_the_records_stay_the_same(
        self, name: str, profile: Profile, other: Profile, tmp_path: Path
    ) -> None:
        data = optimised(part(name), tmp_path, profile)
        records = writeback.records(program_of(data))
        assert records
        assert writeback.records(program_of(converted(data, other))) == records

    @pytest.mark.parametrize("name", PARTS_NAMES)
    def test_both_profiles_write_the_same_records(self, name: str, tmp_path: Path) -> None:
        one, two = (
            writeback.records(program_of(optimised(part(name), tmp_path, profile)))
            for profile in PROFILES
        )
        assert one == two

    @pytest.mark.parametrize("profile", PROFILES)
    def test_a_file_without_records_keeps_its_bytes(self, profile: Profile) -> None:
        for name in PARTS_NAMES:
            assert converted(part(name), profile) == part(name)

    def test_the_verb_writes_what_the_model_converts(self, tmp_path: Path) -> None:
        data = optimised(part("paper002"), tmp_path, Profile.OPTIMISATION)
        target = tmp_path / "standard.stpnc"
        convert(tmp_path / "out.stpnc", profile="standard", output=target)
        assert target.read_bytes() == converted(data, Profile.STANDARD)


class TestAgain:
    @pytest.mark.parametrize("name", PARTS_NAMES)
    @pytest.mark.parametrize("profile", PROFILES)
    @pytest.mark.parametrize("mode", ["TC", "EC"])
    def test_optimising_twice_gives_the_same_bytes(
        self, name: str, profile: Profile, mode: str, tmp_path: Path
    ) -> None:
        once = optimised(part(name), tmp_path, profile, mode=mode)
        assert optimised(once, tmp_path, profile, mode=mode) == once

    @pytest.mark.parametrize("profile", PROFILES)
    def test_ex1_twice_gives_the_same_bytes(self, profile: Profile, tmp_path: Path) -> None:
        once = optimised(ex1(), tmp_path, profile)
        assert optimised(once, tmp_path, profile) == once

    @pytest.mark.parametrize("profile", PROFILES)
    def test_writing_the_same_advice_twice_gives_the_same_bytes(self, profile: Profile) -> None:
        for name in PARTS_NAMES:
            once = write_first(part(name), profile, feed=0.07)
            assert write_first(once, profile, feed=0.07) == once

    @pytest.mark.parametrize("name", PARTS_NAMES)
    @pytest.mark.parametrize("profile", PROFILES)
    @pytest.mark.parametrize("again", PROFILES)
    def test_the_first_programmed_values_survive(
        self, name: str, profile: Profile, again: Profile, tmp_path: Path
    ) -> None:
        once = optimised(part(name), tmp_path, profile, mode="TC")
        twice = optimised(once, tmp_path, again, mode="EC")
        first, last = (writeback.records(program_of(data)) for data in (once, twice))
        assert first.keys() == last.keys()
        for id, record in first.items():
            assert last[id].mode == "EC"
            assert _programmed(last[id]) == _programmed(record)

    def test_the_first_programmed_values_are_those_of_the_file(self, tmp_path: Path) -> None:
        data = optimised(part("paper002"), tmp_path, Profile.OPTIMISATION)
        (record,) = writeback.records(program_of(data)).values()
        assert record.programmed_cutspeed == pytest.approx(0.583333333333333, rel=1e-14)
        assert record.programmed_feedrate_per_tooth == 0.05
        assert record.programmed_axial_depth == 3.0
        assert (record.programmed_feedrate, record.programmed_spindle) == (None, None)

    def test_a_record_takes_the_place_of_the_old_one(self) -> None:
        once = write_first(part("paper002"), Profile.OPTIMISATION, feed=0.07)
        twice = write_first(once, Profile.OPTIMISATION, feed=0.08)
        assert len(instances(twice)) == len(instances(once))
        file = Part21File.from_bytes(twice)
        assert len(file.ids_of("TIME_CRITICAL_OPTIMISATION")) == 1
        assert file.schemas.count(SCHEMA) == 1


def _programmed(record: Record) -> tuple[float | None, ...]:
    return (
        record.programmed_feedrate,
        record.programmed_feedrate_per_tooth,
        record.programmed_cutspeed,
        record.programmed_spindle,
        record.programmed_axial_depth,
    )


class TestOnlyWhatChanges:
    def test_ex1_differs_in_edited_and_added_instances_only(self, tmp_path: Path) -> None:
        before = ex1()
        after = optimised(before, tmp_path, Profile.STANDARD)
        file = Part21File.from_bytes(before)
        allowed = {"MILLING_TECHNOLOGY"}
        for id, text in changed(before, after).items():
            keyword = file.keyword(id)
            assert keyword in allowed or keyword.endswith(("MILLING", "DRILLING", "REAMING"))
            assert text.startswith(b"#%d= %s(" % (id, keyword.encode()))
        assert instances(before).keys() < instances(after).keys()
        assert min(added(before, after)) > max(instances(before))

    @pytest.mark.parametrize("profile", PROFILES)
    def test_ex1_keeps_its_lines_and_comments_in_order(
        self, profile: Profile, tmp_path: Path
    ) -> None:
        before = ex1()
        after = optimised(before, tmp_path, profile)
        lines = untouched_lines(before, after)
        assert len(lines) > 150
        if profile is Profile.OPTIMISATION:
            lines = [line for line in lines if not line.startswith(b"FILE_SCHEMA")]
        assert stand_in_order(lines, after)

    @pytest.mark.parametrize("name", PARTS_NAMES)
    def test_a_standard_file_keeps_every_line_that_is_not_edited(
        self, name: str, tmp_path: Path
    ) -> None:
        before = part(name)
        after = optimised(before, tmp_path, Profile.STANDARD)
        assert stand_in_order(untouched_lines(before, after), after)

    @pytest.mark.parametrize("name", PARTS_NAMES)
    @pytest.mark.parametrize("profile", PROFILES)
    def test_what_is_added_stands_at_the_end(
        self, name: str, profile: Profile, tmp_path: Path
    ) -> None:
        before = part(name)
        after = optimised(before, tmp_path, profile)
        file = Part21File.from_bytes(after)
        new = added(before, after)
        assert list(file.ids())[-len(new) :] == sorted(new)
        assert after.endswith(b"\nENDSEC;\nEND-ISO-10303-21;\n")

    def test_only_the_technology_changes_when_only_the_feed_changes(self) -> None:
        before = part("paper002")
        after = write_first(before, Profile.STANDARD, feed=0.125)
        edits = changed(before, after)
        operation = edits.pop(40)
        assert without_functions(operation) == without_functions(OPERATION)
        assert edits == {41: TECHNOLOGY.replace(b",0.05,", b",0.125,")}

    def test_the_entities_are_one_surplus_parameter_of_the_operation(self) -> None:
        before = part("paper002")
        after = write_first(before, Profile.OPTIMISATION, feed=0.125)
        edits = changed(before, after)
        assert re.fullmatch(re.escape(OPERATION[:-2]) + rb", ?#\d+\);", edits.pop(40))
        assert list(edits) == [41]

    @pytest.mark.parametrize("profile", PROFILES)
    def test_an_advice_of_the_programmed_numbers_edits_no_technology(
        self, profile: Profile
    ) -> None:
        before = part("paper002")
        assert list(changed(before, write_first(before, profile))) == [40]

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
    def test_crlf_is_kept(self, profile: Profile, tmp_path: Path) -> None:
        before = part("paper002").replace(b"\n", b"\r\n")
        after = optimised(before, tmp_path, profile)
        assert after.count(b"\n") == after.count(b"\r\n") > before.count(b"\r\n")
        plain = optimised(part("paper002"), tmp_path, profile)
        assert after.replace(b"\r\n", b"\n") == plain


class TestForbidden:
    @pytest.mark.parametrize("profile", PROFILES)
    @pytest.mark.parametrize(
        ("name", "ids"),
        [("bracket", (214, 215, 312)), ("shaft", (205, 304, 313, 355))],
        ids=["reamed holes", "thread"],
    )
    def test_an_inhibited_feed_stays_byte_for_byte(
        self, profile: Profile, name: str, ids: tuple[int, ...], tmp_path: Path
    ) -> None:
        before = part(name)
        after = optimised(before, tmp_path, profile)
        old, new = instances(before), instances(after)
        assert [new[id] for id in ids] == [old[id] for id in ids]
        assert not writeback.records(program_of(after)).keys() & set(ids)

    def test_a_feed_that_may_not_adapt_stays_byte_for_byte(self, tmp_path: Path) -> None:
        shared = two_operations()
        forbidden = ADAPTIVE.replace(b"#41=", b"#48=").replace(b"#46", b"#98")
        forbidden = forbidden.replace(b"#47", b"#99").replace(b"TOOTH(.T.", b"TOOTH(.F.")
        own = SECOND.replace(b"#50,#41", b"#50,#48")
        before = shared.replace(SECOND, own + b"\n" + forbidden)
        after = optimised(before, tmp_path, Profile.STANDARD)
        old, new = instances(before), instances(after)
        assert 40 in changed(before, after)
        assert [new[id] for id in (45, 48, 98, 99)] == [old[id] for id in (45, 48, 98, 99)]


class TestShared:
    @pytest.mark.parametrize("profile", PROFILES)
    def test_the_other_operation_keeps_its_numbers(self, profile: Profile) -> None:
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
    def test_the_last_operation_keeps_the_instance(self, profile: Profile) -> None:
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

    def test_shared_machine_functions_stay_as_they_are(self) -> None:
        before = two_operations()
        after = write_first(before, Profile.STANDARD, feed=0.125)
        assert instances(after)[42] == instances(before)[42]
        assert program_of(after).workingsteps[1].functions_ref == Ref(42)

    def test_an_optimised_sample_keeps_the_numbers_of_those_not_asked_for(
        self, tmp_path: Path
    ) -> None:
        source, output = tmp_path / "in.stpnc", tmp_path / "out.stpnc"
        source.write_bytes(part("bracket"))
        optimise(Request(file=source, output=output, workingsteps=("ROUGH CONTOUR",)))
        before, after = program_of(part("bracket")), program_of(output.read_bytes())
        for old, new in zip(before.workingsteps, after.workingsteps, strict=True):
            told = programmed(before, old.technology_ref), programmed(after, new.technology_ref)
            same = told[0].feed.value == told[1].feed.value
            assert same == (old.id != "ROUGH CONTOUR")

    def test_an_adaptive_technology_is_edited_in_its_own_instances(self) -> None:
        before = part("paper002").replace(TECHNOLOGY, ADAPTIVE)
        edits = changed(before, write_first(before, feed=0.125, speed=0.75))
        assert edits.keys() == {40, 46, 47}
        assert edits[46] == b"#46=CUTSPEED(.T.,0.75);"
        assert edits[47] == b"#47=FEEDRATE_PER_TOOTH(.T.,0.125);"


class TestTurning:
    def test_the_depth_goes_to_the_strategy(self) -> None:
        program = program_of(part("shaft"))
        step = next(each for each in program.workingsteps if int(each.operation_ref) == 202)
        data = writeback.write(
            program, [change_of(program, step, depth=1.25)], Profile.STANDARD
        )
        edits = changed(part("shaft"), data)
        assert edits.keys() == {202, 352}
        assert edits[352] == (
            b"#352=UNIDIRECTIONAL_TURNING(1.,.T.,(1.25),$,#504,#501,#502,#506,1.,$,$);"
        )

    def test_a_shared_strategy_is_copied_first(self) -> None:
        before = part("shaft").replace(b"#330,$,$,#351,0.);", b"#330,$,$,#350,0.);")
        assert before != part("shaft")
        program = program_of(before)
        data = writeback.write(
            program,
            [change_of(program, program.workingsteps[0], depth=1.25)],
            Profile.STANDARD,
        )
        assert instances(data)[350] == instances(before)[350]
        assert instances(data)[201] == instances(before)[201]
        copies = [text for text in added(before, data).values() if b"(1.25)" in text]
        assert len(copies) == 1

    def test_a_speed_goes_to_a_copy_of_the_shared_speed(self) -> None:
        before = part("shaft")
        program = program_of(before)
        data = writeback.write(
            program, [change_of(program, program.workingsteps[0], speed=2.0)], Profile.STANDARD
        )
        after = program_of(data)
        assert instances(data)[310] == instances(before)[310]
        speeds = [
            programmed(after, step.technology_ref).speed.value for step in after.workingsteps
        ]
        old = [
            programmed(program, step.technology_ref).speed.value
            for step in program.workingsteps
        ]
        assert speeds == [2000.0, *old[1:]]


class TestProfiles:
    @pytest.mark.parametrize("name", PARTS_NAMES)
    def test_standard_has_no_entities_of_the_optimisation(
        self, name: str, tmp_path: Path
    ) -> None:
        data = optimised(part(name), tmp_path, Profile.STANDARD)
        self.assert_standard(data, before=part(name))

    def test_ex1_as_standard_has_none_either(self, tmp_path: Path) -> None:
        self.assert_standard(optimised(ex1(), tmp_path, Profile.STANDARD), before=ex1())

    @staticmethod
    def assert_standard(data: bytes, *, before: bytes) -> None:
        file = Part21File.from_bytes(data)
        own = RECORD_KEYWORDS - {"NUMERIC_PARAMETER"}
        assert not [keyword for keyword in own if file.ids_of(keyword)]
        assert SCHEMA.encode() not in data
        assert file.schemas == Part21File.from_bytes(before).schemas
        assert writeback.records(program_of(data))

    @pytest.mark.parametrize("name", PARTS_NAMES)
    def test_an_operation_has_no_surplus_parameter_in_the_standard(
        self, name: str, tmp_path: Path
    ) -> None:
        data = optimised(part(name), tmp_path, Profile.STANDARD)
        before = Part21File.from_bytes(part(name))
        after = Part21File.from_bytes(data)
        for id in before.ids():
            assert len(after.parameters(id)) == len(before.parameters(id))

    @pytest.mark.parametrize("name", PARTS_NAMES)
    def test_standard_parameters_are_prefixed(self, name: str, tmp_path: Path) -> None:
        before = part(name)
        new = added(before, optimised(before, tmp_path, Profile.STANDARD)).values()
        parameters = [text for text in new if b"_PARAMETER(" in text]
        assert parameters
        assert all(f"('{PREFIX}".encode() in text for text in parameters)

    @pytest.mark.parametrize("name", PARTS_NAMES)
    def test_optimisation_names_its_schema_last(self, name: str, tmp_path: Path) -> None:
        data = optimised(part(name), tmp_path, Profile.OPTIMISATION)
        old = Part21File.from_bytes(part(name)).schemas
        assert Part21File.from_bytes(data).schemas == (*old, SCHEMA)

    @pytest.mark.parametrize("profile", PROFILES)
    @pytest.mark.parametrize("name", PARTS_NAMES)
    def test_what_is_written_has_no_new_warning(
        self, name: str, profile: Profile, tmp_path: Path
    ) -> None:
        after = program_of(optimised(part(name), tmp_path, profile))
        before = program_of(part(name))
        assert [each.message for each in after.findings()] == [
            each.message for each in before.findings()
        ]

    def test_a_process_model_of_the_file_is_kept(self) -> None:
        model = b"#96=PROCESS_MODEL_LIST((#97));\n#97=PROCESS_MODEL('mine.ini','force');\n"
        functions = b"#42=MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,$,$,());"
        with_model = functions.replace(b"$,());", b"#96,());")
        before = part("paper002").replace(functions, model + with_model)
        after = write_first(before, Profile.STANDARD, feed=0.125)
        assert len(Part21File.from_bytes(after).ids_of("PROCESS_MODEL")) == 1
        back = converted(converted(after, Profile.OPTIMISATION), Profile.OPTIMISATION)
        assert instances(back)[97] == b"#97=PROCESS_MODEL('mine.ini','force');"

    def test_other_functions_of_the_file_are_kept(self) -> None:
        functions = b"#42=MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,$,$,());"
        mine = functions.replace(b"());", b"(#96));") + b"\n#96=DESCRIPTIVE_PARAMETER('a','b');"
        before = part("paper002").replace(functions, mine)
        after = write_first(before, Profile.STANDARD, feed=0.125)
        program = program_of(after)
        (step,) = program.workingsteps
        assert step.functions_ref is not None
        other = program.file.parameters(int(step.functions_ref))[-1]
        assert isinstance(other, tuple)
        assert other[0] == Ref(96)
        back = converted(after, Profile.OPTIMISATION)
        assert b"#96=DESCRIPTIVE_PARAMETER('a','b');" in back
        assert instances(back)[42] == mine.split(b"\n")[0]

    def test_without_advice_nothing_is_written(self) -> None:
        for name in PARTS_NAMES:
            program = program_of(part(name))
            assert writeback.write(program, [], Profile.OPTIMISATION) == part(name)


def test_a_file_without_records_has_none() -> None:
    for name in PARTS_NAMES:
        assert writeback.records(program_of(part(name))) == {}


@pytest.mark.parametrize("number", [1 / 3, 1e-300, 123456789.123456789, -0.1])
def test_a_rounded_number_has_twelve_digits(number: float) -> None:
    assert writeback.rounded(number) == pytest.approx(number, rel=1e-11)
    assert writeback.rounded(writeback.rounded(number)) == writeback.rounded(number)
