"""Zero-order lobes against closed forms and the characteristic equation."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import find_peaks

from simulator.physics.engagement import (
    Engagement,
    bilateral,
    conventional,
    full_immersion,
    unidirectional,
)
from simulator.physics.stability import (
    DAMPED_WAVELENGTH,
    MOST_DEPTH,
    DynamicCut,
    ModalStructure,
    borders,
    damped_speed,
    directional_coefficients,
    least_stable_depth,
    lobes,
    receptance,
    stable_depths,
)
from simulator.spec import ModeDirection, VibratingPart, VibrationMode

MODE = VibrationMode(
    part=VibratingPart.TOOL,
    tool="mill",
    direction=ModeDirection.X,
    natural_frequency=600.0,
    damping_ratio=0.03,
    stiffness=10_000.0,
    source="test",
)
SLOT = DynamicCut(engagement=full_immersion(), teeth=4, stiffness=800.0, radial_ratio=0.3)
ROUND = ModalStructure(x=(MODE,), y=(MODE,))
SPEEDS = np.geomspace(20.0, 250.0, 3000)


@pytest.mark.parametrize(
    "engagement",
    [
        full_immersion(),
        unidirectional(5.0, 20.0),
        conventional(8.0, 20.0),
        bilateral(9.0, 20.0),
    ],
)
def test_directional_coefficients_are_the_mean_of_the_forces_of_a_tooth(
    engagement: Engagement,
) -> None:
    """``F_x = −F_t·cos φ − F_r·sin φ``, ``F_y = F_t·sin φ − F_r·cos φ`` for F_t = chip."""
    k_r = 0.37
    edges = np.linspace(engagement.entry_angle, engagement.exit_angle, 20_001)
    phi = 0.5 * (edges[1:] + edges[:-1])
    s, c = np.sin(phi), np.cos(phi)
    force, chip = np.stack([-c - k_r * s, s - k_r * c]), np.stack([s, c])
    # The tensor of [1] is twice this integral, and its eigenvalue has the half in N/4π.
    mean = 2.0 * np.einsum("in,jn->ij", force, chip) * (edges[1] - edges[0])
    assert directional_coefficients(engagement, k_r) == pytest.approx(mean, abs=1e-6)


def test_one_flexible_direction_has_the_closed_form_of_the_book() -> None:
    """``a_min = 2π·4kζ(1 + ζ)/(z·K_t·|α_xx|)``: Tlusty's least Re Φ = −1/(4kζ(1 + ζ))."""
    cut = replace(SLOT, engagement=conventional(10.0, 20.0))
    alpha = directional_coefficients(cut.engagement, cut.radial_ratio)[0, 0]
    assert alpha < 0.0
    found = min(
        float(np.nanmin(border.depth))
        for border in borders(cut, ModalStructure(x=(MODE,), y=()))
        if np.isfinite(border.depth).any()
    )
    expected = 2.0 * pi * 4.0 * 10_000.0 * 0.03 * 1.03 / (4 * 800.0 * abs(alpha))
    assert found == pytest.approx(expected, rel=1e-3)


def test_the_least_depth_of_the_lobes_is_that_at_any_speed() -> None:
    depths = stable_depths(SLOT, ROUND, SPEEDS)
    assert depths.min() == pytest.approx(least_stable_depth(SLOT, ROUND), rel=2e-3)
    assert (depths >= least_stable_depth(SLOT, ROUND) * (1.0 - 1e-6)).all()


def test_lobes_peak_near_whole_fractions_of_the_natural_frequency() -> None:
    """The tooth period is a whole number of the mode's: n = f/(z·k)."""
    depths = stable_depths(SLOT, ROUND, SPEEDS)
    found = SPEEDS[find_peaks(depths)[0]]
    for lobe in (1, 2, 3):
        nearest = min(found, key=lambda speed: abs(speed - 150.0 / lobe))
        assert nearest == pytest.approx(150.0 / lobe, rel=0.04)
    assert SPEEDS[np.argmax(depths)] == pytest.approx(150.0, rel=0.04)


def test_each_depth_is_on_the_border_that_the_characteristic_equation_draws() -> None:
    """``det(I − ½·a·K_t·z/2π·(1 − e^{−iω_c·T})·[α][Φ]) = 0`` at every point of a lobe."""
    structure = ModalStructure(x=(MODE,), y=(replace(MODE, natural_frequency=700.0),))
    alpha = directional_coefficients(SLOT.engagement, SLOT.radial_ratio)
    for border in borders(SLOT, structure):
        rows = np.flatnonzero(np.isfinite(border.depth))[::50]
        for row in rows:
            omega = border.frequency[row]
            period = (border.phase[row] + 4.0 * pi) / omega
            phi = np.diag([
                receptance(structure.x, np.array([omega]))[0],
                receptance(structure.y, np.array([omega]))[0],
            ])
            gain = SLOT.teeth / (4.0 * pi) * border.depth[row] * SLOT.stiffness
            open_loop = gain * (1.0 - np.exp(-1j * omega * period)) * alpha @ phi
            assert abs(np.linalg.det(np.eye(2) - open_loop)) < 1e-6


