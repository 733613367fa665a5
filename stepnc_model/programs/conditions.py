"""Variables of a program and the conditions on them (ISO 14649-10), where the file states them.

A variable has its initial value until an assignment. What only the control knows, as a measured
offset, is not stated: a condition on it is refused, with the option that gives a value.
"""

import operator
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.executables import Assignment
from stepnc_model.entities.measures import (
    AndExpression,
    ComparisonEqual,
    ComparisonExpression,
    ComparisonGreater,
    ComparisonGreaterEqual,
    ComparisonLess,
    ComparisonLessEqual,
    ComparisonNotEqual,
    NcConstant,
    NcVariable,
    NotExpression,
    OrExpression,
    XorExpression,
)
from stepnc_model.errors import SchemaError
from stepnc_model.part21.values import Ref
from stepnc_model.programs.binding import Model

MAX_DEPTH = 100
"""Greatest nesting of a condition; one that contains itself would have no end."""

COMPARISONS: Mapping[type[ComparisonExpression], Callable[[float, float], bool]] = {
    ComparisonEqual: operator.eq,
    ComparisonNotEqual: operator.ne,
    ComparisonGreater: operator.gt,
    ComparisonGreaterEqual: operator.ge,
    ComparisonLess: operator.lt,
    ComparisonLessEqual: operator.le,
}


class ErrorMaker(Protocol):
    """Maker of an error about one instance of a file."""

    def __call__(self, message: str, ref: Ref[Entity], attribute: str = "", /) -> SchemaError:
        """Error with the place of the instance."""
        ...


class ProgramVariables:
    """Values of the variables while a program is walked. Running state."""

    def __init__(self, model: Model, error: ErrorMaker) -> None:
        self._model = model
        self._error = error
        self._assigned: dict[int, float] = {}

    def assign(self, ref: Ref[Entity], assignment: Assignment) -> None:
        """Give a variable its value.

        Raises
        ------
        SchemaError
            If the value is not stated.
        """
        if assignment.its_lvalue is None:
            raise self._error("the assignment has no variable", ref, "its_lvalue")
        value = self._value(assignment.its_rvalue, ref, "its_rvalue")
        self._assigned[int(assignment.its_lvalue)] = value

    def holds(self, condition: Ref[Any] | None, owner: Ref[Entity]) -> bool:
        """Evaluate a condition, of an instance that messages name where it is missing.

        Raises
        ------
        SchemaError
            If it cannot be evaluated.
        """
        return self._holds(condition, owner, {}, MAX_DEPTH)

    def _holds(
        self, ref: Ref[Any] | None, owner: Ref[Entity], known: dict[int, bool], depth: int
    ) -> bool:
        """Evaluate a condition, each shared part of it once."""
        if ref is None:
            raise self._error("a condition is missing", owner)
        if depth == 0:
            raise self._error(f"a condition is nested deeper than {MAX_DEPTH}", owner)
        if int(ref) not in known:
            expression = self._model.get(ref)
            if isinstance(expression, ComparisonExpression):
                one = self._value(expression.operand1, ref, "operand1")
                other = self._value(expression.operand2, ref, "operand2")
                known[int(ref)] = COMPARISONS[type(expression)](one, other)
            else:
                operands = _operands(expression)
                if not operands:
                    raise self._error("is not a condition that can be evaluated", ref)
                truths = [self._holds(each, ref, known, depth - 1) for each in operands]
                known[int(ref)] = _joined(expression, truths)
        return known[int(ref)]

    def _value(self, ref: Ref[Any] | None, owner: Ref[Entity], attribute: str) -> float:
        """Value of a variable or constant."""
        if ref is None:
            raise self._error("a variable or constant is missing", owner, attribute)
        if int(ref) in self._assigned:
            return self._assigned[int(ref)]
        quantity = self._model.get(ref)
        if not isinstance(quantity, (NcVariable, NcConstant)):
            raise self._error("is not a variable or constant", ref)
        if quantity.initial_value is None:
            text = f"what runs depends on '{quantity.its_name}', which only the control knows"
            raise self._error(text, ref, "initial_value")
        return float(quantity.initial_value)


def _operands(expression: Entity) -> tuple[Ref[Any] | None, ...]:
    """Conditions that a logical expression joins; empty for anything else."""
    if isinstance(expression, NotExpression):
        return (expression.operand,)
    if isinstance(expression, XorExpression):
        return expression.operand1, expression.operand2
    if isinstance(expression, (AndExpression, OrExpression)):
        return tuple(expression.operands)
    return ()


def _joined(expression: Entity, truths: Sequence[bool]) -> bool:
    """Truth of a logical expression."""
    if isinstance(expression, NotExpression):
        return not truths[0]
    if isinstance(expression, XorExpression):
        return truths[0] != truths[1]
    return all(truths) if isinstance(expression, AndExpression) else any(truths)
