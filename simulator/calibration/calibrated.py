"""A machine before and after: what it says of its own powers, and the machine as fitted.

An axis' fitted friction, viscous friction and mass are those seen from the mains; the drive
that is written is equivalent to them, its friction all in the bearing's preload. The factor on
the specific cutting force is no property of a machine and stays in the calibration.
Units mm, s, N, W, kg·m².

The delay of the main drive, from how late its measured power follows the model's.

A first-order lag of the predicted power of the cut; the time constant is the one that leaves
the least, its interval where what it leaves is no more than chance explains. Samples within a
block count as one observation, as in :mod:`simulator.calibration.fit`. Units s, W.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import pi

import numpy as np
from scipy.optimize import minimize_scalar

from simulator.calibration.features import (
    AXIS_PARAMETERS,
    Calibration,
    Estimate,
    Parameter,
    ParameterPrior,
    RunFeatures,
    design,
    powers,
)
from simulator.calibration.measured_run import Component
from simulator.motion.segments import AXES, Floats
from simulator.physics.axis import motor_speed, reflected_inertia, steady_torque
from simulator.spec import Axis, AxisDrive, Machine

LONGEST = 2.0
"""s; no main drive is slower"""

SHORTEST = 1e-3
"""s"""

CHANCE = 3.84
"""95 % quantile of χ² with one degree of freedom"""

GRID = 60
"""time constants that are tried before the best is refined"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Delay:
    """Time constant of the main drive, s."""

    value: float
    low: float
    high: float
    reason: str = ""
    """why it could not be identified; empty: it was"""


def fitted_delay(
    runs: Sequence[RunFeatures], calibration: Calibration, *, efficiency: float
) -> Delay:
    """Time constant of the main drive.

    Parameters
    ----------
    runs : sequence of RunFeatures
        With the power of the spindle, or the total.
    calibration : Calibration
        Of the same runs.
    efficiency : float
        Of the spindle.
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
    # Residuals within a block are not independent: so much more may be left by chance.
    bound = least * (1.0 + CHANCE / max(1, min(calibration.blocks, count)))
    inside = np.flatnonzero(misses <= bound)
    low, high = np.exp(trials[inside[[0, -1]]]) if len(inside) else np.exp(bounds)
    reason = ""
    if low <= SHORTEST * 1.01:
        reason = "shorter than these samples can show"
    elif high >= LONGEST * 0.99:
        reason = "no delay makes the model better"
    return Delay(value=float(np.exp(found.x)), low=float(low), high=float(high), reason=reason)


def lagged(power: Floats, step: float, delay: float) -> Floats:
    """Power behind a first-order lag, (N,) samples a step in s apart; straight between them."""
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
    """Measured power of the cut, the model's, and the time between samples.

    As in :mod:`simulator.machine.disturbance`, only the cut shows late: the control knows of
    the spindle's own speed in advance.
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


LEAD = 10.0  # mm per revolution, of a drive that was unknown
BEARING_FRICTION = 0.01  # little, so that the feed force adds next to none
LEAST_MASS = 0.1  # kg, a table without any is none
FORCE, MASS = 500.0, 200.0
"""N and kg that a prior may well be off, where it does not say more itself"""
SLOW = 200.0  # mm/s at which viscous friction may well be as much as the other
POWER, POWER_PER_SPEED = 200.0, 5.0  # W and W/(rev/s), likewise
POWER_PER_SPEED_SQUARED = 0.05  # W/(rev/s)², likewise
INERTIA = 0.01  # kg·m², likewise
CUTTING = 0.5
"""catalogues differ by 20 to 70 % for the same steel"""
CALIBRATED = "powers fitted to measured runs, see the head of this file"
_MM2_PER_M2 = 1e6


def priors(machine: Machine) -> dict[Parameter, ParameterPrior]:
    """Prior of each parameter from the machine's file."""
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
    """The machine with the parameters that were identified; the others stay.

    Parameters
    ----------
    machine : Machine
        Whose :func:`priors` the calibration began with.
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
    """Lines that say what was found and what was not, for the head of a machine's file."""
    late = f"delay of the main drive: {delay.value:.4g} s"
    span = f", 95 % interval {delay.low:.4g} to {delay.high:.4g} s"
    late = f"delay of the main drive not found: {delay.reason}" if delay.reason else late + span
    return (*(_note(each) for each in calibration.estimates), late)


def _prior(value: float, scale: float) -> ParameterPrior:
    """A value that may be off by itself or by the scale."""
    return ParameterPrior(value=value, scale=max(value, scale))


def _from_mains(drive: AxisDrive | None) -> tuple[float, float, float]:
    """Friction N, viscous friction N·s/mm and mass kg of a drive, as seen from the mains."""
    if drive is None:
        return 0.0, 0.0, 0.0
    per_mm = motor_speed(drive, 1.0)
    friction = steady_torque(drive, feed_force=0.0) * per_mm / drive.efficiency
    viscous = drive.viscous * per_mm**2 / drive.efficiency
    mass = reflected_inertia(drive) * per_mm**2 * _MM2_PER_M2 / drive.efficiency
    return friction, viscous, mass


def _axis(axis: Axis, found: Mapping[Parameter, Estimate]) -> Axis:
    """The axis with a drive that draws what was found; as it was if nothing was."""
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
    """One line on a parameter."""
    value = f"{each.value:.4g} {each.unit}".strip()
    span = f"{each.low:.4g} to {each.high:.4g} {each.unit}".strip()
    if each.is_identified:
        return f"{each.parameter}: {value}, 95 % interval {span}"
    return f"{each.parameter}: kept at {value}; {each.reason}"
