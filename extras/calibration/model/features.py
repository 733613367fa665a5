"""Regressors of the power of a machine, sample by sample, and the resulting power.

The power of every component is linear in the parameters, but never negative: braking energy is
dissipated. With ``n`` the spindle speed, ``v`` and ``a`` speed and acceleration of an axis,
``P_c`` the cutting power at the edge for a factor of 1 on the specific cutting force and ``η``
the efficiency of the spindle::

    spindle  P = P_0 + p_1·|n| + p_2·n² + (2π)²·J·n·ṅ/η + k·P_c/η
    axis     P = F_0·|v| + B·v² + m·a·v
    base     P = P_b                      coolant  P = P_k while it flows
    total    the sum

as in :mod:`simulator.physics.spindle` and :mod:`simulator.physics.axis`. Parameters of
an axis are as seen from the mains: friction ``F_0`` in N, ``B`` in N·s/mm and mass ``m`` in kg,
each divided by the efficiency of the drive. The module also defines priors and estimates of the
parameters. Units mm, s, N, W, rev/s, kg·m².
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import pi

import numpy as np

from extras.calibration.model.measured_run import Component
from simulator.motion.segments import Floats
from stepnc_model.units import NMM_S_PER_WATT

_MM2_PER_M2 = 1e6


class Parameter(StrEnum):
    """Parameter of a machine that can be fitted."""

    BASE = "base power"
    COOLANT = "coolant power"
    IDLE = "spindle idle power"
    IDLE_PER_SPEED = "spindle idle power per speed"
    IDLE_PER_SPEED_SQUARED = "spindle idle power per speed squared"
    INERTIA = "spindle inertia"
    CUTTING = "factor on specific cutting force"
    FRICTION_X = "X friction"
    VISCOUS_X = "X viscous friction"
    MASS_X = "X moved mass"
    FRICTION_Y = "Y friction"
    VISCOUS_Y = "Y viscous friction"
    MASS_Y = "Y moved mass"
    FRICTION_Z = "Z friction"
    VISCOUS_Z = "Z viscous friction"
    MASS_Z = "Z moved mass"


PARAMETERS = tuple(Parameter)
UNITS = {
    Parameter.BASE: "W",
    Parameter.COOLANT: "W",
    Parameter.IDLE: "W",
    Parameter.IDLE_PER_SPEED: "W/(rev/s)",
    Parameter.IDLE_PER_SPEED_SQUARED: "W/(rev/s)²",
    Parameter.INERTIA: "kg·m²",
    Parameter.CUTTING: "",
    **dict.fromkeys((Parameter.FRICTION_X, Parameter.FRICTION_Y, Parameter.FRICTION_Z), "N"),
    **dict.fromkeys((Parameter.VISCOUS_X, Parameter.VISCOUS_Y, Parameter.VISCOUS_Z), "N·s/mm"),
    **dict.fromkeys((Parameter.MASS_X, Parameter.MASS_Y, Parameter.MASS_Z), "kg"),
}
AXIS_COMPONENTS = (Component.X, Component.Y, Component.Z)
AXIS_PARAMETERS = (
    (Parameter.FRICTION_X, Parameter.VISCOUS_X, Parameter.MASS_X),
    (Parameter.FRICTION_Y, Parameter.VISCOUS_Y, Parameter.MASS_Y),
    (Parameter.FRICTION_Z, Parameter.VISCOUS_Z, Parameter.MASS_Z),
)
PARTS: tuple[Component, ...] = tuple(part for part in Component if part is not Component.TOTAL)
"""Components whose sum is the total power."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RunFeatures:
    """Quantities of N samples of one run on which the power depends, with measured powers."""

    name: str
    duration: Floats
    """Time represented by each sample, (N,), s."""
    spindle_speed: Floats
    """Spindle speed, (N,), rev/s."""
    spindle_acceleration: Floats
    """Spindle acceleration, (N,), rev/s²."""
    velocity: Floats
    """Velocity of the axes, (N, 3), mm/s."""
    acceleration: Floats
    """Acceleration of the axes, (N, 3), mm/s²."""
    cutting_power: Floats
    """Cutting power at the edge for a factor of 1 on the specific cutting force, (N,), W."""
    coolant: Floats
    """Share of the full coolant power, (N,), 0 to 1."""
    measured: Mapping[Component, Floats]
    """Measured power of each component, each (N,), W; empty if the run is only predicted."""

    def __len__(self) -> int:
        return len(self.duration)


