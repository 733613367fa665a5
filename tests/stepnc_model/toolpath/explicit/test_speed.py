"""Feeds of explicit tool paths: what is left out, factors, and curves of factors."""

from dataclasses import replace
from math import cos, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.arc import length
from stepnc_model.toolpath.explicit.trajectory import PIECES, MoveSpeeds, pace_of, paced
from stepnc_model.toolpath.path import Arc, Feed, Move, MoveType
from stepnc_model.toolpath.spline import Spline
from tests.every_case import every_case

HEADER = (
    "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('MACHINING_SCHEMA'));\nENDSEC;\nDATA;\n"
    "#1=PROJECT('P',#2,(),$,$,$);\n#2=WORKPLAN('W',(),$,$,$);\n"
)
COMMON = (
    "#20=POLYLINE('',(#21,#22));\n#21=CARTESIAN_POINT('',(0.,0.,0.));\n"
    "#22=CARTESIAN_POINT('',(1.,0.,0.));\n#30=TOOLPATH_SPEED(#31);\n"
    "#31=B_SPLINE_CURVE('',1,(#32,#33),.UNSPECIFIED.,.F.,.F.);\n"
    "#32=CARTESIAN_POINT('',(1.));\n#33=CARTESIAN_POINT('',(0.5));\n"
    "#34=TOOLPATH_SPEED(#35);\n"
    "#35=B_SPLINE_CURVE('',1,(#32,#36),.UNSPECIFIED.,.F.,.F.);\n"
    "#36=CARTESIAN_POINT('',(0.5,2.));\n#37=TOOLPATH_SPEED(#38);\n"
    "#38=B_SPLINE_CURVE('',1,(#32,#39),.UNSPECIFIED.,.F.,.F.);\n"
    "#39=CARTESIAN_POINT('',(-1.));\n"
    "#40=MILLING_TECHNOLOGY(0.01,.TCP.,$,0.,$,.F.,.F.,.F.,$);\n"
)
OPERATION = Ref[object](9)
HALVING = Spline(degree=1, knots=(0.0, 0.0, 1.0, 1.0), poles=((1.0, 0.0, 0.0), (0.5, 0.0, 0.0)))


def pace(
    type: str = "CONTACT", speed: str = "$", technology: str = "$", own: int | None = 9
) -> MoveSpeeds:
    text = (
        f"{HEADER}{COMMON}"
        f"#10=CUTTER_LOCATION_TRAJECTORY(.T.,.{type}.,{speed},{technology},$,$,#20,$,$);\n"
        "ENDSEC;\nEND-ISO-10303-21;\n"
    )
    program = Program(Part21File.from_bytes(text.encode()))
    return pace_of(program, Ref(10), None if own is None else Ref(own))


def contact(x: float, y: float = 0.0) -> Move:
    return Move(end=(x, y, 0.0), type=MoveType.CONTACT, feed=Feed(technology=Ref(9)))


class TestPace:
    @every_case(
        ("type", "expected"),
        [
            ("CONTACT", MoveType.CONTACT),
            ("TRAJECTORY_PATH", MoveType.CONTACT),
            ("NON_CONTACT", MoveType.NO_CONTACT),
            ("CONNECT", MoveType.NO_CONTACT),
            ("APPROACH", MoveType.APPROACH),
            ("LIFT", MoveType.RETRACT),
        ],
    )
    def test_the_type_says_what_moves_are_for(self, type: str, expected: MoveType) -> None:
        assert pace(type) == MoveSpeeds(type=expected, feed=Feed(technology=Ref(9)))

    def test_what_is_left_out_is_the_operations(self) -> None:
        assert pace().feed == Feed(technology=Ref(9))

    def test_a_technology_of_its_own_counts_even_with_the_spindle_at_0(self) -> None:
        assert pace(technology="#40").feed == Feed(technology=Ref(40))

    @pytest.mark.parametrize("speed", ["0.25", "POSITIVE_RATIO_MEASURE(0.25)"])
    def test_a_factor_is_on_the_feed(self, speed: str) -> None:
        assert pace(speed=speed).feed == Feed(technology=Ref(9), ratio=0.25)

    @pytest.mark.parametrize(
        ("type", "expected"), [("CONNECT", "rapid"), ("CONTACT", "rapid"), ("LIFT", "retract")]
    )
    def test_rapid_has_no_feed(self, type: str, expected: str) -> None:
        found = pace(type, speed=".RAPID.", technology="#40")
        assert (found.type.value, found.feed) == (expected, None)

    def test_a_rapid_movement_has_no_feed(self) -> None:
        assert pace(own=None, technology="#40", speed="0.5").feed is None

    def test_a_curve_of_factors_is_kept(self) -> None:
        factors = pace(speed="#30").factors
        assert factors is not None
        assert factors.at(1.0)[0] == 0.5

    @every_case(
        ("speed", "message"),
        [
            ("0.", "feed factor 0"),
            ("-1.", "must be positive"),
            ("#34", "one coordinate"),
            ("#37", "factor -1"),
        ],
    )
    def test_what_is_no_factor_is_refused(self, speed: str, message: str) -> None:
        with pytest.raises(PathError, match=message):
            pace(speed=speed)


