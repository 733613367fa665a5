"""The tool grades of one kind of tool."""

from math import radians
from pathlib import Path

import pytest

from simulator.errors import LibraryError
from simulator.files.grade_file import read_grades
from simulator.spec import ToolGrade, ToolKind
from tests.every_case import every_case

GOOD = """
title = "My drills"

[edge.hss]
min_chip_thickness_mm = 0.01
youngs_modulus_n_mm2 = 210_000
bending_strength_n_mm2 = 800
rake_angle_deg = 20
source = "maker"

[[grade]]
cutting_material = "hss"
iso_group = "P"
min_feed_ratio = 0.01
max_feed_ratio = 0.02
min_cutting_speed_m_min = 12
max_cutting_speed_m_min = 30
source = "shop"
"""


def grades_of(text: str, folder: Path) -> tuple[ToolGrade, ...]:
    path = folder / "drill.toml"
    path.write_text(text, encoding="utf-8")
    return read_grades(path, ToolKind.DRILL)


def test_a_grade_joins_its_row_and_its_edge(tmp_path: Path) -> None:
    (grade,) = grades_of(GOOD, tmp_path)
    assert grade.name == "hss drill P"
    assert (grade.min_feed_ratio, grade.max_feed_ratio) == (0.01, 0.02)
    assert grade.max_cutting_speed == 500.0
    assert grade.rake_angle == pytest.approx(radians(20))
    assert grade.max_depth is None
    assert grade.source == "shop; maker"
    assert grade.helix_angle == 0.0


def test_the_helix_belongs_to_the_edge(tmp_path: Path) -> None:
    (grade,) = grades_of(GOOD.replace("rake", "helix_deg = 35\nrake"), tmp_path)
    assert grade.helix_angle == pytest.approx(radians(35))
    with pytest.raises(LibraryError, match=r"helix_deg.*75"):
        grades_of(GOOD.replace("rake", "helix_deg = 80\nrake"), tmp_path)


@every_case(
    ("good", "bad", "key", "word"),
    [
        (
            "max_feed_ratio = 0.02",
            "max_feed_ratio = 2",
            "grade[1].max_feed_ratio",
            "exceeds 0.2",
        ),
        ("max_feed_ratio", "max_feed_per_rev", "grade[1].max_feed_per_rev", "unknown key"),
        ('iso_group = "P"', 'iso_group = ""', "grade[1].iso_group", "not one of"),
        (
            "min_cutting_speed_m_min = 12\n",
            "",
            "grade[1]",
            "two ends",
        ),
        ("[edge.hss]", "[edge.carbide]", "grade[1].cutting_material", "no [edge.hss]"),
        (
            "[edge.hss]",
            "[edge.hsss]",
            "edge.hsss",
            "unknown key",
        ),
        (
            "min_chip_thickness_mm = 0.01",
            "min_chip_thickness_mm = 1",
            "edge.hss.min_chip_thickness_mm",
            "exceeds 0.1",
        ),
    ],
)
def test_a_bad_value_is_told_with_key_value_and_bound(
    good: str, bad: str, key: str, word: str, tmp_path: Path
) -> None:
    assert good in GOOD
    with pytest.raises(LibraryError) as caught:
        grades_of(GOOD.replace(good, bad, 1), tmp_path)
    assert caught.value.key == key
    assert word in caught.value.message
