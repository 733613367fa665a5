"""Tokens of EXPRESS text, with remarks left out.

An embedded remark ``(* … *)`` may hold others, a tail remark runs from ``--`` to the end of
its line (ISO 10303-11, 7.1.6).
"""

import re
from bisect import bisect_right
from dataclasses import dataclass
from enum import Enum

from stepnc_model.errors import SchemaError


class TokenKind(Enum):
    """Kind of a token."""

    NAME = "name"
    NUMBER = "number"
    STRING = "string"
    SYMBOL = "symbol"
    END = "end"


@dataclass(frozen=True, slots=True, kw_only=True)
class Token:
    """One word, literal or symbol."""

    kind: TokenKind
    text: str
    line: int
    is_apart: bool
    """white space or a remark stands before it"""

    @property
    def word(self) -> str:
        """Text in upper case if it is a name, for keywords; else empty."""
        return self.text.upper() if self.kind is TokenKind.NAME else ""


_TOKEN = re.compile(
    r"(?P<blank>\s++|--[^\n]*+)"
    r"|(?P<remark>\(\*)"
    r"|(?P<name>[A-Za-z][A-Za-z0-9_]*+)"
    r"|(?P<number>%[01]++|[0-9]++(?>(?:\.[0-9]*+(?>(?:[eE][+-]?[0-9]++)?))?))"
    r"|(?P<string>'[^'\n]*+(?>(?:''[^'\n]*+)*)'|\"[0-9A-Fa-f]*+\")"
    r"|(?P<symbol>:=:|:<>:|:=|<=|>=|<>|<\*|\|\||\*\*|[-+*/<>=:;,.()\[\]{}|\\?])",
    re.ASCII,
)
_REMARK_END = re.compile(r"\(\*|\*\)")


def tokens(text: str) -> list[Token]:
    """Split EXPRESS text; the last token is of kind END.

    Raises
    ------
    SchemaError
        If a remark or a string is not closed, or a character cannot stand there.
    """
    lines = [match.start() for match in re.finditer(r"\n", text)]
    found: list[Token] = []
    offset = 0
    is_apart = False
    while offset < len(text):
        match = _TOKEN.match(text, offset)
        line = bisect_right(lines, offset - 1) + 1
        if match is None:
            raise SchemaError(_complaint(text[offset]), line=line)
        if match.lastgroup in {"blank", "remark"}:
            is_apart = True
            is_remark = match.lastgroup == "remark"
            offset = _after_remark(text, offset, line=line) if is_remark else match.end()
            continue
        kind = TokenKind(match.lastgroup)
        found.append(Token(kind=kind, text=match[0], line=line, is_apart=is_apart))
        is_apart = False
        offset = match.end()
    line = len(lines) + 1
    found.append(
        Token(kind=TokenKind.END, text="the end of the text", line=line, is_apart=True)
    )
    return found


def _after_remark(text: str, start: int, *, line: int) -> int:
    """Offset behind the embedded remark that starts here."""
    depth = 0
    for match in _REMARK_END.finditer(text, start):
        depth += 1 if match[0] == "(*" else -1
        if depth == 0:
            return match.end()
    raise SchemaError("the remark (* that begins here is not closed", line=line)


def _complaint(character: str) -> str:
    """Fault of a character that begins no token."""
    if character in "'\"":
        return f"the string {character} that begins here is not closed on its line"
    return f"unexpected character {character!r}"
