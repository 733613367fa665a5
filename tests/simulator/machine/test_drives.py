"""Electrical power of axes and spindle as arrays, and its limits."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from simulator.machine.samples import Condition
from simulator.machine.sensing import axes_power, continuous_power, main_power, overload
from simulator.physics.axis import axis_power
from simulator.physics.spindle import available_power
from simulator.spec import AxisDrive, Machine, Spindle, SpindlePoint

VELOCITY = np.array([[3.0, 4.0, 0.0], [0.0, 0.0, -10.0], [0.0, 0.0, 0.0]])
ACCELERATION = np.array([[30.0, 40.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])


def test_an_axis_bears_its_share_of_the_feed_force(mill: Machine) -> None:
    drive = mill.axes[0].drive
    assert drive is not None
    force = np.array([100.0, 200.0, 300.0])
    power = axes_power(mill, VELOCITY, ACCELERATION, feed_force=force)
    assert power[0, 0] == pytest.approx(axis_power(drive, 3.0, 30.0, feed_force=60.0))
    assert power[0, 1] == pytest.approx(axis_power(drive, 4.0, 40.0, feed_force=80.0))
    assert power[1].tolist() == pytest.approx([
        0.0,
        0.0,
        axis_power(drive, -10.0, 0.0, feed_force=200.0),
    ])
    assert power[2].tolist() == [0.0, 0.0, 0.0]


def test_feed_force_costs_its_power_over_the_efficiency(mill: Machine) -> None:
    bare = AxisDrive(lead=10.0, table_mass=0.0, efficiency=0.8)
    machine = replace(mill, axes=tuple(replace(axis, drive=bare) for axis in mill.axes))
    force = np.full(3, 500.0)
    power = axes_power(machine, VELOCITY, 0.0 * VELOCITY, feed_force=force)
    # F·v in direction (3, 4, 0)/5: each axis has F·share times v·share.
    assert power[0].sum() == pytest.approx(500.0 * 5.0 / 1000.0 / 0.8)


def test_an_axis_without_a_drive_draws_nothing(mill: Machine) -> None:
    unknown = replace(mill, axes=tuple(replace(axis, drive=None) for axis in mill.axes))
    assert not axes_power(unknown, VELOCITY, ACCELERATION, feed_force=np.ones(3)).any()


def test_spindle_ramp_has_the_power_of_the_reference(mill: Machine) -> None:
    """J 0.5 kg·m², 1750 rpm, 10 rev/s²: 31.416 N·m and 5757 W at the shaft, no friction."""
    spindle = Spindle(
        curve=(SpindlePoint(speed=25.0, power=7500.0),),
        efficiency=1.0,
        min_speed=None,
        max_speed=None,
        acceleration=10.0,
        inertia=0.5,
    )
    machine = replace(mill, spindle=spindle)
    speed, rise = np.array([1750 / 60, 1750 / 60]), np.array([10.0, -10.0])
    power = main_power(machine, speed, rise, cutting_power=np.zeros(2))
    assert power[0] == pytest.approx(31.416 * 183.26, rel=1e-4)
    assert power[1] == 0.0


def test_cutting_power_is_drawn_over_the_efficiency(mill: Machine) -> None:
    speed, none = np.array([20.0, 20.0]), np.zeros(2)
    power = main_power(mill, speed, none, cutting_power=np.array([0.0, 800.0]))
    assert power[0] == pytest.approx(100.0 + 2.0 * 20.0 + 0.01 * 400.0)
    assert power[1] - power[0] == pytest.approx(1000.0)


def test_continuous_power_is_that_of_the_curve(mill: Machine) -> None:
    speed = np.array([0.0, 5.0, -12.5, 25.0, 120.0, -200.0])
    power = continuous_power(mill, speed)
    assert power[0] == np.inf
    wanted = [available_power(mill.spindle, abs(each)) for each in speed[1:]]
    np.testing.assert_allclose(power[1:], wanted)
    assert wanted[0] == pytest.approx(1000.0)


def test_condition_by_share_of_the_continuous_power(mill: Machine) -> None:
    power = np.array([0.0, 5000.0, 5001.0, 7500.0, 7501.0])
    found = overload(mill, power * mill.spindle.efficiency, np.full(5, 50.0), force=np.zeros(5))
    assert found.tolist() == [
        Condition.NORMAL,
        Condition.NORMAL,
        Condition.WARNING,
        Condition.WARNING,
        Condition.FAULT,
    ]


def test_condition_by_the_permitted_force(mill: Machine) -> None:
    weak = replace(mill, max_cutting_force=1000.0)
    force = np.array([1000.0, 1001.0, 1501.0])
    found = overload(weak, np.zeros(3), np.full(3, 50.0), force=force)
    assert found.tolist() == [Condition.NORMAL, Condition.WARNING, Condition.FAULT]
    none = overload(mill, np.zeros(3), np.full(3, 50.0), force=force)
    assert none.tolist() == [Condition.NORMAL] * 3


def test_torque_times_speed_is_the_power_at_the_edge(mill: Machine) -> None:
    """20 N·m at 25 rev/s: 3141.6 W leave the spindle."""
    drawn = main_power(
        mill, np.array([25.0]), np.zeros(1), cutting_power=np.array([20.0 * 2 * pi * 25.0])
    )
    idle = main_power(mill, np.array([25.0]), np.zeros(1), cutting_power=np.zeros(1))
    assert drawn[0] - idle[0] == pytest.approx(3141.59 / 0.8, rel=1e-5)
