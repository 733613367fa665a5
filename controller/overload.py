"""The force of each tooth period over what that tooth usually takes of a revolution.

With runout some teeth take more than others in every revolution; an overload is more than a
tooth usually takes. Its usual share is learnt slowly, so that a tooth that breaks is not.
Units N.
"""

from dataclasses import dataclass
from math import isnan, log, nan

import numpy as np

from controller.ports import Floats
from controller.signal import COVERED

LEARNING = 0.05
"""of a share's way to what a revolution shows"""

STEADY = 0.1
"""greatest change of ln(mean force) from the revolution before: where the cutter enters, leaves
or meets another depth, teeth differ for another reason than runout"""

SETTLED = 2
"""steady revolutions in a row from which shares are learnt: a cut of a single revolution may
show the same mean twice, half of it each time"""

LEAST, MOST = 0.4, 2.5
"""of a share: beyond it is no runout"""


@dataclass(frozen=True, slots=True, kw_only=True)
class UsualShares:
    """Share of each tooth in the mean force of a revolution."""

    usual: tuple[float, ...]
    seen: tuple[float, ...]
    """N, last mean of each tooth"""
    mean: float = 0.0
    """N, of the last whole revolution; 0: not known"""
    steady: int = 0
    """revolutions in a row that were as the one before"""


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
    # On a line between their neighbours: a tooth's force rises and falls within its period.
    at = np.arange(len(force))
    return float(np.interp(at, at[~lost], force[~lost]).mean())


def fresh(teeth: int) -> UsualShares:
    """A cutter of which nothing is known: all teeth alike."""
    return UsualShares(usual=(1.0,) * teeth, seen=(0.0,) * teeth)


def noted(shares: UsualShares, tooth: int, force: float) -> UsualShares:
    """One tooth period more, of which nothing is to be learnt: air, and the way into the work.

    Parameters
    ----------
    shares : UsualShares
    tooth : int
    force : float, N
        Mean of the period; NaN: lost, the tooth's last one stays.
    """
    if isnan(force):
        return shares
    last = (*shares.seen[:tooth], force, *shares.seen[tooth + 1 :])
    return UsualShares(usual=shares.usual, seen=last, mean=shares.mean, steady=shares.steady)


def seen(shares: UsualShares, tooth: int, force: float) -> UsualShares:
    """One tooth period in the cut more; the last of a steady revolution teaches the shares.

    Parameters
    ----------
    shares : UsualShares
    tooth : int
    force : float, N
        Mean of the period; NaN: lost, the tooth's last one stays.
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
    """Force of a tooth period, less what runout gives the tooth, N.

    Teeth that take little count as they are: they would turn small forces into overloads.
    """
    return force / max(shares.usual[tooth], 1.0)
