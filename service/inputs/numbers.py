"""Parsing of numbers, raw part dimensions and tool numbers entered by the user."""

import re
from math import isfinite

from stepnc_model.editing.user_data import GivenFeed
from stepnc_model.errors import StepNcError
from stepnc_model.programs.program import Stock
from stepnc_model.toolpath.path import FARTHEST
from stepnc_model.units import FeedUnit, speed_from_m_s, speed_from_mm_min

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
        words = list(map(str, counts))
        wanted = " or ".join((", ".join(words[:-1]), words[-1])) if words[1:] else words[0]
        raise StepNcError(f"{what} '{text}': expected {wanted} numbers separated by commas")
    return numbers


def stock_in(text: str) -> Stock:
    """Parse a raw part, in mm.

    Six numbers are the corners of a box; three the diameter and two ends of a bar about zero;
    two its diameter and its length, with its end at z = 0; five the place x, y, the diameter
    and two ends of an upright bar.

    Raises
    ------
    StepNcError
        When the numbers are invalid, or :func:`require_size` refuses the stock.
    """
    match numbers_in(text, "stock", counts=(2, 3, 5, 6)):
        case (diameter, length):
            stock = _bar((0.0, 0.0), diameter, (-length, 0.0))
        case (diameter, low, high):
            stock = _bar((0.0, 0.0), diameter, (low, high))
        case (x, y, diameter, low, high):
            stock = _bar((x, y), diameter, (low, high))
        case (x0, y0, z0, x1, y1, z1):
            stock = Stock(low=(x0, y0, z0), high=(x1, y1, z1))
    require_size(stock)
    return stock


def _bar(axis: tuple[float, float], diameter: float, ends: tuple[float, float]) -> Stock:
    """Upright bar about an axis."""
    radius = 0.5 * diameter
    return Stock(
        low=(axis[0] - radius, axis[1] - radius, ends[0]),
        high=(axis[0] + radius, axis[1] + radius, ends[1]),
        radius=radius,
    )


MOST_SPEED, MOST_CHIP = 2000.0, 100.0
"""Greatest feed that is accepted, in mm/s, and in mm per tooth or revolution."""


def feed_in(text: str) -> GivenFeed:
    """Parse a feed: a number in mm/min, or a number with its unit.

    Parameters
    ----------
    text : str
        As ``240``, ``0.004m/s``, ``0.1mm/tooth`` or ``0.2 mm/rev``.

    Returns
    -------
    GivenFeed

    Raises
    ------
    StepNcError
        When it is no number, or not within its bounds; the unit is named.
    """
    found = re.fullmatch(r"(.*?)\s*([a-z]+/[a-z]+)?\s*", text)
    written, name = found.groups() if found else ("", None)
    try:
        number = float(written)
        unit = FeedUnit(name or FeedUnit.MM_PER_MINUTE)
    except ValueError:
        known = ", ".join(unit.value for unit in FeedUnit)
        message = f"feed '{text}': expected a number in mm/min, or with a unit: {known}"
        raise StepNcError(message) from None
    to_speed = {
        FeedUnit.METRES_PER_SECOND: speed_from_m_s,
        FeedUnit.MM_PER_MINUTE: speed_from_mm_min,
    }.get(unit)
    value = number if to_speed is None else to_speed(number)
    most = MOST_CHIP if to_speed is None else MOST_SPEED
    if not 0.0 < value <= most:
        bound = most if to_speed is None else most / to_speed(1.0)
        message = f"feed {number:g} {unit.value}: it must be above 0 to {bound:g} {unit.value}"
        raise StepNcError(message)
    return GivenFeed(value=value, unit=unit)


def require_size(stock: Stock) -> None:
    """Refuse a stock that has no volume or extends too far from zero."""
    for axis, low, high in zip("xyz", stock.low, stock.high, strict=True):
        if not high - low >= LEAST_SIZE or max(abs(low), abs(high)) > FARTHEST:
            bound = f"must span at least {LEAST_SIZE:g} mm, within {FARTHEST:g} mm of zero"
            raise StepNcError(f"stock: {axis} from {low:g} to {high:g} mm: {bound}")


def program_numbers_in(words: tuple[str, ...]) -> frozenset[int]:
    """Numbers of programs given as ``P9023``, ``O9023`` or ``9023``.

    Raises
    ------
    StepNcError
        When a word is no program number.
    """
    numbers = [word.upper().removeprefix("P").removeprefix("O") for word in words]
    for word, number in zip(words, numbers, strict=True):
        if not number.isdecimal():
            raise StepNcError(f"program '{word}': expected a number, such as P9023")
    return frozenset(map(int, numbers))


def tool_numbers_in(words: tuple[str, ...]) -> frozenset[int]:
    """Numbers of tools given as ``T3`` or ``3``.

    Raises
    ------
    StepNcError
        When a word is no tool number.
    """
    numbers = [word.upper().removeprefix("T") for word in words]
    for word, number in zip(words, numbers, strict=True):
        if not number.isdecimal():
            raise StepNcError(f"tool '{word}': expected a number, such as T3")
    return frozenset(map(int, numbers))
