"""Detection of a broken tooth from the share of each tooth in the force of a revolution.

A broken tooth takes no chip, and the next one takes its chip as well, [1]_. Runout moves chip
from one tooth to another too, but as constant offsets of their radii do: these are learnt from
the first revolution on (:mod:`controller.monitoring.offsets`), and hold for every feed and
engagement. A tooth counts as broken when two revolutions in a row are far likelier without it
than with all teeth, whether their offsets are the learnt ones or new ones. Thresholds on forces
depend on the immersion, [2]_; these likelihoods do not. Units: mm, N, rev/s.

The detector needs at least two teeth, and a cut whose arc of contact the program knows. A tooth
that runout keeps out of the work can break unnoticed.

References
----------
.. [1] Y. Altintas, I. Yellowley, J. Tlusty, "The detection of tool breakage in milling
   operations", J. Eng. Industry 110 (1988), 271-277: mean force of each tooth period, compared
   between teeth; changes of the cut must be told from breakage.
.. [2] Y. Altintas, I. Yellowley, "In-process detection of tool failure in milling using cutting
   force models", J. Eng. Industry 111 (1989), 149-157: thresholds depend on the immersion.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import log

import numpy as np

from controller.monitoring.offsets import (
    OUTLIER,
    Judged,
    Offsets,
    judged,
    misfits,
    unknown,
)
from controller.signals.ports import Floats
from controller.signals.preview import Expected
from controller.signals.signal import Revolution
from controller.signals.tooth_shares import ToothShares, force_ratio, shares_of

EVIDENCE = 10.0
"""Gain of ln(likelihood) that two revolutions together need to indicate a lost tooth."""

LEAST_GAIN = 2.0
"""Gain of ln(likelihood) that each of the two revolutions needs; one alone is not enough."""

TRUST = 2.0
"""Extra ln(likelihood) against a shift of all teeth, per revolution confirming the offsets.

