"""Remarks on a group of outcomes: observations with numbers, and recommendations.

Comparison of the measured force with the force bound of the plan.

Grade of a group of outcomes against its plan.

The letter grades the prediction: the root mean square of the deviations, bias and scatter
together, of the quantity that deviates most. Roughness counts only above the plan. Two words
take precedence over letters: *violated*, the force exceeded its bound, and *wasted*, it stayed
far below although the plan intended to use it.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, eq. (10): theoretical roughness goes with the square of the feed.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from math import hypot, sqrt

from kbe.acceptance import AcceptanceBounds
from kbe.factor import factor_at, interval
from kbe.statistics import DeviationStatistics, Evaluated
from stepnc_model.outcome import LearnedCorrection, ProcessOutcome
from stepnc_model.plurals import counted

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
    """True if the force stayed below a bound that the plan intended to use.

    A plan that itself stays far below its bound is limited by something else (power, chip load,
    roughness), which is not waste.
    """
    share = share_of(outcome)
    if share is None or outcome.force_bound is None or share >= UNUSED:
        return False
    predicted = outcome.force.predicted
    return predicted is None or predicted >= UNUSED * outcome.force_bound


def is_overplanned(outcome: ProcessOutcome) -> bool:
    """True if the plan itself expected more force than its bound."""
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


NOTABLE = 0.05
"""Deviation, or change of the factor, above which a remark is made."""
STEEP = 0.005
"""Slope of a significant trend, per run relative to the plan, above which it is reported."""
ENOUGH = AcceptanceBounds().fewest_outcomes
"""Number of outcomes from which a factor is recommended."""


class Action(StrEnum):
    """Action that a remark recommends."""

    ACCEPT_FACTOR = "accept factor"
    WAIT = "wait for more runs"
    RECORD_RATIO = "record force ratios"
    PLAN_AGAIN = "plan again"
    PLAN_SAFER = "plan safer"
    PLAN_BOLDER = "plan bolder"
    CHECK_FEED = "check the feed"
    LOWER_FEED = "lower the feed"
    CHANGE_TOOL = "change the tool"
    CALIBRATE = "calibrate the machine"


@dataclass(frozen=True, slots=True, kw_only=True)
class Evidence:
    """Statistics and corrections of a group, on which remarks are based."""

    deviations: Mapping[Evaluated, DeviationStatistics]
    bound: BoundUse
    proposed: LearnedCorrection | None
    """Correction learned from the outcomes of the context."""
    accepted: LearnedCorrection | None
    """Correction that plans use now; None: the catalogue's k_c."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Remark:
    """Observation on a quantity with a recommended action."""

    about: Evaluated
    action: Action
    observed: str
    advice: str

    def __str__(self) -> str:
        return f"{self.observed}: {self.advice}"


def remarks(evidence: Evidence) -> tuple[Remark, ...]:
    """All remarks on a group, the most serious first."""
    proposed = evidence.proposed if is_pending(evidence) else None
    found = [
        _overplanned(evidence.bound),
        _violated(evidence.bound),
        _force(evidence) if proposed is None else _factor(evidence, proposed),
        _wasted(evidence),
        _roughness(evidence),
        _feed(evidence) if proposed is None else None,
        _time(evidence),
        *(_trend(evidence, which) for which in Evaluated),
    ]
    return tuple(each for each in found if each is not None)


def is_pending(evidence: Evidence) -> bool:
    """True if the learned factor differs notably from the one that plans use."""
    return abs(_learned(evidence) / _in_force(evidence) - 1.0) > NOTABLE


def _learned(evidence: Evidence) -> float:
    """Centre of the learned factor; without one, the factor that plans use."""
    if evidence.proposed is None:
        return _in_force(evidence)
    return factor_at(evidence.proposed, quantile=0.5)


def _in_force(evidence: Evidence) -> float:
    """Centre of the factor that plans use."""
    return 1.0 if evidence.accepted is None else factor_at(evidence.accepted, quantile=0.5)


