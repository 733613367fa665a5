"""Typed reading of the library's TOML files: keys by name, numbers against a range.

A :class:`Table` remembers what was asked for. What nobody asked for is an error, so a
misspelt limit is never silently without effect. Numbers come back in the unit that the key
names; the caller converts.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import isfinite
from pathlib import Path
from typing import TypeVar

from simulator.errors import LibraryError
from simulator.toml_bounds import MOST_BYTES, require_bounded

LONGEST_SHOWN = 80
"""letters of a value or a key in a message"""

Choice = TypeVar("Choice", bound=StrEnum)


@dataclass(frozen=True, slots=True, kw_only=True)
class Range:
    """Values that a key may have, both ends included."""

    low: float
    high: float
    unit: str = ""
    """as the user reads it; empty for a ratio"""

    def __str__(self) -> str:
        return f"{self.low:g} to {self.quantity(self.high)}"

    def quantity(self, value: float) -> str:
        """``value`` with the unit."""
        return f"{value:g} {self.unit}".rstrip()

    def complaint(self, value: float) -> str:
        """Fault of ``value`` in words; empty when there is none."""
        if not isfinite(value):
            return f"{value} is no finite number; expected {self}"
        if value < self.low:
            return f"{self.quantity(value)} is below {self.quantity(self.low)}"
        if value > self.high:
            return f"{self.quantity(value)} exceeds {self.quantity(self.high)}"
        return ""


class Table:
    """One table of a file; remembers which of its keys were read.

    Parameters
    ----------
    content : mapping
        Keys and values as the parser gave them.
    path : Path
        The file, for messages.
    name : str
        Place of the table in the file, ``spindle.curve[2]``; empty for the root.
    """

    def __init__(self, content: Mapping[str, object], *, path: Path, name: str = "") -> None:
        self.path = path
        self._content = content
        self._name = name
        self._read: set[str] = set()
        self._children: list[Table] = []

    def __contains__(self, key: str) -> bool:
        if key not in self._content:
            self._read.add(key)  # named among the known ones
        return key in self._content

    def error(self, key: str, message: str) -> LibraryError:
        """The error that names this file and ``key``."""
        place = f"{self._name}.{key}" if self._name and key else self._name or key
        return LibraryError(message, path=str(self.path), key=_cut(place))

    def text(self, key: str) -> str:
        """A text that must be there; it may be empty."""
        value = self._take(key, "a text")
        if not isinstance(value, str):
            raise self.error(key, f"{_shown(value)} is no text")
        return value

    def texts(self, key: str) -> tuple[str, ...]:
        """A list of texts; empty when the key is absent."""
        if key not in self:
            return ()
        values = self._take(key, "a list of texts")
        if not isinstance(values, list) or not all(isinstance(value, str) for value in values):
            raise self.error(key, f"{_shown(values)} is no list of texts")
        return tuple(values)

    def choice(self, key: str, kind: type[Choice]) -> Choice:
        """One of the values of an enumeration."""
        value = self.text(key)
        try:
            return kind(value)
        except ValueError:
            known = ", ".join(kind)
            raise self.error(key, f"'{_cut(value)}' is none of {known}") from None

    def flag(self, key: str) -> bool:
        """``true`` or ``false``; false where the key is absent."""
        if key not in self:
            return False
        value = self._take(key, "true or false")
        if not isinstance(value, bool):
            raise self.error(key, f"{_shown(value)} is neither true nor false")
        return value

    def number(self, key: str, allowed: Range) -> float:
        """A number that must be there and in its range."""
        value = self._take(key, f"a number, {allowed}")
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.error(key, f"{_shown(value)} is no number; expected {allowed}")
        try:
            number = float(value)
        except OverflowError:
            what = f"{_shown(value)} is beyond the range of a number; expected {allowed}"
            raise self.error(key, what) from None
        if complaint := allowed.complaint(number):
            raise self.error(key, complaint)
        return number

    def optional_number(self, key: str, allowed: Range) -> float | None:
        """A number in its range, or ``None`` when the key is absent."""
        return self.number(key, allowed) if key in self else None

    def window(
        self, low_key: str, high_key: str, *, allowed: Range
    ) -> tuple[float | None, float | None]:
        """Two optional numbers, the first not above the second."""
        low = self.optional_number(low_key, allowed)
        high = self.optional_number(high_key, allowed)
        if low is not None and high is not None and low > high:
            raise self.error(
                low_key,
                f"{allowed.quantity(low)} exceeds {high_key} {allowed.quantity(high)}",
            )
        return low, high

    def table(self, key: str) -> "Table":
        """A table that must be there."""
        return self._child(key, self._take(key, "a table"), name=self._place(key))

    def tables(self, key: str) -> tuple["Table", ...]:
        """An array of tables; empty when the key is absent."""
        if key not in self:
            return ()
        rows = self._take(key, "an array of tables")
        if not isinstance(rows, list):
            raise self.error(key, f"is no array of tables; write [[{self._place(key)}]]")
        return tuple(
            self._child(key, row, name=f"{self._place(key)}[{index}]")
            for index, row in enumerate(rows, start=1)
        )

    def finish(self) -> None:
        """Refuse unknown keys, here and in the tables below."""
        for key in self._content:
            if key not in self._read:
                known = ", ".join(sorted(self._read))
                raise self.error(key, f"unknown key; known here: {known}")
        for child in self._children:
            child.finish()

    def _place(self, key: str) -> str:
        """Name of a table below this one."""
        return f"{self._name}.{key}" if self._name else key

    def _take(self, key: str, expected: str) -> object:
        """Raw value of a key that must be there; the key counts as read."""
        self._read.add(key)
        if key not in self._content:
            raise self.error(key, f"missing; expected {expected}")
        return self._content[key]

    def _child(self, key: str, content: object, *, name: str) -> "Table":
        """A table below this one."""
        if not isinstance(content, dict):
            raise self.error(key, f"{_shown(content)} is no table")
        child = Table(content, path=self.path, name=name)
        self._children.append(child)
        return child


def read_toml(path: Path) -> Table:
    """Root table of a TOML file."""
    return Table(_parsed(read_text(path), path), path=path)


def read_toml_head(path: Path) -> Table:
    """Keys of the root alone, without the tables below.

    In TOML the keys of the root stand before the first table header, so the rest need not be
    parsed: names of all materials are read five times faster than the materials themselves.
    """
    head = read_text(path).split("\n[", maxsplit=1)[0]
    return Table(_parsed(head, path), path=path)


def read_text(path: Path) -> str:
    """Text of a library file in UTF-8."""
    try:
        return read_bounded(path).decode("utf-8").replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as error:
        raise LibraryError(f"is no UTF-8 text: {error.reason}", path=str(path)) from error


def read_bounded(path: Path) -> bytes:
    """Bytes of a library file, which is small."""
    try:
        if path.is_char_device():
            raise LibraryError("is a device, no file", path=str(path))
        with path.open("rb") as file:
            data = file.read(MOST_BYTES + 1)
    except OSError as error:
        raise LibraryError(f"cannot be read: {error.strerror}", path=str(path)) from error
    if len(data) > MOST_BYTES:
        raise LibraryError(f"is larger than {MOST_BYTES} bytes, the most", path=str(path))
    return data


def _parsed(text: str, path: Path) -> dict[str, object]:
    """Content of a TOML text."""
    require_bounded(text, path)
    try:
        return tomllib.loads(text)
    except ValueError as error:
        # Also a date that is in no calendar, which is no TOMLDecodeError.
        raise LibraryError(f"is no TOML: {error}", path=str(path)) from error


def _shown(value: object) -> str:
    """A value for a message."""
    return _cut(repr(value))


def _cut(text: str) -> str:
    """A text that may be long, for a message."""
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 1]}…"
