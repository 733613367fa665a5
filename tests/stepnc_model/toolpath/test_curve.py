"""Curves of the file as lines and arcs, against ISO 10303-42 and plain geometry."""

from itertools import pairwise
from math import cos, dist, hypot, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.errors import PathError, SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.arc import length
from stepnc_model.toolpath.curve import (
    CHORD_TOLERANCE,
    Bend,
    Segment,
    local,
    move_of,
    segments_of,
)
from stepnc_model.toolpath.frame import Frame
from stepnc_model.toolpath.path import ArcPlane, MoveType, Point
from tests.every_case import every_case

HEADER = (
    "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('MACHINING_SCHEMA'));\nENDSEC;\nDATA;\n"
    "#1=PROJECT('P',#2,(),$,$,$);\n#2=WORKPLAN('W',(),$,$,$);\n"
)
POINTS = (
    "#11=CARTESIAN_POINT('',(0.,0.,0.));",
    "#12=CARTESIAN_POINT('',(5.,0.,0.));",
    "#13=CARTESIAN_POINT('',(0.,5.,0.));",
    "#14=CARTESIAN_POINT('',(0.,-5.,0.));",
    "#15=CARTESIAN_POINT('',(9.,9.,0.));",
    "#20=CIRCLE('',#21,5.);",
    "#21=AXIS2_PLACEMENT_3D('',#11,$,$);",
    "#22=LINE('',#12,#23);",
    "#23=VECTOR('',#24,10.);",
    "#24=DIRECTION('',(0.,0.,7.));",
    "#25=ELLIPSE('',#21,20.,5.);",
    "#26=POLYLINE('',(#11,#12,#13));",
    "#27=POLYLINE('',(#13,#14));",
    "#28=HELIX('',#21,5.,8.);",
    "#29=B_SPLINE_CURVE('',2,(#11,#12,#13),.UNSPECIFIED.,.F.,.F.);",
)
BACK = Frame(y=(0.0, -1.0, 0.0), z=(0.0, 0.0, -1.0))


def read(*instances: str) -> tuple[Segment, ...]:
    """Segments of curve #10."""
    body = "\n".join((*POINTS, *instances))
    text = f"{HEADER}{body}\nENDSEC;\nEND-ISO-10303-21;\n"
    return segments_of(Program(Part21File.from_bytes(text.encode())), Ref(10))


def trimmed(basis: int, first: str, second: str, sense: str = ".T.") -> tuple[Segment, ...]:
    return read(f"#10=TRIMMED_CURVE('',#{basis},({first}),({second}),{sense},.CARTESIAN.);")


def ends(segments: tuple[Segment, ...]) -> list[Point]:
    return [segments[0].start, *(segment.end for segment in segments)]


class TestLines:
    def test_a_polyline_goes_from_point_to_point(self) -> None:
        segments = read("#10=POLYLINE('',(#11,#12,#13));")
        assert ends(segments) == [(0.0, 0.0, 0.0), (5.0, 0.0, 0.0), (0.0, 5.0, 0.0)]
        assert all(segment.bend is None for segment in segments)

    def test_a_point_that_is_said_twice_makes_no_segment(self) -> None:
        assert len(read("#10=POLYLINE('',(#11,#11,#12));")) == 1

    def test_a_composite_curve_is_its_parts_in_a_row(self) -> None:
        segments = read(
            "#10=COMPOSITE_CURVE('',(#31,#32),.F.);",
            "#31=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#26);",
            "#32=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#27);",
        )
        assert ends(segments)[-2:] == [(0.0, 5.0, 0.0), (0.0, -5.0, 0.0)]

    def test_a_part_against_its_sense_runs_backwards(self) -> None:
        segments = read(
            "#10=COMPOSITE_CURVE('',(#31),.F.);",
            "#31=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.F.,#26);",
        )
        assert ends(segments) == [(0.0, 5.0, 0.0), (5.0, 0.0, 0.0), (0.0, 0.0, 0.0)]

    def test_parts_that_do_not_join_are_refused(self) -> None:
        with pytest.raises(PathError, match="gap of 5 mm"):
            read(
                "#10=COMPOSITE_CURVE('',(#31,#32),.F.);",
                "#31=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#27);",
                "#32=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#26);",
            )

    def test_a_line_between_points(self) -> None:
        assert ends(trimmed(22, "#12", "#15")) == [(5.0, 0.0, 0.0), (9.0, 9.0, 0.0)]

    def test_parameters_of_a_line_count_in_lengths_of_its_vector(self) -> None:
        segments = trimmed(22, "PARAMETER_VALUE(0.5)", "PARAMETER_VALUE(-1.)")
        assert ends(segments) == [(5.0, 0.0, 5.0), (5.0, 0.0, -10.0)]

    def test_a_line_that_is_trimmed_by_nothing_is_refused(self) -> None:
        with pytest.raises(PathError, match="neither a point nor a parameter"):
            trimmed(22, "", "#12")


