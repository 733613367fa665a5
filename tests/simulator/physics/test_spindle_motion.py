"""Spindle on ramps, idling, cutting, coasting. Figures from print: tests/reference."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from simulator.physics import spindle
from simulator.spec import Spindle, SpindlePoint
from tests.oracles import spindle as oracle

SPINDLE = Spindle(
    curve=(SpindlePoint(speed=10.0, power=15_000.0),),
    efficiency=0.9,
    min_speed=None,
    max_speed=None,
    acceleration=50.0,
    inertia=0.05,
    idle_power=100.0,
    idle_power_per_speed=3.0,
    idle_power_per_speed_squared=0.02,
)


def test_a_spindle_at_rest_draws_nothing() -> None:
    assert spindle.spindle_power(SPINDLE, 0.0, 50.0) == 0.0


def test_a_spindle_that_idles_draws_its_idle_power() -> None:
    assert spindle.spindle_power(SPINDLE, 50.0) == pytest.approx(100 + 150 + 50)


def test_the_running_torque_carries_the_idle_power() -> None:
    torque = oracle.running_torque(SPINDLE, 50.0)
    assert torque * 2 * pi * 50.0 / 1000.0 == pytest.approx(0.9 * 300.0)


def test_cutting_adds_its_power_over_the_efficiency() -> None:
    idle = spindle.spindle_power(SPINDLE, 50.0)
    cutting = spindle.spindle_power(SPINDLE, 50.0, cutting_power=900.0)
    assert cutting - idle == pytest.approx(1000.0)


def test_both_senses_of_rotation_cost_the_same() -> None:
    for speed, change in ((40.0, 50.0), (40.0, -50.0)):
        assert spindle.spindle_power(SPINDLE, speed, change) == pytest.approx(
            spindle.spindle_power(SPINDLE, -speed, -change)
        )


def test_braking_returns_its_share_and_nothing_without_regeneration() -> None:
    assert spindle.spindle_power(SPINDLE, 50.0, -50.0) == 0.0
    shaft = -0.05 * 2 * pi * 50.0 * 2 * pi * 50.0 + 0.9 * 300.0
    regenerative = replace(SPINDLE, regeneration=0.7)
    power = spindle.spindle_power(regenerative, 50.0, -50.0)
    assert power == pytest.approx(0.7 * shaft)


def test_an_unknown_inertia_costs_nothing() -> None:
    unknown = replace(SPINDLE, inertia=None)
    idle = spindle.spindle_power(unknown, 50.0)
    assert spindle.spindle_power(unknown, 50.0, 50.0) == idle


def test_arrays_give_what_floats_give() -> None:
    speeds, changes = np.array([-50.0, 0.0, 20.0, 50.0]), np.array([50.0, 50.0, -50.0, 0.0])
    table = spindle.spindle_power(SPINDLE, speeds, changes, cutting_power=10.0)
    each = [
        spindle.spindle_power(SPINDLE, n, a, cutting_power=10.0)
        for n, a in zip(speeds.tolist(), changes.tolist(), strict=True)
    ]
    assert table == pytest.approx(each)


def test_the_work_of_a_ramp_is_the_kinetic_energy() -> None:
    ideal = replace(
        SPINDLE,
        efficiency=1.0,
        idle_power=0.0,
        idle_power_per_speed=0.0,
        idle_power_per_speed_squared=0.0,
    )
    times = (np.arange(1000) + 0.5) / 1000.0
    work = spindle.spindle_power(ideal, 50.0 * times, 50.0).sum() / 1000.0
    assert work == pytest.approx(oracle.kinetic_energy(0.05, 50.0), rel=1e-9)
