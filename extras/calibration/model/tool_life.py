"""Taylor constants fitted to measured pairs of cutting speed and tool life.

A straight line through the logarithms, ``ln T = (ln C − ln v_c)/n``, by least squares over
ln T, because the speed is set and the life scatters. Two pairs give the line, three or more
also its uncertainty. Units mm/s and s.

References
----------
.. [1] F. W. Taylor, "On the art of cutting metals", Trans. ASME, 1907: ``v_c · T^n = C``.
.. [2] ISO 3685, "Tool-life testing with single-point turning tools": its evaluation by linear
   regression of the logarithms.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, inf, sqrt

import numpy as np
from scipy.stats import t as student

from simulator.spec import Taylor
from stepnc_model.errors import StepNcError
from stepnc_model.units import SECONDS_PER_MINUTE, m_min_from_speed

CONFIDENCE = 0.95
"""Confidence level of the interval of the exponent."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LifePair:
    """Cutting speed and life of one edge that was used until it was worn out."""

    cutting_speed: float
    """Cutting speed, mm/s."""
    life: float
    """Tool life, s."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedTaylor:
    """Taylor's law fitted to measured pairs."""

    taylor: Taylor
    low: float
    """Lower end of the 95 % interval of n; 0 if there are only two pairs."""
    high: float
    """Upper end of the interval; ``inf`` if the pairs do not show a falling life."""
    scatter: float
    """Standard deviation of ln T about the line; 0 with two pairs."""
    slowest: float
    """Slowest measured cutting speed, mm/s; the law is valid from there to ``fastest``."""
    fastest: float
    pairs: int

    @property
    def has_interval(self) -> bool:
        """True if there are more pairs than constants, so that an interval exists."""
        return self.pairs > 2


def fitted_taylor(pairs: Sequence[LifePair]) -> FittedTaylor:
    """Fit exponent and constant by least squares in logarithms, [2]_.

    Parameters
    ----------
    pairs : sequence of LifePair
        Two or more pairs, with at least two different speeds.

    Raises
    ------
    StepNcError
        If there are too few pairs, a value is not positive, all speeds are equal, or the
        tool life does not fall with the speed.

    Examples
    --------
    Groover: 5 min at 160 m/min, 41 min at 100 m/min.

    >>> found = fitted_taylor([
    ...     LifePair(cutting_speed=160_000 / 60, life=300.0),
    ...     LifePair(cutting_speed=100_000 / 60, life=2460.0),
    ... ])
    >>> round(found.taylor.exponent, 3), round(found.taylor.constant * 0.06)
    (0.223, 229)
    """
    _require_usable(pairs)
    speed = np.log([pair.cutting_speed for pair in pairs])
    life = np.log([pair.life / SECONDS_PER_MINUTE for pair in pairs])
    away = speed - speed.mean()
    spread = float(away @ away)
    slope = float(away @ life) / spread
    if slope >= 0.0:
        raise StepNcError("tool life: it does not fall with the cutting speed in these pairs")
    exponent = -1.0 / slope
    if exponent >= 1.0:
        raise StepNcError(f"tool life: exponent {exponent:.3g} must be less than 1")
    residual = life - life.mean() - slope * away
    free = len(pairs) - 2
    scatter = sqrt(float(residual @ residual) / free) if free > 0 else 0.0
    margin = 0.0
    if free > 0:
        margin = float(student.ppf(0.5 + 0.5 * CONFIDENCE, free)) * scatter / sqrt(spread)
    constant = exp(float(speed.mean()) - float(life.mean()) / slope)
    return FittedTaylor(
        taylor=Taylor(exponent=exponent, constant=constant),
        low=0.0 if free <= 0 else -1.0 / (slope - margin),
        high=inf if free <= 0 or slope + margin >= 0.0 else -1.0 / (slope + margin),
        scatter=scatter,
        slowest=min(pair.cutting_speed for pair in pairs),
        fastest=max(pair.cutting_speed for pair in pairs),
        pairs=len(pairs),
    )


def _require_usable(pairs: Sequence[LifePair]) -> None:
    """Raise an error if no line can be fitted to the pairs."""
    if len(pairs) < 2:
        raise StepNcError(
            f"tool life: {len(pairs)} pair of cutting speed and life; at least 2 are required"
        )
    for number, pair in enumerate(pairs, 1):
        speed, life = m_min_from_speed(pair.cutting_speed), pair.life / SECONDS_PER_MINUTE
        if not (0.0 < speed < inf and 0.0 < life < inf):
            raise StepNcError(
                f"tool life, pair {number}: {speed:g} m/min and {life:g} min must both be"
                " positive and finite"
            )
    if len({pair.cutting_speed for pair in pairs}) < 2:
        speed = m_min_from_speed(pairs[0].cutting_speed)
        raise StepNcError(
            f"tool life: all pairs are at {speed:g} m/min; two different speeds are needed"
        )
