"""What a plan could not check: required limits without a bound, and the risk of chatter."""

from optimiser.advice import Advice, Plan
from optimiser.required import UncheckedLimit
from service.rendering.columns import Column

UNCHECKED: tuple[Column[UncheckedLimit], ...] = (
    Column(key="name", value=lambda limit: limit.name.value),
    Column(key="why", value=lambda limit: limit.why),
    Column(key="datum", value=lambda limit: limit.datum),
)
"""Columns of a required limit that could not be looked at."""


def unchecked_words(plan: Plan) -> str:
    """State how many required limits could not be looked at; empty if none."""
    if not plan.unchecked:
        return ""
    steps = len({advice.workingstep.ref for advice, _ in plan.unchecked})
    limits = "limit is" if len(plan.unchecked) == 1 else "limits are"
    where = "workingstep" if steps == 1 else "workingsteps"
    return f"; {len(plan.unchecked)} required {limits} unchecked in {steps} {where}"


def chatter_words(advice: Advice) -> str | None:
    """Depth beyond the estimated stable depth; None without such a risk."""
    risk = advice.chatter_risk
    return None if risk is None else risk.words


def chatter_record(advice: Advice) -> dict[str, float] | None:
    """Return depth and estimated stable depth for JSON; None without a risk."""
    risk = advice.chatter_risk
    if risk is None:
        return None
    return {"depth_mm": risk.depth, "stable_mm": risk.stable}
