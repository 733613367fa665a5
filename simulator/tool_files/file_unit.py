"""Units of length of a tool file, and the sizes that a tool's name states."""

import re
from collections.abc import Iterator
from enum import StrEnum

from stepnc_model.units import mm_from_inches

ALIKE = 0.02
"""Relative difference below which two sizes count as the same; drills are named by fractions
of an inch that their diameters round."""

_FRACTION = r"(?:(?P<whole>\d{1,3})[-\s])?(?P<top>\d{1,3})/(?P<bottom>\d{1,3})(?![\d/])"
_DECIMAL = r"(?P<size>\d{0,5}\.?\d{1,6})\s?(?P<unit>mm\b|inch(?:es)?\b|in\b|\")"
_SIZE = re.compile(rf"(?<![\w.])(?:{_FRACTION}|{_DECIMAL})", re.IGNORECASE)


class FileUnit(StrEnum):
    """Unit of the lengths of a tool file."""

    MM = "mm"
    INCH = "inch"

    def mm(self, length: float) -> float:
        """Length in mm."""
        return mm_from_inches(length) if self is FileUnit.INCH else length


def named_sizes(name: str) -> Iterator[float]:
    """Sizes with a unit in the name of a tool, mm; fractions without one are inches."""
    for found in _SIZE.finditer(name):
        if found["top"]:
            bottom = int(found["bottom"])
            if bottom:
                yield mm_from_inches(int(found["whole"] or 0) + int(found["top"]) / bottom)
            continue
        unit = FileUnit.MM if found["unit"].lower() == "mm" else FileUnit.INCH
        yield unit.mm(float(found["size"]))


def other_size(name: str, diameter: float) -> float | None:
    """Size in a tool's name from which its diameter differs as an inch does from a millimetre.

    Parameters
    ----------
    diameter : float, mm

    Returns
    -------
    float or None, mm
        None if no size in the name tells another unit.
    """
    sizes = [size for size in named_sizes(name) if size > 0.0]
    if any(_is_like(size, diameter) for size in sizes):
        return None
    inch = mm_from_inches(1.0)
    for size in sizes:
        if _is_like(size, inch * diameter) or _is_like(inch * size, diameter):
            return size
    return None


def _is_like(one: float, other: float) -> bool:
    return abs(one - other) <= ALIKE * other
