"""Lechevalier et al., "Simulating a virtual machining model in an agent-based model", 2018.

Fig. 5 (machine) and §4.3 (validation cuts: Ø8, 4 flutes, slot, AISI 1018, 1750 rpm), evaluated
with the corrected equations and ISCAR's group 2 (1500 N/mm², 0.22). Drives: eqs. (3) and (4),
with a lead of 15 mm per revolution and 6 m/s².
"""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from simulator.library import load_machine
from simulator.physics import axis as feed_axis
from simulator.physics import cutting as power
from simulator.physics import engagement, kinematics, milling
from simulator.physics import (
    spindle as spindle_motion,
)
from simulator.spec import AxisDrive, Kienzle
from stepnc_model.units import (
    m_s_from_speed,
    mm_min_from_speed,
    nm_from_nmm,
    rev_s_from_rpm,
    rpm_from_rev_s,
    speed_from_m_s,
    speed_from_mm_min,
)
from tests.oracles import cutting as oracle
from tests.oracles import motion as moves
from tests.oracles import spindle as oracle_spindle

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
    assert moves.machining_time(101.6, feed) == pytest.approx(seconds, abs=6e-4)


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
    time = moves.move_time(
        1000.0 * length_m, speed=speed_from_m_s(speed_m_s), acceleration=6000.0
    )
    assert time == pytest.approx(seconds, rel=1e-4)


def test_short_rapid_move_peaks_below_the_rapid() -> None:
    peak = moves.peak_speed(100.0, speed=1600.0, acceleration=6000.0)
    assert m_s_from_speed(peak) == pytest.approx(0.7746, abs=5e-5)


def test_spindle_reaches_1750_rpm_in_2_9_s_at_10_rev_s2() -> None:
    assert moves.ramp_time(SPINDLE, 10.0) == pytest.approx(2.916667, rel=1e-6)


def test_step_nc_speeds_are_metres_and_revolutions_a_second() -> None:
    """Figs. 2 and 11: F2529.348 is 0.0421558 m/s, S1798.788 is 29.9798 rev/s."""
    assert m_s_from_speed(speed_from_mm_min(2529.348)) == pytest.approx(0.0421558, rel=1e-5)
    assert rev_s_from_rpm(1798.788) == pytest.approx(29.9798, rel=1e-5)
    assert mm_min_from_speed(speed_from_m_s(0.062695)) == pytest.approx(3761.7, rel=1e-5)
    assert rpm_from_rev_s(13.0768) == pytest.approx(784.608, rel=1e-5)


def drive() -> AxisDrive:
    found = load_machine("paper003").axes[0].drive
    assert found is not None
    return found


def test_torques_of_friction() -> None:
    guide = feed_axis.guide_torque(drive(), vertical_force=0.0)
    bearing = feed_axis.bearing_torque(drive(), feed_force=0.0)
    steady = feed_axis.steady_torque(drive(), feed_force=0.0)
    assert nm_from_nmm(guide) == pytest.approx(0.18736, rel=1e-4)
    assert nm_from_nmm(bearing) == pytest.approx(0.27000, rel=1e-9)
    assert nm_from_nmm(steady) == pytest.approx(0.45736, rel=1e-4)


def test_inertias() -> None:
    bare = replace(drive(), coupling_inertia=0.0)
    screw = replace(bare, table_mass=0.0, workpiece_mass=0.0)
    table = replace(bare, screw_mass=0.0)
    assert feed_axis.reflected_inertia(screw) == pytest.approx(1.1250e-3, rel=1e-9)
    assert feed_axis.reflected_inertia(table) == pytest.approx(4.559e-4, rel=1e-4)
    assert drive().coupling_inertia == 2.875e-4
    assert feed_axis.reflected_inertia(drive()) == pytest.approx(1.86839e-3, rel=1e-4)
    change = feed_axis.motor_speed(drive(), 6000.0)
    assert change == pytest.approx(2513.3, rel=1e-4)
    torque = feed_axis.reflected_inertia(drive()) * change
    assert torque == pytest.approx(4.6959, rel=1e-4)


@pytest.mark.parametrize(
    ("speed", "angular", "without_viscous", "steady", "accelerating", "braking"),
    [
        (speed_from_mm_min(124.46), 0.8689, 0.4273, 0.4314, 4.819, -3.679),
        (42.156, 17.658, 8.684, 10.360, 99.52, -73.29),
        (16_000 / 60, 111.70, 54.93, 122.01, 686.0, -411.1),
        (1600.0, 670.21, 329.6, 2744.5, 6128.6, -594.8),
    ],
)
def test_power_of_moves(
    speed: float,
    angular: float,
    without_viscous: float,
    steady: float,
    accelerating: float,
    braking: float,
) -> None:
    dry = replace(drive(), viscous=0.0)
    brake = feed_axis.motor_torque(drive(), speed, -6000.0) / 1000.0
    assert feed_axis.motor_speed(drive(), speed) == pytest.approx(angular, rel=1e-3)
    assert feed_axis.axis_power(dry, speed) == pytest.approx(without_viscous, rel=1e-3)
    assert feed_axis.axis_power(drive(), speed) == pytest.approx(steady, rel=1e-3)
    assert feed_axis.axis_power(drive(), speed, 6000.0) == pytest.approx(accelerating, rel=1e-3)
    assert brake * feed_axis.motor_speed(drive(), speed) == pytest.approx(braking, rel=1e-3)
    assert feed_axis.axis_power(drive(), speed, -6000.0) == 0.0