class TestArcs:
    @every_case(
        ("first", "second", "sense", "turn"),
        [
            ("#12", "#13", ".T.", 0.5 * pi),
            ("#12", "#13", ".F.", -1.5 * pi),
            ("#13", "#12", ".T.", 1.5 * pi),
            ("#12", "#14", ".F.", -0.5 * pi),
            ("#12", "#12", ".T.", 2.0 * pi),
            ("#12", "#12", ".F.", -2.0 * pi),
            ("PARAMETER_VALUE(0.)", "PARAMETER_VALUE(90.)", ".T.", 0.5 * pi),
        ],
    )
    def test_the_sense_tells_which_way_round(
        self, first: str, second: str, sense: str, turn: float
    ) -> None:
        (segment,) = trimmed(20, first, second, sense)
        assert segment.bend is not None
        assert segment.bend.turn == pytest.approx(turn)
        assert segment.bend.centre == (0.0, 0.0, 0.0)

    def test_it_ends_exactly_at_its_trimming_points(self) -> None:
        (segment,) = trimmed(20, "#12", "#13")
        assert (segment.start, segment.end) == ((5.0, 0.0, 0.0), (0.0, 5.0, 0.0))

    def test_a_point_beside_the_circle_is_refused(self) -> None:
        with pytest.raises(PathError, match=r"lies 7\.728 mm off its circle"):
            trimmed(20, "#12", "#15")

    def test_a_circle_by_itself_is_one_full_turn(self) -> None:
        (segment,) = read("#10=CIRCLE('',#21,3.);")
        assert segment.start == pytest.approx(segment.end)
        assert segment.bend is not None
        assert segment.bend.turn == 2.0 * pi

    def test_a_helix_has_the_turns_of_its_pitch(self) -> None:
        """From (5, 0, 0) to (0, 5, 18) with a pitch of 8: a quarter and two turns."""
        (segment,) = read(
            "#10=TRIMMED_CURVE('',#28,(#12),(#31),.T.,.CARTESIAN.);",
            "#31=CARTESIAN_POINT('',(0.,5.,18.));",
        )
        assert segment.bend is not None
        assert segment.bend.turn == pytest.approx(4.5 * pi)

    def test_a_right_hand_helix_turns_clockwise_on_its_way_down(self) -> None:
        (segment,) = read(
            "#10=TRIMMED_CURVE('',#28,(#12),(#31),.F.,.CARTESIAN.);",
            "#31=CARTESIAN_POINT('',(0.,5.,-6.));",
        )
        assert segment.bend is not None
        assert segment.bend.turn == pytest.approx(-1.5 * pi)

    def test_a_helix_without_points_is_refused(self) -> None:
        with pytest.raises(PathError, match="needs a pitch and two trimming points"):
            trimmed(28, "PARAMETER_VALUE(0.)", "PARAMETER_VALUE(90.)")


class TestChords:
    def test_chords_of_an_ellipse_stay_on_it(self) -> None:
        segments = read("#10=ELLIPSE('',#21,20.,5.);")
        points = ends(segments)
        for x, y, _ in points:
            assert hypot(x / 20.0, y / 5.0) == pytest.approx(1.0)
        for a, b in pairwise(points):
            x, y = 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])
            assert (1.0 - hypot(x / 20.0, y / 5.0)) * 5.0 <= CHORD_TOLERANCE

    def test_chords_of_a_parabola_stay_on_it(self) -> None:
        """Control points (0, 0), (5, 0), (0, 5): x = 10t(1−t), y = 5t²."""
        for x, y, _ in ends(
            read("#10=B_SPLINE_CURVE('',2,(#11,#12,#13),.UNSPECIFIED.,.F.,.F.);")
        ):
            part = (y / 5.0) ** 0.5
            assert x == pytest.approx(10.0 * part * (1.0 - part), abs=1e-9)

    def test_a_bounded_curve_trimmed_at_its_ends_is_itself(self) -> None:
        forward, back = trimmed(29, "#11", "#13"), trimmed(29, "#13", "#11", ".F.")
        assert ends(back) == ends(forward)[::-1]


