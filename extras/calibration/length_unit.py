"""Unit of lengths that a user enters."""

from enum import StrEnum

from stepnc_model.units import inches_from_mm, mm_from_inches


class LengthUnit(StrEnum):
    """Unit of lengths that a user enters.

    Examples
    --------
    >>> LengthUnit.INCH.to_mm(2.0)
    50.8
    """

    INCH = "in"
    MILLIMETRE = "mm"

    def to_mm(self, length: float) -> float:
        """Length in mm."""
        return mm_from_inches(length) if self is LengthUnit.INCH else length

    def from_mm(self, length: float) -> float:
        """Length in this unit from mm."""
        return inches_from_mm(length) if self is LengthUnit.INCH else length
