"""What the loop keeps in a workingstep: the set point on its way, and the band around it.

Units N.
"""

from dataclasses import dataclass, replace
from math import exp, inf

from controller.aims import Aims, Step
from controller.conditioning import RISE, conditioned
from controller.guard import Keeping, aimed, keeping
from controller.hold import EASING
from controller.orders import Criterion
from controller.reference import Reference


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """The set point of a revolution. A new one for each workingstep."""

    set_point: float = 0.0
    """N; 0: there was none yet; infinite: nothing bounds the force"""
    settled: float = 0.0
    """N, greatest set point that the force had the time to follow"""
    cap: float = inf
    """override that a hold has taught, :func:`controller.guard.taught`"""


def wanted(aims: Aims, reference: Reference) -> float:
    """Force that was asked for, or that the plan allows, N; infinite: nothing bounds it."""
    if aims.set_point is not None:
        return aims.set_point
    bound = reference.bound(power_factor=aims.power_factor)
    return inf if bound is None else bound.force


def approached(target: Target, aims: Aims, reference: Reference) -> Target:
    """The target of the next revolution.

    A set point that falls holds at once for the law, but the force needs its time: what is an
    overload falls as slowly as a set point rises, :data:`controller.conditioning.RISE`. What a
    hold has taught is eased little by little: the cut that was too hard may be over.
    """
    goal = aimed(wanted(aims, reference), reference)
    target = replace(target, cap=target.cap * (1.0 + EASING))
    if goal == inf:
        return replace(target, set_point=inf, settled=inf)
    if target.set_point == inf:
        target = Target(cap=target.cap)
    set_point = conditioned(target.set_point, goal)
    settled = max(target.set_point, target.settled) * exp(-RISE)
    return replace(target, set_point=set_point, settled=max(set_point, settled))


def kept(target: Target, aims: Aims, step: Step) -> Keeping:
    """What the guard keeps."""
    keep = keeping(
        aims.band,
        step.reference,
        set_point=target.set_point or inf,
        exponent=step.exponent,
        most=min(target.cap, 1.0 if aims.criterion is Criterion.QC else inf),
    )
    return replace(keep, settled=target.settled)


def introduction(aims: Aims, reference: Reference) -> str:
    """What bounds the force in a workingstep, as a sentence."""
    bound = reference.bound(power_factor=aims.power_factor)
    words = "nothing bounds the force"
    if aims.set_point is not None:
        words = f"force bound {aims.set_point:.4g} N as asked for"
    elif bound is not None:
        words = f"force bound {bound.force:.4g} N by {bound.words}, where the plan cuts hardest"
    asked = wanted(aims, reference)
    least = aimed(asked, reference)
    if least < 0.999 * asked:
        words += f"; {least:.4g} N, for the tool to bear a sudden rise"
    return f"{reference.workingstep}: {words}"
