from math import sqrt

import pytest

from simulator.physics import surface
from tests.oracles.cutting import RT_PER_RA


def test_ideal_profile_s_ra_is_the_mean_deviation_of_its_parabola() -> None:
    feed, radius, steps = 0.3, 0.8, 20_000
    stations = [(i + 0.5) / steps * feed - feed / 2.0 for i in range(steps)]
    heights = [x**2 / (2.0 * radius) for x in stations]
    mean = sum(heights) / steps
    deviation = sum(abs(y - mean) for y in heights) / steps
    assert surface.corner_coefficient(radius) * feed**2 == pytest.approx(deviation, rel=1e-6)


def test_parabola_is_1_6_per_cent_low_at_half_the_radius() -> None:
    exact = 0.8 - sqrt(0.8**2 - 0.4**2 / 4.0)
    found = RT_PER_RA * surface.corner_coefficient(0.8) * 0.4**2
    assert found / exact == pytest.approx(0.984, abs=5e-4)


def test_wall_is_the_sagitta_of_the_mill_between_two_teeth() -> None:
    exact = 10.0 - sqrt(10.0**2 - 0.4**2 / 4.0)
    found = surface.RZ_PER_RA * surface.wall_coefficient(20.0) * 0.4**2
    assert found == pytest.approx(exact, rel=2e-4)


def test_sharp_corner_has_no_roughness_formula() -> None:
    with pytest.raises(ValueError, match="corner radius 0 mm"):
        surface.corner_coefficient(0.0)


def test_wall_without_a_mill_is_refused() -> None:
    with pytest.raises(ValueError, match="tool diameter 0 mm"):
        surface.wall_coefficient(0.0)


def test_rz_is_about_four_ra() -> None:
    assert pytest.approx(RT_PER_RA, rel=0.03) == surface.RZ_PER_RA
