"""NC code that becomes slower says first which bound it breaks, and what would help."""

import re

import pytest

from service.rendering.columns import dump
from service.verbs.optimise.code_result import CodeAdvice
from tests.service.along_path.foreign import END, HEAD, LATHE, MILL, advised, slot

DEEP = HEAD.replace("T1 M6", "T2 M6") + slot(40.0).replace("Z-4.", "Z-8.").replace(
    "F300.", "F700."
)
"""A slot as wide and as deep as the mill of 8 mm: it bends."""

SAID = re.compile(
    r"T2 takes (?P<after>[0-9.]+) s instead of (?P<before>[0-9.]+) s: as programmed "
    r"(?P<words>.+) exceeds its bound of (?P<bound>[0-9.]+) (?P<unit>\S+) by "
    r"(?P<excess>[0-9.]+) %.*; .* would help$"
)


def first_line(found: CodeAdvice) -> str:
    return str(found).splitlines()[0]


def test_the_first_line_names_bound_excess_and_remedy() -> None:
    found = advised(DEEP + END)
    said = SAID.match(first_line(found))
    assert said is not None, first_line(found)
    assert float(said["before"]) == pytest.approx(found.along.time_before, rel=1e-3)
    assert float(said["after"]) == pytest.approx(found.along.time_after, rel=1e-3)
    assert said["words"].startswith("on line 8 shank strength ")
    assert float(said["excess"]) > 10.0
    assert "a thicker tool or a shorter overhang" in first_line(found)


def test_json_and_report_say_it_too() -> None:
    found = advised(DEEP + END)
    record = found.record()
    assert record["slower_than_programmed"] == [first_line(found)]
    assert dump(record)
    assert "exceeds its bound" in found.page()


def test_code_that_becomes_faster_says_nothing() -> None:
    found = advised(HEAD + slot(10.0) + END)
    assert found.along.time_after < found.along.time_before
    assert found.record()["slower_than_programmed"] == []
    assert "instead of" not in str(found)
    assert first_line(found).startswith("part.nc: control")


def test_a_turning_tool_that_is_fed_too_fast_says_its_feed_per_revolution() -> None:
    text = (
        "%\nO0001\nG21 G40 G99\nG50 S2500\nT0101\nG97 S1000 M3\nG0 X55. Z2.\nG0 X46.\n"
        "G1 Z-40. F0.9\nG0 X60.\nG0 X100. Z50.\nM30\n%\n"
    )
    said = first_line(advised(text, LATHE))
    assert said.startswith("T1 takes ")
    assert "on line 9 feed per revolution 0.9 mm exceeds its bound of " in said


def test_a_part_that_is_slower_is_told_where_others_gain_more() -> None:
    text = (
        HEAD
        + slot(10.0)
        + "T2 M6\nS3000 M3\n"
        + slot(40.0).replace("Z-4.", "Z-8.").replace("F300.", "F700.")
    )
    found = advised(text + END, MILL)
    assert [each[:3] for each in found.record()["slower_than_programmed"]] == ["T2 "]
