"""Records that are damaged or another program's are never ours, and never lost."""

from pathlib import Path

import pytest

from service.usecases import Request, optimise
from stepnc_model import writeback
from stepnc_model.part21.reader import Part21File
from stepnc_model.program import Program
from stepnc_model.record_edit import has_parameters
from stepnc_model.writeback import Profile

PAPER002 = Path(__file__).parents[2] / "examples" / "parts" / "paper002.stpnc"
FIG11 = Path(__file__).parents[1] / "data" / "fig11.stpnc"


def optimised(profile: Profile, folder: Path) -> bytes:
    output = folder / "out.stpnc"
    request = Request(file=PAPER002, output=output, machine="paper002", profile=profile.value)
    optimise(request)
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
    data = optimised(Profile.STANDARD, tmp_path)
    assert old in data
    damaged = data.replace(old, new)
    assert writeback.records(program_of(damaged)) == {}
    assert writeback.convert(program_of(damaged), Profile.OPTIMISATION) == damaged


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
    data = optimised(Profile.OPTIMISATION, tmp_path)
    assert old in data
    damaged = data.replace(old, new)
    assert writeback.records(program_of(damaged)) == {}
    assert writeback.convert(program_of(damaged), Profile.STANDARD) == damaged


def test_what_paper_002_prints_is_not_converted_away() -> None:
    data = FIG11.read_bytes()
    assert writeback.convert(program_of(data), Profile.STANDARD) == data


@pytest.mark.parametrize("profile", Profile)
def test_only_profile_standard_has_parameters(profile: Profile, tmp_path: Path) -> None:
    program = program_of(optimised(profile, tmp_path))
    assert has_parameters(program) is (profile is Profile.STANDARD)
    assert not has_parameters(program_of(PAPER002.read_bytes()))
