"""Pieces of the ISO 10303-21 grammar over bytes, and the scans made of them.

Every pattern is possessive: what it took it never gives back, so a scan is linear in the
bytes it passes whatever they are. Repeated groups are atomic, ``(?>(?:…){0,n})``, and not
``(?:…){0,n}+``: CPython before 3.11.5 gets that wrong (gh-106052), and Debian 12 ships 3.11.2.
They are counted, because the engine keeps about 120 bytes for each round of a group until the
group is done: 32 MB of slashes would take 4 GB. What is longer is scanned in runs.
"""

import re

from stepnc_model.part21.places import Slips, SyntaxSlip, error_at

COMMENT = rb"(?>/\*(?s:.*?)\*/)"
"""A comment; within it ``/*`` is text."""
TIDY_COMMENT = rb"/\*(?>(?:[^*/]++|\*(?!/)|/(?!\*)){0,1000})\*/"
"""A comment in which no other is opened."""
BLANK = rb"(?>(?:\s++|" + TIDY_COMMENT + rb"){0,1000})"
ROUNDS = rb"{0,10000}"
"""Rounds of a group in one run."""
STRING = rb"'[^']*+'"
"""A string, or the piece of one up to a doubled apostrophe."""
BINARY = rb'"[^"\r\n;]*+"'
SECTION_END = rb"(?i:ENDSEC(?![A-Za-z0-9_])|END-ISO-10303-21|DATA\s*+[;(])"
"""End of the instances of a section, also where ENDSEC is missing."""

INSTANCE_HEAD = re.compile(rb"\#([0-9]++)\s*+=")
"""``#19=``; its group is the number."""
KEYWORD = re.compile(rb"!?[A-Za-z_][A-Za-z0-9_]*+")

MAX_DEPTH = 500
"""Lists within lists; real files stay below ten. What comes deeper is an error, not a crash."""

MAX_INSTANCE = 1 << 21
"""Bytes of one instance: a quarter of a million references. Real files stay below 100 KB."""

_SPACE = re.compile(rb"\s*+")
_COMMENT = re.compile(COMMENT)
_HEAD_IN_COMMENT = re.compile(rb"\#[0-9]++\s*+=")
_BRACKET = re.compile(
    rb"(?P<skip>[^()'\"/;]++|" + STRING + rb"|" + BINARY + rb"|" + COMMENT + rb")"
    rb"|(?P<open>\()|(?P<close>\))|(?P<stop>;|'|/\*)|[/\"]"
)


def skip_blank(data: bytes, position: int, *, slips: Slips) -> int:
    """Offset of the first byte that is neither white space nor comment.

    A comment opened within a comment is noted in ``slips``.

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
    """Say how much a comment holds that opens another one."""
    hidden = len(_HEAD_IN_COMMENT.findall(data, start, end))
    text = f"; it hides {hidden} instances" if hidden else ""
    return SyntaxSlip(offset=start, message=f"nested comment: '/*' within a comment{text}")


def closing(data: bytes, position: int, *, stop: int | None = None) -> int:
    """Offset behind the bracket that closes the one at ``position``; -1 if none does.

    The search ends at ``stop``, at a ``;`` outside strings and comments, or where no instance
    can go on.

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
    """End of the last of the adjoining matches from ``position`` on."""
    while (match := pattern.match(data, position)) and match.end() > position:
        position = match.end()
    return position
