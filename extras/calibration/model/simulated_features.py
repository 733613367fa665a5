"""Features of a measured run from a simulation of its program.

The simulation gives the motion, the spindle speed and the cutting power over its own time. The
measured clock lags behind by a constant, which is the only alignment. Units mm, s, W.

Skill of predicting a measured run compared with a baseline without physics.

The baseline is the mean power of the calibration runs times the measured duration of the run to
be predicted, so that it has every advantage. Skill is ``1 − |error|/|baseline's error|``: 1 is
perfect, 0 no better than the baseline, negative worse. A constant lag between both clocks is
the only alignment. Units W, J, s.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from extras.calibration.model.features import RunFeatures
from extras.calibration.model.measured_run import Component, MeasuredRun
from simulator.machine.samples import Samples
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


MOST_LAG = 5.0  # s


def features(samples: Samples, run: MeasuredRun) -> RunFeatures:
    """Combine the powers of a measured run with the kinematics of a simulated one.

    Parameters
    ----------
    samples : Samples
        Simulation of the same program on the machine to be calibrated, with a factor of 1 on
        the specific cutting force; dense enough for accelerations, 100 Hz or more.
    run : MeasuredRun
    """
    time = run.time - run.time[0] - lag(samples, run)
    speed = np.abs(samples.spindle_speed)
    push = np.gradient(samples.velocity, samples.time, axis=0)
    return RunFeatures(
        name=run.name,
        duration=run.durations,
        spindle_speed=_at(time, samples.time, speed),
        spindle_acceleration=_at(time, samples.time, np.gradient(speed, samples.time)),
        velocity=_columns(time, samples.time, samples.velocity),
        acceleration=_columns(time, samples.time, push),
        cutting_power=_at(time, samples.time, samples.cutting_power),
        coolant=_at(time, samples.time, samples.coolant.astype(np.float64)),
        measured=run.power,
    )


def lag(samples: Samples, run: MeasuredRun) -> float:
    """Lag of a measured run's clock behind the simulation's, s, found from the powers."""
    time = run.time - run.time[0]
    known = {
        Component.X: samples.axis_power[:, 0],
        Component.Y: samples.axis_power[:, 1],
        Component.Z: samples.axis_power[:, 2],
        Component.SPINDLE: samples.spindle_power,
        Component.COOLANT: samples.coolant_power,
        Component.BASE: samples.base_power,
        Component.TOTAL: samples.total_power,
    }
    whole = [Component.TOTAL] if Component.TOTAL in run.power else list(run.power)
    measured = np.sum([run.power[part] for part in whole], axis=0)
    model = np.sum([known[part] for part in whole], axis=0)
    return estimated_lag(
        time, measured, lambda times: _at(times, samples.time, model), most=MOST_LAG
    )


def _at(times: Floats, known: Floats, values: Floats) -> Floats:
    """Values interpolated at other times; constant before and after the run."""
    return np.interp(times, known, values)


def _columns(times: Floats, known: Floats, values: Floats) -> Floats:
    """Columns of values interpolated at other times."""
    return np.stack([_at(times, known, column) for column in values.T], axis=1)
