from math import pi

import numpy as np
import pytest

from controller.signals.ports import Reading
from controller.signals.source import DrivePower, Dynamometer
from simulator.plant.controlled_machine import ControlledMachine, Instrumentation
from simulator.plant.dynamometer import DYNAMOMETER, Instrument
from simulator.plant.hidden_behaviour import HiddenTruth
from tests.controller.plugged import SPINDLE_SPEED, reading
from tests.controller.shown import turn
from tests.simulator.plant.courses import course, levels

EFFICIENCY = 0.8
DIAMETER = 10.0
"""mm, of :mod:`tests.simulator.plant.courses`"""

WATTS = 20.0
"""noise of the power meter"""


def readings(power_meter: Instrument) -> list[Reading]:
    """A rapid of 10 s, and a cut of 400 N for 10 s."""
    can_override = np.arange(2000) >= 1000
    path = course(levels(0.0, 400.0, cells=1000), can_override=can_override)
    bench = Instrumentation(
        dynamometer=DYNAMOMETER, power_meter=power_meter, efficiency=EFFICIENCY
    )
    machine = ControlledMachine(path, HiddenTruth(), bench)
    found = []
    while (each := machine.read()) is not None:
        found.append(each)
    return found


def test_power_and_dynamometer_tell_the_same_force() -> None:
    by_power, by_force = DrivePower(EFFICIENCY, 60.0), Dynamometer(10.0)
    pairs = [
        (by_force.conditioned(each, DIAMETER), by_power.conditioned(each, DIAMETER))
        for each in readings(Instrument(floor=WATTS, lag=0.05))
    ]
    # The power meter has settled after some of its time constants.
    cut = [pair for pair in pairs if pair[0].can_override][50:]
    forces, powers = (
        np.array([float(each.force.mean()) for each in side]) for side in zip(*cut, strict=True)
    )
    assert forces.mean() == pytest.approx(400.0, rel=0.01)
    per_watt = 1000.0 * EFFICIENCY / (pi * DIAMETER * SPINDLE_SPEED)
    # The idle power is known by some ten samples.
    assert powers.mean() == pytest.approx(400.0, abs=3.0 * WATTS * per_watt / 10.0**0.5)
    assert powers.std() == pytest.approx(WATTS * per_watt, rel=0.1)


def test_a_dynamometer_is_zeroed_while_nothing_can_be_cut() -> None:
    source = Dynamometer(10.0)
    rapid = reading(25.0, can_override=False)
    assert source.conditioned(rapid, DIAMETER) is rapid
    assert source.conditioned(reading(125.0), DIAMETER).force.mean() == pytest.approx(100.0)


def test_a_force_in_the_cut_is_no_zero() -> None:
    source = Dynamometer(10.0)
    for _ in range(100):
        found = source.conditioned(reading(125.0), DIAMETER)
    assert found.force.mean() == 125.0


def test_power_tells_no_force_without_a_diameter_or_an_idle_power() -> None:
    source = DrivePower(EFFICIENCY, 60.0)
    assert np.isnan(source.conditioned(reading(0.0), DIAMETER).force).all()
    idle = reading(0.0, can_override=False, power=200.0)
    assert len(source.conditioned(idle, DIAMETER).force) == 0
    assert len(source.conditioned(reading(0.0), 0.0).force) == 0


def test_power_over_idle_power_is_force_times_speed() -> None:
    source = DrivePower(EFFICIENCY, 60.0)
    source.conditioned(reading(0.0, can_override=False, power=200.0), DIAMETER)
    found = source.conditioned(reading(0.0, power=200.0 + 1000.0), DIAMETER)
    expected = 1000.0 * 1000.0 * EFFICIENCY / (pi * DIAMETER * SPINDLE_SPEED)
    assert found.force == pytest.approx([expected])
    other = reading(0.0, power=1200.0)._replace(spindle_speed=2.0 * SPINDLE_SPEED)
    assert np.isnan(source.conditioned(other, DIAMETER).force).all()


def test_what_the_program_takes_for_air_zeroes_the_instrument() -> None:
    source = Dynamometer(10.0)
    (drifted,) = turn(np.array([[6.0, 6.0]]))
    source.conditioned(drifted, 0.0, is_air=True)
    assert source.conditioned(drifted, 0.0).force.tolist() == [0.0, 0.0]


def test_a_force_where_the_program_expects_air_is_no_zero() -> None:
    source = Dynamometer(10.0)
    still, hit = turn(np.array([[1.0, 1.0], [300.0, 300.0]]))
    source.conditioned(still, 0.0, is_air=True)
    for _ in range(50):
        shown = source.conditioned(hit, 0.0, is_air=True)
    assert shown.force.tolist() == [299.0, 299.0]
