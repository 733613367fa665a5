"""A broken tooth, seen in what each tooth of a revolution takes.

A broken tooth takes little, and what it leaves the next ones take with their own. Force is a
power law of the chip, ``F ∝ h^p``, so ``F^(1/p)`` of a tooth over its mean over all teeth is
the share of the feed that the tooth cuts. Runout shifts shares by an offset in mm over the feed
per tooth, whatever the feed: the offsets are learnt as a running median, and what is judged is
the share against the one that they predict at the feed of now. Units mm, N, rev/s.

It takes two teeth at least. With up to about four teeth in the cut at once it holds; with more,
one tooth is too small a part of the force, and which one it is gets uncertain from three on. A
tooth that runout keeps out of the work, or almost so, can break unseen.

References
----------
.. [1] Y. Altintas, I. Yellowley, J. Tlusty, "The detection of tool breakage in milling
   operations", J. Eng. Industry 110 (1988), 271-277: mean force of each tooth period, compared
   between teeth; changes of the cut must be told from breakage.
.. [2] Y. Altintas, I. Yellowley, "In-process detection of tool failure in milling using cutting
   force models", J. Eng. Industry 111 (1989), 149-157: thresholds depend on the immersion.
"""

from dataclasses import dataclass, field, replace
from math import log

import numpy as np

from controller.ports import Floats
from controller.signal import Revolution

WINDOW = 9
"""revolutions of the running median: a break is confirmed before the median follows it, and a
change of engagement, which takes longer, it follows"""

LEARNING = 5
"""revolutions without which nothing is judged"""

DROP = 0.2
"""of the feed per tooth that a tooth must miss"""

SCATTERS = 6.0
"""standard deviations of the shares that it must miss as well"""

STEADY = 0.25
"""greatest change of ln F from one revolution to the next in which shares are judged: a force
that grows within a revolution looks like teeth that are not alike"""

_DEVIATION = 1.4826  # of a normal distribution over its median absolute deviation


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Breakage:
    """What was learnt of the teeth, and whether one is broken. A new one for a new tool."""

    shares: Floats = field(default_factory=lambda: np.empty((0, 0)))
    """(M, z) of each tooth in the last revolutions, M up to ``WINDOW``"""
    feeds: Floats = field(default_factory=lambda: np.empty(0))
    """(M,) mm, feed per tooth to the shares"""
    workingstep: int = 0
    """that they belong to; another one engages otherwise and is learnt anew"""
    force: float = 0.0
    """N, mean of the revolution before"""
    suspect: int | None = None
    """tooth that looked broken in the last revolution that was judged"""
    broken: int | None = None
    """tooth that is broken, 0 to z − 1; stays"""

    @property
    def is_broken(self) -> bool:
        """Whether a tooth is broken."""
        return self.broken is not None


def inspected(breakage: Breakage, revolution: Revolution, *, exponent: float = 0.8) -> Breakage:
    """What is known of the teeth after one more revolution.

    A tooth is broken when in two judged revolutions running it is the first of those that miss
    ``DROP`` of its feed, one of the next half of the teeth taking half of that too much. Not
    judged is a revolution in which a tooth or the feed is missing; one whose mean force is not
    that of the one before (``STEADY``) clears the suspicion.

    Parameters
    ----------
    breakage : Breakage
    revolution : Revolution
        With chips: what noise alone shows has no pattern to learn.
    exponent : float
        p = 1 − m_c of force over chip, 0 < p ≤ 1.

    Raises
    ------
    ValueError
        If the exponent is out of range.
    """
    if not 0.0 < exponent <= 1.0:
        raise ValueError(f"exponent {exponent:g} must be above 0 and at most 1")
    breakage = _begun(breakage, revolution)
    was, force = breakage.force, revolution.force
    if not force > 0.0:
        return breakage
    breakage = replace(breakage, force=force)
    if breakage.is_broken or revolution.teeth < 2 or not revolution.feed > 0.0:
        return breakage
    if not was > 0.0 or abs(log(force / was)) > STEADY:
        return replace(breakage, suspect=None)
    per_tooth = revolution.feed / (revolution.teeth * revolution.spindle_speed)
    shares = _shares(revolution.tooth_means, exponent)
    if shares is None:
        return breakage
    suspect = _suspect(breakage, shares, per_tooth)
    is_confirmed = suspect is not None and suspect == breakage.suspect
    return replace(
        breakage,
        shares=np.vstack((breakage.shares[1 - WINDOW :], shares)),
        feeds=np.append(breakage.feeds[1 - WINDOW :], per_tooth),
        suspect=suspect,
        broken=suspect if is_confirmed else None,
    )


def _begun(breakage: Breakage, revolution: Revolution) -> Breakage:
    """The state itself, or one that has learnt nothing when what it has is of another cut."""
    is_same = (
        breakage.shares.shape[1] == revolution.teeth
        and breakage.workingstep == revolution.workingstep
    )
    if is_same:
        return breakage
    return Breakage(
        shares=np.empty((0, revolution.teeth)),
        workingstep=revolution.workingstep,
        broken=breakage.broken,
    )


def _shares(forces: Floats, exponent: float) -> Floats | None:
    """(z,) share of each tooth in the feed, mean 1; None when one is lost or none cuts."""
    chips = np.maximum(forces, 0.0) ** (1.0 / exponent)
    total = float(np.add.reduce(chips))
    if not total > 0.0:
        return None
    return np.asarray(chips * (len(chips) / total))


def _suspect(breakage: Breakage, shares: Floats, per_tooth: float) -> int | None:
    """The tooth that looks broken by its (z,) shares, if there is one."""
    if len(breakage.feeds) < LEARNING:
        return None
    usual = _median(breakage.shares)
    scatter = _DEVIATION * float(_median(np.abs(breakage.shares - usual)).max())
    offsets = (breakage.shares - 1.0) * breakage.feeds[:, None]
    expected = 1.0 + _median(offsets) / per_tooth
    # A tooth that cuts nothing hides how low it lies: a share between the two tells nothing.
    missing = (np.minimum(usual, expected) - shares).tolist()
    excess = (shares - np.maximum(usual, expected)).tolist()
    return _first_missing(missing, excess, least=max(DROP, SCATTERS * scatter))


def _first_missing(missing: list[float], excess: list[float], *, least: float) -> int | None:
    """First of the teeth that miss most, when one after it takes too much instead.

    Where several teeth cut at once, the periods of those after the broken one miss it as well.
    """
    teeth, most = len(missing), max(missing)
    if most < least:
        return None
    low = [tooth for tooth in range(teeth) if missing[tooth] >= 0.5 * most]
    first = [tooth for tooth in low if (tooth - 1) % teeth not in low]
    if len(first) != 1:
        return None
    after = range(first[0] + 1, first[0] + 1 + (teeth + 1) // 2)
    is_taken = max(excess[tooth % teeth] for tooth in after) >= 0.5 * least
    return first[0] if is_taken else None


def _median(values: Floats) -> Floats:
    """(z,) medians of the columns of (M, z), the lower one of two; quicker than numpy's."""
    return np.asarray(np.sort(values, axis=0)[(len(values) - 1) // 2])
