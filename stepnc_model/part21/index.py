r"""Index of the instances of the DATA sections, built in one pass without objects per instance.

One regular expression matches an ordinary instance in a single step. Everything else is parsed
piece by piece: an instance with ``#`` in a string or without its ``;``, comments, the end of
the section, and stray text. Every byte of a section is an instance, blank, or noted; nothing
is skipped silently.

A tolerant parser, with an explicit stack, reads single instances that
:mod:`stepnc_model.part21.tokens` does not accept: complex instances, comments between
parameters, the deviations of real files. Nested lists do not use recursion.

References
----------
.. [1] ISO 10303-21:2016, 9.1 (entity instances).
"""

import re
from array import array
from collections import defaultdict
from dataclasses import dataclass, field
from operator import sub
from typing import TypeAlias

from stepnc_model.errors import Part21Error
from stepnc_model.part21.grammar import (
    BINARY,
    COMMENT,
    INSTANCE_HEAD,
    KEYWORD,
    MAX_DEPTH,
    MAX_INSTANCE,
    ROUNDS,
    SECTION_END,
    STRING,
    TIDY_COMMENT,
    closing,
    run_end,
    skip_blank,
)
from stepnc_model.part21.places import InstanceSlips, Slips, SyntaxSlip, error_at, excerpt
from stepnc_model.part21.tokens import (
    MAX_ID_DIGITS,
    TOKEN,
    MalformedError,
    is_tidy,
    scalar,
    shown,
)
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


_ITEM = re.compile(
    rb"\s*+\#([0-9]{1,18}+)\s*+=\s*+([!A-Za-z0-9_]{0,400}+)\s*+(?=\()"
    rb"(?>(?:[^;'/\"=]++|'[^'#]*+'|"
    + BINARY
    + rb"|"
    + TIDY_COMMENT
    + rb")"
    + ROUNDS
    + rb")(?<=\));"
    rb"|(?>(?:\s++|" + TIDY_COMMENT + rb"){1,1000})"
    rb"|(?s:.)"
)
_END_WORD = rb"[Ee](?!(?i:NDSEC\s*+(?:;|END-ISO|DATA)|ND-ISO-10303-21))"
_BODY = re.compile(
    rb"(?>(?:[^;'\"/\#Ee]++|" + STRING + rb"|" + BINARY + rb"|\"|" + COMMENT + rb"|/(?!\*)"
    rb"|\#(?![0-9]++\s*+=)|" + _END_WORD + rb")" + ROUNDS + rb")"
)
_JUNK = re.compile(
    rb"(?>(?:[^\#/EeDd]++|\#(?![0-9]++\s*+=)|/(?!\*)|"
    + _END_WORD
    + rb"|[Dd](?!(?i:ATA\s*+[;(])))"
    + ROUNDS
    + rb")"
)
_STRING_OR_COMMENT = re.compile(STRING + rb"|" + COMMENT)
_SECTION_END = re.compile(SECTION_END)
_MAX_KEYWORD = 400
_MAX_KEYWORDS = 10_000
"""Greatest number of entity names in one file; the largest schemas define 2000."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Index:
    """Instances of a file in file order, as columns of equal length."""

    ids: "array[int]"
    starts: "array[int]"
    """Offset of each instance's ``#`` in the file."""
    ends: "array[int]"
    """Offset behind each instance's ``;`` in the file."""
    codes: "array[int]"
    """Position of each instance's keyword in ``keywords``."""
    keywords: tuple[str, ...]
    """Keywords in upper case; empty for complex instances."""
    positions: dict[int, int]
    """Position of an instance in the columns, by its id."""


