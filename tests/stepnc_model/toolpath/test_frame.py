"""Placements as rigid motions, against ISO 10303-42 and plain geometry."""

from math import cos, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.frame import (
    Frame,
    compound_of,
    direction_of,
    feature_frame,
    frame_of,
    point_of,
    surrounding_frame,
    workpiece_frame,
)
from stepnc_model.toolpath.path import Point

HEADER = (
    "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('MACHINING_SCHEMA'));\nENDSEC;\nDATA;\n"
    "#1=PROJECT('P',#2,(),$,$,$);\n#2=WORKPLAN('W',(),$,$,$);\n"
)
NUMBERS = st.floats(-100.0, 100.0)
POINTS = st.tuples(NUMBERS, NUMBERS, NUMBERS)


def read(*instances: str) -> Program:
    body = "\n".join(instances)
    return Program(
        Part21File.from_bytes(f"{HEADER}{body}\nENDSEC;\nEND-ISO-10303-21;".encode())
    )


def placed(axis: str = "$", ref_direction: str = "$") -> Frame:
    """Frame #10 at (1, 2, 3)."""
    directions = []
    for id, ratios in ((12, axis), (13, ref_direction)):
        if ratios != "$":
            directions.append(f"#{id}=DIRECTION('',({ratios}));")
    z = "#12" if axis != "$" else "$"
    x = "#13" if ref_direction != "$" else "$"
    program = read(
        f"#10=AXIS2_PLACEMENT_3D('',#11,{z},{x});",
        "#11=CARTESIAN_POINT('',(1.,2.,3.));",
        *directions,
    )
    return frame_of(program, Ref(10))


def turned(angle: float, origin: Point) -> Frame:
    return Frame(
        origin=origin, x=(cos(angle), sin(angle), 0.0), y=(-sin(angle), cos(angle), 0.0)
    )


class TestFrame:
    @given(a=st.floats(-7, 7), b=st.floats(-7, 7), p=POINTS, q=POINTS, at=POINTS)
    def test_a_frame_within_a_frame_is_one_after_the_other(
        self, a: float, b: float, p: Point, q: Point, at: Point
    ) -> None:
        outer, inner = turned(a, p), turned(b, q)
        expected = outer.point(inner.point(at))
        assert outer.inner(inner).point(at) == pytest.approx(expected, abs=1e-9)

    def test_a_quarter_turn_takes_x_to_y(self) -> None:
        frame = turned(0.5 * pi, (10.0, 0.0, 5.0))
        assert frame.point((1.0, 0.0, 0.0)) == pytest.approx((10.0, 1.0, 5.0))
        assert frame.direction((0.0, 1.0, 0.0)) == pytest.approx((-1.0, 0.0, 0.0))

    def test_upright_means_along_z_and_not_against_it(self) -> None:
        assert turned(1.0, (0.0, 0.0, 0.0)).is_upright
        assert not Frame(y=(0.0, -1.0, 0.0), z=(0.0, 0.0, -1.0)).is_upright
        assert not placed(axis="0.,0.01,1.").is_upright


