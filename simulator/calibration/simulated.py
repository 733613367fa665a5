"""Features of a measured run from a simulation of its program.

The simulation gives the motion, the spindle speed and the cutting power over its own time. The
measured clock lags behind by a constant, which is the only alignment. Units mm, s, W.
"""

import numpy as np

from simulator.calibration.features import RunFeatures
from simulator.calibration.measured_run import Component, MeasuredRun
from simulator.calibration.skill import estimated_lag
from simulator.machine.samples import Samples
from simulator.motion.segments import Floats

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
