"""Errors and skill, by hand."""

from math import inf, sqrt

import numpy as np
import pytest

from extras.calibration.model.simulated_features import (
    compared,
    estimated_lag,
    mean_power,
    skill,
)

MEASURED = np.array([100.0, 200.0, 300.0, 200.0])
MODEL = np.array([100.0, 210.0, 280.0, 200.0])
DURATION = np.full(4, 0.5)


def test_errors_stand_beside_those_of_the_baseline() -> None:
    found = compared(
        MEASURED,
        MODEL,
        duration=DURATION,
        model_energy=390.0,
        idle=np.full(4, 100.0),
        baseline=180.0,
    )
    assert found.measured_energy == 400.0
    assert found.energy_error == pytest.approx(-0.025)
    assert found.baseline_energy_error == pytest.approx(-0.1)
    assert found.energy_skill == pytest.approx(0.75)
    assert found.model_rmse == pytest.approx(sqrt(125.0))
    assert found.baseline_rmse == pytest.approx(sqrt((80**2 + 20**2 + 120**2 + 20**2) / 4))
    # Net of an idle of 100 W: 200 J measured, 195 J by the model.
    assert found.net_error == pytest.approx(-0.025)


def test_nothing_cut_has_no_relative_error() -> None:
    found = compared(
        MEASURED,
        MODEL,
        duration=DURATION,
        model_energy=400.0,
        idle=MEASURED,
        baseline=200.0,
    )
    assert found.net_error == inf


def test_skill_against_a_perfect_baseline() -> None:
    assert skill(0.0, 0.0) == 0.0
    assert skill(0.1, 0.0) == -inf
    assert skill(-0.2, 0.1) == pytest.approx(-1.0)


def test_mean_power_weighs_by_time() -> None:
    assert (
        mean_power([np.array([100.0]), np.array([400.0])], [np.ones(1), np.full(1, 2.0)]) == 300
    )


def test_gap_counts_nothing() -> None:
    found = compared(
        MEASURED,
        MODEL,
        duration=np.array([0.5, 0.0, 0.0, 0.5]),
        model_energy=150.0,
        idle=np.zeros(4),
        baseline=150.0,
    )
    assert found.measured_energy == 150.0
    assert found.model_rmse == 0.0


@pytest.mark.parametrize("lag", [-0.4, 0.0, 0.35])
def test_constant_lag_is_found_whatever_the_level(lag: float) -> None:
    time = np.arange(0.0, 20.0, 0.1)

    def power(times: np.typing.NDArray[np.float64]) -> np.typing.NDArray[np.float64]:
        return 50.0 * np.sin(times) + 20.0 * np.sin(3.1 * times)

    found = estimated_lag(time, 300.0 + power(time - lag), power, most=1.0)
    assert found == pytest.approx(lag, abs=1e-9)
