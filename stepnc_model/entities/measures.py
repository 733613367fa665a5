"""Lengths with tolerances, parameters, variables and conditions on them (ISO 14649-10)."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import FittingType
from stepnc_model.part21.values import Ref


class PlusMinusValue(Entity):
    """Tolerance given by its limits, mm; both are written as positive numbers."""

    upper_limit: float
    lower_limit: float
    significant_digits: int


class LimitsAndFits(Entity):
    """Tolerance given by deviation and grade of ISO 286.

    Both attributes are of type ``length_measure``, which cannot hold the letters of ISO 286;
    files that write 'H' and 'IT7' are read as well.
    """

    deviation: float | str
    grade: float | str
    its_fitting_type: FittingType | None = None


class TolerancedLengthMeasure(Entity):
    """Length in mm with its tolerance."""

    theoretical_size: float
    implicit_tolerance: Ref[PlusMinusValue | LimitsAndFits]


class PropertyParameter(Entity):
    """Named property; abstract in the standard of 2004, instantiated in drafts."""

    parameter_name: str


class DescriptiveParameter(PropertyParameter):
    """Property given by a text."""

    descriptive_string: str


class NumericParameter(PropertyParameter):
    """Property given by a number with its unit."""

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
    """Boolean expression, evaluated while the program runs."""


class UnaryBooleanExpression(BooleanExpression, abstract=True):
    """Boolean expression with one operand."""

    operand: Ref[BooleanExpression]


class NotExpression(UnaryBooleanExpression):
    """Negation: true if its operand is false."""


class BinaryBooleanExpression(BooleanExpression, abstract=True):
    """Boolean expression with two operands."""

    operand1: Ref[BooleanExpression]
    operand2: Ref[BooleanExpression]


class XorExpression(BinaryBooleanExpression):
    """Exclusive or: true if exactly one operand is true."""


class MultipleArityBooleanExpression(BooleanExpression, abstract=True):
    """Boolean expression with two or more operands."""

    operands: tuple[Ref[BooleanExpression], ...]


class AndExpression(MultipleArityBooleanExpression):
    """Conjunction: true if all operands are true."""


class OrExpression(MultipleArityBooleanExpression):
    """Disjunction: true if at least one operand is true."""


class ComparisonExpression(BooleanExpression, abstract=True):
    """Comparison of a variable with a variable or a constant."""

    operand1: Ref[NcVariable]
    operand2: Ref[NcVariable | NcConstant]


class ComparisonEqual(ComparisonExpression):
    """Comparison: first operand equals second."""


class ComparisonNotEqual(ComparisonExpression):
    """Comparison: first operand differs from second."""


class ComparisonGreater(ComparisonExpression):
    """Comparison: first operand is greater than second."""


class ComparisonGreaterEqual(ComparisonExpression):
    """Comparison: first operand is greater than or equal to second."""


class ComparisonLess(ComparisonExpression):
    """Comparison: first operand is less than second."""


class ComparisonLessEqual(ComparisonExpression):
    """Comparison: first operand is less than or equal to second."""
