from math import asin, pi, sin, sqrt

import pytest

from simulator.physics import edge


def test_ball_cuts_with_the_chord_at_its_depth() -> None:
    diameter = edge.effective_diameter(10.0, 2.0, corner_radius=5.0)
    assert diameter == pytest.approx(2.0 * sqrt(2.0 * (10.0 - 2.0)))


def test_ball_beyond_its_radius_cuts_with_its_diameter() -> None:
    assert edge.effective_diameter(10.0, 7.0, corner_radius=5.0) == 10.0


def test_square_end_mill_cuts_with_its_diameter_at_any_depth() -> None:
    assert edge.effective_diameter(10.0, 0.01) == 10.0


def test_bull_nose_adds_its_flat_to_the_chord() -> None:
    diameter = edge.effective_diameter(20.0, 0.5, corner_radius=2.0)
    assert diameter == pytest.approx(16.0 + 2.0 * sqrt(0.5 * 3.5))


def test_corner_beyond_the_ball_is_refused() -> None:
    with pytest.raises(ValueError, match="at most half the tool diameter, 5 mm"):
        edge.effective_diameter(10.0, 1.0, corner_radius=6.0)


def test_sharp_corner_keeps_the_straight_edge_s_angle() -> None:
    angle = edge.effective_edge_angle(0.0, 3.0, cutting_edge_angle=1.2)
    assert angle == pytest.approx(1.2)


def test_shallow_cut_with_a_round_insert() -> None:
    """Catalogue approximation h_m ≈ f_z·√(a_p/iC), iC = 12."""
    angle = edge.effective_edge_angle(6.0, 0.1)
    assert sin(angle) == pytest.approx(sqrt(0.1 / 12.0), rel=2e-3)


def test_deep_cut_forgets_the_nose() -> None:
    angle = edge.effective_edge_angle(0.4, 400.0, cutting_edge_angle=pi / 3.0)
    assert angle == pytest.approx(pi / 3.0, rel=1e-3)


def test_edge_angle_has_no_jump_where_the_straight_edge_begins() -> None:
    below = edge.effective_edge_angle(5.0, 5.0 - 1e-9)
    assert below == pytest.approx(edge.effective_edge_angle(5.0, 5.0), rel=1e-4)
    assert edge.effective_edge_angle(5.0, 5.0) == pytest.approx(asin(2.0 / pi))


def test_thinnest_chip_is_a_share_of_the_edge_radius() -> None:
    assert edge.minimum_chip_thickness(0.02, ratio=0.3) == pytest.approx(0.006)
    with pytest.raises(ValueError, match="must be at most 1"):
        edge.minimum_chip_thickness(0.02, ratio=1.5)
