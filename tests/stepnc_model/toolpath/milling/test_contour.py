"""Edges and chains against lengths, areas and places worked out by hand."""

from cmath import rect
from math import pi, sqrt

import pytest

from stepnc_model.toolpath.milling.contour import (
    ContourEdge,
    area,
    chain_length,
    circle,
    clockwise,
    counter_clockwise,
    divided,
    halved,
    line,
    moved,
    nearest,
    polygon,
    reversed_chain,
    rotated_to,
    shape,
    stretched,
    vertices,
)

SQUARE = polygon([0j, 10 + 0j, 10 + 10j, 10j])
QUARTER = ContourEdge(5 + 0j, 5j, 0j, 0.5 * pi)
CORNER = (line(0j, 10 + 0j), line(10 + 0j, 10 + 5j))


def test_quarter_circle_is_as_long_as_its_angle_times_its_radius() -> None:
    assert QUARTER.length == pytest.approx(2.5 * pi)
    assert QUARTER.at(0.5) == pytest.approx(rect(5.0, 0.25 * pi))


def test_way_along_an_arc_is_square_to_its_spoke_in_either_sense() -> None:
    assert QUARTER.along(0.0) == pytest.approx(1j)
    assert QUARTER.reversed().along(1.0) == pytest.approx(-1j)


def test_piece_of_an_arc_keeps_centre_and_takes_its_part_of_the_turn() -> None:
    piece = QUARTER.between(0.5, 1.0)
    assert piece.centre == 0j
    assert piece.turn == pytest.approx(0.25 * pi)
    assert piece.end == QUARTER.end


def test_area_by_green_holds_arcs_exactly() -> None:
    assert area(SQUARE) == pytest.approx(100.0)
    assert area(circle(3 + 4j, 2.0)) == pytest.approx(4.0 * pi)
    half = (ContourEdge(2 + 0j, -2 + 0j, 0j, pi), line(-2 + 0j, 2 + 0j))
    assert area(half) == pytest.approx(2.0 * pi)


def test_sense_of_a_loop_is_the_sign_of_its_area() -> None:
    assert area(clockwise(SQUARE)) == pytest.approx(-100.0)
    assert counter_clockwise(clockwise(SQUARE)) == SQUARE


def test_whole_circle_is_halved_and_a_half_stays_whole() -> None:
    whole = halved([ContourEdge(1 + 0j, 1 + 0j, 0j, 2.0 * pi)])
    assert [edge.turn for edge in whole] == pytest.approx([pi, pi])
    assert len(halved([ContourEdge(1 + 0j, -1 + 0j, 0j, pi)])) == 1


def test_polygon_leaves_out_points_that_repeat() -> None:
    assert len(polygon([0j, 0j, 1 + 0j, 1j, 0j])) == 3


def test_chords_stay_within_their_tolerance() -> None:
    points = vertices(circle(0j, 50.0), tolerance=0.01)
    step = 2.0 * pi / len(points)
    sagitta = 50.0 * (1.0 - rect(1.0, 0.5 * step).real)
    assert sagitta <= 0.01
    assert shape(circle(0j, 50.0), tolerance=0.01).area == pytest.approx(2500.0 * pi, rel=1e-3)


def test_turning_and_moving_takes_centres_along() -> None:
    (edge,) = moved((QUARTER,), by=1 + 1j, turned=1j)
    assert edge.start == pytest.approx(1 + 6j)
    assert edge.centre == pytest.approx(1 + 1j)


def test_loop_starts_where_it_is_nearest_to_a_point() -> None:
    loop = rotated_to(SQUARE, 4 - 3j)
    assert loop[0].start == pytest.approx(4 + 0j)
    assert loop[-1].end == pytest.approx(4 + 0j)
    assert chain_length(loop) == pytest.approx(40.0)


def test_loop_that_starts_at_a_corner_is_not_cut() -> None:
    assert rotated_to(SQUARE, 12 + 12j)[0].start == 10 + 10j
    assert len(rotated_to(SQUARE, 12 + 12j)) == 4


def test_nearest_place_of_an_arc_is_on_the_spoke_or_at_an_end() -> None:
    assert nearest((QUARTER,), rect(9.0, pi / 6.0))[1] == pytest.approx(1.0 / 3.0)
    assert nearest((QUARTER,), 6 - 4j) == (0, 0.0)
    assert nearest((QUARTER,), -1 + 6j) == (0, 1.0)


def test_divided_chain_is_cut_at_its_length_and_loses_nothing() -> None:
    head, tail = divided(CORNER, 12.0)
    assert chain_length(head) == pytest.approx(12.0)
    assert head[-1].end == tail[0].start == pytest.approx(10 + 2j)
    assert divided(CORNER, 0.0) == ((), CORNER)
    assert divided(CORNER, 15.0) == (CORNER, ())


def test_stretched_chain_goes_on_straight() -> None:
    chain = stretched(CORNER, 3.0, 4.0)
    assert (chain[0].start, chain[-1].end) == (-3 + 0j, 10 + 9j)
    bent = stretched((QUARTER,), 0.0, 2.0)
    assert bent[-1].end == pytest.approx(-2 + 5j)


def test_chain_cut_back_at_both_ends_is_shorter_along_its_way() -> None:
    chain = stretched(CORNER, -2.0, -1.0)
    assert (chain[0].start, chain[-1].end) == (2 + 0j, 10 + 4j)
    assert stretched(CORNER, -8.0, -8.0) == ()


def test_way_back_has_the_same_length_and_the_other_sense() -> None:
    back = reversed_chain((QUARTER,))
    assert back[0].start == QUARTER.end
    assert back[0].turn == -QUARTER.turn
    assert chain_length(back) == QUARTER.length
    assert abs(back[0].at(0.5) - QUARTER.at(0.5)) < 1e-12
    assert abs(back[0].at(0.5)) == pytest.approx(5.0 * sqrt(1.0))
