"""Records that are damaged or another program's are never ours, and never lost."""

from dataclasses import replace
from pathlib import Path

import pytest

from service.verbs.optimise.program import advise_program as optimise
from stepnc_model.editing import writeback
from stepnc_model.editing.draft import references
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.editing.record_edit import has_parameters
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from tests.asking import asked_advice
from tests.every_case import every_case
from tests.stepnc_model.written import change_of, two_operations

PAPER002 = Path(__file__).parents[3] / "examples" / "parts" / "paper002.stpnc"
BEFORE = Path(__file__).parents[2] / "data" / "standard_before.stpnc"
FIG11 = Path(__file__).parents[2] / "data" / "fig11.stpnc"


def optimised(profile: FileProfile, folder: Path) -> bytes:
    output = folder / "out.stpnc"
    request = asked_advice(
        file=PAPER002, output=output, machine="paper002", profile=profile.value
    )
    optimise(*request)
    return output.read_bytes()


def program_of(data: bytes) -> Program:
    return Program(Part21File.from_bytes(data))


@every_case(
    ("old", "new"),
    [
        (b":1:ROUGH THE FACE'", b":2:ROUGH THE FACE'"),
        (b":1:ROUGH THE FACE'", b":1:ROUGH'"),
        (b"optimisation:mode:1", b"optimisation:mode:one"),
        (b"mode:1:ROUGH THE FACE','TC'", b"mode:1:ROUGH THE FACE','XX'"),
        (b"passes:1:ROUGH THE FACE',1.", b"passes:1:ROUGH THE FACE',1.E400"),
        (b"NUMERIC_PARAMETER('optimisation:machine_power:1:ROUGH THE FACE',0.29,'kW')",
         b"DESCRIPTIVE_PARAMETER('optimisation:machine_power:1:ROUGH THE FACE','much')"),
    ],
)  # fmt: skip
def test_damaged_parameters_are_no_record_and_stay(
    old: bytes, new: bytes, tmp_path: Path
) -> None:
    data = optimised(FileProfile.STANDARD, tmp_path)
    assert old in data
    damaged = data.replace(old, new)
    assert writeback.records(program_of(damaged)) == {}
    assert writeback.convert(program_of(damaged), FileProfile.OPTIMISATION) == damaged


class TestCopiedFunctions:
    """Earlier versions wrote the parameters into copies of machine functions."""

    def test_their_records_are_read(self) -> None:
        (record,) = writeback.records(program_of(BEFORE.read_bytes())).values()
        assert (record.mode, record.machine) == ("TC", "paper002")
        assert record.feed_per_tooth_max is None

    def test_they_become_entities_without_loss(self) -> None:
        old = program_of(BEFORE.read_bytes())
        data = writeback.convert(old, FileProfile.OPTIMISATION)
        assert writeback.records(program_of(data)) == writeback.records(old)
        assert b"optimisation:" not in data

    def test_they_become_parameters_that_nothing_refers_to(self) -> None:
        old = program_of(BEFORE.read_bytes())
        data = writeback.convert(old, FileProfile.STANDARD)
        assert writeback.records(program_of(data)) == writeback.records(old)
        assert_unreferenced(data)
        assert data.count(b"=MILLING_MACHINE_FUNCTIONS(") == 1
        assert b"PROCESS_MODEL" not in data

    @pytest.mark.parametrize("name", [b"'#x'", b"'#'", b"'#50'"])
    def test_damaged_ones_are_no_record_and_stay(self, name: bytes) -> None:
        old = b"'optimisation:machine_functions','#42'"
        data = BEFORE.read_bytes()
        assert old in data
        damaged = data.replace(old, b"'optimisation:machine_functions'," + name)
        assert writeback.records(program_of(damaged)) == {}
        assert writeback.convert(program_of(damaged), FileProfile.OPTIMISATION) == damaged


