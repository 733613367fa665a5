"""Overload detection per tooth, relative to the usual share of each tooth.

With runout some teeth take more than others in every revolution; an overload is more than a
tooth usually takes. The usual share is learnt slowly, so that the load of a breaking tooth is
not learnt. Units: N.
"""

from math import isnan, log, nan
from typing import NamedTuple

import numpy as np

from controller.signals.ports import Floats
from controller.signals.signal import COVERED

LEARNING = 0.05
"""Share of the deviation by which a usual share moves per revolution."""

STEADY = 0.1
"""Greatest change of ln(mean force) between revolutions from which shares are learnt.

Where the cutter enters, leaves or meets another depth, teeth differ for reasons other than
runout.
"""

SETTLED = 2
"""Consecutive steady revolutions from which shares are learnt.

A cut of a single revolution may show the same mean twice, half of it each time.
"""

LEAST, MOST = 0.4, 2.5
"""Range of the usual share; values beyond it are not due to runout."""


class UsualShares(NamedTuple):
    """Usual share of each tooth in the mean force of a revolution."""

    usual: tuple[float, ...]
    seen: tuple[float, ...]
    """Last mean force of each tooth, N."""
    mean: float = 0.0
    """Mean force of the last whole revolution, N; 0: not known."""
    steady: int = 0
    """Consecutive revolutions with nearly the same mean force."""


def mean(force: Floats) -> float:
    """Mean force of a reading, N; NaN when less than half of its samples arrived."""
    if not len(force):
        return nan
    total = float(np.add.reduce(force))
    if not isnan(total):
        return total / len(force)
    lost = np.isnan(force)
    if np.count_nonzero(lost) > (1.0 - COVERED) * len(force):
        return nan
    # Interpolated between neighbours: a tooth's force rises and falls within its period.
    at = np.arange(len(force))
    return float(np.interp(at, at[~lost], force[~lost]).mean())


def fresh(teeth: int) -> UsualShares:
    """Initial shares of a new cutter: all teeth alike."""
    return UsualShares(usual=(1.0,) * teeth, seen=(0.0,) * teeth)


def noted(shares: UsualShares, tooth: int, force: float) -> UsualShares:
    """Record a tooth period without learning shares: in air, or at the entry into the work.

    Parameters
    ----------
    tooth : int
    force : float, N
        Mean of the period; NaN: lost, the tooth's previous value stays.
    """
    if isnan(force):
        return shares
    last = (*shares.seen[:tooth], force, *shares.seen[tooth + 1 :])
    return UsualShares(shares.usual, last, shares.mean, shares.steady)


def seen(shares: UsualShares, tooth: int, force: float) -> UsualShares:
    """Record a tooth period in the cut; the end of a steady revolution updates the shares.

    Parameters
    ----------
    tooth : int
    force : float, N
        Mean of the period; NaN: lost, the tooth's previous value stays.
    """
    shares = noted(shares, tooth, force)
    last = shares.seen
    average = sum(last) / len(last)
    if tooth != len(last) - 1 or isnan(force):
        return shares
    before, usual = shares.mean, shares.usual
    is_steady = average > 0.0 and before > 0.0 and abs(log(average / before)) <= STEADY
    steady = shares.steady + 1 if is_steady else 0
    if steady >= SETTLED:
        usual = tuple(
            min(max(old + LEARNING * (new / average - old), LEAST), MOST)
            for old, new in zip(usual, last, strict=True)
        )
    return UsualShares(usual=usual, seen=last, mean=max(average, 0.0), steady=steady)


def level(shares: UsualShares, tooth: int, force: float) -> float:
    """Force of a tooth period with the effect of runout removed, N.

    Shares below 1 are not corrected, because this would turn small forces into overloads.
    """
    return force / max(shares.usual[tooth], 1.0)
