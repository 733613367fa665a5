"""Proportional-integral control of the cutting force in logarithms: the default law.

In logarithms the plant has one gain, the exponent p, whatever is cut, so no gain scheduling is
needed. The override at which the force would meet its set point is ``ln u* = ln v + e/p``,
where v is what the axes run and ``e = ln(F_ref/F)``: proportional to the error, and the axes
themselves are the integrator (integral action by feedback from the actuator [1]_). The command
has lead, ``u = v + κ·(u* − v)``, so that v approaches u* with time constant T_c instead of
their lag T, :func:`~controller.laws.axes.quickening`. For small errors that is the velocity
form ``Δ ln u = K_p·(e_k − e_{k−1}) + K_i·e_k`` with ``K_p + K_i = κ/p`` and its zero,
``K_p/(K_p + K_i) = exp(−1/T)``, on the pole of the drives; there is no integral to wind up.

References
----------
.. [1] K. J. Åström, T. Hägglund, "Advanced PID Control", ISA, 2006, chapter 3.
.. [2] Y. Altintas, "Manufacturing Automation", Cambridge, 2012: control of the peak force once
   a revolution.
"""

from dataclasses import dataclass, field
from math import exp

from controller.laws.axes import (
    Axes,
    moved,
    quickening,
    resting,
    sent,
    shortfall,
    standing,
    within,
)
from controller.laws.law import Plant, Situation


@dataclass(frozen=True, slots=True, kw_only=True)
class LogPI:
    """PI control law in logarithms; its state is the model of the axes."""

    plant: Plant = field(default_factory=Plant)
    closing: float = 1.5
    """Time constant T_c of the closed loop, revolutions."""

    def begin(self, override: float) -> Axes:
        """Initial state: axes settled at the override."""
        return resting(override)

    def decide(self, state: Axes, at: Situation) -> tuple[Axes, float]:
        """Decide the next override; see :class:`~controller.laws.law.ControlLaw`."""
        axes = moved(state, standing(at), lag=self.plant.lag)
        error = shortfall(axes, at, exponent=self.plant.exponent)
        goal = axes.mean * exp(error / self.plant.exponent)
        lead = quickening(self.plant, self.closing)
        return axes, within(sent(axes, goal, quickening=lead), at)
