"""Tools by their numbers."""

from math import inf, pi
from pathlib import Path

import pytest

from simulator.errors import LibraryError
from simulator.removal.cutter import Cutter, Holder, Insert
from simulator.spec import CuttingMaterial, ToolKind
from simulator.tool_files.read import read_tools
from simulator.tools.tool_table import TURNED, TableTool
from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.units import rad_from_deg
from tests.every_case import every_case

MILL = 'number = 3\nkind = "endmill"\ndiameter_mm = 10\n'


def table(tmp_path: Path, *rows: str) -> Path:
    file = tmp_path / "tools.toml"
    file.write_text("".join(f"[[tool]]\n{row}\n" for row in rows), encoding="utf-8")
    return file


def only(tmp_path: Path, row: str) -> TableTool:
    (tool,) = read_tools(table(tmp_path, row)).tools
    return tool


def test_what_is_absent_is_customary(tmp_path: Path) -> None:
    tool = only(tmp_path, MILL)
    assert tool.number == 3
    assert tool.id == "endmill T3"
    assert tool.cutting_material is CuttingMaterial.CARBIDE
    assert tool.teeth == 1
    assert tool.helix_angle is None
    assert tool.centre_cutting is None
    assert tool.shape == Cutter(diameter=10.0, teeth=1)


@pytest.mark.parametrize("does", [True, False])
def test_a_mill_cuts_over_centre_or_not(tmp_path: Path, does: bool) -> None:
    tool = only(tmp_path, MILL + f"centre_cutting = {str(does).lower()}\n")
    assert tool.centre_cutting is does


def test_a_mill_with_everything(tmp_path: Path) -> None:
    tool = only(
        tmp_path,
        MILL
        + """
        id = "BULL 10"
        cutting_material = "hss"
        teeth = 4
        corner_radius_mm = 2
        taper_angle_deg = 3
        edge_length_mm = 22
        holder_diameter_mm = 40
        overhang_mm = 55
        helix_deg = 38
        """,
    )
    assert tool.helix_angle == pytest.approx(rad_from_deg(38.0))
    assert (tool.id, tool.cutting_material, tool.teeth) == ("BULL 10", CuttingMaterial.HSS, 4)
    assert tool.shape == Cutter(
        diameter=10.0,
        corner_radius=2.0,
        taper_angle=rad_from_deg(3.0),
        teeth=4,
        edge_length=22.0,
        holder=Holder(diameter=40.0, overhang=55.0),
    )


@every_case("kind", list(ToolKind))
def test_every_kind_is_read(tmp_path: Path, kind: ToolKind) -> None:
    size = "width_mm = 3" if kind is ToolKind.GROOVING else "nose_radius_mm = 0.8"
    row = f'number = 1\nkind = "{kind}"\n'
    row += size if kind in TURNED else "diameter_mm = 8"
    tool = only(tmp_path, row)
    assert tool.kind is kind
    assert isinstance(tool.shape, Insert if kind in TURNED else Cutter)


@pytest.mark.parametrize(
    ("kind", "angle", "is_drill"),
    [("drill", 118.0, True), ("countersink", 90.0, True), ("endmill", 180.0, False)],
)
def test_customary_points(tmp_path: Path, kind: str, angle: float, is_drill: bool) -> None:
    shape = only(tmp_path, f'number = 1\nkind = "{kind}"\ndiameter_mm = 8').shape
    assert isinstance(shape, Cutter)
    assert shape.point_angle == pytest.approx(rad_from_deg(angle))
    assert shape.is_drill is is_drill
    assert shape.edge_length == inf


def test_an_insert(tmp_path: Path) -> None:
    row = 'number = 1\nkind = "turning"\nnose_radius_mm = 0.8\nhand = "left"\n'
    shape = only(tmp_path, row + "cutting_edge_angle_deg = 93").shape
    assert shape == Insert(
        nose_radius=0.8, cutting_edge_angle=rad_from_deg(93.0), hand=HandOfToolType.LEFT
    )
    plain = only(tmp_path, 'number = 1\nkind = "turning"').shape
    assert isinstance(plain, Insert)
    assert plain.cutting_edge_angle == 0.5 * pi


