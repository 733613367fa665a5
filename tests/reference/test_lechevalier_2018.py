"""Lechevalier et al., "Simulating a virtual machining model in an agent-based model", 2018.

Fig. 5 (machine) and §4.3 (validation cuts: Ø8, 4 flutes, slot, AISI 1018, 1750 rpm), evaluated
with the corrected equations and ISCAR's group 2 (1500 N/mm², 0.22).
"""

import pytest

from simulator.physics import engagement, kinematics, milling, motion, power
from simulator.spec import Kienzle
from stepnc_model.units import (
    m_s_from_speed,
    mm_min_from_speed,
    rev_s_from_rpm,
    rpm_from_rev_s,
    speed_from_m_s,
    speed_from_mm_min,
)

STEEL = Kienzle(k_c11=1500.0, m_c=0.22)
SPINDLE = rev_s_from_rpm(1750.0)


@pytest.mark.parametrize(
    ("feed_mm_min", "depth", "feed_per_tooth", "specific_force", "watts", "seconds"),
    [
        (124.46, 1.5, 0.017780, 4020.0, 100.1, 48.980),
        (88.9, 2.0, 0.012700, 4329.0, 102.6, 68.572),
    ],
)
def test_validation_cuts(
    feed_mm_min: float,
    depth: float,
    feed_per_tooth: float,
    specific_force: float,
    watts: float,
    seconds: float,
) -> None:
    feed = speed_from_mm_min(feed_mm_min)
    f_z = kinematics.feed_per_tooth(feed, SPINDLE, teeth=4)
    slot = milling.MillingCut(
        feed_per_tooth=f_z, teeth=4, axial_depth=depth, engagement=engagement.full_immersion()
    )
    force = milling.mean_force(STEEL, slot)
    cutting_power = power.cutting_power(force, kinematics.cutting_speed(8.0, SPINDLE))
    assert f_z == pytest.approx(feed_per_tooth, abs=5e-7)
    assert milling.mean_specific_force(STEEL, slot) == pytest.approx(specific_force, abs=0.6)
    assert cutting_power == pytest.approx(watts, abs=0.06)
    assert kinematics.machining_time(101.6, feed) == pytest.approx(seconds, abs=6e-4)


def test_first_cut_mean_chip_force_and_removal_rate() -> None:
    feed = speed_from_mm_min(124.46)
    slot = milling.MillingCut(
        feed_per_tooth=kinematics.feed_per_tooth(feed, SPINDLE, teeth=4),
        teeth=4,
        axial_depth=1.5,
        engagement=engagement.full_immersion(),
    )
    rate = kinematics.milling_removal_rate(feed, axial_depth=1.5, radial_width=8.0)
    assert slot.mean_chip_thickness == pytest.approx(0.011319, abs=5e-7)
    assert milling.mean_force(STEEL, slot) == pytest.approx(136.5, abs=0.06)
    assert rate * 60.0 == pytest.approx(1493.52)


@pytest.mark.parametrize(
    ("length_m", "speed_m_s", "seconds"),
    [
        (0.5, 1.6, 0.579167),
        (0.1, 1.6, 0.258199),
        (0.1, 16.0 / 60.0, 0.419444),
        (0.002, 0.04, 0.056667),
        (0.0002, 0.04, 0.011547),
    ],
)
def test_moves_from_rest_to_rest_at_6_m_s2(
    length_m: float, speed_m_s: float, seconds: float
) -> None:
    time = motion.move_time(
        1000.0 * length_m, speed=speed_from_m_s(speed_m_s), acceleration=6000.0
    )
    assert time == pytest.approx(seconds, rel=1e-4)


def test_short_rapid_move_peaks_below_the_rapid() -> None:
    peak = motion.peak_speed(100.0, speed=1600.0, acceleration=6000.0)
    assert m_s_from_speed(peak) == pytest.approx(0.7746, abs=5e-5)


def test_spindle_reaches_1750_rpm_in_2_9_s_at_10_rev_s2() -> None:
    assert motion.ramp_time(SPINDLE, 10.0) == pytest.approx(2.916667, rel=1e-6)


def test_step_nc_speeds_are_metres_and_revolutions_a_second() -> None:
    """Figs. 2 and 11: F2529.348 is 0.0421558 m/s, S1798.788 is 29.9798 rev/s."""
    assert m_s_from_speed(speed_from_mm_min(2529.348)) == pytest.approx(0.0421558, rel=1e-5)
    assert rev_s_from_rpm(1798.788) == pytest.approx(29.9798, rel=1e-5)
    assert mm_min_from_speed(speed_from_m_s(0.062695)) == pytest.approx(3761.7, rel=1e-5)
    assert rpm_from_rev_s(13.0768) == pytest.approx(784.608, rel=1e-5)
