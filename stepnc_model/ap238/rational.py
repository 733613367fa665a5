"""Rational B-spline curves, which both standards write as complex instances."""

from dataclasses import replace

from stepnc_model.ap238.table import Converted, ConvertedText
from stepnc_model.part21.values import Value
from stepnc_model.part21.writer import format_value

TEXT = (
    b"(BOUNDED_CURVE()B_SPLINE_CURVE%sB_SPLINE_CURVE_WITH_KNOTS%sCURVE()"
    b"GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE%sREPRESENTATION_ITEM%s)"
)
"""Parts in the order of their names, as ISO 10303-21 has them."""


def rational_text(
    instance: Converted, parameters: tuple[Value, ...], weights: tuple[Value, ...]
) -> ConvertedText:
    """Text of a B-spline curve with knots, whose control points have weights."""
    name, *curve, multiplicities, knots, spec = parameters
    parts = (tuple(curve), (multiplicities, knots, spec), (weights,), (name,))
    text = TEXT % tuple(map(format_value, parts))
    return ConvertedText(instance=replace(instance, keyword="", rule=None), text=text)
