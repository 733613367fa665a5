"""Offsets, lines and columns of a file, and deviations from ISO 10303-21 at a place.

A tolerant reader must not be made to describe millions of faults. The number of deviations
outside instances is limited; within an instance, the first are kept and the others counted.
"""

from array import array
from dataclasses import dataclass
from typing import Protocol

from stepnc_model.errors import Part21Error, Severity

_BLOCK = 1 << 14


@dataclass(frozen=True, slots=True, kw_only=True)
class SyntaxSlip:
    """Deviation from the syntax at an offset, to be turned into a finding by the reader."""

    offset: int
    """Byte offset in the file or in the parsed text."""
    message: str
    severity: Severity = Severity.WARNING


class Lines:
    """Line numbers of a file, from line breaks counted once per block.

    Lines end in LF or CR LF; a file that has neither may end them in CR.
    """

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._break = line_break(data)[-1:]
        self._before = array("q", [0])
        for start in range(0, len(data), _BLOCK):
            count = data.count(self._break, start, start + _BLOCK)
            self._before.append(self._before[-1] + count)

    def line(self, offset: int) -> int:
        """Line number of a byte offset, counted from 1."""
        block = offset // _BLOCK
        return self._before[block] + self._data.count(self._break, block * _BLOCK, offset) + 1


def line_break(data: bytes) -> bytes:
    """Bytes that end a line in this file; LF if it has only one line."""
    first = data.find(b"\n")
    if first > 0 and data[first - 1 : first] == b"\r":
        return b"\r\n"
    if first < 0 and b"\r" in data:
        return b"\r"
    return b"\n"


def error_at(data: bytes, offset: int, message: str) -> Part21Error:
    """Error that names the line and column of an offset."""
    newline = line_break(data)[-1:]
    line = data.count(newline, 0, offset) + 1
    column = offset - data.rfind(newline, 0, offset)
    return Part21Error(message, line=line, column=column)


def excerpt(data: bytes, start: int, end: int) -> str:
    """At most forty characters of the file on one line, for a message."""
    text = data[start : min(end, start + 40)].decode("latin-1")
    shown = " ".join("".join(c if c.isprintable() else " " for c in text).split())
    return f"'{shown}…'" if end - start > 40 else f"'{shown}'"


MOST_OF_FILE = 10_000
"""Greatest number of deviations outside instances; real files have a dozen at most."""

MOST_OF_INSTANCE = 100
"""Greatest number of deviations described per instance."""


class Slips(Protocol):
    """Collector of syntax deviations, such as a list."""

    def append(self, slip: SyntaxSlip, /) -> None:
        """Record a syntax deviation."""


class FileSlips:
    """Deviations outside the instances of a file; too many of them are an error.

    Parameters
    ----------
    data : bytes
        Contents of the file, for the place of the error.
    """

    def __init__(self, data: bytes) -> None:
        self.noted: list[SyntaxSlip] = []
        self._data = data

    def append(self, slip: SyntaxSlip, /) -> None:
        """Record a syntax deviation.

        Raises
        ------
        Part21Error
            If there are more than ``MOST_OF_FILE``.
        """
        if len(self.noted) == MOST_OF_FILE:
            message = (
                f"more than {MOST_OF_FILE} deviations from ISO 10303-21: this is not a usable "
                f"exchange structure; the last one: {slip.message}"
            )
            raise error_at(self._data, slip.offset, message)
        self.noted.append(slip)


class InstanceSlips:
    """Deviations of one instance: the first ones, and their total number."""

    def __init__(self) -> None:
        self.noted: list[SyntaxSlip] = []
        self.count = 0

    def append(self, slip: SyntaxSlip, /) -> None:
        """Add a deviation, or only count it if there are too many."""
        self.count += 1
        if self.count <= MOST_OF_INSTANCE:
            self.noted.append(slip)
