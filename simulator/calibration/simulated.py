"""Features of a measured run from a simulation of its program.

The simulation shows the motion, the spindle and the power at the edge by its own time; the
measured clock lags behind it by a constant, the only thing that is aligned. Units mm, s, W.
"""

import numpy as np

from simulator.calibration.features import RunFeatures
from simulator.calibration.measured_run import Component, MeasuredRun
from simulator.calibration.skill import estimated_lag
from simulator.machine.samples import Samples
from simulator.motion.segments import Floats

MOST_LAG = 5.0  # s


def features(samples: Samples, run: MeasuredRun) -> RunFeatures:
    """A measured run with the kinematics of a simulated one.

    Parameters
    ----------
    samples : Samples
        Of the same program on the machine that is to be calibrated, with a factor of 1 on the
        specific cutting force; dense enough to show accelerations, 100 Hz or more.
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
    """Constant lag of a measured run's clock behind a simulation's, s, by their powers."""
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
    """Values at other times; before and after the run those of its ends."""
    return np.interp(times, known, values)


def _columns(times: Floats, known: Floats, values: Floats) -> Floats:
    """Columns of values at other times."""
    return np.stack([_at(times, known, column) for column in values.T], axis=1)
