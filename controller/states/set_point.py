"""Set point of the cutting force in a workingstep, and the override band around it.

Units: N.
"""

from math import exp, inf

from controller.guard import WorkingstepBounds, aimed
from controller.orders import Criterion
from controller.reference import Reference
from controller.signals.conditioning import RISE, conditioned
from controller.states.loop_settings import LoopSettings, LoopStep

EASING = 1.0 / 200.0
"""Relative rise per revolution of the override limit learnt from a feed hold.

Cuts that recur within a second or two occasionally hold the feed; cuts that are over cost
little.
"""


def wanted(settings: LoopSettings, reference: Reference) -> float:
    """Requested force, or force that the plan allows, N; infinite if nothing limits it."""
    if settings.set_point is not None:
        return settings.set_point
    bound = reference.bound(power_factor=settings.power_factor)
    return inf if bound is None else bound.force


def bounded(
    settings: LoopSettings,
    step: LoopStep,
    *,
    set_point: float = inf,
    settled: float = 0.0,
    cap: float = inf,
) -> WorkingstepBounds:
    """Bounds that the guard keeps: the user's band, narrowed by workingstep and mode.

    Parameters
    ----------
    set_point : float, N
        Infinite: there is none yet, or nothing limits the force.
    settled : float, N
        Greatest set point that the force had time to follow.
    cap : float
        Override limit learnt from a feed hold, :func:`controller.guard.taught`.
    """
    band, reference = settings.band, step.reference
    most = min(cap, 1.0 if settings.criterion is Criterion.QC else inf)
    # The programmed feed may exceed the plan's limits by far: the band's floor is kept.
    ceiling = max(min(band.ceiling, reference.ceiling, most), band.floor)
    return WorkingstepBounds(
        set_point=set_point,
        breakage=reference.breakage,
        floor=min(max(band.floor, reference.floor), ceiling),
        ceiling=ceiling,
        exponent=step.exponent,
        least=min(reference.least, ceiling),
        settled=settled,
        cap=cap,
    )


def approached(
    keep: WorkingstepBounds, settings: LoopSettings, step: LoopStep
) -> WorkingstepBounds:
    """Force and override bounds of the next revolution.

    A falling set point applies at once to the law, but the force needs time to follow: the
    overload limit falls as slowly as a set point rises,
    :data:`controller.signals.conditioning.RISE`. The override limit learnt from a feed hold is
    eased little by little, as the cut that was too hard may be over.
    """
    goal = aimed(wanted(settings, step.reference), step.reference)
    cap, before = keep.cap * (1.0 + EASING), keep.set_point
    set_point = settled = goal
    if inf not in {goal, before}:
        set_point = conditioned(before, goal)
        settled = max(set_point, max(before, keep.settled) * exp(-RISE))
    if (set_point, settled, cap) == (before, keep.settled, keep.cap):
        return keep
    return bounded(settings, step, set_point=set_point, settled=settled, cap=cap)


def introduction(settings: LoopSettings, reference: Reference) -> str:
    """Sentence on the force bound of a workingstep."""
    bound = reference.bound(power_factor=settings.power_factor)
    words = "nothing limits the force"
    if settings.set_point is not None:
        words = f"force bound {settings.set_point:.4g} N as requested"
    elif bound is not None:
        words = f"force bound {bound.force:.4g} N by {bound.words}, where the plan cuts hardest"
    asked = wanted(settings, reference)
    least = aimed(asked, reference)
    if least < 0.999 * asked:
        words += f"; reduced to {least:.4g} N so that the tool withstands a sudden rise"
    return f"{reference.workingstep}: {words}"
