"""Remarks on a group of outcomes: observations with numbers, and recommendations.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, eq. (10): theoretical roughness goes with the square of the feed.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import sqrt

from kbe.acceptance import AcceptanceBounds
from kbe.bound import PASSED, UNUSED, BoundUse
from kbe.factor import factor_at, interval
from kbe.statistics import DeviationStatistics, Evaluated
from stepnc_model.outcome import LearnedCorrection

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
    """Whether the learned factor differs notably from the one that plans use."""
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
        f"{bound.known} cuts",
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
        f"{bound.violated} of {bound.known} cuts, by {_percent(bound.highest - 1.0)} at worst",
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
        f"{bound.known} cuts{won}",
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
        f"the plan per run, over {trend.runs} runs",
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
    return f"{which} {_percent(abs(seen.mean))} {side} plan in {runs} of {seen.runs} runs"


def _percent(share: float) -> str:
    """Format a share as a percentage."""
    return f"{100.0 * share:.0f} %"
