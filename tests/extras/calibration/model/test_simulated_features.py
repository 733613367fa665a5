"""A simulated run beside a measured one whose clock lags."""

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

from extras.calibration.model.measured_run import Component, MeasuredRun
from extras.calibration.model.simulated_features import features, lag
from simulator.machine.samples import Samples
from simulator.motion.segments import Floats

LAG = 1.5
TIME = np.arange(0.0, 40.0, 0.01)
AXES = ("position", "velocity", "axis_power")


def samples() -> Samples:
    """Forty seconds: the spindle goes up by a ramp, X swings."""
    columns: dict[str, Any] = {
        field.name: np.zeros((len(TIME), 3) if field.name in AXES else len(TIME))
        for field in fields(Samples)
    }
    bare = Samples(**columns)
    speed = np.interp(TIME, [5.0, 7.0], [0.0, 50.0])
    velocity = np.zeros((len(TIME), 3))
    velocity[:, 0] = 100.0 * np.sin(0.5 * TIME)
    return replace(
        bare,
        time=TIME,
        velocity=velocity,
        spindle_speed=-speed,
        spindle_power=4.0 * speed,
        axis_power=0.5 * np.abs(velocity),
        base_power=np.full(len(TIME), 300.0),
        cutting_power=np.where(TIME > 10.0, 80.0, 0.0),
        coolant=(TIME > 8.0).astype(np.int64),
    )


def power(times: Floats) -> Floats:
    """What the simulation shows, times 1.1, and 20 W."""
    shown = 300.0 + 4.0 * np.interp(times, [5.0, 7.0], [0.0, 50.0])
    return np.asarray(20.0 + 1.1 * (shown + np.abs(50.0 * np.sin(0.5 * times))))


def measured() -> MeasuredRun:
    time = np.arange(0.0, 38.0, 0.1)
    return MeasuredRun(
        name="measured",
        time=100.0 + time,
        position=np.full((len(time), 3), np.nan),
        power={Component.TOTAL: power(time - LAG)},
    )


def test_lag_is_found() -> None:
    assert lag(samples(), measured()) == pytest.approx(LAG, abs=0.06)


def test_components_do_where_there_is_no_total() -> None:
    run = measured()
    time = run.time - run.time[0] - LAG
    spindle = 4.0 * np.interp(time, [5.0, 7.0], [0.0, 50.0])
    assert lag(samples(), replace(run, power={Component.SPINDLE: spindle})) == pytest.approx(
        LAG, abs=0.06
    )


def test_features_are_those_of_the_simulation_at_the_measured_times() -> None:
    run = measured()
    found = features(samples(), run)
    times = run.time - run.time[0] - lag(samples(), run)
    inside = (times > 0.1) & (times < 39.0)
    np.testing.assert_allclose(
        found.velocity[inside, 0], 100.0 * np.sin(0.5 * times[inside]), atol=0.1
    )
    np.testing.assert_allclose(
        found.acceleration[inside, 0], 50.0 * np.cos(0.5 * times[inside]), atol=0.1
    )
    ramp = (times > 5.1) & (times < 6.9)
    np.testing.assert_allclose(found.spindle_acceleration[ramp], 25.0, atol=1e-6)
    assert found.spindle_speed.max() == pytest.approx(50.0)
    assert found.cutting_power.max() == 80.0
    assert found.coolant[-1] == 1.0
    assert found.measured is run.power
