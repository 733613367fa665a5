"""A tool of another diameter: that of the one milling tool, and of no other."""

from pathlib import Path

import pytest

from stepnc_model.editing.cut_settings import with_tool_diameter
from stepnc_model.entities.tools import MillingCuttingTool
from stepnc_model.errors import SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.programs.tool import tool_of
from tests.every_case import every_case

PARTS = Path(__file__).parents[2] / "examples" / "parts"


def test_the_milling_tool_gets_another_diameter() -> None:
    program = Program.load(PARTS / "paper003_pocket.stpnc")
    changed = with_tool_diameter(program, 6.5)
    before, after = (
        tool_of(each, each.workingsteps[0].tool_ref) for each in (program, changed)
    )
    assert (before.diameter, after.diameter) == (8.0, 6.5)
    assert (after.teeth, after.id, after.cutting_edge_length) == (4, "END MILL 8MM", 20.0)
    assert changed.name == program.name


def test_a_tool_that_shares_its_dimension_keeps_it() -> None:
    text = (PARTS / "paper003_pocket.stpnc").read_text(encoding="utf-8")
    other = "#60=MILLING_CUTTING_TOOL('SPARE',#61,(#53),65.,$,$);\n"
    other += "#61=TAPERED_ENDMILL(#52,4,.RIGHT.,.F.,$,$);\n/* ---"
    file = Part21File.from_bytes(text.replace("/* ---", other, 1).encode(), name="two.stpnc")
    changed = with_tool_diameter(Program(file, name="two.stpnc"), 6.0)
    diameters = {
        tool.its_id: tool_of(changed, ref).diameter
        for ref, tool in changed.model.of_type(MillingCuttingTool)
    }
    assert diameters == {"END MILL 8MM": 6.0, "SPARE": 8.0}


@every_case(
    ("part", "diameter", "message"),
    [
        ("bracket", 8.0, r"needs a program that mills with one tool, not 'FACE MILL 63MM', "),
        ("shaft", 8.0, "needs a program that mills with one tool, not none"),
        ("paper003_pocket", 3000.0, "diameter 3000.0 mm: it must be positive"),
    ],
)
def test_what_is_not_possible_is_refused(part: str, diameter: float, message: str) -> None:
    program = Program.load(PARTS / f"{part}.stpnc")
    with pytest.raises(SchemaError, match=message):
        with_tool_diameter(program, diameter)
