"""Grades of tools of a tool table."""

from dataclasses import replace

import pytest

from simulator.library import load_material
from simulator.removal.cutter import Cutter
from simulator.spec import CuttingMaterial, ToolKind
from simulator.tools.tool_table import TableTool, grade_for, grade_of_table_tool

STEEL = load_material("c45")
MILL = TableTool(
    number=1,
    id="A",
    kind=ToolKind.ENDMILL,
    cutting_material=CuttingMaterial.CARBIDE,
    teeth=4,
    shape=Cutter(diameter=10.0, teeth=4),
)
KNOWN = grade_for(ToolKind.ENDMILL, CuttingMaterial.CARBIDE, STEEL)


def test_a_table_that_says_nothing_keeps_the_grade_of_the_library() -> None:
    assert KNOWN is not None
    assert grade_of_table_tool(MILL, STEEL) == KNOWN


def test_the_vendor_replaces_feeds_speeds_helix_and_name() -> None:
    tool = replace(
        MILL,
        grade="P25",
        helix_angle=0.7,
        min_feed=0.03,
        max_feed=0.07,
        min_cutting_speed=2000.0,
        max_cutting_speed=3000.0,
    )
    grade = grade_of_table_tool(tool, STEEL)
    assert grade is not None
    assert KNOWN is not None
    assert (grade.name, grade.helix_angle) == ("P25", 0.7)
    assert (grade.min_feed_ratio, grade.max_feed_ratio) == (None, None)
    assert (grade.min_feed, grade.max_feed) == (0.03, 0.07)
    assert (grade.min_cutting_speed, grade.max_cutting_speed) == (2000.0, 3000.0)
    assert grade.youngs_modulus == KNOWN.youngs_modulus


def test_a_greatest_feed_alone_leaves_no_least_one() -> None:
    grade = grade_of_table_tool(replace(MILL, max_feed=0.07), STEEL)
    assert grade is not None
    assert (grade.min_feed, grade.max_feed) == (None, 0.07)


@pytest.mark.parametrize("kind", [ToolKind.ENDMILL, ToolKind.DRILL])
def test_what_the_vendor_says_is_not_borrowed_from_another_group(kind: ToolKind) -> None:
    unknown = replace(STEEL, iso_group="")
    of_library = grade_of_table_tool(replace(MILL, kind=kind), unknown)
    of_vendor = grade_of_table_tool(replace(MILL, kind=kind, max_feed=0.07), unknown)
    assert of_library is not None
    assert of_vendor is not None
    assert of_library.borrowed
    assert (of_vendor.max_feed, of_vendor.borrowed) == (0.07, "")
