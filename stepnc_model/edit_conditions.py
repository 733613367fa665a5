"""Edits of the cutting conditions of a workingstep: feed, speed and depth of one pass.

A technology, a speed or a strategy that several operations share is copied before it is edited.
"""

from stepnc_model.draft import Draft
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.part21.values import Real
from stepnc_model.program import ResolvedWorkingstep
from stepnc_model.technology import Number

DIGITS = 12
"""Significant digits of numbers written into the file."""


def rounded(value: float) -> float:
    """Round a number to the digits that are written."""
    return float(f"{value:.{DIGITS}g}")


def edit_number(draft: Draft, step: ResolvedWorkingstep, number: Number, value: float) -> None:
    """Write one programmed number, in an instance that only this operation uses.

    Parameters
    ----------
    draft : Draft
    step : ResolvedWorkingstep
    number : Number
    value : float
        Number for the file, with its sign.
    """
    if rounded(value) == rounded(number.in_file(number.value)):
        return
    holder = draft.own(step.operation_ref, "its_technology")
    if number.ref != step.technology_ref:
        technology = draft.program.get(step.technology_ref)
        attribute = next(
            name
            for name in technology.__dataclass_fields__
            if getattr(technology, name) == number.ref
        )
        holder = draft.own(step.technology_ref, attribute, at=holder)
    draft.put(number.ref, number.attribute, Real(rounded(value)), at=holder)


def edit_depth(draft: Draft, step: ResolvedWorkingstep, depth: float) -> bool:
    """Write the depth of one pass, mm: in the operation, or in a turning strategy.

    Returns
    -------
    bool
        Whether the operation has a depth that can be written.
    """
    value, operation = Real(rounded(depth)), step.operation
    if isinstance(operation, TurningMachiningOperation):
        reference = operation.its_machining_strategy
        if reference is None or not hasattr(draft.program.get(reference), "cutting_depth"):
            return False
        strategy = draft.own(step.operation_ref, "its_machining_strategy")
        draft.put(reference, "cutting_depth", (value,), at=strategy)
        return True
    if not hasattr(operation, "axial_cutting_depth"):
        return False
    draft.put(step.operation_ref, "axial_cutting_depth", value)
    return True
