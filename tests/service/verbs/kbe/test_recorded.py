"""What a program holds of runs and corrections, read back by the command."""

import json
from datetime import timedelta
from pathlib import Path

import pytest

from kbe.store import open_store
from service.cli.main import main
from stepnc_model.units import mm_min_from_speed, um_from_mm
from tests.kbe.conftest import NOON, PROPOSAL
from tests.service.verbs.kbe.test_written import MEASURED, PART, write_back


@pytest.fixture
def recorded(tmp_path: Path) -> Path:
    """The sample with a run and an accepted correction."""
    place, output = str(tmp_path / "kb.db"), tmp_path / "out.stpnc"
    with open_store(place) as store:
        store.add([MEASURED])
        store.accept(store.propose(PROPOSAL), by="Ada", at=NOON + timedelta(hours=1))
    write_back(place, PART, output=output)
    return output


def read(file: Path, *words: str) -> int:
    """Exit code of ``stepnc kbe read``."""
    with pytest.raises(SystemExit) as stopped:
        main(["kbe", "read", str(file), *words])
    code = stopped.value.code
    assert isinstance(code, int)
    return code


def test_what_was_written_is_read(recorded: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert read(recorded, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    (outcome,) = found["outcomes"]
    assert outcome["workingsteps"] == [MEASURED.workingstep]
    assert outcome["measured_at"] == MEASURED.recorded_at.isoformat()
    assert outcome["force_n"] == MEASURED.force.measured
    feed, roughness = MEASURED.feed.measured, MEASURED.roughness.measured
    assert feed is not None
    assert outcome["feed_mm_min"] == pytest.approx(mm_min_from_speed(feed))
    expected = None if roughness is None else pytest.approx(um_from_mm(roughness))
    assert outcome["roughness_um"] == expected
    (correction,) = found["corrections"]
    assert (correction["tool"], correction["accepted_by"]) == (PROPOSAL.context.tool, "Ada")


def test_a_table_names_workingstep_and_factor(
    recorded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert read(recorded) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "1 outcome, 1 correction"
    assert any(MEASURED.workingstep in line for line in lines)
    assert any("Ada" in line for line in lines)


def test_a_program_without_any_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert read(PART) == 0
    assert capsys.readouterr().out == "0 outcomes, 0 corrections\n"
