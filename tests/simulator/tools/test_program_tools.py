"""A tool of a table stands for one that a file only names."""

from pathlib import Path

import pytest

from simulator.tool_files.read import read_tools
from simulator.tools.program_tools import user_tool

TABLE = """number,kind,diameter_mm,teeth,corner_radius_mm,edge_length_mm,cutting_material
1,facemill,50,5,0,8,carbide
2,endmill,10,4,0,22,hss
3,endmill,10,2,5,22,carbide
4,endmill,10,2,1,22,carbide
5,drill,8,2,0,60,hss
"""


@pytest.mark.parametrize(
    ("number", "body", "material"),
    [
        (1, "FACEMILL", "carbide"),
        (2, "ENDMILL", "hss"),
        (3, "BALL_ENDMILL", "carbide"),
        (4, "BULLNOSE_ENDMILL", "carbide"),
        (5, "TWIST_DRILL", "hss"),
    ],
)
def test_the_body_follows_from_kind_and_corner(
    tmp_path: Path, number: int, body: str, material: str
) -> None:
    table = tmp_path / "tools.csv"
    table.write_text(TABLE, encoding="utf-8")
    found = user_tool(read_tools(table).by_number[number])
    assert found is not None
    assert (found.body, found.edge_material) == (body, material)
    assert found.is_named(str(number))
    assert found.is_named(f"T{number}")
    assert not found.is_named("9")


def test_a_turning_insert_has_no_diameter(tmp_path: Path) -> None:
    table = tmp_path / "tools.csv"
    table.write_text("number,kind,nose_radius_mm\n1,turning,0.8\n", encoding="utf-8")
    given = user_tool(read_tools(table).by_number[1])
    assert (given.body, given.diameter, given.corner_radius) == (
        "GENERAL_TURNING_TOOL",
        0.0,
        0.8,
    )
    assert given.insert is not None
    assert given.insert.width is None
