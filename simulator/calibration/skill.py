"""Skill of predicting a measured run compared with a baseline without physics.

The baseline is the mean power of the calibration runs times the measured duration of the run to
be predicted, so that it has every advantage. Skill is ``1 − |error|/|baseline's error|``: 1 is
perfect, 0 no better than the baseline, negative worse. A constant lag between both clocks is
the only alignment. Units W, J, s.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from simulator.motion.segments import Floats

LAG_STEP = 0.05  # s between lags to be tried


@dataclass(frozen=True, slots=True, kw_only=True)
class Skill:
    """Errors of one component's power in a run, for the model and for the baseline."""

    measured_energy: float
    """Measured energy, J."""
    model_energy: float
    """Energy predicted by the model, J."""
    baseline_energy: float
    """Energy predicted by the baseline, J."""
    model_rmse: float
    """Root mean square error of the model's power, W."""
    baseline_rmse: float
    """Root mean square error of the baseline's power, W."""
    measured_net: float
    """Measured cutting energy, J: measured energy minus the idle energy of the model."""
    model_net: float
    """Cutting energy of the model, J."""

    @property
    def energy_error(self) -> float:
        """Signed relative error of the model's energy."""
        return relative_error(self.model_energy, self.measured_energy)

    @property
    def baseline_energy_error(self) -> float:
        """Signed relative error of the baseline's energy."""
        return relative_error(self.baseline_energy, self.measured_energy)

    @property
    def net_error(self) -> float:
        """Signed relative error of the cutting energy; infinite if nothing was cut."""
        return relative_error(self.model_net, self.measured_net)

    @property
    def energy_skill(self) -> float:
        """Skill of the model over the baseline by energy."""
        return skill(self.energy_error, self.baseline_energy_error)

    @property
    def power_skill(self) -> float:
        """Skill of the model over the baseline by root mean square error of power."""
        return skill(self.model_rmse, self.baseline_rmse)


def relative_error(found: float, measured: float) -> float:
    """Signed relative error; infinite if the measured value is 0."""
    return found / measured - 1.0 if measured else np.inf


def skill(error: float, baseline: float) -> float:
    """Skill ``1 − |error|/|baseline|``; minus infinity if only the baseline has no error."""
    if baseline == 0.0:
        return 0.0 if error == 0.0 else -np.inf
    return 1.0 - abs(error) / abs(baseline)


def mean_power(watts: list[Floats], durations: list[Floats]) -> float:
    """Mean power of several runs, W, used as the baseline."""
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
    """Compare the measured and predicted power of a run.

    Parameters
    ----------
    measured, model : (N,) array, W
        Powers at the same samples.
    duration : (N,) array, s
        Time represented by each sample.
    model_energy : float, J
        Energy of the whole predicted run, over the predicted time.
    idle : (N,) array, W
        Predicted power at these samples without cutting.
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
    """Constant lag of the measured clock behind the model's, s, regardless of power level.

    Parameters
    ----------
    time : (N,) array, s
    measured : (N,) array, W
    model : function of (N,) times in s
        Power in W.
    most : float, s
        Lags between minus and plus this value are tried.
    """
    steps = round(most / LAG_STEP)
    lags = LAG_STEP * np.arange(-steps, steps + 1)
    errors = [float(np.var(model(time - lag) - measured)) for lag in lags]
    return float(lags[int(np.argmin(errors))])
