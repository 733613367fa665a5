"""Tool libraries of HSMWorks."""

from math import pi
from pathlib import Path

import pytest

from simulator.removal.cutter import Cutter, Holder
from simulator.spec import CuttingMaterial, ToolKind
from simulator.tool_files.read import ToolFormat, ToolLibrary, read_tools
from stepnc_model.units import rad_from_deg, speed_from_m_min
from tests.every_case import every_case
from tests.simulator.tool_files.refusal import refusal

MILL = """\
  <tool guid="{1}" type="end mill" unit="inches" version="1.5">
    <description>3/16 End Mill</description>
    <manufacturer>A vendor</manufacturer>
    <nc break-control="0" diameter-offset="5" length-offset="5" number="5" turret="0"/>
    <coolant mode="flood"/>
    <material name="carbide"/>
    <body body-length="3" corner-radius="0" diameter="0.1875" flute-length="0.94"
      number-of-flutes="3" overall-length="3" shaft-diameter="0.1875"/>
    <holder description="ER20"><section diameter="1.3" length="2"/></holder>
    <presets>
      <preset id="{2}" name="Default">
        <parameter key="tool_spindleSpeed" value="12000"/>
        <parameter key="tool_feedCutting" value="40"/>
      </preset>
    </presets>
  </tool>
"""
DRILL = """\
  <tool guid="{3}" type="drill" unit="millimeters" version="1.5">
    <description>Drill 8</description>
    <nc number="6"/>
    <material name="hss"/>
    <body diameter="8" flute-length="40" number-of-flutes="2" taper-angle="118"/>
    <motion spindle-rpm="1000" cutting-feedrate="200" feed-mode="per-minute"/>
  </tool>
"""


def file_of(folder: Path, *tools: str, encoding: str = "utf-8", root: str = "") -> Path:
    name = root or "tool-library"
    text = (
        f'<?xml version="1.0" encoding="{encoding.upper()}" standalone="no"?>\n'
        f'<{name} xmlns="http://www.hsmworks.com/xml/2004/cnc/tool-library" version="14">\n'
        f"{''.join(tools)}</{name}>\n"
    )
    file = folder / "library.hsmlib"
    file.write_bytes(text.encode(encoding))
    return file


def found(folder: Path, *tools: str, encoding: str = "utf-8") -> ToolLibrary:
    return read_tools(file_of(folder, *tools, encoding=encoding))


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_a_mill_and_a_drill(tmp_path: Path, encoding: str) -> None:
    library = found(tmp_path, MILL, DRILL, encoding=encoding)
    assert library.format is ToolFormat.HSMWORKS
    mill, drill = library.tools
    assert (mill.number, mill.id, mill.kind) == (5, "3/16 End Mill", ToolKind.ENDMILL)
    assert mill.shape == Cutter(
        diameter=0.1875 * 25.4,
        teeth=3,
        edge_length=0.94 * 25.4,
        holder=Holder(diameter=1.3 * 25.4, overhang=3.0 * 25.4),
    )
    assert mill.max_feed == pytest.approx(40.0 * 25.4 / 36_000.0)
    assert mill.max_cutting_speed == pytest.approx(pi * 4.7625 * 200.0)
    assert drill.cutting_material is CuttingMaterial.HSS
    assert drill.shape == Cutter(
        diameter=8.0,
        teeth=2,
        edge_length=40.0,
        point_angle=rad_from_deg(118.0),
        is_drill=True,
    )
    assert drill.max_feed == pytest.approx(0.2)
    assert drill.min_cutting_speed == pytest.approx(speed_from_m_min(8.0 * pi))


