"""Variables of the control and conditions on them (ISO 14649-10)."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity, abstract, entity
from stepnc_model.part21.values import Ref


@entity
class NcVariable(Entity):
    """Variable of the control."""

    its_name: str
    initial_value: float | None = None


@entity
class NcConstant(Entity):
    """Constant of the control."""

    its_name: str
    initial_value: float | None = None


@abstract
class BooleanExpression(Entity):
    """What is true or false when the program runs."""


@abstract
class UnaryBooleanExpression(BooleanExpression):
    """Expression of one operand."""

    operand: Ref[BooleanExpression]


@entity
class NotExpression(UnaryBooleanExpression):
    """True when its operand is false."""


@abstract
class BinaryBooleanExpression(BooleanExpression):
    """Expression of two operands."""

    operand1: Ref[BooleanExpression]
    operand2: Ref[BooleanExpression]


@entity
class XorExpression(BinaryBooleanExpression):
    """True when exactly one operand is true."""


@abstract
class MultipleArityBooleanExpression(BooleanExpression):
    """Expression of two or more operands."""

    operands: tuple[Ref[BooleanExpression], ...]


@entity
class AndExpression(MultipleArityBooleanExpression):
    """True when all operands are true."""


@entity
class OrExpression(MultipleArityBooleanExpression):
    """True when an operand is true."""


@abstract
class ComparisonExpression(BooleanExpression):
    """Variable against a variable or a constant."""

    operand1: Ref[NcVariable]
    operand2: Ref[NcVariable | NcConstant]


@entity
class ComparisonEqual(ComparisonExpression):
    """First equals second."""


@entity
class ComparisonNotEqual(ComparisonExpression):
    """First differs from second."""


@entity
class ComparisonGreater(ComparisonExpression):
    """First is above second."""


@entity
class ComparisonGreaterEqual(ComparisonExpression):
    """First is at or above second."""


@entity
class ComparisonLess(ComparisonExpression):
    """First is below second."""


@entity
class ComparisonLessEqual(ComparisonExpression):
    """First is at or below second."""
