"""Columns of arcs agree with single ones."""

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.toolpath.arc import length, radius
from stepnc_model.toolpath.arc_columns import arms, lengths, to_quadrants
from stepnc_model.toolpath.path import Arc, ArcPlane, Move, MoveType, Point

numbers = st.floats(-100.0, 100.0)
places = st.tuples(numbers, numbers, numbers)
rows = st.tuples(places, places, places, st.floats(-9.0, 9.0), st.sampled_from(ArcPlane))


@given(st.lists(rows, min_size=1, max_size=5))
def test_lengths_and_radii_are_those_of_single_moves(
    moves: list[tuple[Point, Point, Point, float, ArcPlane]],
) -> None:
    start, end, centre = (np.array([move[i] for move in moves]) for i in range(3))
    turn = np.array([move[3] for move in moves])
    normal = np.array([move[4].axes[2] for move in moves])
    size = np.hypot(*arms(start, centre, normal))
    found = lengths(start, end, radius=size, turn=turn, normal=normal)
    for row, (at, there, middle, angle, plane) in enumerate(moves):
        arc = Arc(centre=middle, turn=angle, plane=plane)
        move = Move(end=there, type=MoveType.CONTACT, arc=arc if angle != 0.0 else None)
        assert size[row] == pytest.approx(radius(at, arc), abs=1e-12)
        assert found[row] == pytest.approx(length(at, move), abs=1e-12)


def test_a_length_is_unknown_where_a_point_is() -> None:
    start, end = np.full((1, 3), np.nan), np.ones((1, 3))
    zero = np.zeros(1)
    found = lengths(start, end, radius=zero, turn=zero, normal=np.array([2]))
    assert np.isnan(found).all()


def test_quadrants_are_counted_in_the_sense_of_the_turn() -> None:
    """From 45 degrees, the top is 45 degrees ahead, or 315 behind."""
    ahead, behind = to_quadrants(np.full(2, 0.25 * pi), np.array([1.0, -1.0]))
    assert ahead == pytest.approx(np.array([1.75, 0.25, 0.75, 1.25]) * pi)
    assert behind == pytest.approx(np.array([0.25, 1.75, 1.25, 0.75]) * pi)
