"""Tolerant parser of a single instance in any condition, with an explicit stack.

It reads what :mod:`stepnc_model.part21.tidy` does not accept: complex instances, comments
between parameters, the deviations of real files. Nested lists do not use recursion.

References
----------
.. [1] ISO 10303-21:2016, 9.1 (entity instances).
"""

import re
from dataclasses import dataclass, field
from typing import TypeAlias

from stepnc_model.part21.grammar import MAX_DEPTH
from stepnc_model.part21.places import InstanceSlips, SyntaxSlip
from stepnc_model.part21.tokens import TOKEN, MalformedError, scalar, shown
from stepnc_model.part21.values import Typed, Value

Part: TypeAlias = tuple[str, tuple[Value, ...]]
"""Keyword in upper case and parameter values of one part of an instance."""


@dataclass(frozen=True, slots=True, kw_only=True)
class InstanceRecord:
    """Keyword and parameters of an instance, with its syntax deviations."""

    parts: tuple[Part, ...]
    is_complex: bool
    spans: tuple[tuple[int, int], ...]
    """Spans of the top-level parameters of a simple instance, in the text."""
    end: int
    """Offset of the bracket that closes a simple instance."""
    slips: tuple[SyntaxSlip, ...]
    """First syntax deviations found in the instance."""
    unlisted: int
    """Number of further syntax deviations, which are not listed."""
    error: SyntaxSlip | None
    """Syntax error that makes the parameters unusable, or None."""


def parse_record(text: str) -> InstanceRecord:
    """Parse ``KEYWORD(...);`` or ``(A(...)B(...));``, tolerating deviations of real files.

    Parameters
    ----------
    text : str
        Text after the ``=`` of an instance, one character per byte of the file.
    """
    parser = _Parser()
    error = None
    try:
        for match in TOKEN.finditer(text):
            parser.take(match)
        parser.finish(len(text))
    except MalformedError as malformed:
        error = malformed.slip
    return InstanceRecord(
        parts=tuple(parser.parts),
        is_complex=parser.is_complex,
        spans=tuple(parser.spans),
        end=parser.end,
        slips=tuple(parser.slips.noted),
        unlisted=parser.slips.count - len(parser.slips.noted),
        error=error,
    )


def part_spans(text: str) -> tuple[tuple[tuple[int, int], ...], ...]:
    """Spans of the parameters of each part of a complex instance, in a well-formed text.

    Parameters
    ----------
    text : str
        Text after the ``=`` of an instance, one character per byte of the file.
    """
    parts: list[list[tuple[int, int]]] = []
    depth, start, end = 0, -1, -1
    for match in TOKEN.finditer(text):
        kind = match.lastgroup
        if kind == "blank":
            continue
        closes_part = kind == "close" and depth == _PART_DEPTH
        if depth == _PART_DEPTH and (kind == "comma" or closes_part):
            if start >= 0:
                parts[-1].append((start, end))
            start = -1
        elif depth >= _PART_DEPTH:
            start, end = (match.start() if start < 0 else start), match.end()
        if kind == "open":
            depth += 1
            if depth == _PART_DEPTH:
                parts.append([])
        elif kind == "close":
            depth -= 1
    return tuple(map(tuple, parts))


_PART_DEPTH = 2
"""Number of open brackets within a part of a complex instance."""


@dataclass(slots=True, kw_only=True)
class _Frame:
    """Open bracket on the parser's stack."""

    keyword: str
    """Keyword in front of the bracket, of a part or of a typed value."""
    is_part: bool
    is_complex: bool = False
    values: list[Value] = field(default_factory=list)
    is_full: bool = False
    """Whether the last item is a value, so that a comma or a bracket must follow."""


