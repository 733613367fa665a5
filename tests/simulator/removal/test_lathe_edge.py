"""The leading edge by direction, and the chip it takes."""

from math import acos, cos, pi, radians, sin

import numpy as np
import pytest

from simulator.removal.cutter import Insert
from simulator.removal.lathe import LEAST_ANGLE, chip_ratios, edge_angles
from stepnc_model.entities.enums import HandOfToolType

TO_CHUCK, TO_AXIS, TO_FRONT, OUTWARDS = (
    np.array([[x, 0.0, z]]) for x, z in ((0.0, -1.0), (-1.0, 0.0), (0.0, 1.0), (1.0, 0.0))
)


def test_along_the_axis_the_major_edge_leads() -> None:
    insert = Insert(cutting_edge_angle=radians(75.0))
    assert edge_angles(insert, TO_CHUCK) == pytest.approx(radians(75.0))
    left = Insert(cutting_edge_angle=radians(75.0), hand=HandOfToolType.LEFT)
    assert edge_angles(left, TO_FRONT) == pytest.approx(radians(75.0))


def test_in_facing_the_minor_edge_leads_at_95_degrees() -> None:
    """A holder of 95° and an insert of 80° stand so both ways (ISO 5608, style L)."""
    insert = Insert(cutting_edge_angle=radians(95.0), trailing_angle=radians(5.0))
    assert edge_angles(insert, TO_AXIS) == pytest.approx(radians(95.0))


def test_backwards_the_minor_edge_wipes() -> None:
    insert = Insert(cutting_edge_angle=radians(95.0), trailing_angle=radians(1.0))
    assert edge_angles(insert, TO_FRONT) == pytest.approx(LEAST_ANGLE)


def test_a_blade_cuts_with_its_end_and_with_its_sides() -> None:
    blade = Insert(width=3.0)
    for direction in (TO_AXIS, TO_CHUCK, TO_FRONT):
        assert edge_angles(blade, direction) == pytest.approx(0.5 * pi)


def test_the_chip_of_a_blade_is_as_thick_as_the_feed() -> None:
    blade = Insert(width=3.0, nose_radius=0.2)
    assert chip_ratios(blade, np.array([3.0]), np.array([0.5 * pi])) == pytest.approx(1.0)


def test_a_boring_insert_is_its_own_mirror() -> None:
    insert = Insert(cutting_edge_angle=radians(95.0), is_inside=True)
    outside = Insert(cutting_edge_angle=radians(95.0))
    assert edge_angles(insert, OUTWARDS) == edge_angles(outside, TO_AXIS)


def test_no_direction_is_upright() -> None:
    assert edge_angles(Insert(), np.zeros((1, 3))) == pytest.approx(0.5 * pi)


def test_a_shallow_cut_lies_in_the_nose() -> None:
    """``sin κ = a_p / (r · acos(1 − a_p/r))``: chord height over arc."""
    insert = Insert(nose_radius=0.8)
    ratio = chip_ratios(insert, np.array([0.2]), np.array([0.5 * pi]))
    assert ratio == pytest.approx(0.2 / (0.8 * acos(0.75)))


def test_a_sharp_edge_takes_the_sine_of_its_angle() -> None:
    ratios = chip_ratios(Insert(), np.array([0.0, 2.0]), np.array([0.7, 1.9]))
    np.testing.assert_allclose(ratios, [sin(0.7), cos(1.9 - 0.5 * pi)])
