"""A folder of outputs appears whole, whatever ends the run that writes it."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from service.outputs.staged_folder import staged_folder
from stepnc_model.errors import WriteError
from tests.service.waiting import ROOT, ended

KILLED = """
import os, signal, sys
from pathlib import Path
from service.outputs.staged_folder import staged_folder
with staged_folder(Path(sys.argv[1]), tell=print) as stage:
    (stage / "parts_1.csv").write_text("1")
    os.kill(os.getpid(), signal.SIGKILL)
"""


def content(folder: Path) -> dict[str, str]:
    return {each.name: each.read_text(encoding="utf-8") for each in sorted(folder.iterdir())}


def filled(folder: Path, told: list[str], **texts: str) -> None:
    with staged_folder(folder, tell=told.append) as stage:
        for name, text in texts.items():
            (stage / name).write_text(text, encoding="utf-8")
        if not folder.exists():
            assert [each.name for each in folder.parent.iterdir()] == [stage.name]


def test_a_killed_run_leaves_nothing_beside_the_next_one(tmp_path: Path) -> None:
    for folder in (tmp_path / "new", tmp_path):
        killed = subprocess.Popen([sys.executable, "-c", KILLED, str(folder)], cwd=ROOT)
        assert ended(killed) == -signal.SIGKILL
        told: list[str] = []
        filled(folder, told, parts="2")
        assert [each.endswith("has left it") for each in told[:1]] == [True]
        if folder != tmp_path:
            assert content(folder) == {"parts": "2"}
    assert sorted(each.name for each in tmp_path.iterdir()) == ["new", "parts"]


def test_files_of_others_stay_and_are_told(tmp_path: Path) -> None:
    told: list[str] = []
    (tmp_path / "shop.toml").write_text("mine", encoding="utf-8")
    (tmp_path / "parts.partial.csv").write_text("broken off", encoding="utf-8")
    filled(tmp_path, told, **{"parts.csv": "1"})
    filled(tmp_path, told, **{"parts.csv": "2"})
    assert content(tmp_path) == {"parts.csv": "2", "shop.toml": "mine"}
    assert ["shop.toml" in each for each in told] == [True, True]


def test_a_run_that_fails_leaves_what_it_has(tmp_path: Path) -> None:
    folder = tmp_path / "a" / "out"
    with pytest.raises(ValueError, match="x"), staged_folder(folder, tell=print):
        raise ValueError("x")
    assert not folder.exists()

    def interrupted() -> None:
        with staged_folder(folder, tell=print) as stage:
            (stage / "parts.partial.csv").write_text("1", encoding="utf-8")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert content(folder) == {"parts.partial.csv": "1"}


def test_a_stage_that_is_in_use_is_left(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    with staged_folder(folder, tell=print) as first:
        (first / "a").write_text("1", encoding="utf-8")
        with staged_folder(folder, tell=print) as second:
            (second / "b").write_text("2", encoding="utf-8")
        assert content(folder) == {"b": "2"}
    assert content(folder) == {"a": "1", "b": "2"}


def test_a_disk_that_refuses_is_named() -> None:
    with (
        pytest.raises(WriteError, match="/proc/nowhere"),
        staged_folder(Path("/proc/nowhere/out"), tell=print),
    ):
        pass
