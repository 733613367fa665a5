"""Outcomes and corrections of a knowledge base as entities of the program."""

from dataclasses import replace
from datetime import timedelta
from pathlib import Path

import pytest

from kbe.store import open_store
from service.programs.reading import read_program
from service.verbs.kbe.write.request import WriteFiles, WriteRequest
from service.verbs.kbe.write.result import WriteResult
from service.verbs.kbe.write.run import run as write
from stepnc_model.editing.outcome_record import read_outcomes
from stepnc_model.errors import StepNcError, WriteError
from tests.kbe.conftest import NOON, POCKET, PROPOSAL

PART = Path(__file__).parents[4] / "examples" / "parts" / "paper002.stpnc"
MEASURED = replace(POCKET, program=PART.name, workingstep="ROUGH THE FACE")


@pytest.fixture
def place(tmp_path: Path) -> str:
    """Two runs of the sample, one of another program, an accepted correction."""
    place = str(tmp_path / "kb.db")
    later = NOON + timedelta(days=1)
    with open_store(place) as store:
        again = replace(MEASURED, run="run-2", recorded_at=later)
        store.add([MEASURED, again, replace(POCKET, run="run-3")])
        store.accept(store.propose(PROPOSAL), by="Ada", at=NOON)
    return place


def write_back(place: str, file: Path, *, run: str = "", output: Path) -> WriteResult:
    """Write a run into a program."""
    return write(WriteRequest(run=run), WriteFiles(kb=place, file=file, output=output))


def test_the_newest_run_and_what_is_in_force_are_written(place: str, tmp_path: Path) -> None:
    output = tmp_path / "out.stpnc"
    done = write_back(place, PART, output=output)
    assert (done.run, done.outcomes, done.corrections) == ("run-2", 1, 1)
    recorded = read_outcomes(read_program(output, units="iso"))
    (outcome,) = recorded.outcomes
    assert outcome.force == MEASURED.force.measured
    assert outcome.feed == pytest.approx(MEASURED.feed.measured)
    assert outcome.time == MEASURED.time.measured
    assert recorded.corrections[0].accepted_by == "Ada"


def test_a_run_may_be_named(place: str, tmp_path: Path) -> None:
    done = write_back(place, PART, run="run-1", output=tmp_path / "out.stpnc")
    assert done.run == "run-1"


def test_every_byte_of_the_program_stays(place: str, tmp_path: Path) -> None:
    output = tmp_path / "out.stpnc"
    write_back(place, PART, output=output)
    lines = PART.read_bytes().splitlines()
    written = output.read_bytes().splitlines()
    changed = [line for line in lines if line not in written]
    assert all(line.startswith(b"FILE_SCHEMA") for line in changed)


def test_a_run_that_nobody_knows_is_refused(place: str, tmp_path: Path) -> None:
    output = tmp_path / "out.stpnc"
    with pytest.raises(StepNcError, match="no run 'none'; list runs with"):
        write_back(place, PART, run="none", output=output)
    with pytest.raises(StepNcError, match=r"no run of a program 'bracket\.stpnc'"):
        write_back(place, PART.with_name("bracket.stpnc"), output=output)
    assert not output.exists()


def test_a_run_of_another_program_is_refused(place: str, tmp_path: Path) -> None:
    with open_store(place) as store:
        store.add([replace(POCKET, run="other")])
    with pytest.raises(StepNcError, match="is not a workingstep of this program"):
        write_back(place, PART, run="other", output=tmp_path / "out.stpnc")


def test_the_program_itself_is_not_overwritten(place: str, tmp_path: Path) -> None:
    copy = tmp_path / PART.name
    copy.write_bytes(PART.read_bytes())
    with pytest.raises(WriteError):
        write_back(place, copy, output=copy)
    assert copy.read_bytes() == PART.read_bytes()
