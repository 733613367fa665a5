"""Bound of a tool with its origin: of its own window, of another group, or without a source."""

from dataclasses import dataclass

from optimiser.chip_load import (
    borrowed_datum,
)
from optimiser.conditions import CuttingConditions


@dataclass(frozen=True, slots=True, kw_only=True)
class SourcedBound:
    """Bound with its origin, and the datum that would bring a better one."""

    bound: float | None = None
    origin: str = ""
    datum: str = ""


def borrowed_bound(bound: float, given: float, at: CuttingConditions) -> SourcedBound:
    """Bound by a window of the tool: one of another group does not slow a program down."""
    if at.grade is None or not at.grade.borrowed:
        return SourcedBound(bound=bound)
    above = "as programmed, above " if given > bound else ""
    origin = f"{above}{at.grade.borrowed}"
    return SourcedBound(bound=max(bound, given), origin=origin, datum=borrowed_datum(at))