def assert_unreferenced(data: bytes) -> None:
    """No instance refers to a parameter of a record."""
    file = Part21File.from_bytes(data)
    ours = {
        int(ref)
        for refs in program_of(data).parameters_named("optimisation:").values()
        for ref in refs
    }
    assert ours
    for number in file.ids():
        assert not ours & {int(ref) for ref in references(file.parameters(number))}


class TestOutOfSight:
    def test_no_instance_refers_to_a_record(self, tmp_path: Path) -> None:
        data = optimised(FileProfile.STANDARD, tmp_path)
        assert_unreferenced(data)
        assert data.count(b"=MILLING_MACHINE_FUNCTIONS(") == 1
        assert b"PROCESS_MODEL" not in data

    def test_the_operation_stays_byte_for_byte(self, tmp_path: Path) -> None:
        before, after = PAPER002.read_bytes(), optimised(FileProfile.STANDARD, tmp_path)
        old, new = Part21File.from_bytes(before), Part21File.from_bytes(after)
        for keyword in ("PLANE_ROUGH_MILLING", "MILLING_MACHINE_FUNCTIONS"):
            (number,) = old.ids_of(keyword)
            assert before[slice(*old.span(number))] == after[slice(*new.span(number))]

    def test_workingsteps_of_one_name_are_told_apart(self) -> None:
        data = two_operations().replace(b"'AGAIN'", b"'ROUGH THE FACE'")
        program = program_of(data)
        changes = [
            change_of(program, step, feed=feed)
            for step, feed in zip(program.workingsteps, (0.1, 0.2), strict=True)
        ]
        changes = [
            replace(each, record=replace(each.record, energy=float(number)))
            for number, each in enumerate(changes)
        ]
        after = program_of(writeback.write(program, changes, FileProfile.STANDARD))
        energies = {number: each.energy for number, each in writeback.records(after).items()}
        assert energies == {40: 0.0, 45: 1.0}

    def test_without_records_there_are_none(self) -> None:
        program = program_of(PAPER002.read_bytes())
        change = change_of(program, program.workingsteps[0], feed=0.1)
        for profile in FileProfile:
            written = program_of(writeback.write(program, [change], profile))
            again = change_of(written, written.workingsteps[0], feed=0.1)
            data = writeback.write(written, [again], None)
            assert data == writeback.write(program, [change], None)
            assert writeback.records(program_of(data)) == {}

    def test_without_records_those_of_others_stay(self) -> None:
        program = program_of(FIG11.read_bytes())
        change = change_of(program, program.workingsteps[0], feed=0.03)
        data = writeback.write(program, [change], None)
        assert b"TIME_CRITICAL_OPTIMISATION('POCKET MACHINING'" in data


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"#100,#101,#99,", b"#100,#101,$,"),
        (b"OPTIMISATION_RECORD(1,", b"OPTIMISATION_RECORD($,"),
        (b"#100,#101,#99,", b"#100,$,#99,"),
        (b"#100,#101,#99,", b"#100,#90,#99,"),
    ],
)
def test_incomplete_entities_are_no_record_and_stay(
    old: bytes, new: bytes, tmp_path: Path
) -> None:
    data = optimised(FileProfile.OPTIMISATION, tmp_path)
    assert old in data
    damaged = data.replace(old, new)
    assert writeback.records(program_of(damaged)) == {}
    assert writeback.convert(program_of(damaged), FileProfile.STANDARD) == damaged


def test_what_paper_002_prints_is_not_converted_away() -> None:
    data = FIG11.read_bytes()
    assert writeback.convert(program_of(data), FileProfile.STANDARD) == data


@pytest.mark.parametrize("profile", FileProfile)
def test_only_profile_standard_has_parameters(profile: FileProfile, tmp_path: Path) -> None:
    program = program_of(optimised(profile, tmp_path))
    assert has_parameters(program) is (profile is FileProfile.STANDARD)
    assert not has_parameters(program_of(PAPER002.read_bytes()))
