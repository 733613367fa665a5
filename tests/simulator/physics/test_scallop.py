from math import sqrt

import pytest

from simulator.physics import scallop


def test_ridge_is_the_sagitta_of_the_ball() -> None:
    assert scallop.scallop_height(4.0, 10.0) == pytest.approx(5.0 - sqrt(25.0 - 4.0))


def test_paths_a_diameter_apart_leave_the_whole_radius() -> None:
    assert scallop.scallop_height(10.0, 10.0) == pytest.approx(5.0)


def test_tiny_ridge_keeps_its_digits() -> None:
    assert scallop.scallop_height(1e-6, 10.0) == pytest.approx(2.5e-14, rel=1e-9)


def test_approximation_is_low_by_1_6_per_cent_at_a_quarter_of_the_diameter() -> None:
    ratio = scallop.approximate_scallop_height(2.5, 10.0) / scallop.scallop_height(2.5, 10.0)
    assert ratio == pytest.approx(0.984, abs=5e-4)


def test_step_over_for_a_ridge_is_the_inverse() -> None:
    height = scallop.scallop_height(0.7, 6.0)
    assert scallop.step_over_for_scallop(height, 6.0) == pytest.approx(0.7)


def test_feed_for_a_wall_is_the_inverse() -> None:
    roughness = scallop.wall_roughness(0.12, 16.0)
    assert scallop.feed_for_wall_roughness(roughness, 16.0) == pytest.approx(0.12)


def test_larger_mill_leaves_a_smoother_wall() -> None:
    assert scallop.wall_roughness(0.1, 20.0) < scallop.wall_roughness(0.1, 10.0)


def test_step_over_beyond_the_diameter_is_refused() -> None:
    with pytest.raises(ValueError, match="step-over 11 mm must be at most 10 mm"):
        scallop.scallop_height(11.0, 10.0)
