"""Chains cut at the boundary of an area."""

from math import pi

import pytest

from stepnc_model.toolpath.milling.contour import (
    ContourEdge,
    chain_length,
    circle,
    clockwise,
    line,
    polygon,
)
from stepnc_model.toolpath.milling.cover import MillingPass
from stepnc_model.toolpath.milling.strokes import inside, pieces

FIELD = polygon([0j, 40 + 0j, 40 + 20j, 20j])


def test_line_across_an_area_is_air_material_air() -> None:
    found = pieces((line(-10 + 5j, 50 + 5j),), [FIELD])
    assert [piece.is_inside for piece in found] == [False, True, False]
    assert [chain_length(piece.chain) for piece in found] == pytest.approx([10.0, 40.0, 10.0])


def test_arc_stays_an_arc_when_it_is_cut() -> None:
    """A half circle of 10 mm about a point on the edge: a quarter is inside."""
    arc = ContourEdge(10 + 0j, -10 + 0j, 0j, pi)
    found = pieces((arc,), [FIELD])
    assert [piece.is_inside for piece in found] == [True, False]
    assert found[0].chain[0].turn == pytest.approx(0.5 * pi)


def test_island_is_outside() -> None:
    found = pieces((line(10j, 40 + 10j),), [FIELD, clockwise(circle(20 + 10j, 5.0))])
    assert [piece.is_inside for piece in found] == [True, False, True]


def test_pass_that_stays_inside_stays_itself() -> None:
    cut = MillingPass(circle(20 + 10j, 5.0), is_closed=True)
    assert inside(cut, [FIELD]) == [cut]
    assert inside(MillingPass(circle(90 + 10j, 5.0), is_closed=True), [FIELD]) == []


def test_loop_whose_start_is_inside_is_not_cut_there() -> None:
    """It starts at (3, 10), leaves over the left edge and comes back: one piece."""
    cut = MillingPass(circle(-2 + 10j, 5.0), is_closed=True)
    (found,) = inside(cut, [FIELD])
    assert not found.is_closed
    assert found.start.real == pytest.approx(0.0)
    assert found.end.real == pytest.approx(0.0)


def test_piece_shorter_than_any_cut_is_left_out() -> None:
    assert inside(MillingPass((line(-1 + 1j, 0.05 + 1j),), is_closed=False), [FIELD]) == []