A cutter about which nothing was learnt may have as much runout as it seems to have.
"""

SETTLED = 10
"""Greatest number of confirming revolutions that count."""

FIT = 6.0
"""Misfit per tooth up to which a revolution counts as explained."""

UNFIT = 18.0
"""Misfit per tooth above which a revolution fits no known hypothesis."""

ENOUGH = 20
"""Number of revolutions after which fitting revolutions no longer change the offsets."""

EXPECTED = 0.5
"""Misfit per tooth that gives no reason to change the offsets."""

DOUBTFUL = 30.0
"""Misfit per tooth, computed without one tooth, up to which that tooth may be lost."""

NOTABLE = 2.0
"""Misfit per tooth above which a revolution is examined further."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Turn:
    """Tooth shares of one revolution, with the offsets known before it."""

    shares: ToothShares
    before: Offsets
    misfit: float
    """Misfit with all teeth intact."""
    without: Floats
    """Misfits without each of the teeth, with the offsets as they were, (z,)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Breakage:
    """State of the breakage detector of one tool; create a new one for a new tool."""

    offsets: Offsets | None = None
    """Estimated offsets of the teeth; None before anything was learnt."""
    turns: tuple[_Turn, ...] = ()
    """Up to three last revolutions without a pause.

    The oldest may be the one in which a tooth broke, and supports neither hypothesis.
    """
    ratio: float = 0.0
    """Measured over expected force of the last revolution; 0 if there was none."""
    broken: int | None = None
    """Number of the broken tooth, 0 to z − 1, kept once detected; None: all intact."""
    reason: str = ""
    """Evidence for the broken tooth, in words."""

    @property
    def is_broken(self) -> bool:
        """True if a broken tooth was detected."""
        return self.broken is not None

    def paused(self) -> "Breakage":
        """Detector state outside the cut: the offsets stay, recent revolutions are dropped."""
        return replace(self, turns=(), ratio=0.0)


def inspected(
    breakage: Breakage,
    revolution: Revolution,
    expected: Expected | None,
    *,
    exponent: float = 0.8,
) -> Breakage:
    """Update the detector with one more revolution.

    A revolution in which a tooth, the feed or the arc of contact is missing is not judged.

    Parameters
    ----------
    revolution : Revolution
        A revolution in the cut; noise alone has no pattern to learn.
    expected : Expected, optional
        Forces that equal teeth would take; None: not known.
    exponent : float
        p = 1 − m_c of force over chip, 0 < p ≤ 1.

    Raises
    ------
    ValueError
        If the exponent is out of range.
    """
    if not 0.0 < exponent <= 1.0:
        raise ValueError(f"exponent {exponent:g} must be above 0 and at most 1")
    if breakage.is_broken or revolution.teeth < 2:
        return breakage
    ratio = force_ratio(revolution, expected)
    if expected is None or ratio is None:
        return breakage.paused()
    if breakage.offsets is not None and len(breakage.offsets.mean) != revolution.teeth:
        breakage = Breakage()
    change = log(ratio / breakage.ratio) if breakage.ratio else None
    shares = shares_of(revolution, expected, exponent=exponent, change=change)
    return _verdict(_seen(breakage, shares, ratio))


def _seen(breakage: Breakage, shares: ToothShares, ratio: float) -> Breakage:
    """Add one more revolution, assuming that all teeth are intact."""
    before = breakage.offsets or unknown(len(shares.taken))
    every = misfits(before, shares)
    offsets, misfit = before, float(every[0])
    if before.confirmed < ENOUGH or misfit > EXPECTED * len(shares.taken):
        whole = judged(before, shares)
        offsets, misfit = whole.offsets, whole.misfit
    turn = _Turn(shares=shares, before=before, misfit=misfit, without=every[1:])
    return Breakage(offsets=offsets, turns=(*breakage.turns[-2:], turn), ratio=ratio)


def _verdict(breakage: Breakage) -> Breakage:
    """Decide whether a tooth is lost, or the offsets have changed."""
    turns, teeth = breakage.turns, len(breakage.turns[-1].shares.taken)
    if len(turns) < 2 or sum(turn.misfit for turn in turns[-2:]) < NOTABLE * teeth:
        return breakage
    known, last = turns[0].before, [turn.shares for turn in turns[-2:]]
    for tooth in _suspects(turns[-2:], known):
        if _is_lost(tooth, known, last):
            return replace(breakage, broken=tooth, reason=_reason(turns[-1], known))
    if len(turns) == 3 and all(turn.misfit > OUTLIER * teeth for turn in turns):
        anew = _judged_all(unknown(teeth), last)
        if all(each.misfit <= OUTLIER * teeth for each in anew):
            return replace(breakage, offsets=anew[-1].offsets)
    return breakage


def _suspects(turns: Sequence[_Turn], known: Offsets) -> list[int]:
    """Teeth whose loss is supported by each of two revolutions on its own."""
    suspects = list(range(len(known.mean)))
    for turn in reversed(turns):
        if known.confirmed >= SETTLED:
            bound = max(DOUBTFUL * len(known.mean), turn.misfit)
            suspects = [tooth for tooth in suspects if turn.without[tooth] < bound]
        if not suspects:
            break
        least = judged(known, turn.shares).log_likelihood + LEAST_GAIN
        alone = {each: judged(known, turn.shares, lost=each) for each in suspects}
        suspects = [each for each in suspects if alone[each].log_likelihood >= least]
    return suspects


def _is_lost(tooth: int, known: Offsets, last: Sequence[ToothShares]) -> bool:
    """True if two revolutions together indicate that a tooth is lost."""
    without = _judged_all(known, last, lost=tooth)
    whole, other = _judged_all(known, last), _judged_all(unknown(len(known.mean)), last)
    most = max(each.misfit for each in without) / len(known.mean)
    if most > UNFIT:
        return False
    # A poorly explained revolution, as in a corner, must beat every other explanation.
    trust = TRUST * min(known.confirmed, SETTLED) if most <= FIT else 0.0
    return _sum(without) - max(_sum(whole), _sum(other) - trust) >= EVIDENCE


def _reason(turn: _Turn, known: Offsets) -> str:
    """Text on the tooth period of the last revolution that differs most from intact teeth."""
    whole = turn.shares.of(known.mean[None])[0]
    at = int(np.abs(turn.shares.taken - whole).argmax())
    return (
        f"{turn.shares.taken[at]:.2f} of the mean force in the period of tooth {at + 1}, "
        f"{whole[at]:.2f} with intact teeth"
    )


def _judged_all(
    offsets: Offsets, shares: Sequence[ToothShares], *, lost: int | None = None
) -> list[Judged]:
    """Judge revolutions in order, each with the offsets learnt from those before it."""
    found = []
    for each in shares:
        found.append(judged(offsets, each, lost=lost))
        offsets = found[-1].offsets
    return found


def _sum(of: Sequence[Judged]) -> float:
    return sum(each.log_likelihood for each in of)
