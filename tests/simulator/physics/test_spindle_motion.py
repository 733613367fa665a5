"""Spindle on ramps, idling, cutting, coasting. Figures from print: tests/reference."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from simulator.physics import spindle_motion
from simulator.spec import Spindle, SpindlePoint

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
    assert spindle_motion.spindle_power(SPINDLE, 0.0, 50.0) == 0.0


def test_a_spindle_that_idles_draws_its_idle_power() -> None:
    assert spindle_motion.spindle_power(SPINDLE, 50.0) == pytest.approx(100 + 150 + 50)


def test_the_running_torque_carries_the_idle_power() -> None:
    torque = spindle_motion.running_torque(SPINDLE, 50.0)
    assert torque * 2 * pi * 50.0 / 1000.0 == pytest.approx(0.9 * 300.0)


def test_cutting_adds_its_power_over_the_efficiency() -> None:
    idle = spindle_motion.spindle_power(SPINDLE, 50.0)
    cutting = spindle_motion.spindle_power(SPINDLE, 50.0, cutting_power=900.0)
    assert cutting - idle == pytest.approx(1000.0)


def test_both_senses_of_rotation_cost_the_same() -> None:
    for speed, change in ((40.0, 50.0), (40.0, -50.0)):
        assert spindle_motion.spindle_power(SPINDLE, speed, change) == pytest.approx(
            spindle_motion.spindle_power(SPINDLE, -speed, -change)
        )


def test_braking_returns_its_share_and_nothing_without_regeneration() -> None:
    assert spindle_motion.spindle_power(SPINDLE, 50.0, -50.0) == 0.0
    shaft = -0.05 * 2 * pi * 50.0 * 2 * pi * 50.0 + 0.9 * 300.0
    regenerative = replace(SPINDLE, regeneration=0.7)
    power = spindle_motion.spindle_power(regenerative, 50.0, -50.0)
    assert power == pytest.approx(0.7 * shaft)


def test_an_unknown_inertia_costs_nothing() -> None:
    unknown = replace(SPINDLE, inertia=None)
    idle = spindle_motion.spindle_power(unknown, 50.0)
    assert spindle_motion.spindle_power(unknown, 50.0, 50.0) == idle


def test_arrays_give_what_floats_give() -> None:
    speeds, changes = np.array([-50.0, 0.0, 20.0, 50.0]), np.array([50.0, 50.0, -50.0, 0.0])
    table = spindle_motion.spindle_power(SPINDLE, speeds, changes, cutting_power=10.0)
    each = [
        spindle_motion.spindle_power(SPINDLE, n, a, cutting_power=10.0)
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
    work = spindle_motion.spindle_power(ideal, 50.0 * times, 50.0).sum() / 1000.0
    assert work == pytest.approx(spindle_motion.kinetic_energy(0.05, 50.0), rel=1e-9)


def test_coasting_obeys_its_differential_equation() -> None:
    """d t/d ω = J/(T_c + B·ω), by a central difference."""
    angular, step = 150.0, 0.01
    later, sooner = (
        spindle_motion.coast_down_time(
            0.2, (angular + change) / (2 * pi), dry_torque=800.0, viscous=6.0
        )
        for change in (step, -step)
    )
    slope = 1000.0 * 0.2 / (800.0 + 6.0 * angular)
    assert (later - sooner) / (2 * step) == pytest.approx(slope, rel=1e-6)


def test_a_little_viscous_friction_changes_little() -> None:
    dry = spindle_motion.coast_down_time(0.2, 25.0, dry_torque=800.0)
    damped = spindle_motion.coast_down_time(0.2, 25.0, dry_torque=800.0, viscous=1e-9)
    assert damped == pytest.approx(dry)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"dry_torque": 0.0}, "dry torque 0 N·mm must be greater than 0"),
        ({"inertia": 0.0}, "inertia 0 kg·m² must be greater"),
        ({"speed": -1.0}, "spindle speed -1 rev/s must be at least 0"),
        ({"viscous": -1.0}, "viscous friction -1 N·mm·s/rad must be at least 0"),
    ],
)
def test_coasting_refuses_what_has_no_meaning(change: dict[str, float], message: str) -> None:
    good = {"inertia": 0.2, "speed": 25.0, "dry_torque": 800.0, "viscous": 1.0}
    with pytest.raises(ValueError, match=message):
        spindle_motion.coast_down_time(**(good | change))


def test_petroff_refuses_a_film_without_a_gap() -> None:
    with pytest.raises(ValueError, match="gap 0 mm must be greater"):
        spindle_motion.petroff_torque(1e-8, 50.0, diameter=80.0, length=100.0, gap=0.0)


def test_a_running_torque_needs_a_speed() -> None:
    with pytest.raises(ValueError, match="spindle speed 0 rev/s"):
        spindle_motion.running_torque(SPINDLE, 0.0)
