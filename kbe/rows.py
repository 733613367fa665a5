"""Nouns and rows: the attributes of a dataclass, flat, as columns whose names carry the unit.

The dataclass is the only declaration. ``force.measured`` of an outcome becomes the column
``force_measured_n``; a noun within a noun gives its own attributes, and when it is optional it
is absent when its first column is.
"""

import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from datetime import UTC, datetime
from enum import StrEnum
from itertools import chain, count
from math import isfinite
from types import NoneType
from typing import Any, Generic, TypeVar, cast, get_args, get_type_hints

from stepnc_model.outcome import LearnedCorrection, ProcessOutcome

T = TypeVar("T")
Value = str | float | int | bool | datetime | None

UNITS = {
    "length": "mm",
    "width": "mm",
    "total_depth": "mm",
    "specific_force": "n_mm2",
    "cutting_speed": "mm_s",
    "step_depth": "mm",
    "feed_per_tooth": "mm",
    "roughness": "mm",
    "time": "s",
    "force": "n",
    "feed": "mm_s",
    "force_bound": "n",
}
"""ending of the columns of an attribute, and of all columns of a quantity"""

NAMES = {"context": "", "specific_force": "k_c11"}
"""attributes that have another name as a column, or none"""

EVALUATED = ("roughness", "time", "force", "feed")
"""quantities of an outcome whose deviation is stored with it"""

GREATEST_DEVIATION = 1e100
"""what lies beyond is no measurement, and its square would leave the range of a double"""


@dataclass(frozen=True, slots=True, kw_only=True)
class AttributeColumn:
    """One attribute that becomes one column."""

    path: tuple[str, ...]
    """names of the attributes that lead to it"""
    name: str
    """Name of the column"""
    kind: type
    """str, float, int, bool or datetime"""
    is_optional: bool


class RowLayout(Generic[T]):
    """A noun as columns, and back.

    Examples
    --------
    >>> [leaf.name for leaf in CORRECTION.leaves][:4]
    ['machine', 'material', 'tool', 'log_centre']
    """

    def __init__(self, noun: type[T]) -> None:
        self.leaves = tuple(_leaves(noun, path=(), is_optional=False))
        self._writers = tuple((leaf.name, _writer(leaf)) for leaf in self.leaves)
        self._read = _reader(noun, count())

    def row(self, value: T) -> dict[str, Value]:
        """Columns of a noun.

        Raises
        ------
        ValueError
            When a number is not finite, a time has no zone, or a text cannot be stored.
        """
        return {name: write(value) for name, write in self._writers}

    def noun(self, columns: Sequence[Any]) -> T:
        """The noun of a row, in the order of :attr:`leaves`."""
        return cast(T, self._read(columns))


def outcome_row(outcome: ProcessOutcome) -> dict[str, Value]:
    """Columns of an outcome and of its deviations.

    Raises
    ------
    ValueError
        As :meth:`RowLayout.row`, and for a deviation that no measurement can have.
    """
    row = OUTCOME.row(outcome)
    for name in EVALUATED:
        deviation = getattr(outcome, name).deviation
        if deviation is not None and not abs(deviation) <= GREATEST_DEVIATION:
            raise ValueError(f"{name}: no measurement deviates by a factor of {deviation}")
        row[f"{name}_deviation"] = deviation
    return row


def _plain(hint: Any) -> tuple[Any, bool]:
    """A type hint without ``| None``, and whether it had it."""
    options = [each for each in get_args(hint) if each is not NoneType]
    return (options[0], True) if options else (hint, False)


def _leaves(
    noun: type, *, path: tuple[str, ...], is_optional: bool
) -> Iterator[AttributeColumn]:
    """Attributes of a noun, and of the nouns within it, in order."""
    hints = get_type_hints(noun)
    for field in fields(cast(Any, noun)):
        kind, can_lack = _plain(hints[field.name])
        below, lacks = (*path, field.name), is_optional or can_lack
        if is_dataclass(kind):
            yield from _leaves(cast(type, kind), path=below, is_optional=lacks)
        else:
            stored = str if issubclass(kind, StrEnum) else kind
            yield AttributeColumn(path=below, name=_name(below), kind=stored, is_optional=lacks)


