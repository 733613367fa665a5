"""Tool tables as CSV."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.errors import LibraryError
from simulator.removal.cutter import Cutter, Insert
from simulator.tool_files.csv_table import read_csv
from simulator.tool_files.read import ToolFormat, read_tools
from stepnc_model.units import speed_from_m_min
from tests.every_case import every_case
from tests.simulator.tool_files.refusal import refusal

EXAMPLES = Path(__file__).parents[3] / "examples" / "tools"
HEADING = "number,kind,diameter_mm,id,teeth"


def table(folder: Path, *lines: str) -> Path:
    file = folder / "tools.csv"
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return file


def test_the_example_has_the_tools_of_the_toml_file() -> None:
    found = read_tools(EXAMPLES / "bracket.csv")
    known = read_tools(EXAMPLES / "bracket.toml").tools
    assert found.format is ToolFormat.CSV
    assert [(each.number, each.id, each.kind, each.teeth, each.shape) for each in known] == [
        (each.number, each.id, each.kind, each.teeth, each.shape) for each in found.tools
    ]


def test_windows_of_the_vendor_are_in_mm_and_mm_per_second() -> None:
    face = read_tools(EXAMPLES / "bracket.csv").by_number[1]
    assert (face.grade, face.min_feed, face.max_feed) == ("P25", 0.1, 0.3)
    assert face.min_cutting_speed == speed_from_m_min(180.0)
    assert face.max_cutting_speed == speed_from_m_min(280.0)


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_separators_remarks_and_empty_lines(tmp_path: Path, separator: str) -> None:
    lines = ["# a remark", "", HEADING, "# another, with commas", "", "3,endmill,10,,4"]
    file = table(tmp_path, *(line.replace(",", separator) for line in lines))
    (tool,) = read_tools(file).tools
    assert tool.shape == Cutter(diameter=10.0, teeth=4)
    assert tool.id == "endmill T3"


def test_a_mark_of_the_byte_order_and_windows_line_ends(tmp_path: Path) -> None:
    file = tmp_path / "tools.csv"
    file.write_bytes(b"\xef\xbb\xbf" + f"{HEADING}\r\n3,endmill,10,A,4\r\n".encode())
    assert read_tools(file).tools[0].id == "A"


def test_a_boring_insert(tmp_path: Path) -> None:
    file = table(
        tmp_path,
        "number,kind,nose_radius_mm,cutting_edge_angle_deg,trailing_angle_deg,inside,wiper",
        "2,turning,0.4,93,7,yes,no",
    )
    shape = read_tools(file).tools[0].shape
    assert isinstance(shape, Insert)
    assert shape.is_inside
    assert shape.nose_radius == 0.4


@every_case(
    ("lines", "told"),
    [
        ([HEADING, "3,endmill,12000,A,4"], "line 2: diameter_mm: 12000 mm exceeds 2000 mm"),
        (
            [HEADING, "3,endmill,0.001,A,4"],
            "line 2: diameter_mm: 0.001 mm is below",
        ),
        (
            [HEADING, "", "3,endmill,,A,4"],
            "line 3: diameter_mm: missing",
        ),
        (
            ["number;kind;diameter_mm", "3;endmill;0,5mm"],
            "line 2: diameter_mm: '0,5mm'",
        ),
        ([HEADING, "3,saw,10,A,4"], "line 2: kind: 'saw' is not one of endmill"),
        (
            [HEADING, "3,endmill,10,A,4", "3,drill,5,B,2"],
            "line 3: number: T3 is there twice",
        ),
        ([HEADING, "2.5,endmill,10,A,4"], "line 2: number: 2.5"),
        ([HEADING, "3,endmill,10,A,4,7"], "line 2: 6 cells"),
        (["number,kind,diametre_mm", "3,endmill,10"], "line 1: diametre_mm: unknown column"),
        (["number,kind,kind", "3,endmill,drill"], "line 1: kind: 2 columns"),
        ([HEADING], "has no tool that can be used"),
        (
            [HEADING, "3,endmill,0.5,1/2 inch end mill,4"],
            "line 2: diameter_mm: 0.5 mm, but its name '1/2 inch end mill' says 12.7 mm",
        ),
        (
            ["number,kind,diameter_mm,min_feed_mm,max_feed_mm", "3,endmill,10,0.2,0.1"],
            "line 2: min_feed_mm: 0.2 mm exceeds",
        ),
        (
            ["number,kind,diameter_mm,wiper", "3,endmill,10,perhaps"],
            "line 2: wiper: 'perhaps'",
        ),
        ([HEADING, '3,endmill,10,"A,4'], "line 2: is not CSV"),
    ],
)
def test_a_refusal_names_line_column_value_and_bound(
    tmp_path: Path, lines: list[str], told: str
) -> None:
    assert refusal(table(tmp_path, *lines)).startswith(told)


def test_a_heading_without_a_needed_column_is_refused(tmp_path: Path) -> None:
    with pytest.raises(Exception, match="line 1: kind: missing; the heading has number, id"):
        read_csv("number,id\n3,A\n", tmp_path / "a.csv")


@given(
    st.lists(st.integers(1, 9999), min_size=1, max_size=6, unique=True),
    st.floats(0.02, 1999.0),
)
def test_what_is_written_is_read(numbers: list[int], diameter: float) -> None:
    rows = [f"{number},endmill,{diameter!r},,4" for number in numbers]
    found = read_csv("\n".join((HEADING, *rows)), Path("a.csv")).rows
    assert [each.row.number for each in found] == numbers
    assert {each.row.diameter_mm for each in found} == {diameter}
    assert [each.line for each in found] == list(range(2, len(numbers) + 2))


@pytest.mark.parametrize("first", ["", "sep=;\n"])
def test_decimal_commas_are_read_where_no_comma_separates(tmp_path: Path, first: str) -> None:
    file = tmp_path / "tools.csv"
    file.write_text(first + "number;kind;id;diameter_mm\n1;drill;6,8;6,8\n", encoding="utf-8")
    (tool,) = read_tools(file).tools
    assert isinstance(tool.shape, Cutter)
    assert (tool.id, tool.shape.diameter) == ("6,8", 6.8)


def test_a_comma_in_quotes_is_not_guessed_at(tmp_path: Path) -> None:
    file = tmp_path / "tools.csv"
    file.write_text('number,kind,diameter_mm\n1,drill,"6,8"\n', encoding="utf-8")
    with pytest.raises(LibraryError, match="line 2: diameter_mm: '6,8' is not a number"):
        read_tools(file)


@every_case(
    ("lines", "told"),
    [
        (
            ("number,kind,diameter_mm", "1,endmill,10", "2,drill,8"),
            ["line 2: T1: its", "line 3: T2: its"],
        ),
        ((HEADING, "1,endmill,10,A,", "2,drill,8,B,1"), ["line 2: T1 'A': its"]),
        ((HEADING, "1,endmill,10,A,1"), []),
        (("number,kind,nose_radius_mm", "1,turning,0.8"), []),
    ],
)
def test_an_unknown_number_of_teeth_is_told(
    lines: tuple[str, ...], told: list[str], tmp_path: Path
) -> None:
    found = [str(each) for each in read_tools(table(tmp_path, *lines)).findings]
    how = "number of teeth is not given: taken for one"
    assert found == [f"warning: {each} {how}" for each in told]
