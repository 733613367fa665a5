"""Lengths with tolerances, parameters, variables and conditions on them (ISO 14649-10)."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import FittingType
from stepnc_model.part21.values import Ref


class PlusMinusValue(Entity):
    """Tolerance by its limits, mm; both are written as positive numbers."""

    upper_limit: float
    lower_limit: float
    significant_digits: int


class LimitsAndFits(Entity):
    """Tolerance by deviation and grade of ISO 286.

    Both are of the type ``length_measure``, which cannot hold the letters of ISO 286; files
    that write 'H' and 'IT7' are read as well.
    """

    deviation: float | str
    grade: float | str
    its_fitting_type: FittingType | None = None


class TolerancedLengthMeasure(Entity):
    """Length in mm and what it may deviate."""

    theoretical_size: float
    implicit_tolerance: Ref[PlusMinusValue | LimitsAndFits]


class PropertyParameter(Entity):
    """Named property; abstract in the standard of 2004, written as such in drafts."""

    parameter_name: str


class DescriptiveParameter(PropertyParameter):
    """Property by a text."""

    descriptive_string: str


class NumericParameter(PropertyParameter):
    """Property by a number with its unit."""

    its_parameter_value: float
    its_parameter_unit: str


class NcVariable(Entity):
    """Variable of the control."""

    its_name: str
    initial_value: float | None = None


class NcConstant(Entity):
    """Constant of the control."""

    its_name: str
    initial_value: float | None = None


class BooleanExpression(Entity, abstract=True):
    """Expression that is true or false when the program runs."""


class UnaryBooleanExpression(BooleanExpression, abstract=True):
    """Expression of one operand."""

    operand: Ref[BooleanExpression]


class NotExpression(UnaryBooleanExpression):
    """True when its operand is false."""


class BinaryBooleanExpression(BooleanExpression, abstract=True):
    """Expression of two operands."""

    operand1: Ref[BooleanExpression]
    operand2: Ref[BooleanExpression]


class XorExpression(BinaryBooleanExpression):
    """True when exactly one operand is true."""


class MultipleArityBooleanExpression(BooleanExpression, abstract=True):
    """Expression of two or more operands."""

    operands: tuple[Ref[BooleanExpression], ...]


class AndExpression(MultipleArityBooleanExpression):
    """True when all operands are true."""


class OrExpression(MultipleArityBooleanExpression):
    """True when an operand is true."""


class ComparisonExpression(BooleanExpression, abstract=True):
    """Variable against a variable or a constant."""

    operand1: Ref[NcVariable]
    operand2: Ref[NcVariable | NcConstant]


class ComparisonEqual(ComparisonExpression):
    """First equals second."""


class ComparisonNotEqual(ComparisonExpression):
    """First differs from second."""


class ComparisonGreater(ComparisonExpression):
    """First is above second."""


class ComparisonGreaterEqual(ComparisonExpression):
    """First is at or above second."""


class ComparisonLess(ComparisonExpression):
    """First is below second."""


class ComparisonLessEqual(ComparisonExpression):
    """First is at or below second."""
