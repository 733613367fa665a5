"""Tool libraries of Fusion."""

import json
from math import inf, pi
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import pytest

from simulator.removal.cutter import Cutter, Holder, Insert
from simulator.spec import CuttingMaterial, ToolKind
from simulator.tool_files.read import ToolFormat, ToolLibrary, read_tools
from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.units import rad_from_deg, speed_from_m_min
from tests.every_case import every_case
from tests.simulator.tool_files.refusal import refusal

Json = dict[str, Any]


def mill(**changes: Any) -> Json:
    """A tool as the export has it, with the fields that other programs use left in."""
    return {
        "BMC": "carbide",
        "GRADE": "Mill Generic",
        "description": "10mm Flat End Mill",
        "geometry": {
            "CSP": False,
            "DC": 10,
            "HAND": True,
            "LB": 32,
            "LCF": 22,
            "NOF": 4,
            "OAL": 72,
            "RE": 0,
            "SFDM": 10,
            "shoulder-length": 25,
        },
        "guid": "00000000-0000-4000-8000-000000000001",
        "holder": {
            "description": "ER20",
            "segments": [{"height": 10, "lower-diameter": 34, "upper-diameter": 40}],
            "unit": "millimeters",
        },
        "post-process": {"number": 3, "turret": 0, "length-offset": 3},
        "product-id": "",
        "start-values": {"presets": [{"name": "Steel", "n": 4000, "f_z": 0.05, "v_c": 125.6}]},
        "type": "flat end mill",
        "unit": "millimeters",
        "vendor": "Autodesk",
    } | changes


def file_of(folder: Path, *tools: Json) -> Path:
    file = folder / "library.json"
    file.write_text(json.dumps({"data": list(tools), "version": 36}), encoding="utf-8")
    return file


def found(folder: Path, *tools: Json) -> ToolLibrary:
    return read_tools(file_of(folder, *tools))


def test_a_flat_end_mill(tmp_path: Path) -> None:
    library = found(tmp_path, mill())
    (tool,) = library.tools
    assert library.format is ToolFormat.FUSION
    assert library.findings == ()
    assert (tool.number, tool.id, tool.kind) == (3, "10mm Flat End Mill", ToolKind.ENDMILL)
    assert tool.cutting_material is CuttingMaterial.CARBIDE
    assert tool.shape == Cutter(
        diameter=10.0, teeth=4, edge_length=22.0, holder=Holder(diameter=34.0, overhang=32.0)
    )
    assert (tool.min_feed, tool.max_feed) == (0.05, 0.05)
    assert tool.max_cutting_speed == speed_from_m_min(125.6)


def test_a_tool_in_inches(tmp_path: Path) -> None:
    tool = mill(
        unit="inches",
        description='1/2" bull nose',
        type="bull nose end mill",
        geometry={"DC": 0.5, "RE": 0.03, "NOF": 3, "LCF": 1.25, "HA": 45},
        holder=None,
    )
    tool["start-values"]["presets"] = [{"f_z": 0.002, "v_c": 800}, {"f_z": 0.004, "v_c": 400}]
    library = found(tmp_path, tool)
    (read,) = library.tools
    assert read.shape == Cutter(
        diameter=12.7, corner_radius=0.03 * 25.4, teeth=3, edge_length=31.75
    )
    assert read.helix_angle == pytest.approx(rad_from_deg(45.0))
    assert (read.min_feed, read.max_feed) == pytest.approx((0.0508, 0.1016))
    assert read.max_cutting_speed == pytest.approx(speed_from_m_min(243.84))
    assert ["span 2 presets" in each.message for each in library.findings] == [True]


@every_case(
    ("name", "geometry", "shape"),
    [
        ("ball end mill", {"DC": 6, "RE": 3}, Cutter(diameter=6.0, corner_radius=3.0, teeth=1)),
        (
            "chamfer mill",
            {"DC": 12, "TA": 45, "tip-diameter": 0},
            Cutter(diameter=12.0, point_angle=pi / 2.0, teeth=1),
        ),
        (
            "chamfer mill",
            {"DC": 12, "TA": 45, "tip-diameter": 2, "LCF": 5},
            Cutter(diameter=2.0, taper_angle=pi / 4.0, teeth=1, edge_length=5.0),
        ),
        (
            "drill",
            {"DC": 8, "SIG": 140, "NOF": 2},
            Cutter(diameter=8.0, point_angle=rad_from_deg(140.0), teeth=2, is_drill=True),
        ),
        (
            "counter bore",
            {"DC": 8},
            Cutter(diameter=8.0, teeth=1, is_drill=True),
        ),
        (
            "tapered mill",
            {"DC": 3, "TA": 5, "RE": 0.5},
            Cutter(diameter=3.0, corner_radius=0.5, taper_angle=rad_from_deg(5.0), teeth=1),
        ),
    ],
)
def test_shapes(tmp_path: Path, name: str, geometry: Json, shape: Cutter) -> None:
    tool = mill(type=name, geometry=geometry, description=name)
    assert found(tmp_path, tool).tools[0].shape == shape


