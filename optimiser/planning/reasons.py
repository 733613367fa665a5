"""Sentences on limits: which limit sets a feed, and which limits a program exceeds.

What would help against each limit, in words.

What would help against a limit, and sentences on plans that take longer than the program.

A plan that keeps the bounds may take longer than a program that breaks them. The user should
read first which bound that is, by how much it is broken, and what would help.
"""

from collections.abc import Iterable

from optimiser.advice import Advice, AdviceStatus, EvaluatedSetting, LimitLoad, Plan
from optimiser.bounds.limits import STRAIGHT_DOWN
from optimiser.bounds.plunge_feed import DOWN_A_RAMP
from optimiser.solver import workingstep as exact
from optimiser.solver.problem import ROUNDING, BoundSide, Limit, LimitName
from stepnc_model.errors import Finding, Severity
from stepnc_model.programs.program import Program
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
        f"{limit.words} {limit.load_text(load.value)} reaches its bound of "
        f"{limit.bound_text(speed)}{f', {origin}' if origin else ''}"
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
        speed = advice.before.setting.speed
        text = f"{when}: {exact.violation_text(load.limit, load.value, speed)}"
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


STIFFER = "a thicker tool or a shorter overhang"

REMEDIES: dict[str, str] = {
    LimitName.TOOL_DEFLECTION: f"{STIFFER}, or an allowance for a finishing pass",
    LimitName.SHANK_STRENGTH: f"{STIFFER}, or a smaller radial width",
    LimitName.STABILITY: f"{STIFFER}, or another spindle speed (--free feed,depth,speed)",
    LimitName.MOTOR_POWER: "a stronger spindle, or a smaller radial width",
    LimitName.SPINDLE_TORQUE: "a stronger spindle, or a thinner tool",
    LimitName.CUTTING_FORCE: "a stronger machine, or a thinner tool",
    LimitName.FEED_PER_TOOTH: "more teeth, or a tool with a higher catalogue feed",
    LimitName.PROGRAMMED_FEED: "a catalogue feed for this tool and material",
    LimitName.FEED_MECHANISM: "a machine with faster feed drives",
    LimitName.CUTTING_SPEED: "a cutting material for a higher speed",
    LimitName.SPINDLE_SPEED: "a machine or chuck for a higher speed",
    LimitName.AXIAL_DEPTH: "longer cutting edges",
    LimitName.ROUGHNESS: "a larger corner radius, or a wiper",
    LimitName.CHUCK_TORQUE: "a greater clamping force",
    LimitName.TILTING_MOMENT: "a greater clamping force, or a shorter overhang of the bar",
    LimitName.HOLDING_FORCE: "a greater clamping force",
    LimitName.BAR_DEFLECTION: "a tailstock, or a shorter overhang of the bar",
}
"""Change of tool, machine, clamping or drawing that widens a limit."""


def remedy_for(limits: Iterable[str]) -> str:
    """End of a sentence that names what would help against limits; empty where unknown."""
    words = dict.fromkeys(REMEDIES[each] for each in limits if each in REMEDIES)
    return f"; {', or '.join(words)} would help" if words else ""


SLOWER = 1.005
"""Ratio of planned to programmed time above which a plan counts as slower."""


def slower_than_programmed(plan: Plan) -> tuple[str, ...]:
    """Sentences on the workingsteps that take longer than programmed, and on why.

    Workingsteps that no setting makes feasible are among them.
    """
    return tuple(text for advice in plan.advices if (text := slower_sentence(advice)))


def slower_sentence(advice: Advice) -> str:
    """Sentence on a workingstep that takes longer than programmed; empty for any other."""
    name, before, after = advice.workingstep.id, advice.before, advice.after
    if advice.status is AdviceStatus.INFEASIBLE:
        return f"{name}: {advice.reason}"
    if advice.status is not AdviceStatus.ADVISED or before is None or after is None:
        return ""
    worst = _worst(before.loads) or _worst(before.plunge_loads)
    why = "the program keeps every bound"
    if worst is not None:
        why = f"as programmed {broken_words(worst)}{remedy_for((worst.limit.name,))}"
    return longer_words(name, before.time, after.time, why)


def longer_words(name: str, before: float, after: float, why: str) -> str:
    """Sentence on a part of a program that takes longer, s, and on why; empty for any other."""
    if after <= SLOWER * before:
        return ""
    return f"{name} takes {after:.4g} s instead of {before:.4g} s: {why}"


def _worst(loads: Iterable[LimitLoad]) -> LimitLoad | None:
    """Load farthest above its bound; None where every bound is kept."""
    broken = (
        load
        for load in loads
        if load.limit.sense is BoundSide.AT_MOST and load.margin < -ROUNDING
    )
    return min(broken, key=lambda load: load.margin, default=None)


def broken_words(load: LimitLoad) -> str:
    """Text of a load above its bound: value, bound, excess and the origin of the bound."""
    limit = load.limit
    bound = f"{load.bound * limit.scale:.4g} {limit.unit}"
    origin = f", {limit.origin}" if limit.origin else ""
    is_stable = limit.name is LimitName.STABILITY
    verb = "is above the stable" if is_stable else "exceeds its bound of"
    return (
        f"{limit.words} {limit.load_text(load.value)} {verb} {bound} "
        f"by {-100.0 * load.margin:.3g} %{origin}"
    )
