r"""Decoding and encoding of ISO 10303-21 strings, without the enclosing apostrophes.

Decoding accepts every directive of the standard [1]_ and keeps other backslashes, so that a
path such as ``C:\temp`` survives. Encoding writes ASCII only, with ``\X2\`` for the basic
plane and ``\X4\`` for the rest.

References
----------
.. [1] ISO 10303-21:2016, 6.4.3 (strings) and 5.7 (print control directives).
"""

import re

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