class TestPaced:
    def test_pieces_have_the_factor_of_their_middle(self) -> None:
        """From 1 to 1/2 along 8 mm: at a station s it is 1 − s/16."""
        start, station = (0.0, 0.0, 0.0), 0.0
        for move in paced(start, [contact(2.0), contact(8.0)], HALVING):
            assert move.feed is not None
            middle = station + 0.5 * (move.end[0] - station)
            assert move.feed.ratio == pytest.approx(1.0 - middle / 16.0)
            station = move.end[0]
        assert station == 8.0

    def test_a_constant_factor_splits_nothing(self) -> None:
        moves = [contact(2.0), contact(8.0)]
        poles = ((0.5, 0.0, 0.0), (0.5, 0.0, 0.0))
        found = list(paced((0.0, 0.0, 0.0), moves, replace(HALVING, poles=poles)))
        assert [(move.end[0], move.feed and move.feed.ratio) for move in found] == [
            (2.0, 0.5),
            (8.0, 0.5),
        ]

    @pytest.mark.parametrize(
        ("low", "high", "factors", "expected"),
        [
            (2.95, 3.0, (1.0, 0.5), [(2.95, 1.0), (8.0, 0.5)]),
            (3.0, 3.05, (0.5, 1.0), [(3.05, 0.5), (8.0, 1.0)]),
            (4.95, 5.0, (1.0, 0.5), [(5.0, 1.0), (8.0, 0.5)]),
            (5.0, 5.05, (0.5, 1.0), [(5.0, 0.5), (8.0, 1.0)]),
            (4.97, 5.03, (0.5, 1.0), [(5.0, 0.5), (8.0, 1.0)]),
        ],
    )
    def test_a_short_ramp_is_a_step_at_its_slower_end_or_a_corner(
        self,
        low: float,
        high: float,
        factors: tuple[float, float],
        expected: list[tuple[float, float]],
    ) -> None:
        before, after = factors
        curve = Spline(
            degree=1,
            knots=(0.0, 0.0, low, high, 8.0, 8.0),
            poles=tuple((each, 0.0, 0.0) for each in (before, before, after, after)),
        )
        found = list(paced((0.0, 0.0, 0.0), [contact(5.0), contact(8.0)], curve))
        merged = {move.feed.ratio: move.end[0] for move in found if move.feed}
        assert merged == pytest.approx({ratio: end for end, ratio in expected})
        assert len(found) == (2 if low < 5.05 and high > 4.96 else 3)

    def test_only_a_long_ramp_is_sampled(self) -> None:
        """From 1 to 1/2 between 2 and 6 mm: half of a path of 8 mm."""
        curve = Spline(
            degree=1,
            knots=(0.0, 0.0, 2.0, 6.0, 8.0, 8.0),
            poles=tuple((each, 0.0, 0.0) for each in (1.0, 1.0, 0.5, 0.5)),
        )
        found = list(paced((0.0, 0.0, 0.0), [contact(8.0)], curve))
        assert len(found) == PIECES // 2 + 2
        assert found[0].end[0] == pytest.approx(2.0)
        assert found[-2].end[0] == pytest.approx(6.0)

    def test_there_are_enough_pieces_for_a_path_of_one_move(self) -> None:
        assert len(list(paced((0.0, 0.0, 0.0), [contact(5.0)], HALVING))) == PIECES

    @given(turn=st.floats(0.1, 12.0), sense=st.sampled_from((1.0, -1.0)))
    def test_pieces_of_an_arc_lie_on_it(self, turn: float, sense: float) -> None:
        turned = sense * turn
        end = (5.0 * cos(turned), 5.0 * sin(turned), 3.0)
        arc = Arc(centre=(0.0, 0.0, 0.0), turn=turned)
        move = Move(end=end, type=MoveType.CONTACT, feed=Feed(technology=Ref(9)), arc=arc)
        start = (5.0, 0.0, 0.0)
        pieces = list(paced(start, [move], HALVING))
        assert sum(piece.arc.turn for piece in pieces if piece.arc) == pytest.approx(turned)
        assert pieces[-1].end == end
        at, whole = start, 0.0
        for piece in pieces:
            assert piece.end[0] ** 2 + piece.end[1] ** 2 == pytest.approx(25.0)
            whole += length(at, piece)
            at = piece.end
        assert whole == pytest.approx(length(start, move))

    def test_a_full_circle_comes_back(self) -> None:
        arc = Arc(centre=(0.0, 0.0, 0.0), turn=-2.0 * pi)
        move = Move(
            end=(5.0, 0.0, 0.0), type=MoveType.CONTACT, feed=Feed(technology=Ref(9)), arc=arc
        )
        pieces = list(paced((5.0, 0.0, 0.0), [move], HALVING))
        assert pieces[PIECES // 4 - 1].end == pytest.approx((0.0, -5.0, 0.0))
