"""Structure of an exchange file: header statements, sections, and their ends.

Order and completeness of the sections are not enforced: missing or misplaced parts are noted
and reading continues. Only a text that does not start as ISO 10303-21, or that has neither
instances nor a DATA section, is rejected.
"""

import re
from dataclasses import dataclass

from stepnc_model.errors import Severity
from stepnc_model.part21.grammar import (
    BLANK,
    INSTANCE_HEAD,
    ROUNDS,
    STRING,
    TIDY_COMMENT,
    closing,
    run_end,
    skip_blank,
)
from stepnc_model.part21.index import Index, IndexBuilder, skip_junk
from stepnc_model.part21.places import FileSlips, SyntaxSlip, error_at, excerpt

_BYTE_ORDER_MARK = b"\xef\xbb\xbf"
_OPENING = re.compile(rb"(?i:ISO-10303-21)" + BLANK + rb"(;?)")
_SPACE = re.compile(rb"\s*+")
_SECTION = re.compile(
    b"|".join((
        rb"(?P<header>(?i:HEADER)" + BLANK + rb";)",
        rb"(?P<end>(?i:ENDSEC)(?![A-Za-z0-9_])" + BLANK + rb";?)",
        rb"(?P<close>(?i:END-ISO-10303-21)" + BLANK + rb";?)",
        rb"(?P<data>(?i:DATA)" + BLANK + rb"(?=[;(]))",
        rb"(?P<other>(?i:ANCHOR|REFERENCE|SIGNATURE)" + BLANK + rb";)",
    ))
)
_NO_LETTER = re.compile(rb"[^A-Za-z]")
_STATEMENT = re.compile(rb"(!?[A-Za-z_][A-Za-z0-9_]*+)" + BLANK + rb"(?=\()")
_FOREIGN = re.compile(
    rb"(?>(?:[^'/Ee]++|" + STRING + rb"|" + TIDY_COMMENT + rb"|'|/"
    rb"|[Ee](?!(?i:NDSEC\s*+;|ND-ISO-10303-21)))" + ROUNDS + rb")"
)

_MAX_STEPS = 100_000
"""Greatest number of sections, header entities and stray texts of one file."""
_MAX_STATEMENT = 1 << 20
"""Greatest length of a header entity or of the parameters of DATA, bytes."""
_MAX_UNCLOSED = 10
"""Greatest number of header entities with unclosed brackets, which are slow to scan."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Statement:
    """Statement (entity) in the HEADER section of a file."""

    keyword: str
    """Keyword of the header statement, in upper case."""
    start: int
    bracket: int
    """Byte offset of the opening bracket."""
    end: int
    """Byte offset behind the closing bracket."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FileStructure:
    """Header statements and index of a file."""

    statements: tuple[Statement, ...]
    index: Index
    data_end: int
    """Offset where the last DATA section ends: its ENDSEC, or what stands in its place."""
    slips: tuple[SyntaxSlip, ...]


def read_structure(data: bytes) -> FileStructure:
    """Find the header statements and instances of a file.

    Raises
    ------
    Part21Error
        If the text is not an exchange structure, breaks off within an instance, string or
        comment, defines an id twice, or exceeds a limit.
    """
    scan = _Scan(data)
    position = scan.opening()
    while not scan.is_closed:
        position = skip_blank(data, position, slips=scan.slips)
        if position == len(data):
            break
        position = scan.step(position)
    scan.check_end(position)
    return FileStructure(
        statements=tuple(scan.statements),
        index=scan.index.finish(),
        data_end=scan.data_end,
        slips=tuple(sorted(scan.slips.noted, key=lambda slip: slip.offset)),
    )


