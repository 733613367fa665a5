"""Comparison of the measured force with the force bound of the plan."""

from dataclasses import dataclass, replace

from stepnc_model.outcome import ProcessOutcome

PASSED = 1.05
"""Share of the bound above which the force has violated it."""
UNUSED = 0.80
"""Share of the bound below which the bound is wasted, if the plan intended to use it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundUse:
    """Counts of outcomes that violated, wasted or overplanned their force bounds."""

    known: int = 0
    """Number of outcomes with a bound and a measured force."""
    violated: int = 0
    wasted: int = 0
    overplanned: int = 0
    """Number of outcomes in which the plan itself expected to exceed the bound."""
    highest: float | None = None
    """Greatest ratio of measured force to bound."""
    time_to_win: float = 0.0
    """Time that could be saved in all wasted outcomes together, s."""


def used(sum_before: BoundUse, outcome: ProcessOutcome) -> BoundUse:
    """Add one more outcome to the counts."""
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
    """Measured force over its bound; None if either is not known."""
    measured, bound = outcome.force.measured, outcome.force_bound
    if measured is None or bound is None or not bound > 0.0 or not measured >= 0.0:
        return None
    return measured / bound


def is_wasted(outcome: ProcessOutcome) -> bool:
    """Whether the force stayed below a bound that the plan intended to use.

    A plan that itself stays far below its bound is limited by something else (power, chip load,
    roughness), which is not waste.
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
    """Approximate time that full use of the bound would save, s.

    ``t·(1 − F/F_bound)``: it assumes force proportional to feed and chips all the time. Force
    rises less than the feed, which would save more; time in air, less.
    """
    share, seconds = share_of(outcome), outcome.time.measured
    if share is None or seconds is None:
        return 0.0
    return seconds * max(0.0, 1.0 - share)