class _Parser:
    """Stack parser of one instance, used by :func:`parse_record`."""

    def __init__(self) -> None:
        self.parts: list[Part] = []
        self.spans: list[tuple[int, int]] = []
        self.slips = InstanceSlips()
        self.is_complex = False
        self.end = -1
        self._frames: list[_Frame] = []
        self._keyword = ""
        self._is_done = False
        self._is_ended = False
        self._last_end = 0

    def take(self, match: re.Match[str]) -> None:
        """Process the next token of the instance."""
        kind = match.lastgroup
        if kind == "blank":
            return
        if self._is_ended or (self._is_done and kind != "semicolon"):
            raise MalformedError(match.start(), f"{shown(match)!r} after the closing bracket")
        if kind == "open":
            self._open(match)
        elif kind == "close":
            self._close(match)
        elif kind == "comma":
            self._comma(match)
        elif kind == "semicolon":
            self._semicolon(match)
        elif kind == "keyword":
            self._begin_keyword(match)
        else:
            self._add(scalar(match, slips=self.slips), match)
        self._last_end = match.end()

    def finish(self, offset: int) -> None:
        """Check that the text contained a whole instance."""
        if not self._is_done:
            raise MalformedError(offset, "the instance ends before its brackets close")

    def _begin_keyword(self, match: re.Match[str]) -> None:
        self._expect_value(match)
        self._keyword = match[0].upper()
        self._note_start(match)

    def _open(self, match: re.Match[str]) -> None:
        frames = self._frames
        if len(frames) > MAX_DEPTH:
            raise MalformedError(match.start(), f"lists nested deeper than {MAX_DEPTH}")
        if not self._keyword:
            self._expect_value(match)
            self._note_start(match)
        is_outermost = not frames
        is_complex = is_outermost and not self._keyword
        is_part = is_outermost or frames[-1].is_complex
        if is_part and not is_complex and not self._keyword:
            raise MalformedError(match.start(), "an entity name is missing before '('")
        self.is_complex = self.is_complex or is_complex
        frames.append(_Frame(keyword=self._keyword, is_part=is_part, is_complex=is_complex))
        self._keyword = ""

    def _close(self, match: re.Match[str]) -> None:
        if not self._frames:
            raise MalformedError(match.start(), "')' without an open bracket")
        frame = self._frames.pop()
        if frame.values and not frame.is_full:
            raise MalformedError(match.start(), "a value is missing before ')'")
        if frame.is_complex:
            self._is_done = True
        elif frame.is_part:
            self._close_part(frame, match)
        elif frame.keyword:
            if len(frame.values) != 1:
                raise MalformedError(match.start(), f"{frame.keyword} must hold one value")
            self._put(Typed(frame.keyword, frame.values[0]))
        else:
            self._put(tuple(frame.values))

    def _close_part(self, frame: _Frame, match: re.Match[str]) -> None:
        self.parts.append((frame.keyword, tuple(frame.values)))
        if self._frames:
            return
        self._note_end()
        self.end = match.start()
        self._is_done = True

    def _comma(self, match: re.Match[str]) -> None:
        frame = self._frames[-1] if self._frames else None
        if frame is None or not frame.is_full:
            raise MalformedError(match.start(), "a value is missing before ','")
        frame.is_full = False
        if len(self._frames) == 1:
            self._note_end()

    def _semicolon(self, match: re.Match[str]) -> None:
        if not self._is_done:
            raise MalformedError(match.start(), "';' before the brackets are closed")
        self._is_ended = True

    def _add(self, value: Value, match: re.Match[str]) -> None:
        if not self._frames or self._frames[-1].is_complex:
            raise MalformedError(match.start(), f"an entity was expected, not {shown(match)!r}")
        self._expect_value(match)
        self._note_start(match)
        self._put(value)

    def _put(self, value: Value) -> None:
        frame = self._frames[-1]
        frame.values.append(value)
        frame.is_full = True

    def _expect_value(self, match: re.Match[str]) -> None:
        if self._frames and self._frames[-1].is_full:
            raise MalformedError(match.start(), f"',' is missing before {shown(match)}")

    def _note_start(self, match: re.Match[str]) -> None:
        if len(self._frames) == 1 and self._frames[0].keyword:
            self.spans.append((match.start(), -1))

    def _note_end(self) -> None:
        if self.spans and self.spans[-1][1] < 0:
            self.spans[-1] = (self.spans[-1][0], self._last_end)
