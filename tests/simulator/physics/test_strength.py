from dataclasses import replace
from math import pi

import pytest

from simulator.physics import strength
from simulator.physics.strength import Cantilever

CARBIDE = 600e3
TOOL = Cantilever(
    overhang=40.0,
    flute_length=20.0,
    flute_diameter=8.0,
    shank_diameter=10.0,
    youngs_modulus=CARBIDE,
)


def test_deflection_is_that_of_a_clamped_beam() -> None:
    inertia = pi * 8.0**4 / 64.0
    assert strength.deflection(
        300.0, overhang=40.0, diameter=8.0, youngs_modulus=CARBIDE
    ) == pytest.approx(300.0 * 40.0**3 / (3.0 * CARBIDE * inertia))


def test_twice_the_overhang_bends_eight_times() -> None:
    short = strength.deflection(100.0, overhang=30.0, diameter=8.0, youngs_modulus=CARBIDE)
    long = strength.deflection(100.0, overhang=60.0, diameter=8.0, youngs_modulus=CARBIDE)
    assert long == pytest.approx(8.0 * short)


def test_flutes_weaken_by_the_fourth_power_of_the_customary_ratio() -> None:
    fluted = strength.second_moment(strength.equivalent_diameter(10.0))
    assert fluted / strength.second_moment(10.0) == pytest.approx(0.4096)


def test_stepped_tool_lies_between_its_plain_bars() -> None:
    thin = replace(TOOL, flute_length=TOOL.overhang)
    thick = replace(TOOL, flute_length=0.0)
    assert thick.compliance < TOOL.compliance < thin.compliance


def test_stepped_tool_s_compliance_is_the_integral_of_the_moment() -> None:
    steps = 4000
    width = TOOL.overhang / steps
    total = 0.0
    for i in range(steps):
        x = (i + 0.5) * width
        diameter = TOOL.flute_diameter if x < TOOL.flute_length else TOOL.shank_diameter
        total += x**2 * width / (CARBIDE * strength.second_moment(diameter))
    assert TOOL.compliance == pytest.approx(total, rel=1e-6)


def test_stress_is_the_greater_of_holder_and_flutes() -> None:
    assert TOOL.stress(300.0) == pytest.approx(
        strength.bending_stress(300.0, overhang=40.0, diameter=10.0)
    )
    slim = replace(TOOL, flute_diameter=6.0)
    assert slim.stress(300.0) == pytest.approx(
        strength.bending_stress(300.0, overhang=20.0, diameter=6.0)
    )


def test_flutes_up_to_the_holder_bear_the_whole_moment() -> None:
    fluted = replace(TOOL, flute_length=40.0)
    assert fluted.stress(300.0) == pytest.approx(
        strength.bending_stress(300.0, overhang=40.0, diameter=8.0)
    )


def test_plain_bar_s_stress_is_at_the_holder() -> None:
    plain = replace(TOOL, flute_length=0.0)
    assert plain.stress(300.0) == pytest.approx(32.0 * 300.0 * 40.0 / (pi * 1000.0))


def test_no_force_no_deflection_no_stress() -> None:
    assert strength.deflection(0.0, overhang=40.0, diameter=8.0, youngs_modulus=CARBIDE) == 0.0
    assert TOOL.stress(0.0) == 0.0


def test_flutes_longer_than_the_overhang_are_refused() -> None:
    with pytest.raises(ValueError, match="flute length 50 mm must be at most the overhang"):
        replace(TOOL, flute_length=50.0)


@pytest.mark.parametrize(("length", "overhang"), [(None, 36.0), (26.0, 36.0), (50.0, 50.0)])
def test_an_end_mill_stands_out_three_diameters_or_its_edge(
    length: float | None, overhang: float
) -> None:
    shank = strength.end_mill(12.0, cutting_edge_length=length, youngs_modulus=6e5)
    stated = strength.end_mill(
        12.0, cutting_edge_length=None, youngs_modulus=6e5, overhang=overhang
    )
    assert shank == stated
    expected = overhang**3 / (3.0 * 6e5 * pi * 9.6**4 / 64.0)
    assert shank.compliance == pytest.approx(expected)
    assert shank.stress(100.0) == pytest.approx(32.0 * 100.0 * overhang / (pi * 9.6**3))
