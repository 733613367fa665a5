"""LinuxCNC's tool table, with lines of its own sample configurations."""

from math import pi
from pathlib import Path

import pytest

from simulator.removal.cutter import Cutter, Insert
from simulator.spec import ToolKind
from simulator.tool_files.file_unit import FileUnit
from simulator.tool_files.linuxcnc import is_tool_line
from simulator.tool_files.read import ToolFormat, ToolLibrary, read_tools
from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.units import rad_from_deg
from tests.every_case import every_case
from tests.simulator.tool_files.refusal import refusal

MILL_MM = """\
; tools of a mill
T1 P1 D2.000 ;2mm end mill
T3 P3 D6.000 Z+1.5 ;6mm ball end mill, 2 flutes
T21 P21 D2.50 ;Drill 1/16 - 1/8
T20 P20 D3.000 ;Center drill
T10 P10 D0 ;demo zero diameter
"""
MILL_INCH = "T1 P1 Z0.511 D0.125 ;1/8 end mill\nT2 P2 Z0.1 D0.0625 ;1/16 end mill\n"


def found(folder: Path, text: str, unit: FileUnit | None = None) -> ToolLibrary:
    file = folder / "tool.tbl"
    file.write_text(text, encoding="utf-8")
    return read_tools(file, unit=unit)


def test_a_mill(tmp_path: Path) -> None:
    library = found(tmp_path, MILL_MM)
    assert library.format is ToolFormat.LINUXCNC
    assert [(each.number, each.kind) for each in library.tools] == [
        (1, ToolKind.ENDMILL),
        (3, ToolKind.ENDMILL),
        (20, ToolKind.CENTER_DRILL),
        (21, ToolKind.DRILL),
    ]
    ball = library.by_number[3]
    assert ball.shape == Cutter(diameter=6.0, corner_radius=3.0, teeth=2)
    told = [str(each) for each in library.findings]
    lacks_teeth = "T1 '2mm end mill': its number of teeth is not given: taken for one"
    assert f"warning: line 2: {lacks_teeth}" in told
    assert "warning: line 6: T10 is left out: it has no diameter D" in told


def test_inches_are_told_apart_by_remarks(tmp_path: Path) -> None:
    library = found(tmp_path, MILL_INCH, FileUnit.INCH)
    shape = library.by_number[1].shape
    assert isinstance(shape, Cutter)
    assert shape.diameter == 3.175
    assert refusal(tmp_path / "tool.tbl") == (
        "line 1: D: 0.125 mm, but its name '1/8 end mill' says 3.175 mm; is the table in "
        "another unit?"
    )


@every_case(
    ("line", "hand", "leading", "trailing", "inside"),
    [
        ("T2 P2 D0.8 I85 J25 Q2", HandOfToolType.RIGHT, 95.0, 25.0, False),
        ("T1 P1 D0.8 I95 J155 Q1", HandOfToolType.LEFT, 95.0, 25.0, False),
        ("T3 P3 D0.8 I275 J335 Q3", HandOfToolType.RIGHT, 95.0, 25.0, True),
        ("T4 P4 D0.8 I265 J205 Q4", HandOfToolType.LEFT, 95.0, 25.0, True),
        ("T6 P6 D0.8 I120 J60 Q6", HandOfToolType.NEUTRAL, 60.0, 5.0, False),
        ("T8 P8 D0.8 I240 J300 Q8", HandOfToolType.NEUTRAL, 60.0, 5.0, True),
    ],
)
def test_orientations_of_turning_tools(
    tmp_path: Path,
    line: str,
    hand: HandOfToolType,
    leading: float,
    trailing: float,
    inside: bool,
) -> None:
    (tool,) = found(tmp_path, line).tools
    shape = tool.shape
    assert isinstance(shape, Insert)
    assert (shape.hand, shape.is_inside, shape.nose_radius) == (hand, inside, 0.4)
    assert shape.cutting_edge_angle == pytest.approx(rad_from_deg(leading))
    assert shape.trailing_angle == pytest.approx(rad_from_deg(trailing))


@pytest.mark.parametrize("orientation", range(1, 5))
def test_the_nose_lies_where_linuxcnc_draws_it(tmp_path: Path, orientation: int) -> None:
    x, z = {1: (1, -1), 2: (1, 1), 3: (-1, 1), 4: (-1, -1)}[orientation]
    shape = found(tmp_path, f"T1 P1 D2 Q{orientation}").tools[0].shape
    assert isinstance(shape, Insert)
    assert shape.centre == pytest.approx((x, z))
    assert shape.cutting_edge_angle == pi / 2.0


@every_case(
    ("line", "why"),
    [
        ("T5 P5 D0.1 I210 J150 Q5", "orientation Q5 has no edge towards the axis or a bore"),
        ("T9 P9 D0.1 Q9", "orientation Q9 has no edge towards the axis or a bore"),
        ("T7 P7 D0.1 I10 J20", "edge angles I and J but no orientation Q"),
        ("T6 P6 D0.1 I120 J70 Q6", "the edges of orientation Q6 lean differently"),
        ("T0 P1 D3", "number 0 is an empty spindle"),
    ],
)
def test_tools_that_cannot_be_represented_are_left_out(
    tmp_path: Path, line: str, why: str
) -> None:
    library = found(tmp_path, f"{line}\nT99 P99 D6 ;end mill 4fl\n")
    assert [each.number for each in library.tools] == [99]
    assert [each.line for each in library.findings] == [1]
    assert why in library.findings[0].message


@every_case(
    ("text", "told"),
    [
        ("T1 D3 ;mill", "line 1: P: missing"),
        ("T1 P1 D3\n\nT1 P2 D4", "line 3: T: T1 is there twice"),
        ("T1 P1 D12000", "line 1: D: 12000 mm exceeds 2000 mm"),
        ("T1 P1 D6 D7", "line 1: D: D is there twice"),
        ("T1 P1 D6 G43", "line 1: 'G43'"),
        ("T1 P1 Dwide", "line 1: 'Dwide'"),
        ("T1.5 P1 D6", "is none of the known formats"),
        ("T1 P1 D0.8 I185 J25 Q2", "line 1: I, J: "),
    ],
)
def test_a_refusal_names_line_word_value_and_bound(
    tmp_path: Path, text: str, told: str
) -> None:
    file = tmp_path / "tool.tbl"
    file.write_text(text, encoding="utf-8")
    assert refusal(file).startswith(told)


def test_inches_are_told_beside_the_millimetres(tmp_path: Path) -> None:
    file = tmp_path / "tool.tbl"
    file.write_text("T1 P1 D500", encoding="utf-8")
    assert refusal(file, FileUnit.INCH) == (
        "line 1: D: 12700 mm exceeds 2000 mm (the file says 500 inch)"
    )


@pytest.mark.parametrize("line", ["T1 P1 D3", "P2 T1", "  T7 P1 ;a", "T12"])
def test_lines_of_a_table(line: str) -> None:
    assert is_tool_line(line)


@pytest.mark.parametrize("line", ["tool = 1", "T1M6", "number,kind", "[[tool]]", "Tool 1"])
def test_other_lines(line: str) -> None:
    assert not is_tool_line(line)


def test_zeros_that_an_editor_writes_make_no_turning_tool(tmp_path: Path) -> None:
    library = found(tmp_path, "T3 P0 X0 Y0 Z1.2 A0 B0 C0 D6.8 I0 J0 Q0 ;drill\n", FileUnit.MM)
    assert library.by_number[3].kind is ToolKind.DRILL
    assert isinstance(library.by_number[3].shape, Cutter)
