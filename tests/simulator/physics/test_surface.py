from math import sqrt

import pytest

from simulator.physics import surface


def test_ideal_profile_s_ra_is_the_mean_deviation_of_its_parabola() -> None:
    feed, radius, steps = 0.3, 0.8, 20_000
    stations = [(i + 0.5) / steps * feed - feed / 2.0 for i in range(steps)]
    heights = [x**2 / (2.0 * radius) for x in stations]
    mean = sum(heights) / steps
    deviation = sum(abs(y - mean) for y in heights) / steps
    assert surface.arithmetic_roughness(feed, radius) == pytest.approx(deviation, rel=1e-6)


def test_parabola_is_1_6_per_cent_low_at_half_the_radius() -> None:
    radius = 0.8
    exact = radius - sqrt(radius**2 - 0.4**2 / 4.0)
    assert surface.peak_to_valley(0.4, radius) / exact == pytest.approx(0.984, abs=5e-4)


def test_feed_for_a_roughness_is_the_inverse() -> None:
    assert surface.feed_for_peak_to_valley(
        surface.peak_to_valley(0.17, 0.4), 0.4
    ) == pytest.approx(0.17)
    assert surface.feed_for_arithmetic_roughness(
        surface.arithmetic_roughness(0.17, 0.4), 0.4
    ) == pytest.approx(0.17)


def test_feed_beyond_twice_the_corner_is_refused() -> None:
    with pytest.raises(
        ValueError, match=r"feed per revolution 0\.9 mm must be at most 0\.8 mm"
    ):
        surface.peak_to_valley(0.9, 0.4)


def test_sharp_corner_has_no_roughness_formula() -> None:
    with pytest.raises(ValueError, match="corner radius 0 mm"):
        surface.arithmetic_roughness(0.2, 0.0)


def test_floor_adds_and_is_taken_off_again() -> None:
    total = surface.real_roughness(1.4e-3, floor=0.3e-3)
    assert total == pytest.approx(1.7e-3)
    assert surface.ideal_share(total, floor=0.3e-3) == pytest.approx(1.4e-3)


def test_roughness_below_the_floor_cannot_be_reached() -> None:
    with pytest.raises(ValueError, match="must be greater than the floor of the process"):
        surface.ideal_share(0.1e-3)


def test_rz_is_about_four_ra() -> None:
    assert surface.rz_from_ra(surface.ra_from_rz(6.3e-3)) == pytest.approx(6.3e-3)
    ideal = surface.peak_to_valley(0.2, 0.8) / surface.arithmetic_roughness(0.2, 0.8)
    assert ideal == pytest.approx(surface.RZ_PER_RA, rel=0.03)