def test_a_boring_bar_of_a_lathe(tmp_path: Path) -> None:
    tool = mill(type="turning boring", geometry={"RE": 0.4}, holder={"HAND": "L"})
    shape = found(tmp_path, tool).tools[0].shape
    assert shape == Insert(nose_radius=0.4, hand=HandOfToolType.LEFT, is_inside=True)


def test_holders_probes_and_tools_without_a_number_are_left_out(tmp_path: Path) -> None:
    without = mill(description="spare") | {"post-process": {"number": 0}}
    library = found(tmp_path, mill(), {"type": "holder"}, mill(type="probe"), without)
    assert [each.number for each in library.tools] == [3]
    assert [each.message for each in library.findings] == [
        "data[1] 'holder' is left out: type 'holder' is not a cutter that can be represented",
        "data[2] '10mm Flat End Mill' is left out: type 'probe' is not a cutter that can be "
        "represented",
        "data[3] 'spare' is left out: it has no number of the machine",
    ]


def test_an_archive_is_read(tmp_path: Path) -> None:
    file = tmp_path / "library.tools"
    with ZipFile(file, "w") as archive:
        archive.writestr("tools.json", json.dumps({"data": [mill()]}))
    assert read_tools(file).tools == found(tmp_path, mill()).tools


@every_case(
    ("changes", "told"),
    [
        (
            {"geometry": {"DC": 12000}},
            "data[0].geometry.DC: 12000 mm",
        ),
        (
            {"geometry": {"DC": 500}, "unit": "inches"},
            "data[0].geometry.DC: 12700 mm exceeds 2000 mm (the file says 500 inch)",
        ),
        (
            {"geometry": {"DC": 0.5}, "description": '1/2" end mill'},
            "data[0].geometry.DC: 0.5 mm, but its name '1/2\" end mill' says 12.7 mm",
        ),
        (
            {"geometry": {"DC": 10}, "unit": "inches"},
            "data[0].geometry.DC: 254 mm, but its name '10mm Flat End Mill' says 10 mm",
        ),
        (
            {"geometry": {}},
            "data[0]: diameter_mm: missing",
        ),
        ({"geometry": 3}, "data[0].geometry: 3"),
        ({"geometry": {"DC": "10 mm"}}, "data[0].geometry.DC: '10 mm'"),
        (
            {"geometry": {"DC": 10, "NOF": 0.5}},
            "data[0].geometry.NOF: 0.5 is below 1",
        ),
        (
            {"geometry": {"DC": 10, "RE": 6}},
            "data[0].geometry.RE: 6 mm exceeds half",
        ),
        ({"unit": "mm"}, "data[0].unit: 'mm'"),
        ({"post-process": {"number": "T3"}}, "data[0].post-process.number: 'T3'"),
        ({"description": 7}, "data[0].description: 7"),
    ],
)
def test_a_refusal_names_the_path_the_value_and_the_bound(
    tmp_path: Path, changes: Json, told: str
) -> None:
    assert refusal(file_of(tmp_path, mill(**changes))).startswith(told)


def test_a_number_that_two_tools_have_is_refused(tmp_path: Path) -> None:
    assert refusal(file_of(tmp_path, mill(), mill())) == (
        "data[1].post-process.number: T3 is there twice; first at data[0]"
    )


def test_a_library_without_usable_tools_is_refused(tmp_path: Path) -> None:
    assert refusal(file_of(tmp_path, {"type": "probe"})).startswith(
        "has no tool that can be used: data[0] 'probe' is left out"
    )


def test_an_edge_without_an_end_is_endless(tmp_path: Path) -> None:
    shape = found(tmp_path, mill(geometry={"DC": 10})).tools[0].shape
    assert isinstance(shape, Cutter)
    assert shape.edge_length == inf
