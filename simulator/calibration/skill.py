"""Skill of a predicted run against a measured one, over a baseline without physics.

The baseline is the mean power of the calibration runs times the time of the run that is to be
predicted; it is given the measured time, so that it has every advantage. Skill is
``1 − |error|/|baseline's error|``: 1 is perfect, 0 no better than the baseline, negative worse.
A constant lag between both clocks is the only thing that is aligned. Units W, J, s.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from simulator.motion.segments import Floats

LAG_STEP = 0.05  # s between the lags that are tried


@dataclass(frozen=True, slots=True, kw_only=True)
class Skill:
    """Errors of one power of one run, model and baseline side by side."""

    measured_energy: float
    """Measured energy, J"""
    model_energy: float
    """Model energy, J"""
    baseline_energy: float
    """Baseline energy, J"""
    model_rmse: float
    """Model rmse, W"""
    baseline_rmse: float
    """Baseline rmse, W"""
    measured_net: float
    """J, cutting energy: without base, idle, axes; of the measured run by subtraction"""
    model_net: float
    """Model net, J"""

    @property
    def energy_error(self) -> float:
        """Share of the measured energy, signed."""
        return relative_error(self.model_energy, self.measured_energy)

    @property
    def baseline_energy_error(self) -> float:
        """Share of the measured energy, signed."""
        return relative_error(self.baseline_energy, self.measured_energy)

    @property
    def net_error(self) -> float:
        """Share of the net cutting energy, signed; infinite where nothing was cut."""
        return relative_error(self.model_net, self.measured_net)

    @property
    def energy_skill(self) -> float:
        """Over the baseline, by energy."""
        return skill(self.energy_error, self.baseline_energy_error)

    @property
    def power_skill(self) -> float:
        """Over the baseline, by RMSE."""
        return skill(self.model_rmse, self.baseline_rmse)


def relative_error(found: float, measured: float) -> float:
    """Signed share of what was measured; infinite where that is nothing."""
    return found / measured - 1.0 if measured else np.inf


def skill(error: float, baseline: float) -> float:
    """``1 − |error|/|baseline|``; minus infinity against a baseline without error."""
    if baseline == 0.0:
        return 0.0 if error == 0.0 else -np.inf
    return 1.0 - abs(error) / abs(baseline)


def mean_power(watts: list[Floats], durations: list[Floats]) -> float:
    """Mean power of several runs, W: the baseline."""
    energy = sum(float(watt @ time) for watt, time in zip(watts, durations, strict=True))
    return energy / sum(float(time.sum()) for time in durations)


def compared(
    measured: Floats,
    model: Floats,
    *,
    duration: Floats,
    model_energy: float,
    idle: Floats,
    baseline: float,
) -> Skill:
    """Errors of a run.

    Parameters
    ----------
    measured, model : (N,) array, W
        At the same samples.
    duration : (N,) array, s
        That each sample stands for.
    model_energy : float, J
        Of the whole predicted run, over the predicted time.
    idle : (N,) array, W
        What the model says would flow at these samples if nothing were cut.
    baseline : float, W
    """
    energy = float(measured @ duration)
    weight = duration / duration.sum()
    return Skill(
        measured_energy=energy,
        model_energy=model_energy,
        baseline_energy=baseline * float(duration.sum()),
        model_rmse=float(np.sqrt(weight @ (model - measured) ** 2)),
        baseline_rmse=float(np.sqrt(weight @ (baseline - measured) ** 2)),
        measured_net=energy - float(idle @ duration),
        model_net=float((model - idle) @ duration),
    )


def estimated_lag(
    time: Floats, measured: Floats, model: Callable[[Floats], Floats], *, most: float
) -> float:
    """Constant lag of the measured clock behind the model's, s; levels do not matter.

    Parameters
    ----------
    time : (N,) array, s
    measured : (N,) array, W
    model : function of (N,) times in s
        Power in W.
    most : float, s
        Lags from minus to plus this are tried.
    """
    steps = round(most / LAG_STEP)
    lags = LAG_STEP * np.arange(-steps, steps + 1)
    errors = [float(np.var(model(time - lag) - measured)) for lag in lags]
    return float(lags[int(np.argmin(errors))])
