"""Records that are damaged or another program's are never ours, and never lost."""

from pathlib import Path

import pytest

from service.usecases import optimise
from stepnc_model import writeback
from stepnc_model.file_profile import FileProfile
from stepnc_model.part21.reader import Part21File
from stepnc_model.program import Program
from stepnc_model.record_edit import has_parameters
from tests.asking import asked_advice

PAPER002 = Path(__file__).parents[2] / "examples" / "parts" / "paper002.stpnc"
FIG11 = Path(__file__).parents[1] / "data" / "fig11.stpnc"


def optimised(profile: FileProfile, folder: Path) -> bytes:
    output = folder / "out.stpnc"
    request = asked_advice(
        file=PAPER002, output=output, machine="paper002", profile=profile.value
    )
    optimise(*request)
    return output.read_bytes()


def program_of(data: bytes) -> Program:
    return Program(Part21File.from_bytes(data))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"'optimisation:machine_functions','#42'", b"'optimisation:machine_functions','#x'"),
        (b"'optimisation:machine_functions','#42'", b"'optimisation:machine_functions','#'"),
        (b"'optimisation:machine_functions','#42'", b"'optimisation:machine_functions','#50'"),
        (b"'optimisation:mode','TC'", b"'optimisation:mode','XX'"),
        (b"'optimisation:number_of_passes',1.", b"'optimisation:number_of_passes',1.E400"),
        (b"NUMERIC_PARAMETER('optimisation:machine_power',0.29,'kW')",
         b"DESCRIPTIVE_PARAMETER('optimisation:machine_power','much')"),
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
