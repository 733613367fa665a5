from dataclasses import replace
from math import exp, pi

import numpy as np
import pytest

from simulator.plant.controlled_machine import ControlledMachine, Instrumentation
from simulator.plant.course import NominalCourse
from simulator.plant.dynamometer import Instrument
from simulator.plant.hidden_behaviour import HiddenChange, HiddenQuantity, HiddenTruth
from simulator.reading import Reading
from tests.every_case import every_case
from tests.simulator.plant.courses import (
    EXPONENT,
    FEED,
    LAND_SHARE,
    SPEED,
    TEETH,
    course,
    levels,
)

PERFECT = Instrumentation(dynamometer=Instrument(), power_meter=Instrument())
PERIOD = 1.0 / (SPEED * TEETH)
QUICK = HiddenTruth(servo_lag=1e-4)


def machine(
    on: NominalCourse, hidden: HiddenTruth = QUICK, bench: Instrumentation = PERFECT
) -> ControlledMachine:
    return ControlledMachine(on, hidden, bench)


def run(at: ControlledMachine, override: float = 1.0) -> list[Reading]:
    at.set(override)
    readings = []
    while (reading := at.read()) is not None:
        readings.append(reading)
    return readings


def test_at_an_override_of_one_it_takes_the_planned_time() -> None:
    at = machine(course(levels(100.0, 200.0)))
    readings = run(at)
    assert at.time == pytest.approx(2.0)
    assert readings[-1].progress == 2.0
    assert sum(reading.period for reading in readings) == pytest.approx(2.0)
    assert [reading.tooth for reading in readings[:4]] == [0, 1, 0, 1]


