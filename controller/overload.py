"""The force of each tooth period over what that tooth usually takes of a revolution.

With runout some teeth take more than others in every revolution; an overload is more than a
tooth usually takes. Its usual share is learnt slowly, so that a tooth that breaks is not.
Units N.
"""

from dataclasses import dataclass
from math import isnan

LEARNING = 0.05
"""of a share's way to what a revolution shows"""

LEAST, MOST = 0.4, 2.5
"""of a share: beyond it is no runout"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Shares:
    """What each tooth takes over the mean of a revolution."""

    usual: tuple[float, ...]
    seen: tuple[float, ...]
    """N, last mean of each tooth"""


def fresh(teeth: int) -> Shares:
    """A cutter of which nothing is known: all teeth alike."""
    return Shares(usual=(1.0,) * teeth, seen=(0.0,) * teeth)


def seen(shares: Shares, tooth: int, force: float) -> Shares:
    """One tooth period more; the last tooth of a revolution teaches the shares.

    Parameters
    ----------
    shares : Shares
    tooth : int
    force : float, N
        Mean of the period; NaN: lost, the tooth's last one stays.
    """
    if isnan(force):
        return shares
    last = (*shares.seen[:tooth], force, *shares.seen[tooth + 1 :])
    usual = shares.usual
    mean = sum(last) / len(last)
    if tooth == len(last) - 1 and mean > 0.0:
        usual = tuple(
            min(max(old + LEARNING * (new / mean - old), LEAST), MOST)
            for old, new in zip(usual, last, strict=True)
        )
    return Shares(usual=usual, seen=last)


def level(shares: Shares, tooth: int, force: float) -> float:
    """Force of a tooth period as if all teeth were alike, N."""
    return force / shares.usual[tooth]
