"""What would help against a limit, and sentences on plans that take longer than the program.

A plan that keeps the bounds may take longer than a program that breaks them. The user should
read first which bound that is, by how much it is broken, and what would help.
"""

from collections.abc import Iterable

from optimiser.advice import Advice, AdviceStatus, LimitLoad, Plan
from optimiser.problem import ROUNDING, BoundSide, LimitName
from optimiser.remedy_words import remedy_for

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
    if after.time <= SLOWER * before.time:
        return ""
    text = f"{name} takes {after.time:.4g} s instead of {before.time:.4g} s: "
    worst = _worst(before.loads) or _worst(before.plunge_loads)
    if worst is None:
        return f"{text}the program keeps every bound"
    return f"{text}as programmed {_broken(worst)}{remedy_for((worst.limit.name,))}"


def _worst(loads: Iterable[LimitLoad]) -> LimitLoad | None:
    """Load farthest above its bound; None where every bound is kept."""
    broken = (
        load
        for load in loads
        if load.limit.sense is BoundSide.AT_MOST and load.margin < -ROUNDING
    )
    return min(broken, key=lambda load: load.margin, default=None)


def _broken(load: LimitLoad) -> str:
    """Text of a load above its bound: value, bound, excess and the origin of the bound."""
    limit = load.limit
    bound = f"{load.bound * limit.scale:.4g} {limit.unit}"
    origin = f", {limit.origin}" if limit.origin else ""
    is_stable = limit.name is LimitName.STABILITY
    verb = "is above the stable" if is_stable else "exceeds its bound of"
    return (
        f"{limit.words} {limit.told(load.value)} {verb} {bound} "
        f"by {-100.0 * load.margin:.3g} %{origin}"
    )
