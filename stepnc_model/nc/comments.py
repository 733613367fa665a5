r"""Comments and tool calls of NC code in the order of the file.

A comment stands in parentheses, which posts also nest, or behind a semicolon; Klartext has
structure blocks ``* - text`` too. A control may see the end of a nested comment elsewhere: what
is found here changes nothing of what is executed.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stepnc_model.nc.text import NcText
from stepnc_model.post.dialect import Dialect

_ROUND = rb"\((?P<round>(?:[^()\r\n]|\([^()\r\n]*\))*)\)"
_AFTER = rb";(?P<after>[^\r\n]*)"
_STARRED = rb"^[ \t]*(?:[0-9]+[ \t]+)?\*[ \t]+-?(?P<starred>[^\r\n]*)"
_CHANGE = rb"(?P<change>(?<![A-Z0-9.#<])M0?6(?![0-9.]))"
_TOOL = rb"(?<![A-Z_#<])T[ \t]*=?[ \t]*(?P<tool>[0-9]{1,8})(?![0-9.])"
_CALLED = rb"\bTOOL[ \t]+CALL[ \t]+(?P<tool>[0-9]{1,8})(?![0-9.])"
_MOTION = rb"(?P<motion>(?<![A-Z#<])[XYZ][ \t]*=?[ \t]*[-+]?[0-9.])"

_PIECES = {
    Dialect.HEIDENHAIN: (_AFTER, _STARRED, _CALLED, _MOTION),
    Dialect.SINUMERIK: (_AFTER, _CHANGE, _TOOL, _MOTION),
}
_ISO = (_ROUND, _AFTER, _CHANGE, _TOOL, _MOTION)


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeComment:
    """Comment of a program."""

    block: int
    line: int
    """Line of the file, counted from 1."""
    text: str
    """Text without its marks, and without spaces around it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CalledTool:
    """Call of a tool by its number, which brings it into the spindle."""

    block: int
    line: int
    number: int


@dataclass(frozen=True, slots=True, kw_only=True)
class FirstMotion:
    """First words of axes after a comment or a tool call."""

    block: int


Remark = CodeComment | CalledTool | FirstMotion


def remarks_of(text: NcText, dialect: Dialect) -> Iterator[Remark]:
    r"""Yield comments, tool calls, and where motion begins behind them.

    Where a program changes tools by M6, a T word without it only gets a tool ready.

    Parameters
    ----------
    text : NcText
    dialect : Dialect

    Examples
    --------
    >>> from stepnc_model.nc.text import text_of
    >>> text = text_of(b"(6MM END MILL)\nT1 M6\nG0 X1\n", Dialect.FANUC)
    >>> [type(each).__name__ for each in remarks_of(text, Dialect.FANUC)]
    ['CodeComment', 'CalledTool', 'FirstMotion']
    """
    pieces = _PIECES.get(dialect, _ISO)
    still = _compiled(pieces)
    # Words of axes are most of a file: they are looked for only until motion has begun.
    moving = _compiled(tuple(each for each in pieces if each != _MOTION))
    changes = _CHANGE in pieces and _has_change(text.data, moving)
    ready: int | None = None
    is_moving = True
    at, changing, place = -1, -1, 0
    while found := (moving if is_moving else still).search(text.data, place):
        kind, place = found.lastgroup, found.end()
        block = _block(text, found.start())
        if kind == "motion":
            is_moving = True
            yield FirstMotion(block=block)
            continue
        if kind == "tool":
            ready, at = int(found["tool"]), block
            if changes and changing != block:
                continue
        elif kind == "change":
            changing = block
            if ready is None or (at != block and _follows(text, found, moving)):
                continue
        else:
            is_moving = False
            yield _comment(text, found, block)
            continue
        is_moving = False
        yield CalledTool(block=block, line=text.line(block), number=ready)


def _compiled(pieces: tuple[bytes, ...]) -> re.Pattern[bytes]:
    return re.compile(b"|".join(pieces), re.IGNORECASE | re.MULTILINE)


def _has_change(data: bytes, pattern: re.Pattern[bytes]) -> bool:
    """True if a program changes tools by M6, outside comments."""
    return any(found.lastgroup == "change" for found in pattern.finditer(data))


def _follows(text: NcText, found: re.Match[bytes], pattern: re.Pattern[bytes]) -> bool:
    """True if a tool word follows in the same block, as in ``M6 T1``."""
    end = int(text.starts[_block(text, found.start()) + 1])
    rest = pattern.finditer(text.data, found.end(), end)
    return any(each.lastgroup == "tool" for each in rest)


def _block(text: NcText, offset: int) -> int:
    """Index of the block at an offset."""
    return int(np.searchsorted(text.starts, offset, side="right")) - 1


def _comment(text: NcText, found: re.Match[bytes], block: int) -> CodeComment:
    content = found[found.lastgroup or 0].decode("utf-8", errors="replace")
    return CodeComment(block=block, line=text.line(block), text=content.strip())
