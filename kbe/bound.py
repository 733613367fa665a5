"""Use of the force bound: how the measured force compares with it."""

from dataclasses import dataclass, replace

from stepnc_model.outcome import ProcessOutcome

PASSED = 1.05
"""of the bound; what is above has violated it"""
UNUSED = 0.80
"""of the bound; what is below has wasted it, where the plan meant to use it"""


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundUse:
    """Outcomes of a group against their force bounds."""

    known: int = 0
    """outcomes with a bound and a measured force"""
    violated: int = 0
    wasted: int = 0
    overplanned: int = 0
    """in which the plan itself expected to pass the bound"""
    highest: float | None = None
    """greatest measured force over its bound"""
    time_to_win: float = 0.0
    """Time to win, s, of all wasted outcomes together"""


def used(sum_before: BoundUse, outcome: ProcessOutcome) -> BoundUse:
    """The same with one more outcome."""
    share = share_of(outcome)
    if share is None:
        return sum_before
    wasted = is_wasted(outcome)
    return replace(
        sum_before,
        known=sum_before.known + 1,
        violated=sum_before.violated + (share > PASSED),
        wasted=sum_before.wasted + wasted,
        overplanned=sum_before.overplanned + is_overplanned(outcome),
        highest=max(share, sum_before.highest or 0.0),
        time_to_win=sum_before.time_to_win + (time_to_win(outcome) if wasted else 0.0),
    )


def share_of(outcome: ProcessOutcome) -> float | None:
    """Measured force over its bound; None: one of them is not known."""
    measured, bound = outcome.force.measured, outcome.force_bound
    if measured is None or bound is None or not bound > 0.0 or not measured >= 0.0:
        return None
    return measured / bound


def is_wasted(outcome: ProcessOutcome) -> bool:
    """Whether force was left unused that the plan intended to use.

    A plan that itself stays far below its bound is held back by something else (power, chip
    load, roughness), which is no waste.
    """
    share = share_of(outcome)
    if share is None or outcome.force_bound is None or share >= UNUSED:
        return False
    predicted = outcome.force.predicted
    return predicted is None or predicted >= UNUSED * outcome.force_bound


def is_overplanned(outcome: ProcessOutcome) -> bool:
    """Whether the plan itself expected more force than its bound."""
    predicted, bound = outcome.force.predicted, outcome.force_bound
    return predicted is not None and bound is not None and predicted > PASSED * bound


def time_to_win(outcome: ProcessOutcome) -> float:
    """Seconds that full use of the bound would save, about.

    ``t·(1 − F/F_bound)``: force in proportion to feed, all of the time with chips. Force rises
    less than the feed, which would save more; time in air, less.
    """
    share, seconds = share_of(outcome), outcome.time.measured
    if share is None or seconds is None:
        return 0.0
    return seconds * max(0.0, 1.0 - share)
