from math import asin, pi, sin, sqrt

import pytest

from simulator.physics import edge


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
