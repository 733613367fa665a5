"""Tools as the virtual machine holds them."""

from dataclasses import replace
from math import inf, pi
from pathlib import Path

import pytest

from simulator.library import find_window, load_material
from simulator.machine.tooling import loaded_tool, table_tool
from simulator.machine.virtual import LoadedTool
from simulator.removal.cutter import Cutter, Holder, Insert, profile_of
from simulator.spec import CuttingMaterial, ToolKind
from simulator.tools.tool_table import TableTool
from stepnc_model.post.neutral import tool_numbers
from stepnc_model.programs.program import Program
from stepnc_model.programs.tool import tool_of
from stepnc_model.programs.user_tools import GivenTool
from stepnc_model.toolpath.generate import generate
from stepnc_model.toolpath.path import ToolPath
from stepnc_model.units import rad_from_deg

PARTS = Path(__file__).parents[3] / "examples" / "parts"

STEEL = load_material("c45")


def tools_of(name: str, *, factor: float = 1.0) -> dict[str, LoadedTool]:
    program = Program.load(PARTS / f"{name}.stpnc")
    paths = [item for item in generate(program) if isinstance(item, ToolPath)]
    numbers = tool_numbers(paths)
    return {
        tool_of(program, ref).keyword: loaded_tool(program, ref, number, STEEL, factor=factor)
        for ref, number in numbers.items()
    }


def test_tools_of_a_mill_have_their_bodies() -> None:
    found = tools_of("bracket")
    drill = next(tool for keyword, tool in found.items() if "DRILL" in keyword)
    assert isinstance(drill.shape, Cutter)
    assert drill.shape.is_drill
    assert rad_from_deg(90.0) <= drill.shape.point_angle < pi
    mill = next(tool for keyword, tool in found.items() if keyword.endswith("ENDMILL"))
    assert isinstance(mill.shape, Cutter)
    assert not mill.shape.is_drill
    assert mill.shape.point_angle == pi
    for tool in found.values():
        assert tool.edge.kienzle == STEEL.kienzle
        if isinstance(tool.shape, Cutter):
            assert tool.shape.teeth == tool.edge.teeth
            # A shape that the map refuses would end the run.
            profile_of(tool.shape, reach=100.0)


def test_tools_of_a_lathe_have_inserts_and_threads_have_none() -> None:
    found = tools_of("shaft")
    assert isinstance(found["GENERAL_TURNING_TOOL"].shape, Insert)
    assert found["GENERAL_TURNING_TOOL"].edge.teeth == 1
    groove = found["GROOVING_TOOL"].shape
    assert isinstance(groove, Insert)
    assert groove.width is not None
    assert found["TURNING_THREADING_TOOL"].shape is None


def test_factor_of_calibration_multiplies_the_force() -> None:
    once, twice = tools_of("bracket"), tools_of("bracket", factor=1.5)
    for keyword, tool in once.items():
        assert twice[keyword].edge.factor == pytest.approx(1.5 * tool.edge.factor)


def table(kind: ToolKind, material: CuttingMaterial = CuttingMaterial.CARBIDE) -> TableTool:
    return TableTool(
        number=5,
        id="X",
        kind=kind,
        cutting_material=material,
        teeth=3,
        shape=Cutter(diameter=8.0, teeth=3),
    )


def test_tool_of_a_table_keeps_what_the_table_says() -> None:
    tool = table_tool(table(ToolKind.ENDMILL), STEEL)
    assert (tool.number, tool.id, tool.edge.teeth) == (5, "X", 3)
    assert tool.shape == Cutter(diameter=8.0, teeth=3)
    window = find_window(STEEL, ToolKind.ENDMILL, CuttingMaterial.CARBIDE)
    assert window is not None
    assert tool.taylor == window.taylor
    assert isinstance(tool.shape, Cutter)
    assert tool.shape.edge_length == inf


def test_high_speed_steel_cuts_harder_than_carbide() -> None:
    """K_v: 1.2 to 1.0."""
    kinds = (CuttingMaterial.HSS, CuttingMaterial.CARBIDE)
    hss, carbide = (
        table_tool(table(ToolKind.DRILL, kind), STEEL).edge.factor for kind in kinds
    )
    assert hss > carbide


def test_a_constant_k_s_of_a_textbook_has_no_correction() -> None:
    book = replace(STEEL, iso_group="", kienzle=replace(STEEL.kienzle, m_c=0.0))
    tool = table(ToolKind.ENDMILL, CuttingMaterial.HSS)
    assert table_tool(tool, book, factor=1.25).edge.factor == 1.25


def test_an_end_mill_has_the_helix_of_its_grade_and_gives_way() -> None:
    """30°; 64·(3·D)³/(3·E·π·(0.8·D)⁴) mm per N, D = 8 mm of carbide."""
    edge = table_tool(table(ToolKind.ENDMILL), STEEL).edge
    assert edge.flutes is not None
    assert edge.flutes.helix_angle == pytest.approx(rad_from_deg(30.0))
    assert (edge.flutes.teeth, edge.flutes.diameter) == (3, 8.0)
    expected = 64.0 * 24.0**3 / (3.0 * 600_000.0 * pi * 6.4**4)
    assert edge.compliance == pytest.approx(expected)


def test_a_stated_overhang_bends_the_tool_of_a_table() -> None:
    """The bend grows with the cube of the length: by 125 from 3 D to 15 D."""
    mill = table(ToolKind.ENDMILL)
    assert isinstance(mill.shape, Cutter)
    held = replace(mill.shape, holder=Holder(diameter=20.0, overhang=120.0))
    usual = table_tool(mill, STEEL).edge.compliance
    stated = table_tool(replace(mill, shape=held), STEEL).edge.compliance
    assert stated == pytest.approx(125.0 * usual)


def test_an_overhang_of_a_table_bends_the_tool_of_a_program() -> None:
    """The assembly length of the file includes the holder, and bends nothing."""
    plain = Program.load(PARTS / "bracket.stpnc")
    ref = plain.workingsteps[2].tool_ref
    id = tool_of(plain, ref).id
    given = GivenTool(number=1, id=id, body="ENDMILL", diameter=20.0, teeth=2, overhang=120.0)
    told = Program(plain.file, tools=[given])
    usual, stated = (loaded_tool(each, ref, 1, STEEL).edge.compliance for each in (plain, told))
    assert stated == pytest.approx(8.0 * usual)


def test_a_table_may_say_the_helix() -> None:
    said = replace(table(ToolKind.ENDMILL), helix_angle=rad_from_deg(45.0))
    edge = table_tool(said, STEEL).edge
    assert edge.flutes is not None
    assert edge.flutes.helix_angle == rad_from_deg(45.0)


def test_the_edge_of_a_tool_does_not_depend_on_the_material() -> None:
    """Helix and stiffness are the tool's, whatever group the material names."""
    known, unknown = (
        table_tool(table(ToolKind.ENDMILL), material).edge
        for material in (STEEL, replace(STEEL, iso_group=""))
    )
    assert unknown.flutes == known.flutes
    assert unknown.compliance == known.compliance > 0.0


def test_face_mills_and_drills_do_not_bend() -> None:
    assert table_tool(table(ToolKind.FACEMILL), STEEL).edge.compliance == 0.0
    assert table_tool(table(ToolKind.DRILL), STEEL).edge.compliance == 0.0


@pytest.mark.parametrize("kind", [ToolKind.TAP, ToolKind.THREADING])
def test_threads_have_no_shape(kind: ToolKind) -> None:
    assert table_tool(table(kind), STEEL).shape is None
