r"""Tokens of Part 21 parameters in real files, and the values of single tokens.

Decoding and encoding of ISO 10303-21 strings, without the enclosing apostrophes.

Decoding accepts every directive of the standard [2]_ and keeps other backslashes, so that a
path such as ``C:\temp`` survives. Encoding writes ASCII only, with ``\X2\`` for the basic
plane and ``\X4\`` for the rest.

Fast parser of parameters that strictly follow the standard, by one regular expression.

Nearly all text of nearly all files is of this kind. Everything else is parsed by
:mod:`stepnc_model.part21.index`; both give the same values where both apply.

References
----------
.. [1] ISO 10303-21:2016, 6.4 (simple data types).
.. [2] ISO 10303-21:2016, 6.4.3 (strings) and 5.7 (print control directives).
"""

import re

from stepnc_model.errors import Severity
from stepnc_model.part21.places import Slips, SyntaxSlip
from stepnc_model.part21.values import DERIVED, Binary, Enumeration, Real, Ref, Typed, Value

_PLAIN = re.compile(r"[^'\\\r\n\x80-\xff]*+", re.ASCII)
_DIRECTIVE = re.compile(
    r"''"
    r"|[\r\n]++"
    r"|\\\\"
    r"|\\X2\\(?P<two>(?>(?:[0-9A-Fa-f]{4})+))\\X0\\"
    r"|\\X4\\(?P<four>(?>(?:[0-9A-Fa-f]{8})+))\\X0\\"
    r"|\\X\\(?P<one>[0-9A-Fa-f]{2})"
    r"|\\P(?P<page>[A-I])\\"
    r"|\\S\\(?P<section>'')(?!')"
    r"|\\S\\(?P<high>[\x20-\x7e\xa7])"
    r"|\\(?P<print>[NF])\\"
    r"|[\x80-\xff]++"
)
_UNSAFE = re.compile(r"['\\]|[^\x20-\x7e]++")
_PRINT_CONTROL = {"N": "\n", "F": "\f"}
_BASIC_PLANE_END = 0x10000
_SURROGATES = range(0xD800, 0xE000)


def decode(raw: str) -> str:
    r"""Decode a string as written in the file.

    Line breaks within a string are dropped. Bytes above 127 are read as UTF-8 if valid and as
    Latin-1 otherwise. ``\N\`` and ``\F\`` become a line feed and a form feed.

    Parameters
    ----------
    raw : str
        Text between the apostrophes, one character per byte of the file.

    Examples
    --------
    >>> decode(r"d''usinage \X2\00E9\X0\ \S\D")
    "d'usinage é Ä"
    """
    if _PLAIN.fullmatch(raw):
        return raw
    page = "iso8859-1"

    def meaning(match: re.Match[str]) -> str:
        nonlocal page
        if match["page"]:
            page = f"iso8859-{ord(match['page']) - ord('A') + 1}"
            return ""
        if match["section"]:
            # Some writers double the apostrophe here, too.
            return _high_half("'", page=page)
        if match["high"]:
            return _high_half(match["high"], page=page) or match[0]
        return _meaning(match)

    return _DIRECTIVE.sub(meaning, raw)


def _high_half(character: str, *, page: str) -> str:
    r"""Character of ``\S\`` in a part of ISO 8859; empty where it is undefined."""
    return bytes([ord(character) | 0x80]).decode(page, errors="ignore")


def _meaning(match: re.Match[str]) -> str:
    """Text of a directive that does not depend on the code page."""
    if match["two"]:
        return bytes.fromhex(match["two"]).decode("utf-16-be", errors="surrogatepass")
    if match["four"]:
        return _wide(match["four"]) or match[0]
    if match["one"]:
        return chr(int(match["one"], 16))
    if match["print"]:
        return _PRINT_CONTROL[match["print"]]
    if match[0][0] in "\r\n":
        return ""
    if match[0][0] in "'\\":
        return match[0][0]
    return _bytes_above_ascii(match[0])


def _wide(digits: str) -> str:
    """Characters of 32-bit units; empty if one of them is not a code point."""
    points = [int(digits[i : i + 8], 16) for i in range(0, len(digits), 8)]
    return "".join(map(chr, points)) if max(points) <= 0x10FFFF else ""


def _bytes_above_ascii(raw: str) -> str:
    """Decode bytes above 127 as UTF-8 if valid, else as Latin-1."""
    try:
        return raw.encode("latin-1").decode("utf-8")
    except UnicodeDecodeError:
        return raw


def encode(text: str) -> str:
    r"""Encode text in ASCII, without the enclosing apostrophes.

    Examples
    --------
    >>> print(encode("50 % 'Ø' \\"))
    50 % ''\X2\00D8\X0\'' \\
    """
    return _UNSAFE.sub(_escape, text)


