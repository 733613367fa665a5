"""Pieces of a half plane against plane geometry."""

from math import pi, sqrt

import pytest

from stepnc_model.toolpath.turning.profile import (
    ProfilePiece,
    arc_pieces,
    crossings,
    half_circle,
)

LINE = ProfilePiece(start=(0.0, 1.0), end=(4.0, 3.0))
ARCH = half_circle((0.0, 0.0), 5.0, 1)


def test_a_line_has_one_height_over_each_place() -> None:
    assert LINE.at(1.0) == 1.5
    assert LINE.part(3.0, 1.0).start == (3.0, 2.5)


def test_an_arc_follows_its_circle() -> None:
    assert ARCH.at(3.0) == 4.0
    assert half_circle((0.0, 0.0), 5.0, -1).at(3.0) == -4.0


def test_the_upper_side_turns_clockwise_forwards() -> None:
    assert ARCH.turn == pytest.approx(-pi)
    assert ARCH.reversed().turn == pytest.approx(pi)


def test_the_middle_of_an_arch_is_its_top() -> None:
    assert ARCH.point(0.5) == pytest.approx((0.0, 5.0))
    assert ARCH.tangent((0.0, 5.0)) == pytest.approx((1.0, 0.0))


def test_an_arc_is_cut_where_its_circle_stands_upright() -> None:
    """A three-quarter circle from (0, −5) counter-clockwise to (−5, 0) has three parts."""
    pieces = list(arc_pieces((0.0, -5.0), (-5.0, 0.0), centre=(0.0, 0.0), turn=1.5 * pi))
    assert [piece.side for piece in pieces] == [-1, 1]
    assert pieces[0].end == pytest.approx((5.0, 0.0))
    assert sum(piece.turn for piece in pieces) == pytest.approx(1.5 * pi)


def test_lines_cross_where_they_do() -> None:
    assert list(crossings(LINE, ProfilePiece(start=(0.0, 3.0), end=(4.0, 1.0)))) == [2.0]


def test_a_line_crosses_a_circle_twice() -> None:
    level = ProfilePiece(start=(-9.0, 4.0), end=(9.0, 4.0))
    assert sorted(crossings(level, ARCH)) == pytest.approx([-3.0, 3.0])


def test_circles_of_equal_size_cross_in_the_middle() -> None:
    other = half_circle((6.0, 0.0), 5.0, 1)
    assert set(crossings(ARCH, other)) == {3.0}


def test_what_lies_apart_does_not_cross() -> None:
    assert list(crossings(LINE, ProfilePiece(start=(5.0, 0.0), end=(6.0, 9.0)))) == []


def test_distance_is_to_the_nearest_spot() -> None:
    assert ProfilePiece(start=(0.0, 0.0), end=(2.0, 0.0)).distance((1.0, 3.0)) == 3.0
    assert ProfilePiece(start=(0.0, 0.0), end=(2.0, 0.0)).distance((5.0, 4.0)) == 5.0
    assert ARCH.distance((4.0, 4.0)) == pytest.approx(4.0 * sqrt(2.0) - 5.0)