class TestPlacement:
    def test_none_is_the_coordinates_around_it(self) -> None:
        assert frame_of(read(), None) == Frame()

    def test_without_directions_it_is_moved_only(self) -> None:
        assert placed() == Frame(origin=(1.0, 2.0, 3.0))

    def test_ref_direction_is_made_square_to_the_axis(self) -> None:
        frame = placed(axis="0.,0.,2.", ref_direction="3.,3.,99.")
        assert frame.x == pytest.approx((0.5**0.5, 0.5**0.5, 0.0))
        assert frame.y == pytest.approx((-(0.5**0.5), 0.5**0.5, 0.0))
        assert frame.z == (0.0, 0.0, 1.0)

    @pytest.mark.parametrize("axis", ["1.,0.,0.", "-1.,0.,0."])
    def test_an_axis_along_x_has_its_x_along_y(self, axis: str) -> None:
        """ISO 10303-42, first_proj_axis."""
        assert placed(axis=axis).x == (0.0, 1.0, 0.0)

    @pytest.mark.parametrize("axis", ["0.,1.,0.", "1.,2.,3.", "-1.,0.,0."])
    def test_axes_are_right_handed(self, axis: str) -> None:
        frame = placed(axis=axis)
        x, y, z = frame.x, frame.y, frame.z
        cross = (
            x[1] * y[2] - x[2] * y[1],
            x[2] * y[0] - x[0] * y[2],
            x[0] * y[1] - x[1] * y[0],
        )
        assert cross == pytest.approx(z)

    def test_ref_direction_along_the_axis_is_refused(self) -> None:
        with pytest.raises(PathError, match=r"#10 .*ref_direction is parallel to the axis"):
            placed(axis="0.,0.,1.", ref_direction="0.,0.,-3.")

    def test_a_direction_of_length_0_is_refused(self) -> None:
        with pytest.raises(PathError, match=r"#12 DIRECTION.*ratios are all 0"):
            placed(axis="0.,0.,0.")

    def test_a_placement_in_the_plane_lies_in_xy(self) -> None:
        program = read(
            "#10=AXIS2_PLACEMENT_2D('',#11,#12);",
            "#11=CARTESIAN_POINT('',(1.,2.));",
            "#12=DIRECTION('',(0.,1.));",
        )
        frame = frame_of(program, Ref(10))
        assert frame.origin == (1.0, 2.0, 0.0)
        assert frame.x == (0.0, 1.0, 0.0)
        assert frame.is_upright

    def test_a_point_is_no_placement(self) -> None:
        program = read("#10=CARTESIAN_POINT('',(1.,2.));")
        with pytest.raises(PathError, match="is not a placement"):
            frame_of(program, Ref(10))

    def test_missing_coordinates_are_0(self) -> None:
        program = read("#10=CARTESIAN_POINT('',(1.,2.));", "#11=DIRECTION('',(0.,-4.));")
        assert point_of(program, Ref(10)) == (1.0, 2.0, 0.0)
        assert direction_of(program, Ref(11)) == (0.0, -1.0, 0.0)

    def test_what_is_no_point_or_direction_is_refused(self) -> None:
        program = read("#10=CARTESIAN_POINT('',(1.,2.));", "#11=DIRECTION('',(0.,-4.));")
        with pytest.raises(PathError, match="is not a point"):
            point_of(program, Ref(11))
        with pytest.raises(PathError, match="is not a direction"):
            direction_of(program, Ref(10))


class TestFeature:
    """A hole at (1, 2, -3) in a compound at (10, 0, 0) on a workpiece at (0, 0, 100)."""

    PROGRAM = read(
        "#10=SETUP('S',$,#30,(#11));",
        "#11=WORKPIECE_SETUP(#40,#12,$,$,());",
        "#12=AXIS2_PLACEMENT_3D('',#13,$,#14);",
        "#13=CARTESIAN_POINT('',(0.,0.,100.));",
        "#14=DIRECTION('',(0.,1.,0.));",
        "#20=ROUND_HOLE('H',#40,(),#21,#30,#50,$,#51);",
        "#21=AXIS2_PLACEMENT_3D('',#22,$,$);",
        "#22=CARTESIAN_POINT('',(1.,2.,-3.));",
        "#23=COUNTERBORE_HOLE('C',#40,(),#24,(#20));",
        "#24=AXIS2_PLACEMENT_3D('',#25,$,$);",
        "#25=CARTESIAN_POINT('',(10.,0.,0.));",
        "#26=ROUND_HOLE('ALONE',#40,(),#24,#30,#50,$,#51);",
        "#30=PLANE('',#21);",
        "#40=WORKPIECE('W',$,$,$,$,$,());",
        "#51=THROUGH_BOTTOM_CONDITION();",
    )

    def test_the_workpiece_is_placed_in_its_setup(self) -> None:
        frame = workpiece_frame(self.PROGRAM, Ref(10))
        assert frame.origin == (0.0, 0.0, 100.0)
        assert frame.x == (0.0, 1.0, 0.0)

    def test_without_a_setup_the_workpiece_is_the_setup(self) -> None:
        assert workpiece_frame(self.PROGRAM, None) == Frame()

    def test_a_feature_is_placed_on_its_workpiece(self) -> None:
        frame = feature_frame(self.PROGRAM, Ref(10), Ref(26))
        assert frame.origin == pytest.approx((0.0, 10.0, 100.0))

    def test_an_element_is_placed_in_its_compound_feature(self) -> None:
        assert compound_of(self.PROGRAM, Ref(20)) == Ref(23)
        assert surrounding_frame(self.PROGRAM, None, Ref(20)).origin == (10.0, 0.0, 0.0)
        assert feature_frame(self.PROGRAM, None, Ref(20)).origin == (11.0, 2.0, -3.0)

    def test_a_feature_of_its_own_is_in_no_compound(self) -> None:
        assert compound_of(self.PROGRAM, Ref(26)) is None