class IndexBuilder:
    """Builder of the index of one file, section by section."""

    def __init__(self, data: bytes, slips: Slips) -> None:
        self._slips = slips
        self._data = data
        self._ids = array("q")
        self._starts = array("q")
        self._ends = array("q")
        self._codes = array("I")
        self._code_of: defaultdict[bytes, int] = defaultdict()
        self._code_of.default_factory = self._code_of.__len__

    def add_section(self, position: int) -> int:
        """Index the instances from ``position`` on; return the offset of the section's end."""
        while True:
            position = self._ordinary(position)
            position = skip_blank(self._data, position, slips=self._slips)
            if position == len(self._data) or _SECTION_END.match(self._data, position):
                return position
            head = INSTANCE_HEAD.match(self._data, position)
            if head is None:
                position = skip_junk(self._data, position, slips=self._slips)
            else:
                position = self._unusual(head)

    def _ordinary(self, position: int) -> int:
        """Index ordinary instances and skip comments; return the offset of anything else."""
        add_id, add_start = self._ids.append, self._starts.append
        add_end, add_code = self._ends.append, self._codes.append
        code_of = self._code_of
        for match in _ITEM.finditer(self._data, position):
            number, keyword = match.group(1, 2)
            if number is not None:
                add_id(int(number))
                add_start(match.start(1) - 1)
                add_end(match.end())
                add_code(code_of[keyword])
            elif match.end() - match.start() == 1 and not match[0].isspace():
                return match.start()
        return len(self._data)

    def _unusual(self, head: re.Match[bytes]) -> int:
        """Parse an unusual instance piece by piece; return the offset behind it."""
        data, start = self._data, head.start()
        if len(head[1]) > MAX_ID_DIGITS:
            text = f"instance name #{head[1][:20].decode()}… has {len(head[1])} digits"
            raise error_at(data, start, f"{text}: at most {MAX_ID_DIGITS} are read")
        stop = run_end(_BODY, data, head.end())
        name = f"#{int(head[1])}"
        if data.startswith(b";", stop):
            _check_strings(data, head, stop + 1)
            end = stop + 1
        else:
            _check_unended(data, start, stop, name=name)
            end = self._end_without_semicolon(head.end(), stop, name=name)
        self._ids.append(int(head[1]))
        self._starts.append(start)
        self._ends.append(end)
        self._codes.append(self._code_of[_keyword(data, head.end())])
        return end

    def _end_without_semicolon(self, start: int, stop: int, *, name: str) -> int:
        """End of an instance whose ``;`` is missing before ``stop``."""
        data = self._data
        bracket = data.find(b"(", start, stop)
        end = closing(data, bracket, stop=stop) if bracket >= 0 else -1
        if end < 0:
            end = start + len(data[start:stop].rstrip())
        self._slips.append(SyntaxSlip(offset=end - 1, message=f"';' is missing after {name}"))
        return end

    def finish(self) -> Index:
        """Build the index of all DATA sections.

        Raises
        ------
        Part21Error
            If two instances have the same id, an instance is longer than ``MAX_INSTANCE``, or
            there are more entity names than any schema defines.
        """
        sizes = list(map(sub, self._ends, self._starts))
        if max(sizes, default=0) > MAX_INSTANCE:
            raise self._too_long(sizes)
        if len(self._code_of) > _MAX_KEYWORDS:
            message = f"{len(self._code_of)} entity names; at most {_MAX_KEYWORDS} are allowed"
            raise error_at(self._data, 0, message)
        positions = dict(zip(self._ids, range(len(self._ids)), strict=True))
        if len(positions) != len(self._ids):
            raise self._duplicate()
        return Index(
            ids=self._ids,
            starts=self._starts,
            ends=self._ends,
            codes=self._codes,
            keywords=tuple(raw.decode("latin-1").upper() for raw in self._code_of),
            positions=positions,
        )

    def _too_long(self, sizes: list[int]) -> Part21Error:
        """Error about an instance that is too long, naming the longest."""
        longest = sizes.index(max(sizes))
        message = (
            f"#{self._ids[longest]} is {sizes[longest]} bytes long; at most {MAX_INSTANCE}"
        )
        return error_at(self._data, self._starts[longest], message)

    def _duplicate(self) -> Part21Error:
        """Error that names the first duplicate id and both its lines."""
        first: dict[int, int] = {}
        for number, start in zip(self._ids, self._starts, strict=True):
            if number in first:
                break
            first[number] = start
        line = error_at(self._data, first[number], "").line
        message = f"#{number} is defined twice, first on line {line}"
        return error_at(self._data, start, message)


def skip_junk(data: bytes, position: int, *, slips: Slips) -> int:
    """Note stray text; return the offset where known syntax may begin again."""
    end = max(run_end(_JUNK, data, position), position + 1)
    last = position + len(data[position:end].rstrip())
    message = f"text outside any instance: {excerpt(data, position, last)}"
    slips.append(SyntaxSlip(offset=position, message=message))
    return end


def _check_unended(data: bytes, start: int, stop: int, *, name: str) -> None:
    """Raise an error if an instance is cut off or has an unterminated string or comment."""
    if stop == len(data):
        label = f"{name} {_keyword(data, data.index(b'=', start) + 1).decode()}".strip()
        raise error_at(data, start, f"the file is cut off within {label}")
    if data.startswith(b"'", stop):
        raise error_at(data, stop, f"the string that begins here in {name} does not end")
    if data.startswith(b"/*", stop):
        raise error_at(data, stop, f"the comment that begins here in {name} does not end")


def _check_strings(data: bytes, head: re.Match[bytes], end: int) -> None:
    """Raise an error if a string with a missing apostrophe contains another instance.

    A text such as ``#5=`` within a string is allowed if the instance around it is valid.
    """
    start = head.end()
    if end - start > MAX_INSTANCE or INSTANCE_HEAD.search(data, start, end) is None:
        return
    if is_tidy(data[head.start() : end].decode("latin-1")):
        return
    for piece in _STRING_OR_COMMENT.finditer(data, start, end):
        swallowed = INSTANCE_HEAD.search(data, piece.start(), piece.end())
        if not piece[0].startswith(b"'") or swallowed is None:
            continue
        record = parse_record(data[start:end].decode("latin-1"))
        if record.error is None and not record.slips:
            return
        message = f"the string that begins here does not end before #{int(swallowed[1])}"
        raise error_at(data, piece.start(), message)


def _keyword(data: bytes, position: int) -> bytes:
    """Keyword at ``position`` after blanks; empty for a complex instance."""
    start = skip_blank(data, position, slips=[])
    match = KEYWORD.match(data, start)
    if match is not None and len(match[0]) > _MAX_KEYWORD:
        message = f"an entity name of {len(match[0])} letters; at most {_MAX_KEYWORD}"
        raise error_at(data, start, message)
    return match[0] if match else b""
