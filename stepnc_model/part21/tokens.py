"""Tokens of parameters as real files write them, and the values that single ones stand for.

References
----------
.. [1] ISO 10303-21:2016, 6.4 (simple data types).
"""

import re

from stepnc_model.errors import Severity
from stepnc_model.part21.places import Slips, SyntaxSlip
from stepnc_model.part21.strings import decode
from stepnc_model.part21.values import DERIVED, Binary, Enumeration, Real, Ref, Value

KEYWORD = r"!?[A-Za-z_][A-Za-z0-9_]*+"
STRING = r"'[^']*+(?>(?:''[^']*+)*)'"
ENUMERATION = r"\.[A-Za-z_][A-Za-z0-9_]*+\."
BINARY = r'"[0-3][0-9A-F]*+"'
COMMENT = r"(?>/\*(?s:.*?)\*/)"

_MAX_DIGITS = 4000
TOKEN = re.compile(
    rf"(?P<blank>\s++|{COMMENT}|\\[NF]\\)"
    rf"|(?P<keyword>{KEYWORD})(?=(?>(?:\s++|{COMMENT}){{0,1000}})\()"
    rf"|(?P<word>{KEYWORD})"
    r"|(?P<reference>#[0-9]++)"
    r"|(?P<number>[+-]?(?:[0-9]++\.?[0-9]*+|\.[0-9]++)(?>(?:[Ee][+-]?[0-9]++)?)(?![\w#\"']))"
    rf"|(?P<string>{STRING})"
    r'|(?P<quoted>"[^"]*+")'
    r"|(?P<enumeration>\.++[A-Za-z_][A-Za-z0-9_]*+\.++)"
    r"|(?P<open>\()|(?P<close>\))|(?P<comma>,)|(?P<semicolon>;)"
    r"|(?P<unset>\$)|(?P<derived>\*)"
    r"|(?P<unended>'|/\*|\")|(?P<other>.)",
    re.ASCII | re.DOTALL,
)
"""Any text is a sequence of these; the last two groups are what cannot stand there."""

_INTEGER = re.compile(r"[+-]?[0-9]++", re.ASCII)
_STANDARD_REAL = re.compile(r"[+-]?[0-9]++\.[0-9]*+(?>(?:E[+-]?[0-9]++)?)", re.ASCII)
_STANDARD_BINARY = re.compile(BINARY)
_NO_NUMBER = frozenset({"NAN", "INF", "INFINITY", "IND", "QNAN", "SNAN"})


class MalformedError(Exception):
    """Stops the parser; never leaves this package."""

    def __init__(self, offset: int, message: str) -> None:
        super().__init__(message)
        self.slip = SyntaxSlip(offset=offset, message=message, severity=Severity.ERROR)


def scalar(match: re.Match[str], *, slips: Slips) -> Value:
    """Value of a token that is neither bracket, comma nor keyword."""
    token = match[0]
    match match.lastgroup:
        case "reference":
            return _reference(match)
        case "number":
            return _number(match, slips=slips)
        case "string":
            return decode(token[1:-1])
        case "enumeration":
            if token[1] == "." or token[-2] == ".":
                slips.append(_slip(match, "an enumeration has one dot on either side"))
            return Enumeration(token.strip(".").upper())
        case "unset":
            return None
        case "derived":
            return DERIVED
        case "word":
            return _word(match, slips=slips)
        case "quoted":
            return _quoted(match, slips=slips)
        case "unended":
            raise MalformedError(match.start(), f"what {token} begins does not end")
        case _:
            raise MalformedError(match.start(), f"invalid character {token!r}")


def _reference(match: re.Match[str]) -> Ref[object]:
    """Reference whose number is of a size that an instance can have."""
    if len(match[0]) > 19:
        raise MalformedError(match.start(), f"instance name too long: {shown(match)}")
    return Ref(match[0][1:])


def _number(match: re.Match[str], *, slips: Slips) -> Value:
    """Integer or real; a real in another notation is kept as it is, and noted."""
    token = match[0]
    if _INTEGER.fullmatch(token):
        if len(token) > _MAX_DIGITS:
            raise MalformedError(match.start(), f"an integer of {len(token)} digits")
        return int(token)
    if not _STANDARD_REAL.fullmatch(token):
        slips.append(_slip(match, "a real has digits, a point and an upper-case exponent"))
    return Real(float(token), token)


def _word(match: re.Match[str], *, slips: Slips) -> Enumeration:
    """Word without dots, read as an enumeration."""
    word = match[0].upper()
    if word in _NO_NUMBER or word.startswith("!"):
        raise MalformedError(match.start(), f"{match[0]} is no value")
    slips.append(_slip(match, f"read as .{word}."))
    return Enumeration(word)


def _quoted(match: re.Match[str], *, slips: Slips) -> Value:
    """Binary; text in double quotes is read as a string."""
    token = match[0]
    if _STANDARD_BINARY.fullmatch(token):
        return Binary(token[1:-1])
    slips.append(_slip(match, "double quotes enclose binary values; read as a string"))
    return decode(token[1:-1])


def _slip(match: re.Match[str], message: str) -> SyntaxSlip:
    """Deviation at a token."""
    return SyntaxSlip(offset=match.start(), message=f"{shown(match)}: {message}")


def shown(match: re.Match[str]) -> str:
    """Token for a message, cut where it is long."""
    return match[0] if len(match[0]) <= 40 else match[0][:39] + "…"