def _overplanned(bound: BoundUse) -> Remark | None:
    """Remark on plans that themselves exceed the force bound."""
    if not bound.overplanned:
        return None
    return Remark(
        about=Evaluated.FORCE,
        action=Action.PLAN_AGAIN,
        observed=f"the plan itself exceeded the force bound in {bound.overplanned} of "
        f"{counted(bound.known, 'cut')}",
        advice="optimise the program for this machine and material",
    )


def _violated(bound: BoundUse) -> Remark | None:
    """Remark on a force that exceeded its bound."""
    if not bound.violated or bound.highest is None:
        return None
    return Remark(
        about=Evaluated.FORCE,
        action=Action.PLAN_SAFER,
        observed=f"force passed its bound by more than {_percent(PASSED - 1.0)} in "
        f"{bound.violated} of {counted(bound.known, 'cut')}, "
        f"by {_percent(bound.highest - 1.0)} at worst",
        advice="plan with a higher quantile of the k_c factor, or a lower bound",
    )


def _factor(evidence: Evidence, proposed: LearnedCorrection) -> Remark:
    """Remark on a learned factor that differs from the one that plans use."""
    seen = interval(proposed)
    factor = f"the k_c factor {seen.centre:.2f} ({seen.low:.2f} to {seen.high:.2f})"
    phrases = [_deviates(evidence, which) for which in (Evaluated.FORCE, Evaluated.FEED)]
    observed = " and ".join(filter(None, phrases)) or (
        f"force {seen.centre:.2f} × catalogue, but plans use factor {_in_force(evidence):.2f}"
    )
    missing = ENOUGH - proposed.outcomes
    return Remark(
        about=Evaluated.FORCE,
        action=Action.WAIT if missing > 0 else Action.ACCEPT_FACTOR,
        observed=observed,
        advice=f"collect {missing} more to confirm {factor}"
        if missing > 0
        else f"accept {factor}",
    )


def _force(evidence: Evidence) -> Remark | None:
    """Remark on a force off its plan that no new factor explains."""
    observed = _deviates(evidence, Evaluated.FORCE)
    if not observed:
        return None
    action, advice = Action.CHECK_FEED, "compare the actual feed with the planned one"
    if evidence.proposed is None:
        action, advice = Action.RECORD_RATIO, "let the controller record force ratios"
    elif evidence.accepted is not None:
        factor = f"{_in_force(evidence):.2f}"
        action, advice = Action.PLAN_AGAIN, f"plan again with the accepted k_c factor {factor}"
    return Remark(about=Evaluated.FORCE, action=action, observed=observed, advice=advice)


def _wasted(evidence: Evidence) -> Remark | None:
    """Remark on a force far below a bound that the plan intended to use."""
    bound = evidence.bound
    if not bound.wasted:
        return None
    each = bound.time_to_win / bound.wasted
    won = f", about {each:.1f} s each could be saved" if each > 0.0 else ""
    overestimated = is_pending(evidence) and _learned(evidence) < _in_force(evidence)
    return Remark(
        about=Evaluated.FORCE,
        action=Action.PLAN_AGAIN if overestimated else Action.PLAN_BOLDER,
        observed=f"force below {_percent(UNUSED)} of its bound in {bound.wasted} of "
        f"{counted(bound.known, 'cut')}{won}",
        advice="accept the k_c factor and plan again"
        if overestimated
        else f"let the controller raise the feed, or {_bolder(evidence)}",
    )


def _roughness(evidence: Evidence) -> Remark | None:
    """Remark on a surface rougher than planned."""
    mean = evidence.deviations[Evaluated.ROUGHNESS].mean
    if mean is None or mean <= NOTABLE:
        return None
    lower = 1.0 - 1.0 / sqrt(1.0 + mean)  # [1]_ eq. (10)
    return Remark(
        about=Evaluated.ROUGHNESS,
        action=Action.LOWER_FEED,
        observed=_deviates(evidence, Evaluated.ROUGHNESS),
        advice=f"lower the feed per tooth by {_percent(lower)}",
    )