@settings(max_examples=20, deadline=None)
@given(
    factor=st.floats(0.2, 5.0),
    width=st.floats(0.11, 1.0),
    ratio=st.floats(0.0, 0.8),
    damping=st.floats(0.01, 0.1),
)
def test_depth_follows_stiffness_and_speed_follows_frequency(
    factor: float, width: float, ratio: float, damping: float
) -> None:
    mode = replace(MODE, damping_ratio=damping)
    cut = replace(SLOT, engagement=unidirectional(width * 20.0, 20.0), radial_ratio=ratio)
    depths = stable_depths(cut, ModalStructure(x=(mode,), y=(mode,)), SPEEDS)
    stiffer = replace(mode, stiffness=factor * mode.stiffness)
    found = stable_depths(cut, ModalStructure(x=(stiffer,), y=(stiffer,)), SPEEDS)
    shown = depths < 0.1 * MOST_DEPTH
    assert found[shown] == pytest.approx(factor * depths[shown], rel=1e-6)
    faster = replace(mode, natural_frequency=factor * mode.natural_frequency)
    found = stable_depths(cut, ModalStructure(x=(faster,), y=(faster,)), factor * SPEEDS)
    assert found[shown] == pytest.approx(depths[shown], rel=1e-3)


def test_a_stiff_direction_does_not_matter_and_a_soft_one_does_in_every_feed() -> None:
    soft = replace(MODE, stiffness=4_000.0)
    along_x = least_stable_depth(SLOT, ModalStructure(x=(soft,), y=(MODE,)))
    along_y = least_stable_depth(SLOT, ModalStructure(x=(MODE,), y=(soft,)))
    assert along_x == pytest.approx(along_y, rel=1e-9)
    assert along_x < least_stable_depth(SLOT, ROUND)


def test_a_tolerance_lowers_to_the_least_of_neighbouring_speeds() -> None:
    exact = stable_depths(SLOT, ROUND, SPEEDS)
    safe = stable_depths(SLOT, ROUND, SPEEDS, tolerance=0.01)
    assert (safe <= exact).all()
    softer = replace(MODE, natural_frequency=0.992 * MODE.natural_frequency)
    drifted = stable_depths(SLOT, ModalStructure(x=(softer,), y=(softer,)), SPEEDS)
    assert (safe <= drifted * (1.0 + 1e-2)).all()


def test_lobes_as_numbers_end_at_the_speeds_asked_for() -> None:
    speeds, depths = lobes(SLOT, ROUND, between=(30.0, 90.0), step=1e-3, tolerance=0.0)
    assert (speeds[0], speeds[-1]) == (30.0, 90.0)
    assert len(speeds) == len(depths)
    assert list(speeds) == sorted(speeds)
    expected = stable_depths(SLOT, ROUND, np.geomspace(30.0, 90.0, 5000))
    at = np.interp(np.array(speeds), np.geomspace(30.0, 90.0, 5000), expected)
    assert np.array(depths) == pytest.approx(at, rel=0.02)


def test_lobes_of_a_single_speed() -> None:
    speeds, depths = lobes(SLOT, ROUND, between=(40.0, 40.0), step=1e-3, tolerance=0.01)
    assert speeds == (40.0, 40.0)
    assert depths[0] > 0.0


def test_far_below_the_counted_lobes_the_least_depth_holds() -> None:
    found = stable_depths(SLOT, ROUND, np.array([0.2, 0.3]))
    assert found == pytest.approx([least_stable_depth(SLOT, ROUND)] * 2)


def test_the_flank_damps_below_the_speed_of_a_short_wave() -> None:
    fast = replace(MODE, natural_frequency=2_000.0)
    speed = damped_speed((MODE, fast), 20.0)
    assert pi * 20.0 * speed / 600.0 == pytest.approx(DAMPED_WAVELENGTH)


def test_what_no_cut_is_is_refused() -> None:
    with pytest.raises(ValueError, match="number of teeth 0"):
        replace(SLOT, teeth=0)
    with pytest.raises(ValueError, match="cutting stiffness 0"):
        replace(SLOT, stiffness=0.0)
    with pytest.raises(ValueError, match="radial ratio -1"):
        replace(SLOT, radial_ratio=-1.0)
    with pytest.raises(ValueError, match="diameter 0 mm"):
        damped_speed((MODE,), 0.0)
