"""Trajectories as ways of the tool's tip: curves, contact points and machine axes."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.programs.tool import Tool
from stepnc_model.toolpath.curve import Segment
from stepnc_model.toolpath.explicit.trajectory import trajectory_segments
from stepnc_model.toolpath.frame import Frame
from stepnc_model.toolpath.path import Point
from tests.every_case import every_case

HEADER = (
    "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('MACHINING_SCHEMA'));\nENDSEC;\nDATA;\n"
    "#1=PROJECT('P',#2,(),$,$,$);\n#2=WORKPLAN('W',(),$,$,$);\n"
)
COMMON = (
    "#20=POLYLINE('',(#21,#22));\n#21=CARTESIAN_POINT('',(0.,0.,0.));\n"
    "#22=CARTESIAN_POINT('',(10.,0.,0.));\n#23=POLYLINE('',(#24,#24));\n"
    "#25=CURVE_WITH_NORMAL_VECTOR(#20,#23);\n"
    "#30=POLYLINE('',(#31,#32));\n#31=CARTESIAN_POINT('',(1.));\n#32=CARTESIAN_POINT('',(3.));\n"
    "#33=POLYLINE('',(#31,#32,#31));\n#34=CIRCLE('',#35,1.);\n"
    "#35=AXIS2_PLACEMENT_3D('',#21,$,$);\n"
    "#36=POLYLINE('',(#37,#37));\n#37=CARTESIAN_POINT('',(0.,0.,2.));\n"
    "#38=POLYLINE('',(#37,#39));\n#39=CARTESIAN_POINT('',(0.1,0.,1.));\n"
)
BALL = Tool(id="B", keyword="BALL_ENDMILL", diameter=10.0, corner_radius=5.0)
FLAT = Tool(id="F", keyword="ENDMILL", diameter=10.0)
BULL = Tool(id="R", keyword="BULLNOSE_ENDMILL", diameter=10.0, corner_radius=2.0)
SHIFTED = Frame(origin=(100.0, 0.0, 0.0), x=(0.0, 1.0, 0.0), y=(-1.0, 0.0, 0.0))


def traced(
    trajectory: str,
    *,
    tool: Tool | None = None,
    normal: Point = (0.0, 0.0, 1.0),
    frame: Frame | None = None,
    at: Point | None = None,
) -> tuple[Segment, ...]:
    x, y, z = normal
    text = (
        f"{HEADER}{COMMON}#24=CARTESIAN_POINT('',({x!r},{y!r},{z!r}));\n"
        f"#10={trajectory};\nENDSEC;\nEND-ISO-10303-21;\n"
    )
    program = Program(Part21File.from_bytes(text.encode()))
    return trajectory_segments(
        program,
        Ref(10),
        frame=frame or Frame(),
        tool=None if tool is None else lambda: tool,
        at=at,
    )


def location(direction: str = "$", axis: str = "$") -> str:
    return f"CUTTER_LOCATION_TRAJECTORY(.T.,.CONTACT.,$,$,$,{direction},#20,{axis},$)"


def contact(curve: int = 25) -> str:
    return f"CUTTER_CONTACT_TRAJECTORY(.T.,.CONTACT.,$,$,$,$,#{curve},$,$)"


def axes(names: str, commands: str) -> str:
    return f"AXIS_TRAJECTORY(.T.,.CONTACT.,$,$,$,$,({names}),({commands}))"


class TestLocation:
    def test_it_is_its_curve_in_its_frame(self) -> None:
        (segment,) = traced(location(), frame=SHIFTED)
        assert (segment.start, segment.end) == ((100.0, 0.0, 0.0), (100.0, 10.0, 0.0))

    @pytest.mark.parametrize("direction", ["$", ".T."])
    def test_it_runs_with_its_curve(self, direction: str) -> None:
        assert traced(location(direction))[0].end == (10.0, 0.0, 0.0)

    def test_a_false_direction_runs_it_backwards(self) -> None:
        (segment,) = traced(location(".F."))
        assert (segment.start, segment.end) == ((10.0, 0.0, 0.0), (0.0, 0.0, 0.0))

    def test_an_upright_tool_axis_is_followed(self) -> None:
        assert len(traced(location(axis="#36"))) == 1

    @every_case("axis", ["#38", "#20", "#34"])
    def test_a_tool_axis_that_leans_is_refused(self, axis: str) -> None:
        with pytest.raises(PathError, match="the tool axis"):
            traced(location(axis=axis))


class TestContact:
    @given(x=st.floats(-1.0, 1.0), y=st.floats(-1.0, 1.0), z=st.floats(0.1, 1.0))
    def test_a_balls_centre_lies_along_the_normal(self, x: float, y: float, z: float) -> None:
        size = (x * x + y * y + z * z) ** 0.5
        (segment,) = traced(contact(), tool=BALL, normal=(x, y, z))
        centre = tuple(5.0 * part / size for part in (x, y, z))
        expected = (centre[0], centre[1], centre[2] - 5.0)
        assert segment.start == pytest.approx(expected, abs=1e-9)

    def test_a_flat_tool_stands_beside_a_wall(self) -> None:
        (segment,) = traced(contact(), tool=FLAT, normal=(0.0, -2.0, 0.0))
        assert (segment.start, segment.end) == ((0.0, -5.0, 0.0), (10.0, -5.0, 0.0))

    def test_a_rounded_corner_touches_a_slope(self) -> None:
        """R = 5, r = 2, normal (0, 0.6, 0.8): 3 + 2·0.6 aside, 2·0.8 − 2 below."""
        (segment,) = traced(contact(), tool=BULL, normal=(0.0, 0.6, 0.8))
        assert segment.start == pytest.approx((0.0, 4.2, -0.4))

    def test_the_normal_is_turned_with_its_frame(self) -> None:
        (segment,) = traced(contact(), tool=FLAT, normal=(0.0, -1.0, 0.0), frame=SHIFTED)
        assert segment.start == pytest.approx((105.0, 0.0, 0.0))

    @every_case(
        ("tool", "normal", "message"),
        [
            (FLAT, (0.0, 0.0, 1.0), "a flat tool on a level surface"),
            (BALL, (0.0, 0.0, 0.0), "has zero length"),
            (None, (0.0, 0.0, 1.0), "needs a rotating tool"),
        ],
    )
    def test_what_the_normal_does_not_tell_is_refused(
        self, tool: Tool | None, normal: Point, message: str
    ) -> None:
        with pytest.raises(PathError, match=message):
            traced(contact(), tool=tool, normal=normal)

    def test_contact_without_normals_is_refused(self) -> None:
        with pytest.raises(PathError, match="has no surface normals"):
            traced(contact(20), tool=BALL)


class TestAxes:
    def test_named_axes_move_together_from_where_they_are(self) -> None:
        first, second = traced(axes("'X','z'", "#30,#30"), at=(0.0, 7.0, 0.0))
        assert first.start == (0.0, 7.0, 0.0)
        assert first.end == second.start == (1.0, 7.0, 1.0)
        assert second.end == (3.0, 7.0, 3.0)

    def test_all_three_need_no_start(self) -> None:
        (segment,) = traced(axes("'Y','Z','X'", "#30,#30,#30"))
        assert (segment.start, segment.end) == ((1.0, 1.0, 1.0), (3.0, 3.0, 3.0))

    def test_they_are_those_of_the_setup(self) -> None:
        (segment,) = traced(axes("'X','Y','Z'", "#30,#30,#30"), frame=SHIFTED)
        assert segment.start == (1.0, 1.0, 1.0)

    @every_case(
        ("names", "commands", "message"),
        [
            ("'X'", "#30", "positions of the other axes"),
            ("'X','Y','B'", "#30,#30,#30", "axes X, Y, B"),
            ("'X','X'", "#30,#30", "each once"),
            ("'X','Y','Z'", "#30,#30", "3 axes but 2 commands"),
            ("'X','Y','Z'", "#30,#30,#33", "different numbers of points"),
            ("'X','Y','Z'", "#30,#30,#34", "is not a polyline"),
        ],
    )
    def test_what_does_not_fit_is_refused(
        self, names: str, commands: str, message: str
    ) -> None:
        with pytest.raises(PathError, match=message):
            traced(axes(names, commands))
