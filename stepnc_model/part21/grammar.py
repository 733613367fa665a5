"""Pieces of the ISO 10303-21 grammar over bytes, and the two scans made of them.

Every pattern is possessive: what it took it never gives back, so a scan is linear in the
bytes it passes whatever they are. Repeated groups are atomic, ``(?>(?:…)*)``, and not
``(?:…)*+``: CPython before 3.11.5 gets that wrong (gh-106052), and Debian 12 ships 3.11.2.
"""

import re

from stepnc_model.part21.places import Slip, error_at

COMMENT = rb"/\*(?>(?:[^*]++|\*(?!/))*)\*/"
"""A comment; within it ``/*`` is text."""
TIDY_COMMENT = rb"/\*(?>(?:[^*/]++|\*(?!/)|/(?!\*))*)\*/"
"""A comment in which no other is opened."""
BLANK = rb"(?>(?:\s++|" + TIDY_COMMENT + rb")*)"
STRING = rb"'[^']*+'"
"""A string, or the piece of one up to a doubled apostrophe."""
BINARY = rb'"[^"\r\n;]*+"'
SECTION_END = rb"(?i:ENDSEC(?![A-Za-z0-9_])|END-ISO-10303-21|DATA\s*+[;(])"
"""What ends the instances of a section, the missing ENDSEC included."""

INSTANCE_HEAD = re.compile(rb"\#([0-9]++)\s*+=")
"""``#19=``; its group is the number."""
KEYWORD = re.compile(rb"!?[A-Za-z_][A-Za-z0-9_]*+")

MAX_DEPTH = 500
"""Lists within lists; real files stay below ten. What comes deeper is an error, not a crash."""

_SPACE = re.compile(rb"\s*+")
_COMMENT = re.compile(COMMENT)
_HEAD_IN_COMMENT = re.compile(rb"\#[0-9]++\s*+=")
_BRACKET = re.compile(
    rb"(?P<skip>[^()'\"/;]++|" + STRING + rb"|" + BINARY + rb"|" + COMMENT + rb")"
    rb"|(?P<open>\()|(?P<close>\))|(?P<stop>;|'|/\*)|[/\"]"
)


def skip_blank(data: bytes, position: int, *, slips: list[Slip]) -> int:
    """Offset of the first byte that is neither white space nor comment.

    A comment opened within a comment is noted in ``slips``.

    Raises
    ------
    Part21Error
        If a comment does not end.
    """
    while True:
        position = _end(_SPACE, data, position)
        if not data.startswith(b"/*", position):
            return position
        comment = _COMMENT.match(data, position)
        if comment is None:
            raise error_at(data, position, "the comment that begins here does not end")
        if data.find(b"/*", position + 2, comment.end()) >= 0:
            slips.append(_nested(data, position, comment.end()))
        position = comment.end()


def _nested(data: bytes, start: int, end: int) -> Slip:
    """Say how much a comment holds that opens another one."""
    hidden = len(_HEAD_IN_COMMENT.findall(data, start, end))
    text = f"; it hides {hidden} instances" if hidden else ""
    return Slip(offset=start, message=f"nested comment: '/*' within a comment{text}")


def closing(data: bytes, position: int) -> int:
    """Offset behind the bracket that closes the one at ``position``; -1 if none does.

    The search ends at a ``;`` outside strings and comments.

    Raises
    ------
    Part21Error
        If brackets nest deeper than ``MAX_DEPTH``.
    """
    depth = 0
    for match in _BRACKET.finditer(data, position):
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


def _end(pattern: re.Pattern[bytes], data: bytes, position: int) -> int:
    """Where a pattern that may be empty ends."""
    match = pattern.match(data, position)
    return match.end() if match else position
