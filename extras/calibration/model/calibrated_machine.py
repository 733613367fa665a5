"""Machine parameters before and after calibration, and the delay of the main drive.

The fitted friction, viscous friction and mass of an axis are as seen from the mains; the
resulting drive is equivalent to them, with all friction in the preload of its bearing. The
factor on the specific cutting force is not a property of a machine and stays in the
calibration.

The delay of the main drive follows from how late its measured power follows the predicted power
of the cut. It is modelled as a first-order lag; the time constant minimises the residual, and
its interval contains all values whose residual is explained by chance. Samples within a block
count as one observation, as in :mod:`extras.calibration.model.fit`. Units mm, s, N, W, kg·m².
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import pi

import numpy as np
from scipy.optimize import minimize_scalar

from extras.calibration.model.features import (
    AXIS_PARAMETERS,
    Calibration,
    Estimate,
    Parameter,
    ParameterPrior,
    RunFeatures,
    design,
    powers,
)
from extras.calibration.model.measured_run import Component
from simulator.motion.segments import AXES, Floats
from simulator.physics.axis import motor_speed, reflected_inertia, steady_torque
from simulator.spec import Axis, AxisDrive, Machine

LONGEST = 2.0
"""Upper limit of the time constant, s; no main drive is slower."""

SHORTEST = 1e-3
"""Lower limit of the time constant, s."""

CHANCE = 3.84
"""95 % quantile of χ² with one degree of freedom."""

GRID = 60
"""Number of time constants tried before the best is refined."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Delay:
    """Time constant of the main drive with its interval, s."""

    value: float
    low: float
    high: float
    reason: str = ""
    """Reason why the delay could not be identified; empty if it was."""


def fitted_delay(
    runs: Sequence[RunFeatures], calibration: Calibration, *, efficiency: float
) -> Delay:
    """Fit the time constant of the main drive.

    Parameters
    ----------
    runs : sequence of RunFeatures
        Runs with the power of the spindle, or the total power.
    calibration : Calibration
        Calibration from the same runs.
    efficiency : float
        Efficiency of the spindle.
    """
    parts = [_pair(run, calibration, efficiency) for run in runs]
    pairs = [pair for pair in parts if pair is not None]
    if not pairs:
        return Delay(value=0.0, low=0.0, high=np.inf, reason="no spindle or total power")
    count = sum(len(measured) for measured, _, _ in pairs)

    def left(log_delay: float) -> float:
        delay = float(np.exp(log_delay))
        return sum(
            float(((lagged(model, step, delay) - measured) ** 2).sum())
            for measured, model, step in pairs
        )

    trials = np.linspace(np.log(SHORTEST), np.log(LONGEST), GRID)
    misses = np.array([left(trial) for trial in trials])
    best = int(misses.argmin())
    bounds = trials[max(best - 1, 0)], trials[min(best + 1, GRID - 1)]
    found = minimize_scalar(left, bounds=bounds, method="bounded")
    least = min(float(found.fun), float(misses[best]))
    # Residuals within a block are dependent: this increase may be due to chance.
    bound = least * (1.0 + CHANCE / max(1, min(calibration.blocks, count)))
    inside = np.flatnonzero(misses <= bound)
    low, high = np.exp(trials[inside[[0, -1]]]) if len(inside) else np.exp(bounds)
    reason = ""
    if low <= SHORTEST * 1.01:
        reason = "shorter than the sampling interval can resolve"
    elif high >= LONGEST * 0.99:
        reason = "no delay improves the model"
    return Delay(value=float(np.exp(found.x)), low=float(low), high=float(high), reason=reason)


def lagged(power: Floats, step: float, delay: float) -> Floats:
    """Power after a first-order lag, (N,), with samples a step in s apart, linear between."""
    ratio = step / delay
    decay = float(np.exp(-ratio))
    now = 1.0 - (1.0 - decay) / ratio
    before = 1.0 - decay - now
    shown = np.empty(len(power))
    value, last = float(power[0]), float(power[0])
    for row, load in enumerate(power.tolist()):
        value = decay * value + before * last + now * load
        shown[row], last = value, load
    return shown


def _pair(
    run: RunFeatures, calibration: Calibration, efficiency: float
) -> tuple[Floats, Floats, float] | None:
    """Measured power of the cut, its predicted power, and the time between samples.

    As in :mod:`simulator.machine.disturbance`, only the power of the cut is delayed: the
    control knows the speed of the spindle in advance.
    """
    part = Component.SPINDLE if Component.SPINDLE in run.measured else Component.TOTAL
    if part not in run.measured:
        return None
    idle_run = replace(run, cutting_power=np.zeros(len(run)))
    model, idle = (
        powers(design(each, efficiency=efficiency), calibration.values)[part]
        for each in (run, idle_run)
    )
    return run.measured[part] - idle, model - idle, float(np.median(run.duration))


LEAD = 10.0  # mm per revolution, assumed for an unknown drive
BEARING_FRICTION = 0.01  # small, so that the feed force adds almost nothing
LEAST_MASS = 0.1  # kg, because a table must have a mass
FORCE, MASS = 500.0, 200.0
"""Typical uncertainty of a prior friction in N and mass in kg, unless the value is greater."""
SLOW = 200.0  # mm/s at which viscous friction may be as large as constant friction
POWER, POWER_PER_SPEED = 200.0, 5.0  # W and W/(rev/s), typical uncertainty of a prior
POWER_PER_SPEED_SQUARED = 0.05  # W/(rev/s)², typical uncertainty of a prior
INERTIA = 0.01  # kg·m², typical uncertainty of a prior
CUTTING = 0.5
"""Typical uncertainty of the factor on k_c: catalogues differ by 20 to 70 % for one steel."""
CALIBRATED = "powers fitted to measured runs, see the comments at the top of this file"
_MM2_PER_M2 = 1e6


