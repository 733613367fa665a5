"""Tools of the sample parts as bodies."""

from math import pi, radians
from pathlib import Path

import pytest

from simulator.removal.cutter import Cutter, Insert, shape_of
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program

PARTS = Path(__file__).parents[3] / "examples" / "parts"


def shape(part: str, workingstep: str, *change: str) -> Cutter | Insert | None:
    text = (PARTS / f"{part}.stpnc").read_text()
    if change:
        assert change[0] in text
        text = text.replace(change[0], change[1])
    program = Program(Part21File.from_bytes(text.encode(), name=part), name=part)
    (step,) = (each for each in program.workingsteps if each.id == workingstep)
    return shape_of(program, step.tool_ref)


def test_an_end_mill_cuts_with_its_side() -> None:
    found = shape("paper002", "ROUGH THE FACE")
    assert isinstance(found, Cutter)
    assert (found.diameter, found.teeth, found.is_drill) == (18.0, 4, False)
    assert found.edge_length == 29.0
    assert found.point_angle == pytest.approx(pi)


def test_a_tapered_end_mill_grows_upward() -> None:
    found = shape(
        "paper002", "ROUGH THE FACE",
        "#51=TAPERED_ENDMILL(#52,4,.RIGHT.,.F.,$,$);",
        "#51=TAPERED_ENDMILL(#52,4,.RIGHT.,.F.,$,5.);",
    )  # fmt: skip
    assert isinstance(found, Cutter)
    assert found.taper_angle == pytest.approx(radians(5.0))


def test_a_drill_cuts_with_its_end() -> None:
    found = shape("bracket", "DRILL HOLE 1")
    assert isinstance(found, Cutter)
    assert found.is_drill
    assert found.diameter == 9.8
    assert found.point_angle < pi


def test_an_insert_has_its_nose_and_a_blade_its_width() -> None:
    nose, blade = shape("shaft", "ROUGH CONTOUR"), shape("shaft", "THREAD RELIEF")
    assert isinstance(nose, Insert)
    assert isinstance(blade, Insert)
    assert nose.nose_radius > 0.0
    assert nose.width is None
    assert blade.width == 3.0


def test_threads_are_no_part_of_the_map() -> None:
    assert shape("shaft", "THREAD M30 X 2") is None
