"""Lengths with tolerances and named parameters (ISO 14649-10)."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity, entity
from stepnc_model.entities.enums import FittingType
from stepnc_model.part21.values import Ref


@entity
class PlusMinusValue(Entity):
    """Tolerance by its limits, mm; both are written as positive numbers."""

    upper_limit: float
    lower_limit: float
    significant_digits: int


@entity
class LimitsAndFits(Entity):
    """Tolerance by deviation and grade of ISO 286.

    Both are of the type ``length_measure``, which cannot hold the letters of ISO 286; files
    that write 'H' and 'IT7' are read as well.
    """

    deviation: float | str
    grade: float | str
    its_fitting_type: FittingType | None = None


@entity
class TolerancedLengthMeasure(Entity):
    """Length in mm and what it may deviate."""

    theoretical_size: float
    implicit_tolerance: Ref[PlusMinusValue | LimitsAndFits]


@entity
class PropertyParameter(Entity):
    """Named property; abstract in the standard of 2004, written as such in drafts."""

    parameter_name: str


@entity
class DescriptiveParameter(PropertyParameter):
    """Property by a text."""

    descriptive_string: str


@entity
class NumericParameter(PropertyParameter):
    """Property by a number with its unit."""

    its_parameter_value: float
    its_parameter_unit: str
