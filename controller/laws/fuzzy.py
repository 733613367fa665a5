"""Fuzzy control of the cutting force: rules of a machinist instead of a gain.

Sugeno's method [2]_ of order zero: the error ``e = ln(F_ref/F)`` and its change ``Δe`` in one
revolution belong to five and three triangular sets, which add up to 1 everywhere; each of the
fifteen rules proposes a step of ln u, and the step is the mean of the proposals, each weighted
with the product of its memberships. Steps add up (incremental output), from the override that
the guard applied, so nothing winds up. Such rules have controlled torque [1]_ and force [3]_ on
machining centres; the sets and rules here are our own.

The sets are scaled to a force off by the factor 2; the rules are scaled to the step which would
bring such a force back with time constant T_c, ``κ·ln 2/p`` (see
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

UNIT = log(2.0)
"""Logarithm of the force ratio that counts as a large error."""
ERRORS = (-1.0, -0.2, 0.0, 0.2, 1.0)
"""Peaks of the error sets: force much too high, too high, right, too low, much too low."""
CHANGES = (-1.0, 0.0, 1.0)
"""Peaks of the sets of the error change: force rises, stays, falls."""
RULES = (
    (-1.00, -0.45, 0.25),
    (-0.77, -0.07, 0.63),
    (-0.70, 0.00, 0.70),
    (-0.63, 0.07, 0.77),
    (-0.30, 0.40, 1.00),
)
"""Step for each set of the error (rows) and of its change (columns)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FuzzyState:
    """State of the fuzzy control law."""

    axes: Axes
    error: float
    """Error of the previous revolution, ln."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Fuzzy:
    """Fuzzy control law with fifteen rules."""

    plant: Plant = field(default_factory=Plant)
    closing: float = 2.0
    """Time constant T_c for small errors, revolutions."""

    def begin(self, override: float) -> FuzzyState:
        """Initial state, as if the force were at its set point."""
        return FuzzyState(axes=resting(override), error=0.0)

    def decide(self, state: FuzzyState, at: Situation) -> tuple[FuzzyState, float]:
        """Decide the next override; see :class:`~controller.laws.law.ControlLaw`."""
        axes = moved(state.axes, standing(at), lag=self.plant.lag)
        error = shortfall(axes, at, exponent=self.plant.exponent)
        step = inferred(error / UNIT, (error - state.error) / UNIT)
        step *= UNIT * quickening(self.plant, self.closing) / self.plant.exponent
        return FuzzyState(axes=axes, error=error), within(standing(at) * exp(step), at)


def inferred(error: float, change: float) -> float:
    """Output of the fuzzy rules for an error and its change, in the units of the sets."""
    return sum(
        belongs * changes * rule
        for belongs, row in zip(memberships(error, ERRORS), RULES, strict=True)
        if belongs > 0.0
        for changes, rule in zip(memberships(change, CHANGES), row, strict=True)
    )


def memberships(value: float, peaks: tuple[float, ...]) -> list[float]:
    """Membership of a value in each of the triangular sets with these peaks; they sum to 1."""
    held = min(max(value, peaks[0]), peaks[-1])
    below = min(bisect_right(peaks, held), len(peaks) - 1) - 1
    share = (held - peaks[below]) / (peaks[below + 1] - peaks[below])
    found = [0.0] * len(peaks)
    found[below], found[below + 1] = 1.0 - share, share
    return found
