"""Tool libraries of FreeCAD, with tool bits as its default library has them."""

import json
from math import pi
from pathlib import Path
from typing import Any

from simulator.removal.cutter import Cutter
from simulator.spec import CuttingMaterial, ToolKind
from simulator.tool_files.read import ToolFormat, read_tools
from stepnc_model.units import rad_from_deg
from tests.every_case import every_case
from tests.simulator.tool_files.refusal import refusal

Json = dict[str, Any]


def bit(shape: str, **parameters: Any) -> Json:
    return {
        "version": 2,
        "name": f"a {shape}",
        "shape": f"{shape}.fcstd",
        "parameter": parameters,
        "attribute": {},
    }


def write(file: Path, content: object) -> Path:
    file.parent.mkdir(exist_ok=True)
    file.write_text(json.dumps(content), encoding="utf-8")
    return file


def library(folder: Path, *bits: Json) -> Path:
    """Library as FreeCAD keeps it: the tool bits in a folder beside that of libraries."""
    tools = []
    for number, each in enumerate(bits, start=1):
        write(folder / "Bit" / f"{number}.fctb", each)
        tools.append({"nr": number, "path": f"{number}.fctb"})
    return write(folder / "Library" / "a.fctl", {"tools": tools, "version": 1})


MILL = bit(
    "endmill",
    CuttingEdgeHeight="30.0000 mm",
    Diameter="5.0000 mm",
    Length="50.0000 mm",
    ShankDiameter="3.0000 mm",
    Flutes="2",
    Material="HSS",
    Chipload="0.03 mm",
)


def test_a_library(tmp_path: Path) -> None:
    drill = bit("drill", Diameter="5.0000 mm", TipAngle="119.0000 °", Length="50.0000 mm")
    bull = bit("bullnose", Diameter="6.0000 mm", CornerRadius="1.5000 mm", Flutes=4)
    read = read_tools(library(tmp_path, MILL, drill, bull))
    assert read.format is ToolFormat.FREECAD
    mill = read.by_number[1]
    assert mill.shape == Cutter(diameter=5.0, teeth=2, edge_length=30.0)
    assert (mill.cutting_material, mill.max_feed) == (CuttingMaterial.HSS, 0.03)
    assert read.by_number[2].kind is ToolKind.DRILL
    assert read.by_number[2].shape == Cutter(
        diameter=5.0, point_angle=rad_from_deg(119.0), teeth=1, is_drill=True
    )
    assert read.by_number[3].shape == Cutter(diameter=6.0, corner_radius=1.5, teeth=4)


@every_case(
    ("given", "shape"),
    [
        (
            bit("tap", Diameter='0.375 "', Flutes="3"),
            Cutter(diameter=0.375 * 25.4, teeth=3),
        ),
        (
            bit("endmill", Diameter=6, CuttingEdgeHeight="1 in"),
            Cutter(diameter=6.0, teeth=1, edge_length=25.4),
        ),
        (
            bit("ballend", Diameter="6 mm"),
            Cutter(diameter=6.0, corner_radius=3.0, teeth=1),
        ),
        (
            bit("bullnose", Diameter="6 mm", FlatRadius="2 mm"),
            Cutter(diameter=6.0, corner_radius=1.0, teeth=1),
        ),
        (
            bit("v-bit", Diameter="10 mm", CuttingEdgeAngle="60 °", TipDiameter="0.1 mm"),
            Cutter(diameter=0.1, taper_angle=pi / 6.0, teeth=1),
        ),
        (
            bit("chamfer", Diameter="10 mm", CuttingEdgeAngle="90 °"),
            Cutter(diameter=10.0, point_angle=pi / 2.0, teeth=1),
        ),
    ],
)
def test_shapes(tmp_path: Path, given: Json, shape: Cutter) -> None:
    found = read_tools(library(tmp_path, given)).tools[0].shape
    assert isinstance(found, Cutter)
    assert found == shape


def test_a_tool_bit_alone_is_number_one(tmp_path: Path) -> None:
    read = read_tools(write(tmp_path / "a.fctb", MILL))
    assert [each.number for each in read.tools] == [1]
    assert read.findings[0].message == "'a endmill': a tool bit has no number: it is T1"


def test_a_probe_is_left_out(tmp_path: Path) -> None:
    read = read_tools(library(tmp_path, MILL, bit("probe", Diameter="6 mm")))
    assert len(read.tools) == 1
    assert read.findings[-1].message == (
        "2.fctb 'a probe' is left out: shape 'probe' is not a cutter that can be represented"
    )


@every_case(
    ("given", "told"),
    [
        (bit("endmill", Diameter="12000 mm"), "parameter.Diameter: 12000 mm"),
        (
            bit("endmill", Diameter="500 in"),
            "parameter.Diameter: 12700 mm exceeds 2000 mm (the file says 500 inch)",
        ),
        (bit("endmill", Diameter="5 kg"), "parameter.Diameter: '5 kg'"),
        (bit("endmill"), "diameter_mm: missing"),
        (
            bit("endmill", Diameter="0.25 mm") | {"name": "1/4 end mill"},
            "parameter.Diameter: 0.25 mm, but its name '1/4 end mill' says 6.35 mm",
        ),
        (
            bit("drill", Diameter="5 mm", TipAngle="2 mm"),
            "parameter.TipAngle: '2 mm'",
        ),
    ],
)
def test_a_refusal_names_the_parameter_the_value_and_the_bound(
    tmp_path: Path, given: Json, told: str
) -> None:
    assert told in refusal(library(tmp_path, given))


@every_case(
    ("entry", "told"),
    [
        (
            {"nr": 1, "path": "../secret.fctb"},
            "tools[0].path: '../secret.fctb'",
        ),
        ({"nr": 1, "path": ".."}, "tools[0].path: '..' is not"),
        ({"nr": 1, "path": 3}, "tools[0].path: 3 is not"),
        ({"nr": 1, "path": "b.fctb"}, "tools[0].path: 'b.fctb' is neither"),
        ({"path": "1.fctb"}, "tools[0].nr: missing"),
        (7, "tools[0]: 7"),
    ],
)
def test_an_entry_that_leads_nowhere_is_refused(
    tmp_path: Path, entry: object, told: str
) -> None:
    file = write(tmp_path / "a.fctl", {"tools": [entry]})
    assert refusal(file).startswith(told)


def test_a_number_that_two_tools_have_is_refused(tmp_path: Path) -> None:
    write(tmp_path / "1.fctb", MILL)
    entry = {"nr": 4, "path": "1.fctb"}
    file = write(tmp_path / "a.fctl", {"tools": [entry, entry]})
    assert "tools[1].nr: T4 is there twice" in refusal(file)
