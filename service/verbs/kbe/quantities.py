"""Planned and measured quantities of outcomes, in the user's units."""

from collections.abc import Callable, Mapping

from service.rendering.columns import shown
from stepnc_model.outcome import EvaluatedQuantity, ProcessOutcome
from stepnc_model.units import mm_min_from_speed, um_from_mm

NOTHING = "–"
"""Text for unknown values."""

Quantity = Callable[[ProcessOutcome], EvaluatedQuantity]
"""Function that returns a quantity of an outcome, in the user's unit."""

EVALUATED: Mapping[str, Quantity] = {
    "Ra µm": lambda each: _scaled(each.roughness, um_from_mm(1.0)),
    "time s": lambda each: each.time,
    "force N": lambda each: each.force,
    "feed mm/min": lambda each: _scaled(each.feed, mm_min_from_speed(1.0)),
}
"""The four evaluated quantities, by their headings."""


def _scaled(quantity: EvaluatedQuantity, by: float) -> EvaluatedQuantity:
    """Convert planned and measured value to another unit."""
    predicted, measured = quantity.predicted, quantity.measured
    return EvaluatedQuantity(
        predicted=None if predicted is None else predicted * by,
        measured=None if measured is None else measured * by,
    )


def quantity_text(of: Quantity) -> Callable[[ProcessOutcome], str]:
    """Return a function for the planned, measured and deviating value of an outcome."""
    return lambda outcome: comparison_text(of(outcome))


def comparison_text(quantity: EvaluatedQuantity) -> str:
    """Return the text of a cell: planned, measured and deviation."""
    values = (quantity.predicted, quantity.measured)
    if values == (None, None):
        return ""
    share = quantity.deviation
    pair = " -> ".join(shown(each, ".3g", nothing=NOTHING) for each in values)
    return pair if share is None else f"{pair} ({100.0 * share:+.0f} %)"
