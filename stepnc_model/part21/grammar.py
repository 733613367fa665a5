"""Patterns of the ISO 10303-21 grammar over bytes, and the scans built from them.

Every pattern is possessive and never backtracks, so that a scan is linear in the length of any
input. Repeated groups are atomic, ``(?>(?:…){0,n})``, and not ``(?:…){0,n}+``, which CPython
before 3.11.5 gets wrong (gh-106052); Debian 12 ships 3.11.2. Their repetitions are bounded,
because the engine keeps about 120 bytes per repetition until the group is complete: 32 MB of
slashes would take 4 GB. Longer text is scanned in several runs.
"""

import re

from stepnc_model.part21.places import Slips, SyntaxSlip, error_at
from stepnc_model.plurals import counted

COMMENT = rb"(?>/\*(?s:.*?)\*/)"
"""Comment; within it ``/*`` is plain text."""
TIDY_COMMENT = rb"/\*(?>(?:[^*/]++|\*(?!/)|/(?!\*)){0,1000})\*/"
"""Comment that does not contain another ``/*``."""
BLANK = rb"(?>(?:\s++|" + TIDY_COMMENT + rb"){0,1000})"
ROUNDS = rb"{0,10000}"
"""Greatest number of repetitions of a pattern group in one match."""
STRING = rb"'[^']*+'"
"""String, or the piece of a string up to a doubled apostrophe."""
BINARY = rb'"[^"\r\n;]*+"'
SECTION_END = rb"(?i:ENDSEC(?![A-Za-z0-9_])|END-ISO-10303-21|DATA\s*+[;(])"
"""End of the instances of a section, also where ENDSEC is missing."""

INSTANCE_HEAD = re.compile(rb"\#([0-9]++)\s*+=")
"""Start of an instance, ``#19=``; its group is the number."""
KEYWORD = re.compile(rb"!?[A-Za-z_][A-Za-z0-9_]*+")

MAX_DEPTH = 500
"""Greatest nesting depth of lists; real files stay below ten, deeper lists are an error."""

MAX_INSTANCE = 1 << 21
"""Greatest length of an instance, bytes, a quarter of a million references."""

_SPACE = re.compile(rb"\s*+")
_COMMENT = re.compile(COMMENT)
_HEAD_IN_COMMENT = re.compile(rb"\#[0-9]++\s*+=")
_BRACKET = re.compile(
    rb"(?P<skip>[^()'\"/;]++|" + STRING + rb"|" + BINARY + rb"|" + COMMENT + rb")"
    rb"|(?P<open>\()|(?P<close>\))|(?P<stop>;|'|/\*)|[/\"]"
)


def skip_blank(data: bytes, position: int, *, slips: Slips) -> int:
    """Offset of the first byte that is neither white space nor comment.

    A comment that contains ``/*`` is noted in ``slips``.

    Raises
    ------
    Part21Error
        If a comment does not end.
    """
    while True:
        position = run_end(_SPACE, data, position)
        if not data.startswith(b"/*", position):
            return position
        comment = _COMMENT.match(data, position)
        if comment is None:
            raise error_at(data, position, "the comment that begins here does not end")
        if data.find(b"/*", position + 2, comment.end()) >= 0:
            slips.append(_nested(data, position, comment.end()))
        position = comment.end()


def _nested(data: bytes, start: int, end: int) -> SyntaxSlip:
    """Deviation for a comment that contains ``/*``, with the number of hidden instances."""
    hidden = len(_HEAD_IN_COMMENT.findall(data, start, end))
    text = f"; it hides {counted(hidden, 'instance')}" if hidden else ""
    return SyntaxSlip(offset=start, message=f"nested comment: '/*' within a comment{text}")


def closing(data: bytes, position: int, *, stop: int | None = None) -> int:
    """Offset behind the bracket that closes the one at ``position``; -1 if there is none.

    The search ends at ``stop``, at a ``;`` outside strings and comments, or where an instance
    cannot continue.

    Raises
    ------
    Part21Error
        If brackets nest deeper than ``MAX_DEPTH``.
    """
    depth = 0
    end = position + MAX_INSTANCE if stop is None else stop
    for match in _BRACKET.finditer(data, position, end):
        kind = match.lastgroup
        if kind == "open":
            depth += 1
            if depth > MAX_DEPTH:
                raise error_at(data, match.start(), f"lists nested deeper than {MAX_DEPTH}")
        elif kind == "close":
            depth -= 1
            if depth == 0:
                return match.end()
        elif kind == "stop":
            return -1
    return -1


def run_end(pattern: re.Pattern[bytes], data: bytes, position: int) -> int:
    """End of the last of consecutive matches from ``position`` on."""
    while (match := pattern.match(data, position)) and match.end() > position:
        position = match.end()
    return position
