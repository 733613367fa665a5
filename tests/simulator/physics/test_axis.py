"""Feed axis: signs, limits and what each term does. Figures: tests/reference."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.physics import axis
from simulator.spec import AxisDrive

DRIVE = AxisDrive(
    lead=10.0,
    table_mass=200.0,
    workpiece_mass=50.0,
    screw_mass=8.0,
    screw_diameter=32.0,
    coupling_inertia=1e-4,
    motor_inertia=2e-3,
    guide_friction=0.02,
    bearing_friction=0.005,
    preload=2000.0,
    viscous=3.0,
    efficiency=0.9,
)
SPEEDS = st.floats(-600.0, 600.0)
ACCELERATIONS = st.floats(-5000.0, 5000.0)
FORCES = st.floats(-3000.0, 3000.0)


@settings(max_examples=40)
@given(velocity=SPEEDS, acceleration=ACCELERATIONS, force=FORCES)
def test_the_axis_does_not_know_left_from_right(
    velocity: float, acceleration: float, force: float
) -> None:
    there = axis.axis_power(DRIVE, velocity, acceleration, feed_force=force)
    back = axis.axis_power(DRIVE, -velocity, -acceleration, feed_force=force)
    assert there == pytest.approx(back)


@settings(max_examples=40)
@given(velocity=SPEEDS, acceleration=ACCELERATIONS, force=FORCES)
def test_without_regeneration_no_power_returns(
    velocity: float, acceleration: float, force: float
) -> None:
    assert axis.axis_power(DRIVE, velocity, acceleration, feed_force=force) >= 0.0


def test_an_axis_at_rest_draws_nothing() -> None:
    assert axis.axis_power(DRIVE, 0.0, 4000.0, feed_force=500.0) == 0.0
    assert axis.motor_torque(DRIVE, 0.0, feed_force=500.0) == 0.0


def test_arrays_give_what_floats_give() -> None:
    speeds, changes = np.meshgrid([-300.0, -1.0, 0.0, 1.0, 300.0], [-4000.0, 0.0, 4000.0])
    forces = np.full_like(speeds, 250.0)
    table = axis.axis_power(DRIVE, speeds, changes, feed_force=forces, vertical_force=-50.0)
    each = [
        axis.axis_power(DRIVE, v, a, feed_force=250.0, vertical_force=-50.0)
        for v, a in zip(speeds.ravel().tolist(), changes.ravel().tolist(), strict=True)
    ]
    assert table.ravel() == pytest.approx(each)


def test_regeneration_returns_a_share_of_what_braking_gives() -> None:
    regenerative = replace(DRIVE, regeneration=0.6)
    torque = axis.motor_torque(DRIVE, 400.0, -4000.0)
    shaft = torque * axis.motor_speed(DRIVE, 400.0) / 1000.0
    assert shaft < 0.0
    assert axis.axis_power(regenerative, 400.0, -4000.0) == pytest.approx(0.6 * shaft)


def test_friction_helps_to_brake() -> None:
    slippery = replace(DRIVE, guide_friction=0.0, bearing_friction=0.0, viscous=0.0)
    rough = axis.motor_torque(DRIVE, 400.0, -4000.0)
    assert axis.motor_torque(slippery, 400.0, -4000.0) < rough < 0.0


def test_a_force_with_the_motion_relieves_the_motor() -> None:
    powers = [axis.axis_power(DRIVE, 50.0, feed_force=force) for force in (-300.0, 0.0, 300.0)]
    assert powers == sorted(powers)
    assert powers[0] < powers[1] < powers[2]


def test_the_feed_force_costs_its_own_power() -> None:
    smooth = AxisDrive(lead=10.0, table_mass=100.0)
    assert axis.axis_power(smooth, 50.0, feed_force=2000.0) == pytest.approx(100.0)


def test_a_force_that_lifts_the_table_does_not_relieve_the_guide() -> None:
    dry = axis.guide_torque(DRIVE, vertical_force=0.0)
    assert axis.guide_torque(DRIVE, vertical_force=-500.0) == dry
    pressed = axis.guide_torque(DRIVE, vertical_force=500.0)
    assert pressed - dry == pytest.approx(10.0 * 0.02 * 500.0 / (2 * pi))


def test_a_gear_turns_the_motor_faster_with_less_torque_and_inertia_behind_it() -> None:
    geared = replace(DRIVE, gear_ratio=2.0)
    assert axis.motor_speed(geared, 100.0) == 2.0 * axis.motor_speed(DRIVE, 100.0)
    steady = axis.steady_torque(DRIVE, feed_force=300.0)
    assert axis.steady_torque(geared, feed_force=300.0) == pytest.approx(steady / 2.0)
    shaft = DRIVE.motor_inertia + DRIVE.coupling_inertia
    behind = axis.reflected_inertia(DRIVE) - shaft
    assert axis.reflected_inertia(geared) - shaft == pytest.approx(behind / 4.0)


def test_a_gear_changes_no_power_of_load_and_friction() -> None:
    dry = replace(DRIVE, viscous=0.0)
    power = axis.axis_power(dry, 100.0, feed_force=300.0)
    geared = axis.axis_power(replace(dry, gear_ratio=3.0), 100.0, feed_force=300.0)
    assert geared == pytest.approx(power)


def test_the_work_of_a_ramp_is_kinetic_energy_and_friction() -> None:
    """Midpoint sums of a quadratic in time, against ½·J·w² and the losses."""
    ideal = replace(DRIVE, efficiency=1.0)
    acceleration, steps = 4000.0, 2000
    time = 0.1
    times = (np.arange(steps) + 0.5) * time / steps
    work = axis.axis_power(ideal, acceleration * times, acceleration).sum() * time / steps
    top = axis.motor_speed(ideal, acceleration * time)
    kinetic = 0.5 * axis.reflected_inertia(ideal) * top**2
    dry = axis.steady_torque(ideal, feed_force=0.0) * top * time / 2.0
    viscous = ideal.viscous * top**2 * time / 3.0
    assert work == pytest.approx(kinetic + (dry + viscous) / 1000.0, rel=1e-6)
