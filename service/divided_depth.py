"""Notes on depths of passes that a user sets and that do not divide the whole depth."""

from collections.abc import Iterable, Iterator
from math import ceil

from optimiser.advice import Advice, Plan
from optimiser.cut import CutKind
from stepnc_model.errors import Finding, Severity
from stepnc_model.given import SetAttribute
from stepnc_model.program import Program

DEPTHS = {"axial_cutting_depth", "cutting_depth"}
"""Attributes that set the depth of passes."""

DIVIDES = 1e-6
"""Relative difference within which equal passes have the depth that was set."""

DECIMALS = 4


def depth_notes(
    program: Program, plan: Plan, given: Iterable[SetAttribute]
) -> tuple[Finding, ...]:
    """Notes on depths that were set and became passes of another depth."""
    refs = {int(each.ref) for each in given if each.attribute in DEPTHS}
    return tuple(_notes(program, plan, refs)) if refs else ()


def _notes(program: Program, plan: Plan, refs: set[int]) -> Iterator[Finding]:
    for advice in plan.advices:
        step = advice.workingstep
        strategy = getattr(step.operation, "its_machining_strategy", None)
        if refs & {int(ref) for ref in (step.operation_ref, strategy) if ref is not None}:
            text = _text(advice)
            if text:
                yield program.finding(Severity.NOTE, text, step.operation_ref)


def _text(advice: Advice) -> str:
    """Number and depth of the passes as programmed; empty where the depth divides."""
    cut = advice.cut
    if cut is None or cut.kind is not CutKind.MILLING or not cut.is_depth_free:
        return ""
    given, whole = cut.programmed, cut.total_depth
    real = whole / given.passes
    if abs(real / given.depth - 1.0) <= DIVIDES:
        return ""
    text = (
        f"a depth of {given.depth:g} mm does not divide {whole:g} mm: as programmed they are "
        f"{given.passes} passes of {real:.4g} mm"
    )
    fewer = given.passes - 1
    if fewer < 1:
        return text
    least = ceil(whole / fewer * 10**DECIMALS - DIVIDES) / 10**DECIMALS
    passes = "1 pass needs" if fewer == 1 else f"{fewer} passes need"
    return f"{text}; {passes} at least {least:g} mm"