def phase_energy(drive: AxisDrive, *, speeds: tuple[float, float], time: float) -> float:
    """Work in J of a phase of equal acceleration; Gauss is exact for a quadratic power."""
    nodes, weights = np.polynomial.legendre.leggauss(3)
    first, last = speeds
    velocity = first + (last - first) * 0.5 * (1.0 + nodes)
    watts = feed_axis.axis_power(drive, velocity, (last - first) / time)
    return float(weights @ watts * time / 2.0)


def test_energy_of_a_rapid_of_100_mm() -> None:
    rapid = 16_000 / 60
    ramp = rapid / 6000.0
    steady = moves.move_time(100.0, speed=rapid, acceleration=6000.0) - 2.0 * ramp
    assert ramp == pytest.approx(0.04444, rel=1e-3)
    assert steady == pytest.approx(0.33056, rel=1e-4)
    phases = (
        phase_energy(drive(), speeds=(0.0, rapid), time=ramp),
        phase_energy(drive(), speeds=(rapid, rapid), time=steady),
        phase_energy(drive(), speeds=(rapid, 0.0), time=ramp),
    )
    assert phases == pytest.approx((14.748, 40.332, 0.0), rel=1e-3)
    assert sum(phases) == pytest.approx(55.08, rel=1e-3)
    lossless = replace(drive(), regeneration=1.0)
    returned = phase_energy(lossless, speeds=(rapid, 0.0), time=ramp)
    assert returned == pytest.approx(-9.597, rel=1e-3)


def test_energy_of_the_first_feed_case() -> None:
    """Axis 21.13 J; basic load 370 W and coolant 280 W take 31 837 J meanwhile."""
    feed = speed_from_mm_min(124.46)
    seconds = moves.machining_time(101.6, feed)
    machine = load_machine("paper003")
    assert feed_axis.axis_power(drive(), feed) * seconds == pytest.approx(21.13, rel=1e-3)
    always = machine.base_power + machine.coolant_power
    assert always * seconds == pytest.approx(31_837.0, rel=1e-4)


@pytest.mark.parametrize(
    ("acceleration", "seconds", "newton_metres", "watts"),
    [(10.0 / (2 * pi), 18.326, 5.000, 964.5), (10.0, 2.9167, 31.416, 6060.3)],
)
def test_spindle_ramps_in_either_reading_of_the_acceleration(
    acceleration: float, seconds: float, newton_metres: float, watts: float
) -> None:
    spindle = load_machine("paper003").spindle
    torque = spindle_motion.acceleration_torque(0.5, acceleration)
    assert moves.ramp_time(SPINDLE, acceleration) == pytest.approx(seconds, rel=1e-4)
    assert nm_from_nmm(torque) == pytest.approx(newton_metres, rel=1e-4)
    peak = spindle_motion.spindle_power(spindle, SPINDLE, acceleration)
    assert peak == pytest.approx(watts, rel=1e-4)
    assert oracle_spindle.kinetic_energy(0.5, SPINDLE) == pytest.approx(8396.0, rel=1e-4)


def test_running_torque_by_petroff_if_the_gap_were_1_mm() -> None:
    torque = oracle_spindle.petroff_torque(0.2, SPINDLE, diameter=5.7, length=0.3, gap=1.0)
    assert nm_from_nmm(torque) == pytest.approx(1.5993, rel=1e-4)
    watts = power.motor_power(oracle.torque_power(torque, SPINDLE), 0.95)
    assert watts == pytest.approx(308.5, rel=1e-3)


def test_coasting_on_that_film_takes_minutes() -> None:
    """J/B = 57 s and 264 s to a hundredth of the speed, by viscous friction alone."""
    torque = oracle_spindle.petroff_torque(0.2, SPINDLE, diameter=5.7, length=0.3, gap=1.0)
    viscous = torque / (2 * pi * SPINDLE)
    assert 500.0 / viscous == pytest.approx(57.0, rel=0.01)
    # Dry friction far below the viscous one at the end: t(ω) − t(ω/100) is the viscous time.
    whole, rest = (
        oracle_spindle.coast_down_time(0.5, speed, dry_torque=1e-6, viscous=viscous)
        for speed in (SPINDLE, SPINDLE / 100.0)
    )
    assert whole - rest == pytest.approx(264.0, rel=2e-3)
