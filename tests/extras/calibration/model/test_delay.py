"""The delay of a drive is found where the samples can show it, and named where not."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from extras.calibration.model.calibrated_machine import fitted_delay, lagged
from extras.calibration.model.features import (
    PARAMETERS,
    Calibration,
    Estimate,
    Parameter,
    RunFeatures,
)
from extras.calibration.model.measured_run import Component
from simulator.motion.segments import Floats

KNOWN = {Parameter.IDLE: 200.0, Parameter.CUTTING: 1.0}
CALIBRATION = Calibration(
    estimates=tuple(
        Estimate(parameter=each, value=KNOWN.get(each, 0.0), low=0.0, high=1.0)
        for each in PARAMETERS
    ),
    noise={Component.SPINDLE: 5.0},
    blocks=40,
)


def run(rate: float, delay: float, *, noise: float = 5.0, seed: int = 7) -> RunFeatures:
    """Cuts of 0 to 1500 W that begin and end, seen late."""
    count = int(60.0 * rate)
    random = np.random.default_rng(seed)
    cutting = np.repeat(random.choice([0.0, 500.0, 1500.0], 60), int(rate))
    truth = 200.0 + lagged(cutting, 1.0 / rate, delay) + random.normal(0.0, noise, count)
    still = np.zeros(count)
    return RunFeatures(
        name="synthetic",
        duration=np.full(count, 1.0 / rate),
        spindle_speed=np.full(count, 50.0),
        spindle_acceleration=still,
        velocity=np.zeros((count, 3)),
        acceleration=np.zeros((count, 3)),
        cutting_power=cutting,
        coolant=still,
        measured={Component.SPINDLE: truth},
    )


def test_the_lag_is_the_solution_of_its_equation() -> None:
    """τ·y' = u − y, u straight between samples."""
    step, delay = 0.05, 0.12
    times = np.arange(40) * step
    power: Floats = np.random.default_rng(1).uniform(0.0, 100.0, 40)
    exact = solve_ivp(
        lambda t, y: (np.interp(t, times, power) - y) / delay,
        (0.0, times[-1]), [power[0]], t_eval=times, max_step=step / 50.0, rtol=1e-9,
    )  # fmt: skip
    assert lagged(power, step, delay) == pytest.approx(exact.y[0], abs=1e-4)


@pytest.mark.parametrize("delay", [0.05, 0.2])
def test_a_delay_that_the_samples_show_is_found(delay: float) -> None:
    found = fitted_delay([run(100.0, delay)], CALIBRATION, efficiency=1.0)
    assert not found.reason
    assert found.value == pytest.approx(delay, rel=0.03)
    assert found.low <= delay * 1.03
    assert found.high >= delay * 0.97


def test_a_delay_shorter_than_the_samples_is_named() -> None:
    found = fitted_delay([run(10.0, 1e-4)], CALIBRATION, efficiency=1.0)
    assert found.reason == "shorter than the sampling interval can resolve"


def test_the_total_serves_too() -> None:
    whole = run(100.0, 0.1)
    total = replace(whole, measured={Component.TOTAL: whole.measured[Component.SPINDLE]})
    found = fitted_delay([total], CALIBRATION, efficiency=1.0)
    assert found.value == pytest.approx(0.1, rel=0.03)


def test_without_a_power_that_tells_nothing_is_found() -> None:
    blind = replace(run(10.0, 0.1), measured={Component.BASE: np.full(600, 1.0)})
    assert fitted_delay([blind], CALIBRATION, efficiency=1.0).reason
