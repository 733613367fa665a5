"""Sentences on limits: which limit sets a feed, and which limits a program exceeds."""

from optimiser import workingstep as exact
from optimiser.advice import Advice, AdviceStatus, EvaluatedSetting, LimitLoad
from optimiser.limits import STRAIGHT_DOWN
from optimiser.plunge_feed import DOWN_A_RAMP
from optimiser.problem import ROUNDING, Limit, LimitName
from stepnc_model.errors import Finding, Severity
from stepnc_model.program import Program
from stepnc_model.units import rpm_from_rev_s


def reason_of(state: EvaluatedSetting, limit: Limit) -> str:
    """Sentence naming the limit that sets the feed."""
    load = next(load for load in state.loads if load.limit is limit)
    return _reached(load, state.setting.speed)


def _reached(load: LimitLoad, speed: float) -> str:
    """Sentence on a load that reaches its bound."""
    limit = load.limit
    origin = f", {limit.origin}" if limit.origin else ""
    return (
        f"{limit.words} {limit.told(load.value)} reaches its bound of "
        f"{limit.told_bound(speed)}{origin}"
    )


def plunge_reason(state: EvaluatedSetting) -> str:
    """Sentence naming the limit that sets the plunge feed; empty without a plunge feed."""
    tight = min(state.plunge_loads, key=lambda load: load.margin, default=None)
    return "" if tight is None else _reached(tight, state.setting.speed)


def passed_limits(program: Program, advice: Advice) -> list[Finding]:
    """Findings on limits exceeded as programmed, and whether the advice exceeds them too."""
    if advice.before is None:
        return []
    still = set()
    if advice.status is AdviceStatus.ADVISED and advice.after is not None:
        still = {_kind(load) for load in _passed_loads(advice.after)}
    found = {}
    for load in _passed_loads(advice.before):
        when = "as programmed and as advised" if _kind(load) in still else "as programmed"
        text = f"{when}: {exact.told(load.limit, load.value, advice.before.setting.speed)}"
        text += _brought_within(load.limit, advice)
        ref = advice.workingstep.technology_ref
        found[_kind(load)] = program.finding(Severity.WARNING, text, ref)
    return list(found.values())


def _passed_loads(state: EvaluatedSetting) -> list[LimitLoad]:
    """Loads beyond their bounds by more than rounding."""
    return [each for each in (*state.loads, *state.plunge_loads) if each.margin < -ROUNDING]


def _kind(load: LimitLoad) -> tuple[LimitName, bool]:
    """Key by which loads are grouped: limit name, and whether it belongs to a way down."""
    return load.limit.name, load.limit.words.endswith((STRAIGHT_DOWN, DOWN_A_RAMP))


def _brought_within(limit: Limit, advice: Advice) -> str:
    """Text with the spindle speed that was changed to keep a limit; empty for other limits."""
    is_speed = limit.name in {LimitName.CUTTING_SPEED, LimitName.SPINDLE_SPEED}
    if not is_speed or advice.before is None or advice.after is None:
        return ""
    given, speed = advice.before.setting.speed, advice.after.setting.speed
    return "" if speed == given else f"; changed to {rpm_from_rev_s(speed):.4g} rpm"