@pytest.mark.parametrize(
    ("curve", "message"),
    [
        ("TRIMMED_CURVE('',#11,(#12),(#13),.T.,.CARTESIAN.)", "cannot be trimmed"),
        ("VECTOR('',#24,10.)", "this kind of curve is not supported"),
    ],
)
def test_other_things_are_refused(curve: str, message: str) -> None:
    with pytest.raises(SchemaError, match=message):
        read(f"#10={curve};")


class TestSegment:
    ARC = Segment(
        start=(5.0, 0.0, 1.0),
        end=(0.0, 5.0, 3.0),
        bend=Bend(centre=(0.0, 0.0, 0.0), normal=(0.0, 0.0, 1.0), turn=0.5 * pi),
    )

    def test_there_and_back_is_itself(self) -> None:
        assert self.ARC.reversed().reversed() == self.ARC
        bend = self.ARC.reversed().bend
        assert bend is not None
        assert bend.turn == -0.5 * pi

    def test_a_frame_takes_ends_centre_and_normal_along(self) -> None:
        frame = Frame(origin=(10.0, 0.0, 0.0), y=BACK.y, z=BACK.z)
        segment = self.ARC.within(frame)
        assert segment.start == (15.0, 0.0, -1.0)
        assert segment.end == (10.0, -5.0, -3.0)
        assert segment.bend == Bend(
            centre=(10.0, 0.0, 0.0), normal=(0.0, 0.0, -1.0), turn=0.5 * pi
        )

    def test_local_undoes_a_frame(self) -> None:
        frame = Frame(origin=(1.0, 2.0, 3.0), y=BACK.y, z=BACK.z)
        assert local(frame, frame.point((4.0, 5.0, 6.0))) == (4.0, 5.0, 6.0)


class TestMove:
    def test_a_line_is_one_rapid_where_it_has_no_feed(self) -> None:
        segment = Segment(start=(0.0, 0.0, 0.0), end=(1.0, 2.0, 3.0))
        (move,) = move_of(segment, MoveType.RAPID, None)
        assert (move.end, move.arc, move.feed) == ((1.0, 2.0, 3.0), None, None)

    @every_case(("plane", "sign"), [(p, s) for p in ArcPlane for s in (1.0, -1.0)])
    def test_an_arc_in_a_principal_plane_stays_one(self, plane: ArcPlane, sign: float) -> None:
        """Seen from the other tip of the normal the same arc turns the other way."""
        first, second, third = plane.axes
        normal, start, end = [0.0] * 3, [0.0] * 3, [0.0] * 3
        normal[third], start[first], end[second] = sign, 2.0, 2.0
        segment = Segment(
            start=(start[0], start[1], start[2]),
            end=(end[0], end[1], end[2]),
            bend=Bend(
                centre=(0.0, 0.0, 0.0),
                normal=(normal[0], normal[1], normal[2]),
                turn=sign * 0.5 * pi,
            ),
        )
        (move,) = move_of(segment, MoveType.CONTACT, None)
        assert move.arc is not None
        assert move.arc.plane is plane
        assert move.arc.turn == pytest.approx(0.5 * pi)

    @given(lean=st.floats(0.1, 1.4), turn=st.floats(0.1, 6.0))
    def test_an_arc_in_any_other_plane_becomes_chords_on_it(
        self, lean: float, turn: float
    ) -> None:
        across = (0.0, cos(lean), sin(lean))
        end = tuple(
            10.0 * (cos(turn) * u + sin(turn) * v)
            for u, v in zip((1.0, 0.0, 0.0), across, strict=True)
        )
        bend = Bend(centre=(0.0, 0.0, 0.0), normal=(0.0, -sin(lean), cos(lean)), turn=turn)
        segment = Segment(start=(10.0, 0.0, 0.0), end=(end[0], end[1], end[2]), bend=bend)
        moves = list(move_of(segment, MoveType.CONTACT, None))
        assert all(dist(move.end, (0.0, 0.0, 0.0)) == pytest.approx(10.0) for move in moves)
        starts = [segment.start, *(move.end for move in moves)]
        chords = sum(length(a, move) for a, move in zip(starts, moves, strict=False))
        assert chords == pytest.approx(10.0 * turn, rel=1e-3)
