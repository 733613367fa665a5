"""Mapping between dataclasses and database rows, with units in the column names.

The dataclass is the only declaration. ``force.measured`` of an outcome becomes the column
``force_measured_n``; a nested dataclass gives its own attributes, and when it is optional it
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
"""Unit suffixes of the columns of an attribute, and of all columns of a quantity."""

NAMES = {"context": "", "specific_force": "k_c11"}
"""Attributes whose column has another name, or none."""

EVALUATED = ("roughness", "time", "force", "feed")
"""Quantities of an outcome whose deviation is stored with it."""

IDENTITY = ("run", "machine", "program", "workingstep", "sequence")
"""Columns that say which outcome a row is; no two rows have the same values in all of them.

Ids of runs of real machines are given by people, who may count from 1 on every machine.
"""

CIRCUMSTANCES = ("trace", "recorded_at", "recorded_by")
"""Columns that say how an outcome was recorded; they may differ when it is recorded again."""

GREATEST_DEVIATION = 1e100
"""Greatest deviation that is stored; beyond it, the square could overflow a double."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AttributeColumn:
    """Attribute that becomes one column."""

    path: tuple[str, ...]
    """Names of the attributes that lead to it."""
    name: str
    """Name of the database column."""
    kind: type
    """Type of the value: str, float, int, bool or datetime."""
    is_optional: bool


class RowLayout(Generic[T]):
    """Conversion of a dataclass to columns, and back.

    Examples
    --------
    >>> [leaf.name for leaf in CORRECTION.leaves][:4]
    ['machine', 'material', 'tool', 'log_centre']
    """

    def __init__(self, noun: type[T]) -> None:
        self.leaves = tuple(_leaves(noun, path=(), is_optional=False))
        self.readers = tuple((leaf, _writer(leaf)) for leaf in self.leaves)
        self._read = _reader(noun, count())

    def row(self, value: T) -> dict[str, Value]:
        """Convert a dataclass instance to its columns.

        Raises
        ------
        ValueError
            When a number is not finite, a time has no zone, or a text cannot be stored.
        """
        return {leaf.name: write(value) for leaf, write in self.readers}

    def noun(self, columns: Sequence[Any]) -> T:
        """Convert a row, in the order of :attr:`leaves`, to a dataclass instance."""
        return cast(T, self._read(columns))


def outcome_row(outcome: ProcessOutcome) -> dict[str, Value]:
    """Convert an outcome to its columns, with its deviations.

    Raises
    ------
    ValueError
        As :meth:`RowLayout.row`, and for an implausibly large deviation.
    """
    row = OUTCOME.row(outcome)
    for name in EVALUATED:
        deviation = getattr(outcome, name).deviation
        if deviation is not None and not abs(deviation) <= GREATEST_DEVIATION:
            raise ValueError(f"{name}: implausible deviation by a factor of {deviation}")
        row[f"{name}_deviation"] = deviation
    return row


def what_differs(row: Mapping[str, Value], other: Mapping[str, Value]) -> str:
    """First column in which two rows of an outcome disagree; empty if they say the same."""
    counted = (leaf.name for leaf in OUTCOME.leaves if leaf.name not in CIRCUMSTANCES)
    return next((name for name in counted if row[name] != other[name]), "")


def _plain(hint: Any) -> tuple[Any, bool]:
    """Type hint without ``| None``, and whether ``None`` was allowed."""
    options = [each for each in get_args(hint) if each is not NoneType]
    return (options[0], True) if options else (hint, False)


def _leaves(
    noun: type, *, path: tuple[str, ...], is_optional: bool
) -> Iterator[AttributeColumn]:
    """Attributes of a dataclass and of its nested dataclasses, in order."""
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
    """Column name of an attribute: its path and its unit."""
    units = [UNITS[part] for part in path if part in UNITS][:1]
    parts = [NAMES.get(part, part) for part in path]
    return "_".join(part for part in parts + units if part)


def _writer(leaf: AttributeColumn) -> Callable[[object], Value]:
    """Function that reads a column's value from a dataclass instance."""
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
    """Function that builds a dataclass instance from a row; consumes its columns in order."""
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
    """Reader of a nested dataclass."""
    first = next(columns)
    read = _reader(noun, chain([first], columns))
    return (lambda row: None if row[first] is None else read(row)) if is_optional else read


def _choice(kind: type[StrEnum], column: int) -> Callable[[Sequence[Any]], object]:
    """Reader of an enumeration value, or of None."""
    return lambda row: None if row[column] is None else kind(row[column])


def storable_text(name: str, value: Any) -> str:
    """Check that a text can be stored by every database."""
    text = str(value)
    if "\0" in text or (not text.isascii() and _has_surrogate(text)):
        raise ValueError(f"{name}: {text!r} cannot be stored as text")
    return text


def _has_surrogate(text: str) -> bool:
    """True if the text contains surrogates, which UTF-8 cannot encode."""
    return any("\ud800" <= letter <= "\udfff" for letter in text)


def _number(name: str, value: Any) -> float:
    """Check that a number is finite."""
    number = float(value)
    if not isfinite(number):
        raise ValueError(f"{name}: {number} is not a finite number")
    # SQLite does not keep the sign of zero.
    return number + 0.0


def _whole(name: str, value: Any) -> int:
    """Check that a whole number fits into 64 bits."""
    number = operator.index(value)
    if not -(2**63) <= number < 2**63:
        raise ValueError(f"{name}: {number} does not fit into 64 bits")
    return number


def _truth(_name: str, value: Any) -> bool:
    """Convert a value to bool."""
    return bool(value)


def _time(name: str, value: Any) -> datetime:
    """Convert a point in time to UTC."""
    return utc(name, value)


def utc(name: str, time: datetime) -> datetime:
    """Convert a time to UTC.

    Raises
    ------
    ValueError
        When it has no time zone.
    """
    if time.tzinfo is None:
        raise ValueError(f"{name}: {time} has no time zone")
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
