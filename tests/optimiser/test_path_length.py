"""Explicit tool paths are as long as their curves."""

from pathlib import Path

import pytest

from optimiser.cuts.feature_estimate import path_length
from stepnc_model.entities.operations import ToolpathList
from stepnc_model.programs.program import Program

CORPUS = Path(__file__).parents[3] / "shared" / "corpus" / "iso14649"
PARTS = Path(__file__).parents[2] / "examples" / "parts"


def test_rapid_moves_do_not_count_as_cutting() -> None:
    """Example 3: the tool cuts 3 mm, from -48 to -45; everything else is run at rapid."""
    path = CORPUS / "EXAMPLE3.stp"
    if not path.exists():
        pytest.skip("the corpus is not beside the project")
    program = Program.load(path)
    ((ref, _),) = program.model.of_type(ToolpathList)
    assert path_length(program, ref) == pytest.approx(3.0)


def test_a_part_without_paths_has_none() -> None:
    program = Program.load(PARTS / "bracket.stpnc")
    assert list(program.model.of_type(ToolpathList)) == []
