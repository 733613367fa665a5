"""Linear proportional-integral control of the cutting force, in velocity form.

With the error relative to the set point, ``e = 1 − F/F_ref``, and ``ΔF/F = p·Δu/u`` the plant's
gain is p over the override, so the step is taken relative to the override:
``u_{k+1} = u_k·(1 + K_p·(e_k − e_{k−1}) + K_i·e_k)``, [1]_. The zero of the law is placed on
the pole of the feed drives, ``K_p/(K_p + K_i) = exp(−1/T)``, and what is left of the loop is an
integrator that closes with time constant T_c when ``K_p + K_i = κ/p``, κ by
:func:`~controller.laws.axes.quickening`. The velocity form starts from the override that the
guard applied, and so cannot wind up.

The error is not symmetric: half the force is −0.5, double is +1. The law slows down faster
than it speeds up.

References
----------
.. [1] K. J. Åström, B. Wittenmark, "Computer-Controlled Systems", 3rd ed., 1997, chapter 8:
   discrete PID, velocity form.
"""

from dataclasses import dataclass, field
from math import exp

from controller.laws.axes import (
    Axes,
    moved,
    quickening,
    resting,
    shortfall,
    standing,
    within,
)
from controller.laws.law import Plant, Situation

GREATEST = 1.0
"""Greatest relative excess of force over set point that is used, so the feed never stops."""
SLOWEST = 0.3
"""Least share of the override that one step leaves."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PIState:
    """State of the linear PI law."""

    axes: Axes
    error: float
    """Error of the previous revolution, relative to the set point."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PI:
    """Linear PI control law."""

    plant: Plant = field(default_factory=Plant)
    closing: float = 2.0
    """Time constant T_c of the closed loop, revolutions."""

    def begin(self, override: float) -> PIState:
        """Initial state, as if the force were at its set point."""
        return PIState(axes=resting(override), error=0.0)

    def decide(self, state: PIState, at: Situation) -> tuple[PIState, float]:
        """Decide the next override; see :class:`~controller.laws.law.ControlLaw`."""
        plant = self.plant
        axes = moved(state.axes, standing(at), lag=plant.lag)
        error = max(1.0 - exp(-shortfall(axes, at, exponent=plant.exponent)), -GREATEST)
        both = quickening(plant, self.closing) / plant.exponent
        proportional = both * exp(-1.0 / plant.lag)
        step = proportional * (error - state.error) + (both - proportional) * error
        override = standing(at) * max(1.0 + step, SLOWEST)
        return PIState(axes=axes, error=error), within(override, at)
