r"""Index of the instances of the DATA sections, built in one pass without objects per instance.

One regular expression matches an ordinary instance in a single step. Everything else is parsed
piece by piece: an instance with ``#`` in a string or without its ``;``, comments, the end of
the section, and stray text. Every byte of a section is an instance, blank, or noted; nothing
is skipped silently.
"""

import re
from array import array
from collections import defaultdict
from dataclasses import dataclass
from operator import sub

from stepnc_model.errors import Part21Error
from stepnc_model.part21.grammar import (
    BINARY,
    COMMENT,
    INSTANCE_HEAD,
    KEYWORD,
    MAX_INSTANCE,
    ROUNDS,
    SECTION_END,
    STRING,
    TIDY_COMMENT,
    closing,
    run_end,
    skip_blank,
)
from stepnc_model.part21.places import Slips, SyntaxSlip, error_at, excerpt
from stepnc_model.part21.record import parse_record
from stepnc_model.part21.tidy import is_tidy
from stepnc_model.part21.tokens import MAX_ID_DIGITS

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
