"""Sentences on parts of a program that take longer along their paths than as programmed."""

from optimiser.along_path.caps import CapName
from optimiser.along_path.filter_transfer import BrokenBound
from optimiser.along_path.plan import PartPlan
from optimiser.planning.reasons import broken_words, longer_words, remedy_for
from optimiser.solver.problem import LimitName

REMEDY_OF = {
    CapName.CHIP_THICKNESS: LimitName.FEED_PER_TOOTH,
    CapName.ENTRY: LimitName.FEED_PER_TOOTH,
    CapName.PLUNGE: LimitName.FEED_PER_TOOTH,
    CapName.HOLDING: LimitName.HOLDING_FORCE,
}
"""Limits whose remedies help against caps of another name."""


def slower_part(plan: PartPlan, before: float, after: float) -> str:
    """Sentence on a part that takes longer than programmed; empty for any other.

    It names the bound that costs most time, where the program breaks it most.

    Parameters
    ----------
    before, after : float, s
        Times of the runs as programmed and as planned.
    """
    worst = max(
        plan.broken.values(),
        key=lambda each: (plan.lost.get(each.name, 0.0), each.ratio),
        default=None,
    )
    most = max(plan.shares, key=lambda name: plan.shares[name][1], default=None)
    if most is CapName.FEED_MECHANISM:
        why = "the greatest feed of the machine, or of --max-feed, is less than programmed"
    elif worst is None:
        why = "the program keeps every bound"
    else:
        why = _broken(worst)
    return longer_words(plan.name, before, after, why)


def _broken(bound: BrokenBound) -> str:
    """Words for a broken bound: where, by how much, and what would help."""
    load = bound.load
    text = f"as programmed on line {bound.block} "
    if load is not None:
        return f"{text}{broken_words(load)}{remedy_for((load.limit.name,))}"
    remedy = remedy_for((REMEDY_OF.get(bound.name, bound.name),))
    return f"{text}{bound.words}{remedy}"
