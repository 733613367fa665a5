"""Tools that one may be of which something is guessed."""

from math import pi

import pytest

from simulator.library import load_material
from simulator.removal.cutter import Cutter
from simulator.spec import CuttingMaterial, ToolKind
from simulator.tools.plausible_tools import ToolGuess, ToolUse, plausible_tools
from simulator.tools.tool_table import TableTool, ToolRow, tool_of_row

C45 = load_material("c45")
TOOL = tool_of_row(ToolRow(number=1, kind=ToolKind.ENDMILL, diameter_mm=10.0, teeth=3))
FAST = ToolUse(speed=5000.0 / 60.0)


def edge_lengths(tools: tuple[TableTool, ...]) -> set[float]:
    """Lengths of their edges, mm."""
    return {tool.shape.edge_length for tool in tools if isinstance(tool.shape, Cutter)}


def test_the_fewest_teeth_come_first() -> None:
    found = plausible_tools(TOOL, ToolGuess(has_teeth=True), FAST, C45)
    assert found[0].teeth == 2
    assert {tool.teeth for tool in found} == {2, 3, 6}


def test_teeth_that_a_comment_names_are_no_guess() -> None:
    found = plausible_tools(TOOL, ToolGuess(), FAST, C45)
    assert {tool.teeth for tool in found} == {3}


@pytest.mark.parametrize(("speed", "is_plausible"), [(0.0, True), (60.0, True), (150.0, False)])
def test_a_cutting_speed_that_no_high_speed_steel_stands_rules_it_out(
    speed: float, *, is_plausible: bool
) -> None:
    use = ToolUse(speed=speed / 0.06 / (pi * 10.0))
    found = plausible_tools(TOOL, ToolGuess(has_edge=True), use, C45)
    edges = {tool.cutting_material for tool in found}
    assert (CuttingMaterial.HSS in edges) is is_plausible


def test_deep_cuts_need_long_tools() -> None:
    usual = edge_lengths(plausible_tools(TOOL, ToolGuess(), FAST, C45))
    deep = edge_lengths(plausible_tools(TOOL, ToolGuess(), ToolUse(depth=60.0), C45))
    assert min(usual) == pytest.approx(40.0)
    assert min(deep) == pytest.approx(60.0)