def priors(machine: Machine) -> dict[Parameter, ParameterPrior]:
    """Prior value of each parameter, from the machine's file."""
    spindle = machine.spindle
    known = {
        Parameter.BASE: _prior(machine.base_power, POWER),
        Parameter.COOLANT: _prior(machine.coolant_power, POWER),
        Parameter.IDLE: _prior(spindle.idle_power, POWER),
        Parameter.IDLE_PER_SPEED: _prior(spindle.idle_power_per_speed, POWER_PER_SPEED),
        Parameter.IDLE_PER_SPEED_SQUARED: _prior(
            spindle.idle_power_per_speed_squared, POWER_PER_SPEED_SQUARED
        ),
        Parameter.INERTIA: _prior(spindle.inertia or 0.0, INERTIA),
        Parameter.CUTTING: ParameterPrior(value=1.0, scale=CUTTING),
    }
    drives = {axis.name: axis.drive for axis in machine.axes}
    for name, parameters in zip(AXES, AXIS_PARAMETERS, strict=True):
        values = _from_mains(drives.get(name))
        for parameter, value, scale in zip(
            parameters, values, (FORCE, FORCE / SLOW, MASS), strict=True
        ):
            known[parameter] = _prior(value, scale)
    return known


def calibrated(machine: Machine, calibration: Calibration, delay: Delay) -> Machine:
    """Machine with the identified parameters; all others are unchanged.

    Parameters
    ----------
    machine : Machine
        Machine from whose :func:`priors` the calibration started.
    calibration : Calibration
    delay : Delay
    """
    found = {each.parameter: each for each in calibration.estimates if each.is_identified}

    def value(parameter: Parameter, before: float) -> float:
        return float(f"{found[parameter].value:.6g}") if parameter in found else before

    spindle = machine.spindle
    inertia = value(Parameter.INERTIA, spindle.inertia or 0.0)
    return replace(
        machine,
        source=f"{CALIBRATED}; the rest: {machine.source}",
        base_power=value(Parameter.BASE, machine.base_power),
        coolant_power=value(Parameter.COOLANT, machine.coolant_power),
        spindle=replace(
            spindle,
            idle_power=value(Parameter.IDLE, spindle.idle_power),
            idle_power_per_speed=value(Parameter.IDLE_PER_SPEED, spindle.idle_power_per_speed),
            idle_power_per_speed_squared=value(
                Parameter.IDLE_PER_SPEED_SQUARED, spindle.idle_power_per_speed_squared
            ),
            inertia=inertia or None,
            delay=spindle.delay if delay.reason else delay.value,
        ),
        axes=tuple(_axis(axis, found) for axis in machine.axes),
    )


def notes(calibration: Calibration, delay: Delay) -> tuple[str, ...]:
    """Lines that report each fitted parameter, for the head of a machine file."""
    late = f"delay of the main drive: {delay.value:.4g} s"
    span = f", 95 % interval {delay.low:.4g} to {delay.high:.4g} s"
    late = f"delay of the main drive not found: {delay.reason}" if delay.reason else late + span
    return (*(_note(each) for each in calibration.estimates), late)


def _prior(value: float, scale: float) -> ParameterPrior:
    """Prior whose uncertainty is its value or a scale, whichever is greater."""
    return ParameterPrior(value=value, scale=max(value, scale))


def _from_mains(drive: AxisDrive | None) -> tuple[float, float, float]:
    """Friction in N, viscous friction in N·s/mm and mass in kg, as seen from the mains."""
    if drive is None:
        return 0.0, 0.0, 0.0
    per_mm = motor_speed(drive, 1.0)
    friction = steady_torque(drive, feed_force=0.0) * per_mm / drive.efficiency
    viscous = drive.viscous * per_mm**2 / drive.efficiency
    mass = reflected_inertia(drive) * per_mm**2 * _MM2_PER_M2 / drive.efficiency
    return friction, viscous, mass


def _axis(axis: Axis, found: Mapping[Parameter, Estimate]) -> Axis:
    """Axis with a drive equivalent to the fitted parameters; unchanged if there are none."""
    parameters = AXIS_PARAMETERS[AXES.index(axis.name)] if axis.name in AXES else ()
    if not any(parameter in found for parameter in parameters):
        return axis
    friction, viscous, mass = (
        found[parameter].value if parameter in found else before
        for parameter, before in zip(parameters, _from_mains(axis.drive), strict=True)
    )
    before = axis.drive or AxisDrive(lead=LEAD, table_mass=LEAST_MASS)
    share = before.efficiency
    drive = AxisDrive(
        lead=before.lead,
        table_mass=max(LEAST_MASS, mass * share),
        screw_diameter=before.lead / pi,
        bearing_friction=BEARING_FRICTION,
        preload=friction * share / BEARING_FRICTION,
        viscous=viscous * share * (before.lead / (2.0 * pi)) ** 2,
        efficiency=share,
        regeneration=before.regeneration,
    )
    return replace(axis, drive=drive)


def _note(each: Estimate) -> str:
    """Line that reports a parameter and its interval."""
    value = f"{each.value:.4g} {each.unit}".strip()
    span = f"{each.low:.4g} to {each.high:.4g} {each.unit}".strip()
    if each.is_identified:
        return f"{each.parameter}: {value}, 95 % interval {span}"
    return f"{each.parameter}: kept at {value}; {each.reason}"
