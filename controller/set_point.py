"""Set point of a workingstep, and the override band around it.

Units N.
"""

from math import exp, inf

from controller.conditioning import RISE, conditioned
from controller.guard import WorkingstepBounds, aimed
from controller.loop_settings import LoopSettings, LoopStep
from controller.orders import Criterion
from controller.reference import Reference

EASING = 1.0 / 200.0
"""share by which the override that a hold has taught is eased in a revolution: cuts that come
again within a second or two hold the feed now and then, and those that are over cost little"""


def wanted(settings: LoopSettings, reference: Reference) -> float:
    """Force that was asked for, or that the plan allows, N; infinite: nothing bounds it."""
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
    settings : LoopSettings
    step : LoopStep
    set_point : float, N
        Infinite: there is none yet, or nothing bounds the force.
    settled : float, N
        Greatest set point that the force had the time to follow.
    cap : float
        Override that a hold has taught, :func:`controller.guard.taught`.
    """
    band, reference = settings.band, step.reference
    most = min(cap, 1.0 if settings.criterion is Criterion.QC else inf)
    # What is programmed may pass the plan's limits by far: the band's floor is kept.
    ceiling = max(min(band.ceiling, reference.ceiling, most), band.floor)
    return WorkingstepBounds(
        set_point=set_point,
        breakage=reference.breakage,
        floor=min(max(band.floor, reference.floor), ceiling),
        ceiling=ceiling,
        exponent=step.exponent,
        settled=settled,
        cap=cap,
    )


def approached(
    keep: WorkingstepBounds, settings: LoopSettings, step: LoopStep
) -> WorkingstepBounds:
    """The bounds of the next revolution.

    A set point that falls holds at once for the law, but the force needs its time: what is an
    overload falls as slowly as a set point rises, :data:`controller.conditioning.RISE`. What a
    hold has taught is eased little by little: the cut that was too hard may be over.
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
    """Bound on the force in a workingstep, as a sentence."""
    bound = reference.bound(power_factor=settings.power_factor)
    words = "nothing bounds the force"
    if settings.set_point is not None:
        words = f"force bound {settings.set_point:.4g} N as asked for"
    elif bound is not None:
        words = f"force bound {bound.force:.4g} N by {bound.words}, where the plan cuts hardest"
    asked = wanted(settings, reference)
    least = aimed(asked, reference)
    if least < 0.999 * asked:
        words += f"; {least:.4g} N, for the tool to bear a sudden rise"
    return f"{reference.workingstep}: {words}"
