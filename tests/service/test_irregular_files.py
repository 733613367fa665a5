"""A pipe, a device, a folder or a circular link in place of a file is refused, and at once."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from stepnc_model.regular_file import why_irregular
from tests.service import irregular_files
from tests.service.irregular_files import COMMANDS, cases

SEED = 21


def test_each_command_refuses_each_kind_of_file(tmp_path: Path) -> None:
    """One kind for each command by a seed; all of them: ``irregular_files.py FOLDER``."""
    done = subprocess.run(
        [sys.executable, irregular_files.__file__, str(tmp_path), str(SEED)],
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])},
        capture_output=True,
        text=True,
        timeout=120.0,
        check=False,
    )
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    found = [line for line in lines if "words" in line]
    last = lines[-1]
    assert len(found) == len(COMMANDS), f"hangs: {last}\n{done.stderr}"
    for each, case in zip(found, cases(SEED), strict=True):
        name = next(word for word in case.words if word.startswith(f"{case.kind}."))
        assert each["code"] == 3, each
        assert each["told"].count("error: ") == 1, each
        assert name in each["told"], each
        assert "Traceback" not in each["told"], each


@pytest.mark.parametrize("kind", ["pipe", "device", "folder"])
def test_the_kind_is_named(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "file"
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "device":
        path.symlink_to("/dev/zero")
    else:
        path.mkdir()
    assert why_irregular(path) == f"is a {kind}, not a regular file"


def test_what_is_regular_or_unknown_has_no_reason(tmp_path: Path) -> None:
    path = tmp_path / "file"
    assert why_irregular(path) == ""
    path.write_text("")
    assert why_irregular(path) == ""