Design = Mapping[Component, Floats]
"""Power per unit of each parameter, (N, P), for each component except the total, W."""


def design(run: RunFeatures, *, efficiency: float) -> Design:
    """Contribution of each parameter to the power of each component, sample by sample.

    Parameters
    ----------
    run : RunFeatures
    efficiency : float
        Efficiency of the spindle.
    """
    count = len(run)
    table = {part: np.zeros((count, len(PARAMETERS))) for part in PARTS}

    def put(part: Component, parameter: Parameter, values: Floats | float) -> None:
        table[part][:, PARAMETERS.index(parameter)] = values

    speed = np.abs(run.spindle_speed)
    change = (2.0 * pi) ** 2 * run.spindle_speed * run.spindle_acceleration
    put(Component.BASE, Parameter.BASE, 1.0)
    put(Component.COOLANT, Parameter.COOLANT, run.coolant)
    put(Component.SPINDLE, Parameter.IDLE, (speed > 0.0).astype(np.float64))
    put(Component.SPINDLE, Parameter.IDLE_PER_SPEED, speed)
    put(Component.SPINDLE, Parameter.IDLE_PER_SPEED_SQUARED, speed**2)
    put(Component.SPINDLE, Parameter.INERTIA, change / efficiency)
    put(Component.SPINDLE, Parameter.CUTTING, run.cutting_power / efficiency)
    for axis, (part, parameters) in enumerate(
        zip(AXIS_COMPONENTS, AXIS_PARAMETERS, strict=True)
    ):
        pace = np.abs(run.velocity[:, axis])
        push = run.velocity[:, axis] * run.acceleration[:, axis]
        put(part, parameters[0], pace / NMM_S_PER_WATT)
        put(part, parameters[1], pace**2 / NMM_S_PER_WATT)
        put(part, parameters[2], push / _MM2_PER_M2)
    return table


def powers(table: Design, values: Floats) -> dict[Component, Floats]:
    """Power of every component and their total for (P,) parameter values, each (N,), W."""
    watts = {part: np.maximum(0.0, table[part] @ values) for part in PARTS}
    return {**watts, Component.TOTAL: np.sum(list(watts.values()), axis=0)}


def slopes(table: Design, values: Floats) -> dict[Component, Floats]:
    """Derivative of every component's power and of their total by each parameter, (N, P)."""
    parts = {part: table[part] * (table[part] @ values > 0.0)[:, None] for part in PARTS}
    return {**parts, Component.TOTAL: np.sum(list(parts.values()), axis=0)}


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterPrior:
    """Prior value of a parameter and its uncertainty."""

    value: float
    scale: float
    """Typical uncertainty of the value."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """Estimate of a parameter after a fit, with its 95 % interval."""

    parameter: Parameter
    value: float
    low: float
    high: float
    """Upper end of the 95 % interval; if not identified, of what the data permit."""
    reason: str = ""
    """Reason why the parameter was not identified and keeps its prior; empty if it was."""

    @property
    def is_identified(self) -> bool:
        """True if the data give more information than the prior."""
        return not self.reason

    @property
    def unit(self) -> str:
        """Unit of value and interval."""
        return UNITS[self.parameter]


@dataclass(frozen=True, slots=True, kw_only=True)
class Calibration:
    """Fitted parameters of a machine with the residual noise."""

    estimates: tuple[Estimate, ...]
    """Estimates, one per parameter."""
    noise: Mapping[Component, float]
    """Standard deviation of the residuals by component, W."""
    blocks: int
    """Number of blocks of consecutive samples; each counts as one observation."""

    @property
    def values(self) -> Floats:
        """Values in the order of the parameters, (P,)."""
        return np.array([estimate.value for estimate in self.estimates])
