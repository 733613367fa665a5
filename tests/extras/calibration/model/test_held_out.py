"""Errors on what was not fitted."""

from dataclasses import replace

import numpy as np
import pytest

from extras.calibration.model.features import (
    PARAMETERS,
    Parameter,
    ParameterPrior,
    RunFeatures,
    design,
    powers,
)
from extras.calibration.model.fit import held_out
from extras.calibration.model.measured_run import Component

PRIORS = {name: ParameterPrior(value=0.0, scale=500.0) for name in Parameter} | {
    Parameter.CUTTING: ParameterPrior(value=1.0, scale=0.5)
}


def run(name: str, seed: int) -> RunFeatures:
    count = 600
    time = 0.1 * np.arange(count)
    bare = RunFeatures(
        name=name,
        duration=np.full(count, 0.1),
        spindle_speed=np.where(time < 5.0, 0.0, 40.0 + 20.0 * np.sin(time + seed)),
        spindle_acceleration=np.zeros(count),
        velocity=np.zeros((count, 3)),
        acceleration=np.zeros((count, 3)),
        cutting_power=np.where(np.sin(0.9 * time + seed) > 0.0, 900.0, 0.0),
        coolant=np.zeros(count),
        measured={},
    )
    truth = np.zeros(len(PARAMETERS))
    for parameter, value in (
        (Parameter.BASE, 400.0),
        (Parameter.IDLE_PER_SPEED, 5.0),
        (Parameter.CUTTING, 1.2),
    ):
        truth[PARAMETERS.index(parameter)] = value
    watts = powers(design(bare, efficiency=0.8), truth)[Component.TOTAL]
    noise = np.random.default_rng(seed).normal(0.0, 5.0, count)
    return replace(bare, measured={Component.TOTAL: watts + noise})


@pytest.mark.parametrize("count", [1, 3])
def test_what_was_not_fitted_is_predicted(count: int) -> None:
    runs = [run(f"run {seed}", seed) for seed in range(count)]
    found = held_out(runs, PRIORS, efficiency=0.8)
    assert [each.name for each in found] == [each.name for each in runs]
    for each in found:
        total = each.skills[Component.TOTAL]
        assert abs(total.energy_error) < 0.01
        assert abs(total.net_error) < 0.03
        assert total.model_rmse == pytest.approx(5.0, rel=0.15)
        assert total.power_skill > 0.95


def test_end_of_a_single_run_is_held_out() -> None:
    whole = run("run", 1)
    (found,) = held_out([whole], PRIORS, efficiency=0.8)
    energy = float(whole.measured[Component.TOTAL] @ whole.duration)
    assert found.skills[Component.TOTAL].measured_energy < 0.4 * energy
