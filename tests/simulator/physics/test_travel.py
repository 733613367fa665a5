from math import pi

import pytest

from simulator.physics import engagement


def test_slot_needs_half_the_diameter_on_either_model() -> None:
    assert engagement.centred_approach(20.0, 20.0) == pytest.approx(10.0)
    assert engagement.one_sided_approach(20.0, 20.0) == pytest.approx(10.0)


def test_one_sided_approach_never_falls_with_the_width() -> None:
    ways = [
        engagement.one_sided_approach(20.0, width) for width in (1.0, 5.0, 10.0, 15.0, 20.0)
    ]
    assert ways == sorted(ways)


def test_one_sided_approach_has_no_jump_at_half_the_diameter() -> None:
    below = engagement.one_sided_approach(20.0, 9.999999)
    assert below == pytest.approx(engagement.one_sided_approach(20.0, 10.0), rel=1e-6)


def test_narrow_face_needs_hardly_any_approach() -> None:
    assert engagement.centred_approach(100.0, 1.0) == pytest.approx(0.0025, abs=1e-6)


def test_flat_bottomed_tool_has_no_point() -> None:
    assert engagement.drill_point_length(10.0, pi) == pytest.approx(0.0, abs=1e-12)


def test_right_angled_point_is_as_high_as_its_radius() -> None:
    assert engagement.drill_point_length(10.0, pi / 2.0) == pytest.approx(5.0)


def test_face_wider_than_the_cutter_is_refused() -> None:
    with pytest.raises(ValueError, match="radial width 60 mm must be at most 50 mm"):
        engagement.centred_approach(50.0, 60.0)
