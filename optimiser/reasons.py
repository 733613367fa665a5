"""Sentences on limits: which limit sets a feed, and which limits a program exceeds."""

from optimiser import workingstep as exact
from optimiser.advice import Advice, AdviceStatus, EvaluatedSetting, LimitLoad
from optimiser.limits import STRAIGHT_DOWN
from optimiser.plunge_feed import DOWN_A_RAMP
from optimiser.problem import ROUNDING, Limit, LimitName
from stepnc_model.errors import Finding, Severity
from stepnc_model.program import Program
from stepnc_model.units import rpm_from_rev_s

SOURCES = {
    LimitName.FEED_PER_TOOTH: "the catalogue value for tool and material",
    LimitName.CUTTING_FORCE: "the greatest force that the machine states",
    LimitName.FEED_MECHANISM: "the greatest feed of the machine",
    LimitName.TOOL_DEFLECTION: "the customary maximum for any end mill",
    LimitName.SHANK_STRENGTH: "the bending strength of the cutting material",
    LimitName.MOTOR_POWER: "the power of the machine",
    LimitName.SPINDLE_TORQUE: "the torque of the machine",
    LimitName.ROUGHNESS: "as required",
    LimitName.STABILITY: "by the measured modes",
    LimitName.CHUCK_TORQUE: "by the [[holding]] table",
    LimitName.TILTING_MOMENT: "by the [[holding]] table",
    LimitName.HOLDING_FORCE: "by the [[holding]] table",
    LimitName.PROGRAMMED_FEED: "as programmed: no source gives more",
}
"""Where a bound comes from whose limit does not say it."""


def reason_of(state: EvaluatedSetting, limit: Limit) -> str:
    """Sentence naming the limit that sets the feed."""
    load = next(load for load in state.loads if load.limit is limit)
    return _reached(load, state.setting.speed)


def _reached(load: LimitLoad, speed: float) -> str:
    """Sentence on a load that reaches its bound."""
    limit = load.limit
    origin = limit.origin or SOURCES.get(limit.name, "")
    return (
        f"{limit.words} {limit.told(load.value)} reaches its bound of "
        f"{limit.told_bound(speed)}{f', {origin}' if origin else ''}"
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
