"""Fuzzy control of the cutting force: rules of a machinist instead of a gain.

Sugeno's method [2]_ of order zero: the error ``e = ln(F_ref/F)`` and its change ``Δe`` in one
revolution belong to triangular sets, five and three of them, that add up to 1 everywhere; each
of the fifteen rules proposes a step of ln u, and the step is the mean of the proposals, each
with the product of its memberships for weight. Steps add up (incremental output), from the
override that the guard let through, so nothing winds up. Such rules have held torque [1]_ and
force [3]_ on machining centres; sets and rules here are our own.

A force off by the factor 2 is the sets' unit; the rules' unit is the step which would bring
such a force back with time constant T_c, ``κ·ln 2/p`` (see
:func:`~controller.laws.axes.quickening`). The table follows ``0.35·e + 0.7·Δe``, PI control
whose zero is near the pole of drives with a lag of three revolutions, and bends that plane:
far from the set point, steps that slow down are greater than those that speed up.

References
----------
.. [1] M. Liang, T. Yeap, A. Hermansyah, S. Rahmati, "Fuzzy control of spindle torque for
   industrial CNC machining", Int. J. Mach. Tools Manuf. 43 (2003), 1497-1508.
.. [2] T. Takagi, M. Sugeno, "Fuzzy identification of systems and its applications to modeling
   and control", IEEE Trans. SMC 15 (1985), 116-132.
.. [3] D. Kim, D. Jeon, "Fuzzy-logic control of cutting forces in CNC milling processes using
   motor currents as indirect force sensors", Precision Engineering 35 (2011), 143-152.
"""

from bisect import bisect_right
from dataclasses import dataclass, field
from math import exp, log

from controller.law import Plant, Situation
from controller.laws.axes import (
    Axes,
    moved,
    quickening,
    resting,
    shortfall,
    standing,
    within,
)

UNIT = log(2.0)
"""ln of the force ratio that is called big"""
ERRORS = (-1.0, -0.2, 0.0, 0.2, 1.0)
"""peaks of the sets of the error: far too much, too much, right, too little, far too little"""
CHANGES = (-1.0, 0.0, 1.0)
"""peaks of the sets of its change: force rises, stays, falls"""
RULES = (
    (-1.00, -0.45, 0.25),
    (-0.77, -0.07, 0.63),
    (-0.70, 0.00, 0.70),
    (-0.63, 0.07, 0.77),
    (-0.30, 0.40, 1.00),
)
"""step for each set of the error, down, and of its change, across"""


@dataclass(frozen=True, slots=True, kw_only=True)
class FuzzyState:
    """State of the fuzzy law."""

    axes: Axes
    error: float
    """of the revolution before, ln"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Fuzzy:
    """Fuzzy control with fifteen rules."""

    plant: Plant = field(default_factory=Plant)
    closing: float = 2.0
    """T_c, revolutions, of small errors"""

    def begin(self, override: float) -> FuzzyState:
        """As though the force had been at its set point."""
        return FuzzyState(axes=resting(override), error=0.0)

    def decide(self, state: FuzzyState, at: Situation) -> tuple[FuzzyState, float]:
        """See :class:`~controller.law.ControlLaw`."""
        axes = moved(state.axes, standing(at), lag=self.plant.lag)
        error = shortfall(axes, at, exponent=self.plant.exponent)
        step = inferred(error / UNIT, (error - state.error) / UNIT)
        step *= UNIT * quickening(self.plant, self.closing) / self.plant.exponent
        return FuzzyState(axes=axes, error=error), within(standing(at) * exp(step), at)


def inferred(error: float, change: float) -> float:
    """Output of the rules for an error and its change, in their units."""
    return sum(
        belongs * changes * rule
        for belongs, row in zip(memberships(error, ERRORS), RULES, strict=True)
        if belongs > 0.0
        for changes, rule in zip(memberships(change, CHANGES), row, strict=True)
    )


def memberships(value: float, peaks: tuple[float, ...]) -> list[float]:
    """Membership of a value in each of the triangular sets with these peaks; sum 1."""
    held = min(max(value, peaks[0]), peaks[-1])
    below = min(bisect_right(peaks, held), len(peaks) - 1) - 1
    share = (held - peaks[below]) / (peaks[below + 1] - peaks[below])
    found = [0.0] * len(peaks)
    found[below], found[below + 1] = 1.0 - share, share
    return found
