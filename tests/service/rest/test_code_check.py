"""NC code is checked in a process of its own, within a time limit."""

import json
from pathlib import Path

import pytest

import stepnc
from service.rest.code_check import checked_code
from stepnc_model.errors import StepNcError
from tests.service.rest.samples import CODE

ENDLESS = b"o1 repeat [1000000000]\nG1 X1 F100\nG1 X0\no1 endrepeat\nM2\n"
DEEP = b"O1\nM98 P1 L99999\nM30\n"


def stored(folder: Path, data: bytes) -> Path:
    """A file whose name says nothing."""
    file = folder / "01.stpnc"
    file.write_bytes(data)
    return file


def test_the_check_is_that_of_the_command_line(tmp_path: Path) -> None:
    file = stored(tmp_path, CODE)
    found = json.loads(checked_code(file, name="plate ü.nc"))
    assert found == stepnc.check(file, name="plate ü.nc").record()
    assert found["program"] == "plate ü.nc"


def test_code_that_cannot_be_executed_is_refused_by_its_name(tmp_path: Path) -> None:
    with pytest.raises(StepNcError, match=r"^plate\.nc: line 2: .* nested more than"):
        checked_code(stored(tmp_path, DEEP), name="plate.nc")


def test_a_check_without_end_is_ended(tmp_path: Path) -> None:
    with pytest.raises(StepNcError, match="takes longer than 1 s"):
        checked_code(stored(tmp_path, ENDLESS), name="plate.nc", longest=1.0)
