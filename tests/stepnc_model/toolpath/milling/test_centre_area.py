"""Room around a pass, by distances worked out by hand."""

from math import pi

import pytest

from stepnc_model.toolpath.milling.contour import ContourEdge, circle, clockwise, line, polygon
from stepnc_model.toolpath.milling.layer import CentreArea, clearance_from_wall, nowhere, within

FIELD = polygon([0j, 40 + 0j, 40 + 20j, 20j])
CLEAR = within([FIELD, clockwise(circle(20 + 10j, 5.0))])


def test_clearance_is_the_distance_to_the_nearest_wall() -> None:
    assert CLEAR(4 + 10j) == pytest.approx(4.0)
    assert CLEAR(12 + 10j) == pytest.approx(3.0)


def test_clearance_is_negative_outside_and_in_an_island() -> None:
    assert CLEAR(-3 + 10j) == pytest.approx(-3.0)
    assert CLEAR(20 + 10j) == pytest.approx(-5.0)


def test_circle_fits_up_to_the_wall() -> None:
    room = CentreArea(clearance=CLEAR)
    assert room.holds_circle(7.5 + 10j, 7.5)
    assert not room.holds_circle(7.5 + 10j, 7.51)


def test_way_is_held_only_where_all_of_it_stays_inside() -> None:
    room = CentreArea(clearance=CLEAR)
    assert room.holds((line(1 + 1j, 39 + 1j),))
    assert not room.holds((line(1 + 10j, 39 + 10j),))
    assert not room.holds((ContourEdge(10 + 2j, 30 + 2j, 20 + 2j, pi),))


def test_room_beside_a_wall_keeps_its_distance() -> None:
    room = CentreArea(clearance=clearance_from_wall((line(0j, 10 + 0j),), 3.0))
    assert room.holds((line(3j, 10 + 3j),))
    assert not room.holds((line(3j, 10 + 2j),))


def test_there_is_no_room_in_a_slot_as_wide_as_the_tool() -> None:
    room = CentreArea(clearance=nowhere)
    assert not room.holds((line(0j, 1 + 0j),))
    assert not room.holds_circle(0j, 0.0)
