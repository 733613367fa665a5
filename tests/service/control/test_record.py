"""Runs under control go to the knowledge base that is named, and to none else."""

from pathlib import Path

import pytest

from kbe.queries import EVERYTHING
from service.control.record import control_recorded
from service.knowledge.verbs import newest
from tests.asking import AskedControl, asked_control

PART = Path(__file__).parents[3] / "examples" / "parts" / "paper002.stpnc"


def request(**more: object) -> AskedControl:
    return asked_control(PART, machine="vmc15", material="c45", **more)  # type: ignore[arg-type]


def test_a_run_is_recorded_where_a_knowledge_base_is_named(tmp_path: Path) -> None:
    place, told = str(tmp_path / "knowledge.db"), list[str]()
    words = ("kc:1.1",)
    control_recorded(*request(disturbances=words), knowledge=place, by="Ada", tell=told.append)
    found = newest(place, EVERYTHING, limit=10)
    assert found.total == 1
    assert found.outcomes[0].recorded_by == "Ada, virtual machine, kc:1.1"
    assert told[-1] == f"recorded: 1 outcome, run {found.outcomes[0].run}"
    # The same run with the same seed says nothing new, also when somebody else asks for it.
    control_recorded(*request(disturbances=words), knowledge=place, by="Bob", tell=told.append)
    assert newest(place, EVERYTHING, limit=10) == found
    assert "already recorded: 1 of 1" in told[-1]


def test_without_one_nothing_is_recorded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("STEPNC_KB", raising=False)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    told: list[str] = []
    control_recorded(*request(), tell=told.append)
    assert not list(tmp_path.iterdir())
    assert not any("recorded" in line for line in told)


def test_a_run_that_was_stopped_is_not(tmp_path: Path) -> None:
    place = str(tmp_path / "knowledge.db")
    run = control_recorded(*request(disturbances=("tooth:1@20s",)), knowledge=place)
    assert run.is_stopped
    assert not Path(place).exists()
