"""Ways to a cut: lines and arcs that meet it as they should."""

from math import cos, dist, radians, sin

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.curve import Bend, Segment
from stepnc_model.toolpath.explicit.path_builder import (
    approach_segments,
    lift_segments,
    point_on_plane,
)
from stepnc_model.toolpath.frame import Frame
from stepnc_model.toolpath.path import Point

HEADER = (
    "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('MACHINING_SCHEMA'));\nENDSEC;\nDATA;\n"
    "#1=PROJECT('P',#2,(),$,$,$);\n#2=WORKPLAN('W',(),$,$,$);\n"
)
CUT = Segment(start=(0.0, 0.0, 0.0), end=(10.0, 0.0, 0.0))
NUMBERS = st.floats(-50.0, 50.0)


def program(path: str, fix: Point = (0.0, 0.0, 0.0)) -> Program:
    x, y, z = fix
    text = (
        f"{HEADER}#10={path};\n#11=CARTESIAN_POINT('',({x!r},{y!r},{z!r}));\n"
        "#12=DIRECTION('',(1.,0.,2.));\n#13=DIRECTION('',(1.,0.,0.));\n"
        "ENDSEC;\nEND-ISO-10303-21;\n"
    )
    return Program(Part21File.from_bytes(text.encode()))


def approach(path: str, fix: Point, cut: Segment = CUT) -> tuple[Segment, ...]:
    return approach_segments(program(path, fix), Ref(10), frame=Frame(), cut=cut)


def angle(degrees: float, before: float) -> str:
    return f"AP_LIFT_PATH_ANGLE(.T.,.APPROACH.,$,$,$,#11,$,{degrees!r},{before!r})"


def tangent(radius: float) -> str:
    return f"AP_LIFT_PATH_TANGENT(.T.,.APPROACH.,$,$,$,#11,$,{radius!r})"


def minus(one: Point, other: Point) -> Point:
    return one[0] - other[0], one[1] - other[1], one[2] - other[2]


def dot(one: Point, other: Point) -> float:
    return sum(a * b for a, b in zip(one, other, strict=True))


class TestAngle:
    def test_it_bends_before_the_cut_and_above_it(self) -> None:
        first, second = approach(angle(30.0, 4.0), (-20.0, 5.0, 20.0))
        bend = (-4.0 * cos(radians(30.0)), 0.0, 4.0 * sin(radians(30.0)))
        assert first.start == (-20.0, 5.0, 20.0)
        assert first.end == second.start == pytest.approx(bend)
        assert second.end == CUT.start

    def test_an_arc_is_met_along_its_tangent(self) -> None:
        """A quarter about the origin from (5, 0): its tangent there is y."""
        arc = Segment(
            start=(5.0, 0.0, 0.0),
            end=(0.0, 5.0, 0.0),
            bend=Bend(centre=(0.0, 0.0, 0.0), normal=(0.0, 0.0, 1.0), turn=1.5707963267948966),
        )
        assert approach(angle(0.0, 2.0), (9.0, 9.0, 9.0), arc)[1].start == (5.0, -2.0, 0.0)
        back = approach(angle(0.0, 2.0), (9.0, 9.0, 9.0), arc.reversed())
        assert back[1].start == pytest.approx((-2.0, 5.0, 0.0))

    def test_a_lift_is_an_approach_backwards(self) -> None:
        first, second = lift_segments(
            program(angle(30.0, 4.0), (20.0, 5.0, 20.0)), Ref(10), frame=Frame(), cut=CUT
        )
        bend = (10.0 + 4.0 * cos(radians(30.0)), 0.0, 4.0 * sin(radians(30.0)))
        assert first.start == CUT.end
        assert first.end == second.start == pytest.approx(bend)
        assert second.end == (20.0, 5.0, 20.0)


class TestTangent:
    def test_a_fixed_point_beside_the_centre_is_reached_by_a_quarter(self) -> None:
        """Radius 5 mm, centre (0, 5): from (−5, 20) straight down to (−5, 5)."""
        line, arc = approach(tangent(5.0), (-5.0, 20.0, 0.0))
        assert line.end == arc.start == pytest.approx((-5.0, 5.0, 0.0))
        assert arc.bend is not None
        assert arc.bend.centre == pytest.approx((0.0, 5.0, 0.0))
        assert arc.bend.turn == pytest.approx(0.5 * 3.141592653589793)
        assert arc.bend.normal == pytest.approx((0.0, 0.0, 1.0))

    @given(x=NUMBERS, y=NUMBERS, z=NUMBERS, radius=st.floats(0.5, 20.0))
    def test_line_arc_and_cut_meet_smoothly(
        self, x: float, y: float, z: float, radius: float
    ) -> None:
        height = (y * y + z * z) ** 0.5
        assume(height > 1.0)
        assume((x * x + (height - radius) ** 2) ** 0.5 > radius + 0.1)
        line, arc = approach(tangent(radius), (x, y, z))
        assert arc.bend is not None
        centre = arc.bend.centre
        assert dist(arc.start, centre) == pytest.approx(radius)
        assert dist(arc.end, centre) == pytest.approx(radius)
        assert dot(minus(centre, CUT.start), (1.0, 0.0, 0.0)) == pytest.approx(0.0, abs=1e-9)
        assert dot(minus(line.end, line.start), minus(line.end, centre)) == pytest.approx(
            0.0, abs=1e-6
        )
        assert 0.0 <= arc.bend.turn < 6.2831854

    def test_a_fixed_point_on_the_tangent_is_refused(self) -> None:
        with pytest.raises(PathError, match="lies on the tangent"):
            approach(tangent(5.0), (-20.0, 0.0, 0.0))

    def test_a_fixed_point_within_the_arc_is_refused(self) -> None:
        with pytest.raises(PathError, match="within the arc of radius 5 mm"):
            approach(tangent(5.0), (1.0, 5.0, 0.0))


class TestSecurityPlane:
    def test_without_direction_it_is_straight_above(self) -> None:
        found = point_on_plane(
            program(tangent(1.0)), (1.0, 2.0, 3.0), None, frame=Frame(), height=30.0
        )
        assert found == (1.0, 2.0, 30.0)

    def test_a_direction_leans(self) -> None:
        found = point_on_plane(
            program(tangent(1.0)), (1.0, 2.0, 0.0), Ref(12), frame=Frame(), height=30.0
        )
        assert found == pytest.approx((16.0, 2.0, 30.0))

    def test_a_level_direction_is_refused(self) -> None:
        with pytest.raises(PathError, match=r"#13 .*the direction is level"):
            point_on_plane(
                program(tangent(1.0)), (1.0, 2.0, 0.0), Ref(13), frame=Frame(), height=30.0
            )
