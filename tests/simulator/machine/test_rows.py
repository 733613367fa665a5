"""Lines and arcs collected for one stretch."""

from math import inf, isnan, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.machine.interpreter import PieceSpeed, Rows
from stepnc_model.post.blocks import Circular, Rate
from stepnc_model.toolpath.path import Arc, ArcPlane, Point


def test_lines_keep_speed_line_and_spindle() -> None:
    rows = Rows()
    rows.line((0.0, 0.0, 0.0), (3.0, 4.0, 0.0), pace=PieceSpeed(speed=inf), line=7)
    pace = PieceSpeed(speed=5.0, spindle=12.0, per_revolution=0.4)
    rows.line((3.0, 4.0, 0.0), (3.0, 4.0, -2.0), pace=pace, line=8)
    assert len(rows) == 2
    stretch = rows.taken()
    segments = stretch.segments
    assert segments.is_rapid.tolist() == [True, False]
    assert segments.length.tolist() == [5.0, 2.0]
    assert segments.block.tolist() == [7, 8]
    assert isnan(stretch.spindle_speed[0])
    assert stretch.spindle_speed[1] == 12.0
    assert isnan(stretch.per_revolution[0])
    assert stretch.per_revolution[1] == 0.4
    assert len(rows) == 0


def test_ways_are_told_at_both_ends_and_not_within() -> None:
    rows = Rows()
    for index, is_way in enumerate([True, True, False, True, False, True, True, True]):
        here, there = (float(index), 0.0, 0.0), (index + 1.0, 0.0, 0.0)
        rows.line(here, there, pace=PieceSpeed(speed=inf), line=1, is_way=is_way)
    stretch = rows.taken()
    assert (stretch.way, stretch.back) == (2, 3)
    rows.line((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), pace=PieceSpeed(speed=inf), line=2, is_way=True)
    stretch = rows.taken()
    assert (stretch.way, stretch.back) == (1, 0)


@settings(max_examples=30)
@given(
    plane=st.sampled_from(list(ArcPlane)),
    turn=st.floats(0.01, 15.0) | st.floats(-15.0, -0.01),
    rise=st.floats(-10.0, 10.0),
    pieces=st.integers(1, 7),
)
def test_pieces_of_an_arc_lie_on_it_and_add_up(
    plane: ArcPlane, turn: float, rise: float, pieces: int
) -> None:
    first, second, normal = plane.axes
    centre = (3.0, -2.0, 7.0)
    start, end = list(centre), list(centre)
    start[first] += 6.0
    end[first] += 6.0 * np.cos(turn)
    end[second] += 6.0 * np.sin(turn)
    end[normal] += rise
    begin: Point = (start[0], start[1], start[2])
    there: Point = (float(end[0]), float(end[1]), float(end[2]))
    rows = Rows()
    block = Circular(
        end=there, arc=Arc(centre=centre, turn=turn, plane=plane), rate=Rate(value=1.0)
    )
    rows.arc(
        begin,
        block,
        pieces=pieces,
        paces=lambda middle, end: PieceSpeed(speed=middle + 20.0, spindle=end),
        line=4,
    )
    stretch = rows.taken()
    segments = stretch.segments
    assert len(segments) == pieces
    np.testing.assert_allclose(segments.radius, 6.0, rtol=1e-9)
    assert segments.length.sum() == pytest.approx(np.hypot(6.0 * turn, rise), rel=1e-9)
    np.testing.assert_array_equal(segments.start[1:], segments.end[:-1])
    np.testing.assert_array_equal(segments.end[-1], there)
    # Speeds are asked for the middle of a piece, the spindle's for its end.
    middle = segments.position(np.arange(pieces), 0.5 * segments.length)
    np.testing.assert_allclose(segments.speed, middle[:, 0] + 20.0, rtol=1e-9)
    np.testing.assert_allclose(stretch.spindle_speed, segments.end[:, 0])
    assert set(segments.block.tolist()) == {4}


def test_whole_circle_ends_where_it_began() -> None:
    rows, at = Rows(), (5.0, 0.0, 0.0)
    block = Circular(end=at, arc=Arc(centre=(0.0, 0.0, 0.0), turn=2 * pi), rate=Rate(value=1.0))
    rows.arc(
        at, block, pieces=4, paces=lambda _a, _b: PieceSpeed(speed=1.0, spindle=1.0), line=1
    )
    assert rows.taken().segments.length.sum() == pytest.approx(10.0 * pi)