def _feed(evidence: Evidence) -> Remark | None:
    """Remark on a feed off its plan that no factor explains."""
    observed, mean = (
        _deviates(evidence, Evaluated.FEED),
        evidence.deviations[Evaluated.FEED].mean,
    )
    if not observed or mean is None:
        return None
    slower = mean < 0.0
    return Remark(
        about=Evaluated.FEED,
        action=Action.CHECK_FEED if slower else Action.PLAN_BOLDER,
        observed=observed,
        advice="check what limits the feed: override, force bound, short blocks"
        if slower
        else _bolder(evidence),
    )


def _bolder(evidence: Evidence) -> str:
    """Recommendation to plan with more force: with a smaller margin, or at all."""
    if evidence.accepted is None:
        return "optimise the program: it leaves room for more feed"
    return "plan with a lower quantile of the k_c factor"


def _time(evidence: Evidence) -> Remark | None:
    """Remark on a time off its plan although the feed is not."""
    observed = _deviates(evidence, Evaluated.TIME)
    if not observed or _deviates(evidence, Evaluated.FEED):
        return None
    return Remark(
        about=Evaluated.TIME,
        action=Action.CALIBRATE,
        observed=observed,
        advice="calibrate the machine's cycle time",
    )


def _trend(evidence: Evidence, which: Evaluated) -> Remark | None:
    """Remark on a quantity with a trend from run to run."""
    trend = evidence.deviations[which].trend
    if trend is None or not trend.is_significant or abs(trend.per_run) < STEEP:
        return None
    rises = trend.per_run > 0.0
    worn = rises if which is not Evaluated.FEED else not rises
    size, error = 100.0 * abs(trend.per_run), 100.0 * trend.standard_error
    return Remark(
        about=which,
        action=Action.CHANGE_TOOL if worn else Action.WAIT,
        observed=f"{which} {'rises' if rises else 'falls'} by {size:.1f} ± {error:.1f} % of "
        f"the plan per run, over {counted(trend.runs, 'run')}",
        advice="the edge wears; index or change the tool"
        if worn
        else "wait until it settles before accepting a factor",
    )


def _deviates(evidence: Evidence, which: Evaluated) -> str:
    """Text on the deviation of a quantity; empty if it is not notable."""
    seen = evidence.deviations[which]
    if seen.mean is None or abs(seen.mean) <= NOTABLE:
        return ""
    above = seen.mean > 0.0
    runs = seen.runs_above if above else seen.runs - seen.runs_above
    side = "above" if above else "below"
    share = f"{runs} of {counted(seen.runs, 'run')}"
    return f"{which} {_percent(abs(seen.mean))} {side} plan in {share}"


def _percent(share: float) -> str:
    """Format a share as a percentage."""
    return f"{100.0 * share:.0f} %"


LETTERS = ((0.05, "A"), (0.10, "B"), (0.20, "C"))
"""Greatest root mean square deviation of each letter."""


class EvaluationGrade(StrEnum):
    """Grade of a group, from worst to best; unknown without data."""

    VIOLATED = "violated"
    WASTED = "wasted"
    D = "D"
    C = "C"
    B = "B"
    A = "A"
    UNKNOWN = "unknown"


def grade(
    deviations: Mapping[Evaluated, DeviationStatistics], bound: BoundUse
) -> EvaluationGrade:
    """Grade a group of outcomes.

    Parameters
    ----------
    deviations : mapping of DeviationStatistics
    bound : BoundUse
        A group is violated by one outcome, and wasted by half of its outcomes.
    """
    if bound.violated:
        return EvaluationGrade.VIOLATED
    if bound.wasted and 2 * bound.wasted >= bound.known:
        return EvaluationGrade.WASTED
    sizes = [_size(which, each) for which, each in deviations.items()]
    known = [size for size in sizes if size is not None]
    if not known:
        return EvaluationGrade.UNKNOWN
    worst = max(known)
    return next(
        (EvaluationGrade(letter) for most, letter in LETTERS if worst <= most),
        EvaluationGrade.D,
    )


def _size(which: Evaluated, statistics: DeviationStatistics) -> float | None:
    """Root mean square deviation of one quantity; None if nothing is known."""
    if statistics.mean is None:
        return None
    # A surface smoother than planned is not a defect.
    if which is Evaluated.ROUGHNESS and statistics.mean <= 0.0:
        return 0.0
    return hypot(statistics.mean, statistics.deviation or 0.0)
