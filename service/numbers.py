"""Parsing of comma-separated numbers and raw part dimensions entered by the user."""

from math import isfinite

from stepnc_model.errors import StepNcError
from stepnc_model.program import Stock
from stepnc_model.toolpath.path import FARTHEST

LEAST_SIZE = 0.01
"""Smallest accepted size of a stock along an axis, in mm."""


def numbers_in(text: str, what: str, *, counts: tuple[int, ...]) -> tuple[float, ...]:
    """Parse finite numbers separated by commas.

    Raises
    ------
    StepNcError
        When the text does not hold numbers, or not an accepted count of them.
    """
    try:
        numbers = tuple(float(word) for word in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) not in counts or not all(map(isfinite, numbers)):
        wanted = " or ".join(map(str, counts))
        raise StepNcError(f"{what} '{text}': expected {wanted} numbers separated by commas")
    return numbers


def stock_in(text: str) -> Stock:
    """Parse a raw part, in mm: six block corner coordinates, or a bar's diameter and two ends.

    Raises
    ------
    StepNcError
        When the numbers are invalid, or :func:`require_size` refuses the stock.
    """
    numbers = numbers_in(text, "stock", counts=(3, 6))
    radius = None
    if len(numbers) == 3:
        radius = 0.5 * numbers[0]
        numbers = (-radius, -radius, numbers[1], radius, radius, numbers[2])
    low, high = numbers[:3], numbers[3:]
    stock = Stock(low=(low[0], low[1], low[2]), high=(high[0], high[1], high[2]), radius=radius)
    require_size(stock)
    return stock


def require_size(stock: Stock) -> None:
    """Refuse a stock that has no volume or extends too far from zero."""
    for axis, low, high in zip("xyz", stock.low, stock.high, strict=True):
        if not high - low >= LEAST_SIZE or max(abs(low), abs(high)) > FARTHEST:
            bound = f"must span at least {LEAST_SIZE:g} mm, within {FARTHEST:g} mm of zero"
            raise StepNcError(f"stock: {axis} from {low:g} to {high:g} mm: {bound}")