@every_case(
    ("row", "key", "word"),
    [
        ('number = 3\nkind = "endmill"', "diameter_mm", "missing"),
        ('number = 3\nkind = "saw"', "kind", "not one of"),
        ('kind = "endmill"\ndiameter_mm = 3', "number", "missing"),
        (MILL.replace("3", "2.5", 1), "number", "whole"),
        (MILL.replace("3", "0", 1), "number", "below 1"),
        (MILL.replace("10", "-1"), "diameter_mm", "below 0.01"),
        (MILL.replace("10", "nan"), "diameter_mm", "finite"),
        (MILL + "teeth = 0", "teeth", "below 1"),
        (MILL + "teeth = 2.5", "teeth", "whole"),
        (MILL + "teeth = 501", "teeth", "exceeds 500"),
        (MILL + "corner_radius_mm = 6", "corner_radius_mm", "half the diameter"),
        (MILL + "taper_angle_deg = 81", "taper_angle_deg", "exceeds 80"),
        (MILL + "point_angle_deg = 20", "point_angle_deg", "below 30"),
        (MILL + "edge_length_mm = 2001", "edge_length_mm", "exceeds 2000"),
        (MILL + "overhang_mm = 50", "holder_diameter_mm", "missing"),
        (MILL + "holder_diameter_mm = 50", "overhang_mm", "missing"),
        (MILL + "diametre = 3", "diametre", "unknown key"),
        (MILL + 'diameter = "3"', "diameter", "unknown key"),
        (MILL + 'cutting_material = "wood"', "cutting_material", "not one of"),
        (MILL.replace("10", '"10"'), "diameter_mm", "not a number"),
        ('number = 1\nkind = "grooving"', "width_mm", "missing"),
        (
            'number = 1\nkind = "turning"\ncutting_edge_angle_deg = 180',
            "cutting_edge_angle_deg",
            "exceeds 179",
        ),
    ],
)
def test_a_bad_value_is_told_with_its_key(
    tmp_path: Path, row: str, key: str, word: str
) -> None:
    file = table(tmp_path, row)
    with pytest.raises(LibraryError) as caught:
        read_tools(file)
    assert caught.value.path == str(file)
    assert caught.value.key == f"tool[1].{key}"
    assert word in caught.value.message


def test_a_refusal_of_two_values_names_the_row_and_both(tmp_path: Path) -> None:
    file = table(tmp_path, 'number = 1\nkind = "grooving"\nwidth_mm = 2\nnose_radius_mm = 1.5')
    with pytest.raises(LibraryError) as caught:
        read_tools(file)
    assert str(caught.value) == (
        f"{file}: tool[1]: corner radius 1.5 mm must be at most half the blade width, 1 mm"
    )


def test_number_twice_is_told(tmp_path: Path) -> None:
    with pytest.raises(LibraryError, match=r"tool\[1\].number: T3 is there twice"):
        read_tools(table(tmp_path, MILL, MILL))


@pytest.mark.parametrize("text", ["", "# nothing\n"])
def test_table_without_tools(tmp_path: Path, text: str) -> None:
    file = tmp_path / "empty.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(LibraryError, match=r"has no \[\[tool\]\]"):
        read_tools(file)


def test_numbers_stay_apart(tmp_path: Path) -> None:
    rows = [MILL.replace("number = 3", f"number = {number}") for number in (2, 7, 12)]
    tools = read_tools(table(tmp_path, *rows)).tools
    assert [tool.number for tool in tools] == [2, 7, 12]


def test_a_turning_insert_may_have_a_wiper(tmp_path: Path) -> None:
    insert = 'number = 1\nkind = "turning"\nnose_radius_mm = 0.8\n'
    assert only(tmp_path, insert + "wiper = true\n").has_wiper
    assert not only(tmp_path, insert).has_wiper
    with pytest.raises(LibraryError, match="wiper: is of turning inserts, not of kind endmill"):
        only(tmp_path, MILL + "wiper = true\n")