def test_cones_and_balls(tmp_path: Path) -> None:
    body = '<body diameter="10" flute-length="5" taper-angle="45" {}/>'
    kinds = {
        1: ("ball end mill", "", Cutter(diameter=10.0, corner_radius=5.0, teeth=1)),
        2: ("chamfer mill", "", Cutter(diameter=10.0, point_angle=pi / 2.0, teeth=1)),
        3: (
            "chamfer mill",
            'tip-diameter="2"',
            Cutter(diameter=2.0, taper_angle=pi / 4.0, teeth=1),
        ),
        4: ("counter bore", "", Cutter(diameter=10.0, teeth=1, is_drill=True)),
    }
    tools = [
        f'<tool type="{kind}" unit="millimeters"><nc number="{number}"/>{body.format(more)}'
        "</tool>\n"
        for number, (kind, more, _) in kinds.items()
    ]
    read = found(tmp_path, *tools).by_number
    for number, (_, _, shape) in kinds.items():
        tool = read[number].shape
        assert isinstance(tool, Cutter)
        assert tool.edge_length == 5.0
        assert (tool.diameter, tool.corner_radius) == (shape.diameter, shape.corner_radius)
        assert tool.point_angle == pytest.approx(shape.point_angle)
        assert tool.taper_angle == pytest.approx(shape.taper_angle)
        assert tool.is_drill is shape.is_drill


def test_other_tools_are_left_out_with_their_line(tmp_path: Path) -> None:
    other = '  <tool type="probe" unit="millimeters"><description>P</description></tool>\n'
    library = found(tmp_path, other, DRILL.replace('number="6"', 'number="0"'), MILL)
    assert [each.number for each in library.tools] == [5]
    assert [(each.line, each.message) for each in library.findings] == [
        (3, "'P' is left out: type 'probe' is not a cutter that can be represented"),
        (4, "'Drill 8' is left out: it has no number of the machine"),
    ]


@every_case(
    ("old", "new", "told"),
    [
        ('diameter="8"', 'diameter="12000"', "line 3: body.diameter: 12000 mm exceeds 2000 mm"),
        ('diameter="8"', "", "line 3: diameter_mm: missing"),
        ('diameter="8"', 'diameter="wide"', "line 3: body.diameter: 'wide'"),
        ('number="6"', 'number="six"', "line 3: nc.number: 'six'"),
        ('"millimeters"', '"mm"', "line 3: tool.unit: 'mm'"),
        ("Drill 8", "Drill 8 mm, inch", ""),
        ("</tool>", "</tol>", "line 9: is not XML: "),
    ],
)
def test_a_refusal_names_line_attribute_value_and_bound(
    tmp_path: Path, old: str, new: str, told: str
) -> None:
    file = file_of(tmp_path, DRILL.replace(old, new))
    if not told:
        assert read_tools(file).tools[0].number == 6
        return
    assert refusal(file).startswith(told)


def test_wrong_units_are_told_by_the_name(tmp_path: Path) -> None:
    file = file_of(tmp_path, MILL.replace("inches", "millimeters"))
    assert refusal(file) == (
        "line 3: body.diameter: 0.1875 mm, but its name '3/16 End Mill' says 4.7625 mm"
    )


def test_a_number_that_two_tools_have_is_refused(tmp_path: Path) -> None:
    assert refusal(file_of(tmp_path, DRILL, DRILL)) == (
        "line 10: nc.number: T6 is there twice; first at line 3"
    )


def test_another_document_is_refused(tmp_path: Path) -> None:
    file = file_of(tmp_path, DRILL, root="machine")
    assert refusal(file) == "root element machine; expected tool-library"


def test_entities_are_not_resolved(tmp_path: Path) -> None:
    file = tmp_path / "library.hsmlib"
    file.write_text(
        '<!DOCTYPE a [<!ENTITY b SYSTEM "file:///etc/hostname">]>\n'
        '<tool-library xmlns="http://www.hsmworks.com/xml/2004/cnc/tool-library">'
        '<tool type="drill" unit="millimeters"><description>&b;</description><nc number="1"/>'
        '<body diameter="8"/></tool></tool-library>',
        encoding="utf-8",
    )
    assert read_tools(file).tools[0].id == "drill"