class _Scan:
    """Scanner of the file structure, used by :func:`read_structure`."""

    def __init__(self, data: bytes) -> None:
        self.slips = FileSlips(data)
        self.statements: list[Statement] = []
        self.index = IndexBuilder(data, self.slips)
        self.data_end = -1
        self.is_closed = False
        self._data = data
        self._open = ""
        self._steps = 0
        self._unclosed = 0

    def opening(self) -> int:
        """Check the opening line; return the offset behind ``ISO-10303-21;``."""
        data = self._data
        start = len(_BYTE_ORDER_MARK) if data.startswith(_BYTE_ORDER_MARK) else 0
        if _blank_to_end(data, start):
            raise error_at(data, 0, "the file is empty")
        start = skip_blank(data, start, slips=self.slips)
        match = _OPENING.match(data, start)
        if match is None:
            found = excerpt(data, start, len(data))
            message = f"not an ISO 10303-21 file: 'ISO-10303-21;' expected, {found} found"
            raise error_at(data, start, message)
        if not match[1]:
            self._note(start, "';' is missing after ISO-10303-21")
        return match.end()

    def step(self, position: int) -> int:
        """Read the part that begins at ``position``; return the offset behind it."""
        self._steps += 1
        if self._steps > _MAX_STEPS:
            message = f"more than {_MAX_STEPS} sections and header entities"
            raise error_at(self._data, position, message)
        match = _SECTION.match(self._data, position)
        if match is not None:
            return self._section(match)
        if INSTANCE_HEAD.match(self._data, position):
            self._note(position, "instances outside a DATA section: 'DATA;' is missing")
            return self._instances(position)
        match = _STATEMENT.match(self._data, position)
        if match is not None:
            return self._statement(match)
        return skip_junk(self._data, position, slips=self.slips)

    def _section(self, match: re.Match[bytes]) -> int:
        """Read a word that opens or closes a section; skip sections that are not supported."""
        if match.lastgroup == "end":
            return self._end_section(match)
        if self._open:
            self._note(match.start(), f"ENDSEC is missing after the {self._open} section")
        self._open = ""
        if match.lastgroup == "close":
            self.is_closed = True
            self._check_semicolon(match, "END-ISO-10303-21")
            return match.end()
        self._open = _NO_LETTER.split(match[0], maxsplit=1)[0].decode("ascii").upper()
        if match.lastgroup == "data":
            return self._instances(self._after_data(match.end()))
        if match.lastgroup == "other":
            return run_end(_FOREIGN, self._data, match.end())
        return match.end()

    def _end_section(self, match: re.Match[bytes]) -> int:
        if not self._open:
            self._note(match.start(), "ENDSEC without an open section")
        self._check_semicolon(match, "ENDSEC")
        self._open = ""
        return match.end()

    def _after_data(self, position: int) -> int:
        """Offset behind the parameters and the ``;`` of DATA (edition 2)."""
        data = self._data
        end = self._closing(position) if data.startswith(b"(", position) else position
        if end < 0:
            self._note(position, "the parameters of DATA do not end")
            end = position
        end = skip_blank(data, end, slips=self.slips)
        if data.startswith(b";", end):
            return end + 1
        self._note(end, "';' is missing after DATA")
        return end

    def _instances(self, position: int) -> int:
        self._open = "DATA"
        self.data_end = self.index.add_section(position)
        return self.data_end

    def _statement(self, match: re.Match[bytes]) -> int:
        """Read a statement of the HEADER section."""
        data = self._data
        keyword = match[1].decode("ascii").upper()
        if self._open != "HEADER":
            self._note(match.start(), f"{keyword} outside the HEADER section")
        end = self._closing(match.end())
        if end < 0:
            self._note(match.start(), f"the brackets of {keyword} do not close")
            return match.end() + 1
        self.statements.append(
            Statement(keyword=keyword, start=match.start(), bracket=match.end(), end=end)
        )
        after = skip_blank(data, end, slips=self.slips)
        if data.startswith(b";", after):
            return after + 1
        self._note(end - 1, f"';' is missing after {keyword}")
        return after

    def _closing(self, position: int) -> int:
        """Offset behind the brackets that open at ``position``; -1 if they do not close."""
        end = closing(self._data, position, stop=position + _MAX_STATEMENT)
        if end < 0:
            self._unclosed += 1
            if self._unclosed > _MAX_UNCLOSED:
                message = f"brackets of more than {_MAX_UNCLOSED} header entities do not close"
                raise error_at(self._data, position, message)
        return end

    def check_end(self, position: int) -> None:
        """Note missing or surplus text at the end of the file."""
        if self.data_end < 0:
            raise error_at(self._data, len(self._data), "the file has no DATA section")
        if not self.is_closed:
            if self._open:
                self._note(position, f"ENDSEC is missing after the {self._open} section")
            self._note(position, "END-ISO-10303-21 is missing")
        elif not _blank_to_end(self._data, position):
            rest = excerpt(self._data, position, len(self._data)).strip()
            self._note(position, f"text after the end of the file is ignored: {rest}")

    def _check_semicolon(self, match: re.Match[bytes], word: str) -> None:
        if not match[0].endswith(b";"):
            self._note(match.start(), f"';' is missing after {word}")

    def _note(self, offset: int, message: str) -> None:
        self.slips.append(SyntaxSlip(offset=offset, message=message, severity=Severity.WARNING))


def _blank_to_end(data: bytes, position: int) -> bool:
    """True if only white space follows up to the end of the file."""
    match = _SPACE.match(data, position)
    return match is not None and match.end() == len(data)
