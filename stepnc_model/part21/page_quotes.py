r"""Apostrophes that the directive ``\S\`` takes as its character.

``\S\`` is followed by one character of the basic alphabet, which includes the apostrophe [1]_:
``\S\'`` is a section sign, and does not end the string. All patterns of this package take an
apostrophe for the end of a string, so they scan bytes of the same length in which that
apostrophe is masked. The bytes of the file themselves stay as they are.

References
----------
.. [1] ISO 10303-21:2016, 6.4.3: ``page = \S\ character``.
"""

import re

MASK = 0x80
"""Bit set in a masked apostrophe, whose byte then is that of its meaning in ISO 8859-1."""

_TAKEN = rb"\S\'"
_STRICT = re.compile(rb"'(?>(?:[^'\\]++|''|\\\\|\\S\\[\x20-\x7e]|\\){0,100000})'")
_PLAIN = re.compile(rb"'(?>[^']*+(?>(?:''[^']*+){0,100000}))'")
_END = re.compile(rb"\s*+(?:[,)]|/\*)")
_DIRECTIVE = re.compile(rb"''|\\\\|\\S\\[\x20-\x7e]")
_BETWEEN = re.compile(rb"(?>(?:[^'/]++|/\*(?s:.*?)(?:\*/|\Z)|/){0,10000})")
_MAX_RETRIED = 1 << 23
"""Limit for strings that are read twice, bytes; beyond it no apostrophe is masked."""


def masked(data: bytes) -> bytes:
    r"""Bytes in which the apostrophes of ``\S\'`` are masked; most files are returned as given.

    A string is read by the standard where a comma or a bracket follows its end. Elsewhere the
    apostrophe ends it, as in a path ``'C:\S\'`` whose backslashes are not doubled.

    Examples
    --------
    >>> masked(rb"#1=A('\S\'7',2);")
    b"#1=A('\\S\\\xa77',2);"
    """
    if _TAKEN not in data:
        return data
    found = bytearray(data)
    position, retried = 0, 0
    while (start := _next_string(data, position)) >= 0:
        strict = _STRICT.match(data, start)
        if strict is not None and _END.match(data, strict.end()):
            _mask(found, data, strict.start() + 1, strict.end() - 1)
            position = strict.end()
            continue
        retried += (len(data) if strict is None else strict.end()) - start
        if retried > _MAX_RETRIED:
            break
        plain = _PLAIN.match(data, start)
        position = len(data) if plain is None else plain.end()
    return bytes(found)


def _next_string(data: bytes, position: int) -> int:
    """Offset of the next apostrophe outside comments; -1 if there is none."""
    while (end := _BETWEEN.match(data, position).end()) > position:  # type: ignore[union-attr]
        position = end
    return position if position < len(data) else -1


def _mask(found: bytearray, data: bytes, start: int, end: int) -> None:
    """Mask the apostrophes that directives between two offsets take."""
    for directive in _DIRECTIVE.finditer(data, start, end):
        if directive[0] == _TAKEN:
            found[directive.end() - 1] |= MASK