def _name(path: tuple[str, ...]) -> str:
    """Column of an attribute: the path to it and its unit."""
    units = [UNITS[part] for part in path if part in UNITS][:1]
    parts = [NAMES.get(part, part) for part in path]
    return "_".join(part for part in parts + units if part)


def _writer(leaf: AttributeColumn) -> Callable[[object], Value]:
    """Getter of a column's value from a dataclass."""
    check = CHECKS[leaf.kind]

    def write(noun: object) -> Value:
        value: Any = noun
        for part in leaf.path:
            value = getattr(value, part)
            if value is None and leaf.is_optional:
                return None
        return check(leaf.name, value)

    return write


def _reader(noun: type, columns: Iterator[int]) -> Callable[[Sequence[Any]], object]:
    """Constructor of a dataclass from a row; takes its columns in order."""
    hints = get_type_hints(noun)
    readers: dict[str, Callable[[Sequence[Any]], object]] = {}
    for field in fields(cast(Any, noun)):
        kind, can_lack = _plain(hints[field.name])
        if is_dataclass(kind):
            readers[field.name] = _nested(cast(type, kind), columns, is_optional=can_lack)
        elif issubclass(kind, StrEnum):
            readers[field.name] = _choice(kind, next(columns))
        else:
            readers[field.name] = operator.itemgetter(next(columns))
    pairs = tuple(readers.items())
    return lambda row: noun(**{name: read(row) for name, read in pairs})


def _nested(
    noun: type, columns: Iterator[int], *, is_optional: bool
) -> Callable[[Sequence[Any]], object]:
    """Reader of a noun within a noun."""
    first = next(columns)
    read = _reader(noun, chain([first], columns))
    return (lambda row: None if row[first] is None else read(row)) if is_optional else read


def _choice(kind: type[StrEnum], column: int) -> Callable[[Sequence[Any]], object]:
    """Reader of one of some words, or of none."""
    return lambda row: None if row[column] is None else kind(row[column])


def storable_text(name: str, value: Any) -> str:
    """Text that every database takes."""
    text = str(value)
    if "\0" in text or (not text.isascii() and _has_surrogate(text)):
        raise ValueError(f"{name}: {text!r} cannot be stored as text")
    return text


def _has_surrogate(text: str) -> bool:
    """Whether the text has no form in UTF-8."""
    return any("\ud800" <= letter <= "\udfff" for letter in text)


def _number(name: str, value: Any) -> float:
    """Finite number."""
    number = float(value)
    if not isfinite(number):
        raise ValueError(f"{name}: {number} is no number to keep")
    # SQLite does not keep the sign of zero.
    return number + 0.0


def _whole(name: str, value: Any) -> int:
    """Whole number of 64 bits."""
    number = operator.index(value)
    if not -(2**63) <= number < 2**63:
        raise ValueError(f"{name}: {number} is no number to keep")
    return number


def _truth(_name: str, value: Any) -> bool:
    """Truth value."""
    return bool(value)


def _time(name: str, value: Any) -> datetime:
    """Point in time."""
    return utc(name, value)


def utc(name: str, time: datetime) -> datetime:
    """A time in UTC.

    Raises
    ------
    ValueError
        When it has no zone.
    """
    if time.tzinfo is None:
        raise ValueError(f"{name}: {time} has no zone")
    return time.astimezone(UTC)


CHECKS: Mapping[type, Callable[[str, Any], Value]] = {
    str: storable_text,
    float: _number,
    int: _whole,
    bool: _truth,
    datetime: _time,
}

OUTCOME = RowLayout(ProcessOutcome)
CORRECTION = RowLayout(LearnedCorrection)
