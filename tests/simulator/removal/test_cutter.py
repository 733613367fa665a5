"""Shapes of tools: the programmed point of an insert and its edges."""

from dataclasses import replace
from math import pi, radians

import pytest

from simulator.removal.cutter import Insert
from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.toolpath.turning.plane import tip_of


@pytest.mark.parametrize("hand", list(HandOfToolType))
def test_the_nose_lies_where_the_tool_paths_have_it(hand: HandOfToolType) -> None:
    x, z = Insert(nose_radius=0.8, hand=hand).centre
    assert (-x, -z) == tip_of(hand, 0.8)


def test_a_blade_is_programmed_at_its_corner_at_the_chuck() -> None:
    blade = Insert(width=3.0, nose_radius=0.2, hand=HandOfToolType.LEFT)
    assert blade.centre == (0.2, 0.2)
    assert blade.flat == pytest.approx(2.6)
    assert blade.edge_angles == (0.5 * pi, 0.5 * pi)


def test_a_boring_insert_lies_on_the_other_side_of_its_point() -> None:
    assert Insert(nose_radius=0.4, is_inside=True).centre == (-0.4, 0.4)


def test_the_major_edge_is_at_the_chuck_for_a_right_hand() -> None:
    right = Insert(cutting_edge_angle=radians(95.0), trailing_angle=radians(7.0))
    assert right.edge_angles == (radians(95.0), radians(7.0))
    left = replace(right, hand=HandOfToolType.LEFT)
    assert left.edge_angles == (radians(7.0), radians(95.0))
    neutral = replace(right, hand=HandOfToolType.NEUTRAL)
    assert neutral.edge_angles == (radians(95.0), radians(95.0))


def test_impossible_inserts_are_refused() -> None:
    with pytest.raises(ValueError, match="nose radius -1 mm"):
        Insert(nose_radius=-1.0)
    with pytest.raises(ValueError, match=r"trailing angle 1\.6 rad"):
        Insert(trailing_angle=1.6)
    with pytest.raises(ValueError, match="corners of 2 mm must be at most half"):
        Insert(width=3.0, nose_radius=2.0)
    with pytest.raises(ValueError, match="blade width 0 mm"):
        Insert(width=0.0)
