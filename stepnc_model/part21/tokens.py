"""Tokens of Part 21 parameters in real files, and the values of single tokens.

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

MAX_ID_DIGITS = 18
"""Greatest number of digits of an instance name."""

_MAX_DIGITS = 308
"""Greatest number of digits of an integer; each then has a value as a real, too."""

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
"""Pattern of all tokens; the last two groups match invalid text."""

_INTEGER = re.compile(r"[+-]?[0-9]++", re.ASCII)
_STANDARD_REAL = re.compile(r"[+-]?[0-9]++\.[0-9]*+(?>(?:E[+-]?[0-9]++)?)", re.ASCII)
_STANDARD_BINARY = re.compile(BINARY)
_NO_NUMBER = frozenset({"NAN", "INF", "INFINITY", "IND", "QNAN", "SNAN"})


class MalformedError(Exception):
    """Internal error that stops the parser of an instance."""

    def __init__(self, offset: int, message: str) -> None:
        super().__init__(message)
        self.slip = SyntaxSlip(offset=offset, message=message, severity=Severity.ERROR)


def scalar(match: re.Match[str], *, slips: Slips) -> Value:
    """Value of a token other than a bracket, comma or keyword."""
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
                slips.append(_slip(match, "an enumeration must have one dot on each side"))
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
            raise MalformedError(match.start(), f"text that starts with {token} does not end")
        case _:
            raise MalformedError(match.start(), f"invalid character {token!r}")


def _reference(match: re.Match[str]) -> Ref[object]:
    """Instance reference from a token; an error if its number is too long."""
    digits = len(match[0]) - 1
    if digits > MAX_ID_DIGITS:
        text = f"instance name {shown(match)} has {digits} digits: at most {MAX_ID_DIGITS}"
        raise MalformedError(match.start(), f"{text} are read")
    return Ref(match[0][1:])


def _number(match: re.Match[str], *, slips: Slips) -> Value:
    """Integer or real; a real in non-standard notation keeps its text and is noted."""
    token = match[0]
    if _INTEGER.fullmatch(token):
        if len(token) > _MAX_DIGITS:
            raise MalformedError(
                match.start(),
                f"an integer of {len(token)} digits: at most {_MAX_DIGITS} are read",
            )
        return int(token)
    if not _STANDARD_REAL.fullmatch(token):
        slips.append(_slip(match, "a real needs digits, a point and an upper-case exponent"))
    return Real(float(token), token)


def _word(match: re.Match[str], *, slips: Slips) -> Enumeration:
    """Word without dots, read as an enumeration."""
    word = match[0].upper()
    if word in _NO_NUMBER or word.startswith("!"):
        raise MalformedError(match.start(), f"{match[0]} is not a valid value")
    slips.append(_slip(match, f"read as .{word}."))
    return Enumeration(word)


def _quoted(match: re.Match[str], *, slips: Slips) -> Value:
    """Binary value; other text in double quotes is read as a string."""
    token = match[0]
    if _STANDARD_BINARY.fullmatch(token):
        return Binary(token[1:-1])
    slips.append(_slip(match, "double quotes enclose binary values; read as a string"))
    return decode(token[1:-1])


def _slip(match: re.Match[str], message: str) -> SyntaxSlip:
    """Record a deviation from the standard at a token."""
    return SyntaxSlip(offset=match.start(), message=f"{shown(match)}: {message}")


def shown(match: re.Match[str]) -> str:
    """Token as shown in messages, shortened if long."""
    return match[0] if len(match[0]) <= 40 else match[0][:39] + "…"
