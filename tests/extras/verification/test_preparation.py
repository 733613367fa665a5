"""Programs prepared for verification."""

from dataclasses import replace
from pathlib import Path

import pytest

from extras.verification.preparation import with_tools
from simulator.removal.cutter import Cutter
from stepnc_model.errors import StepNcError
from tests.extras.verification.runs import program, shaft

TABLE = '[[tool]]\nnumber = {}\nkind = "endmill"\ndiameter_mm = 10.1\ncorner_radius_mm = 0.2\n'


def test_workingsteps_have_their_features_and_tools() -> None:
    found = program()
    assert found.steps[7].workingstep == "FINISH POCKET"
    assert found.steps[7].feature == "POCKET"
    assert found.names.tool_of[7] == 4
    assert not found.is_turned
    assert shaft().is_turned


def test_measured_tools_replace_those_of_the_program(tmp_path: Path) -> None:
    path = tmp_path / "tools.toml"
    path.write_text(TABLE.format(4), encoding="utf-8")
    cutter = with_tools(program(), path).cutters[4]
    assert isinstance(cutter, Cutter)
    assert cutter.diameter == 10.1


def test_tools_of_another_kind_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "tools.toml"
    path.write_text(TABLE.format(1), encoding="utf-8")
    with pytest.raises(StepNcError, match="another kind of tool"):
        with_tools(shaft(), path)
    path.write_text(TABLE.format(40), encoding="utf-8")
    with pytest.raises(StepNcError, match="T40 is not in the program"):
        with_tools(replace(program()), path)