@pytest.mark.parametrize("override", [0.5, 0.8, 1.2])
def test_a_constant_override_scales_the_time_and_the_force_by_its_power(
    override: float,
) -> None:
    at = machine(course(levels(100.0)))
    readings = run(at, override)
    assert at.time == pytest.approx(1.0 / override, rel=1e-3)
    middle = readings[len(readings) // 2]
    assert middle.force.mean() == pytest.approx(100.0 * override**EXPONENT, rel=1e-3)
    assert middle.feed == pytest.approx(FEED * override)
    assert middle.override == pytest.approx(override)


def test_rapids_and_pauses_keep_their_pace() -> None:
    can = np.arange(200) >= 100
    at = machine(course(levels(0.0, 100.0), can_override=can))
    readings = run(at, 0.5)
    assert at.time == pytest.approx(1.0 + 2.0, rel=1e-3)
    waits = [reading for reading in readings if not reading.can_override]
    assert sum(reading.period for reading in waits) == pytest.approx(1.0)
    assert max(reading.period for reading in waits) <= 0.25 + 1e-9


def test_the_feed_follows_the_override_as_a_first_order_lag() -> None:
    at = machine(course(levels(100.0)), HiddenTruth(servo_lag=0.05))
    at.set(0.5)
    reading = at.read()
    assert reading is not None
    mean = 0.5 + 0.5 * 0.05 / PERIOD * (1.0 - exp(-PERIOD / 0.05))
    assert reading.override == pytest.approx(mean)
    assert reading.progress == pytest.approx(mean * PERIOD)


def test_a_held_feed_stands_while_time_goes_on() -> None:
    at = machine(course(levels(100.0)))
    at.set(0.0)
    for _ in range(50):
        reading = at.read()
    assert reading is not None
    assert reading.time == pytest.approx(50 * PERIOD)
    assert reading.progress < 1e-3
    assert reading.force.mean() == pytest.approx(0.0, abs=1e-6)


def test_power_is_idle_power_and_the_force_at_its_speed() -> None:
    at = machine(course(levels(100.0)), bench=replace(PERFECT, efficiency=0.8))
    reading = at.read()
    assert reading is not None
    cutting = at.truth.force * pi * 10.0 * SPEED / 1000.0
    assert reading.power == pytest.approx(200.0 + cutting / 0.8)


def test_factors_on_depth_and_hardness_act_from_their_time() -> None:
    changes = (
        HiddenChange(time=0.5, what=HiddenQuantity.DEPTH, value=2.0),
        HiddenChange(time=0.8, what=HiddenQuantity.HARDNESS, value=1.3),
    )
    at = machine(course(levels(100.0)), replace(QUICK, force_factor=1.1, changes=changes))
    forces = {round(each.time, 6): each.force.mean() for each in run(at)}
    assert forces[0.4] == pytest.approx(110.0, rel=1e-3)
    assert forces[0.6] == pytest.approx(220.0, rel=1e-3)
    assert forces[0.9] == pytest.approx(286.0, rel=1e-3)


def test_wear_grows_only_while_it_cuts_and_raises_the_force() -> None:
    hidden = replace(QUICK, wear_rate=0.1)
    at = machine(course(levels(0.0, 100.0, 0.0)), hidden)
    run(at)
    assert at.truth.flank_wear == pytest.approx(0.1, abs=0.1 * 2 * PERIOD)
    worn = machine(course(levels(100.0)), replace(QUICK, flank_wear=0.2))
    assert worn.read() is not None
    assert worn.truth.force == pytest.approx(137.0, rel=1e-3)


def test_the_wear_land_takes_its_force_at_every_feed_and_in_every_work() -> None:
    """``F = K·g·u^p + VB·l``, both in proportion to the depth."""
    hidden = replace(QUICK, flank_wear=0.2, force_factor=1.3)
    at = machine(course(levels(100.0)), hidden)
    at.set(0.5)
    for _ in range(20):
        assert at.read() is not None
    expected = 1.3 * 100.0 * 0.5**EXPONENT + 0.2 * LAND_SHARE * 100.0
    assert at.truth.force == pytest.approx(expected, rel=1e-3)


def test_a_silent_sensor_shows_nothing_for_a_while() -> None:
    silence = HiddenChange(time=0.2, what=HiddenQuantity.SILENCE, value=0.3)
    readings = run(machine(course(levels(100.0)), replace(QUICK, changes=(silence,))))
    silent = [each.time for each in readings if np.isnan(each.force).all()]
    assert min(silent) == pytest.approx(0.2 + PERIOD, abs=PERIOD + 1e-9)
    assert max(silent) == pytest.approx(0.5, abs=PERIOD + 1e-9)
    assert np.isnan([each.power for each in readings if each.time in silent]).all()


def test_a_tooth_that_breaks_shows_in_every_revolution() -> None:
    broken = HiddenChange(time=0.5, what=HiddenQuantity.TOOTH, value=1.0)
    readings = run(machine(course(levels(100.0)), replace(QUICK, changes=(broken,))))
    late = [each for each in readings if each.time > 0.6]
    assert max(each.force.max() for each in late if each.tooth == 1) == 0.0
    assert min(each.force.mean() for each in late if each.tooth == 0) > 150.0


def test_a_change_may_come_while_it_runs() -> None:
    at = machine(course(levels(100.0)))
    at.read()
    at.change(HiddenChange(time=at.time, what=HiddenQuantity.DEPTH, value=2.0))
    at.read()
    assert at.truth.force == pytest.approx(200.0, rel=1e-3)
    assert at.factors[HiddenQuantity.DEPTH] == 2.0


def test_same_seed_same_readings() -> None:
    def forces(seed: int) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        return np.concatenate([
            each.force
            for each in run(machine(course(levels(100.0)), bench=Instrumentation(seed=seed)))
        ])

    np.testing.assert_array_equal(forces(1), forces(1))
    assert (forces(1) != forces(2)).any()


@every_case("override", [-0.1, float("nan"), float("inf")])
def test_an_impossible_override_is_refused(override: float) -> None:
    with pytest.raises(ValueError, match="override"):
        machine(course(levels(100.0))).set(override)


def test_each_tool_wears_and_breaks_for_itself() -> None:
    path = course(levels(100.0, 100.0, 100.0))
    tools = np.repeat([1, 2, 1], 100)
    broken = HiddenChange(time=0.5, what=HiddenQuantity.TOOTH, value=1.0)
    hidden = replace(QUICK, wear_rate=0.05, changes=(broken,))
    at = machine(replace(path, tool=tools), hidden)
    readings = run(at)
    assert at.truth.flank_wear == pytest.approx(0.1, abs=0.05 * 2 * PERIOD)

    def least(begin: float, end: float) -> float:
        return min(float(each.force.max()) for each in readings if begin < each.time < end)

    assert least(0.6, 0.98) == 0.0
    assert least(1.02, 1.98) > 50.0
    assert least(2.02, 2.98) == 0.0
