"""Boundaries have the area and the length that geometry gives them."""

from math import pi, sqrt

import pytest

from optimiser.cuts.region import BoundarySize, circle_outline, closed_outline, open_outline
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program

PROGRAM = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','',(''),(''),'','','');
FILE_SCHEMA(('MACHINING_SCHEMA'));
ENDSEC;
DATA;
#1=PROJECT('',#2,(),$,$,$);
#2=WORKPLAN('',(),$,$,$);
#5=PLUS_MINUS_VALUE(0.1,0.1,3);
#6=TOLERANCED_LENGTH_MEASURE(20.,#5);
#7=TOLERANCED_LENGTH_MEASURE(30.,#5);
#11=CARTESIAN_POINT('',(0.,0.,0.));
#12=CARTESIAN_POINT('',(30.,0.,0.));
#13=CARTESIAN_POINT('',(30.,20.,0.));
#14=CARTESIAN_POINT('',(0.,20.,0.));
#15=POLYLINE('',(#11,#12,#13,#14));
%s
ENDSEC;
END-ISO-10303-21;
"""


def program(*lines: str) -> Program:
    data = PROGRAM % "\n".join(lines)
    return Program(Part21File.from_bytes(data.encode()))


def closed(line: str) -> BoundarySize:
    return closed_outline(program(f"#20={line};"), Ref(20))


def test_a_rectangle() -> None:
    outline = closed("RECTANGULAR_CLOSED_PROFILE($,#6,#7)")
    assert outline == BoundarySize(area=600.0, length=100.0, width=20.0)


def test_a_circle() -> None:
    outline = circle_outline(10.0)
    assert outline.area == pytest.approx(25.0 * pi)
    assert outline.length == pytest.approx(10.0 * pi)


def test_a_hexagon_in_its_circle_and_across_its_flats() -> None:
    """Regular hexagon: area 3√3/2·R², and 2√3·r²."""
    inside = closed("NGON_CLOSED_PROFILE($,#6,6,.T.)")
    assert inside.area == pytest.approx(1.5 * sqrt(3.0) * 10.0**2)
    across = closed("NGON_CLOSED_PROFILE($,#6,6,.F.)")
    assert across.area == pytest.approx(2.0 * sqrt(3.0) * 10.0**2)
    assert across.width == pytest.approx(20.0)


def test_a_polyline_is_closed_by_its_last_side() -> None:
    outline = closed("GENERAL_CLOSED_PROFILE($,#15)")
    assert (outline.area, outline.length, outline.width) == (600.0, 100.0, 20.0)


def test_an_open_polyline_keeps_its_gap() -> None:
    outline = open_outline(program("#20=GENERAL_PROFILE($,#15);"), Ref(20))
    assert (outline.area, outline.length) == (600.0, 80.0)


def test_a_half_circle() -> None:
    outline = open_outline(program("#20=PARTIAL_CIRCULAR_PROFILE($,#6,180.);"), Ref(20))
    assert outline.length == pytest.approx(20.0 * pi)
    assert outline.area == pytest.approx(0.5 * pi * 20.0**2)
