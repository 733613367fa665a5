"""Supervision of the axes: whether the override that was commanded is run.

A locked override, an operator's knob or a control that reads another address leaves the loop
without effect. The axes follow with a lag, so that they are compared with a model of the lag,
and with the command itself. Units: s.
"""

from math import exp
from typing import NamedTuple

from simulator.reading import Reading

TOLERANCE = 0.05
"""Greatest difference of actual and commanded override, as a share."""

LEAST = 0.02
"""Difference that always counts as none: axes that stand."""

PATIENCE = 1.0
"""Time for which the axes may be elsewhere, s."""


class Following(NamedTuple):
    """Response of the axes to the commanded override."""

    modelled: float = 1.0
    """Override that axes of the assumed lag would run now."""
    astray: float = 0.0
    """Time without a break in which the axes ran another override, s."""

    @property
    def is_astray(self) -> bool:
        """True if the override is not followed."""
        return self.astray >= PATIENCE


def followed(before: Following, reading: Reading, commanded: float, *, lag: float) -> Following:
    """Update with one more reading.

    Parameters
    ----------
    commanded : float
        Override commanded before the reading.
    lag : float, s
        Lag of the axes that the loop assumes.
    """
    if not reading.can_override:
        return Following(modelled=commanded)
    away, periods = before.modelled - commanded, reading.period / lag
    mean = commanded + away * (1.0 - exp(-periods)) / periods if periods > 0.0 else commanded
    low, high = min(mean, commanded), max(mean, commanded)
    allowed = max(TOLERANCE * high, LEAST)
    is_off = not low - allowed <= reading.override <= high + allowed
    return Following(
        modelled=commanded + away * exp(-periods),
        astray=before.astray + reading.period if is_off else 0.0,
    )