def _escape(match: re.Match[str]) -> str:
    """Double an apostrophe or backslash, or encode a run of characters in hexadecimal."""
    run = match[0]
    if run in {"'", "\\"}:
        return run * 2
    pieces: list[str] = []
    for is_wide, characters in _by_width(run):
        name, width = ("X4", 8) if is_wide else ("X2", 4)
        digits = "".join(f"{ord(c):0{width}X}" for c in characters)
        pieces.append(f"\\{name}\\{digits}\\X0\\")
    return "".join(pieces)


def _by_width(run: str) -> list[tuple[bool, str]]:
    """Split a run of characters where its need for 32 bits changes."""
    groups: list[tuple[bool, str]] = []
    for character in run:
        point = ord(character)
        is_wide = point >= _BASIC_PLANE_END or point in _SURROGATES
        if groups and groups[-1][0] == is_wide:
            groups[-1] = (is_wide, groups[-1][1] + character)
        else:
            groups.append((is_wide, character))
    return groups


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


_SCALAR = (
    r"(?:#[0-9]{1,18}+|[+-]?[0-9]{1,300}+(?>(?:\.[0-9]*+(?>(?:E[+-]?[0-9]++)?))?)"
    rf"|{STRING}|\$|{ENUMERATION}|\*|{BINARY})"
)


def _list_of(value: str) -> str:
    """Pattern of a bracketed list whose items match a pattern."""
    return rf"\(\s*+(?>(?:{value}\s*+(?>(?:,\s*+{value}\s*+)*))?)\)"


def _value_of_depth(depth: int) -> str:
    """Pattern of a value with lists and types nested up to a depth."""
    if depth == 0:
        return _SCALAR
    inner = _value_of_depth(depth - 1)
    return rf"(?:{_SCALAR}|{_list_of(inner)}|{KEYWORD}\s*+\(\s*+{inner}\s*+\))"


_TIDY = re.compile(
    rf"#[0-9]++\s*+=\s*+{KEYWORD}\s*+{_list_of(_value_of_depth(2))}\s*+;", re.ASCII
)
_REAL = r"[+-]?[0-9]++\.[0-9]*+(?>(?:E[+-]?[0-9]++)?)"
_new_float = float.__new__
# Flat lists of reals or of references, the bulk of large files, are one token each.
_TOKEN = re.compile(
    rf"\((?>(?:{_REAL},)*){_REAL}\)|\((?>(?:#[0-9]++,)*)#[0-9]++\)"
    rf"|#[0-9]++|[+-]?[0-9][0-9.E+-]*+|[()$*]|{STRING}|{ENUMERATION}|{BINARY}|{KEYWORD}",
    re.ASCII,
)


def is_tidy(text: str) -> bool:
    """True if ``#1=KEYWORD(...);`` strictly follows the standard in its plain form.

    The standard also allows comments and deeper nested lists, which are not tidy.
    """
    return _TIDY.fullmatch(text) is not None


def tidy_values(text: str) -> tuple[Value, ...]:
    """Values of a text that :func:`is_tidy` accepts."""
    open_lists: list[tuple[list[Value], str]] = []
    values: list[Value] = []
    keyword = ""
    for token in _TOKEN.findall(text, text.index("(") + 1, text.rindex(")")):
        head = token[0]
        if head == "#":
            values.append(Ref(token[1:]))
        elif head in "0123456789-+":
            values.append(_real(token) if "." in token else int(token))
        elif head == "'":
            values.append(decode(token[1:-1]) if token != "''" else "")
        elif token == "(":
            open_lists.append((values, keyword))
            values, keyword = [], ""
        elif head == "(":
            flat = _references(token) if token[1] == "#" else _reals(token)
            values.append(Typed(keyword, flat[0]) if keyword else flat)
            keyword = ""
        elif head == ")":
            inner = values
            values, named = open_lists.pop()
            values.append(Typed(named, inner[0]) if named else tuple(inner))
        elif head in '$.*"':
            values.append(_mark(token))
        else:
            keyword = token.upper()
    return tuple(values)


def _references(text: str) -> tuple[Value, ...]:
    """Values of a flat list of references, ``(#1,#2)``."""
    return tuple(map(Ref, text[2:-1].split(",#")))


def _reals(text: str) -> tuple[Value, ...]:
    """Values of a flat list of reals, ``(0.,1.)``."""
    return tuple(map(_real, text[1:-1].split(",")))


def _real(lexeme: str) -> Real:
    """Real with its characters, created without calling ``Real.__new__`` for speed."""
    real = _new_float(Real, lexeme)
    real.lexeme = lexeme
    return real


def _mark(token: str) -> Value:
    """Unset or derived value, enumeration or binary."""
    if token == "$":
        return None
    if token[0] == ".":
        return Enumeration(token[1:-1].upper())
    return DERIVED if token == "*" else Binary(token[1:-1])
