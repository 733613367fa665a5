"""Byte splices: what stands where, so that all other bytes stay as they are."""

from collections.abc import Iterable, Sequence
from typing import TypeAlias

from stepnc_model.part21.grammar import skip_blank

Span: TypeAlias = tuple[int, int]
"""Bytes from and to."""
Element: TypeAlias = Span | bytes
"""An element of a list: a place in the file, or new text."""
Splice: TypeAlias = tuple[int, int, bytes]
"""Bytes from and to, and what stands there instead."""

_BLANK = b" \t"
_BREAK = b"\r\n"


def list_splices(
    data: bytes, elements: Sequence[Element], *, spans: Sequence[Span], close: int
) -> list[Splice]:
    """Splices that turn a bracketed list into another one.

    Parameters
    ----------
    data : bytes
        The file.
    elements : sequence of span or bytes
        The list as it shall be.
    spans : sequence of span
        The elements as they are.
    close : int
        Offset of the bracket that ends the list.
    """
    splices: list[Splice] = []
    for (start, end), element in zip(spans, elements, strict=False):
        text = _text(data, element)
        if text != data[start:end]:
            splices.append((start, end, text))
    kept = len(elements)
    if kept > len(spans):
        more = b", ".join(_text(data, element) for element in elements[len(spans) :])
        place = spans[-1][1] if spans else close
        splices.append((place, place, b", " + more if spans else more))
    elif kept < len(spans):
        start = skip_blank(data, spans[kept - 1][1], slips=[]) if kept else spans[0][0]
        splices.append((start, spans[-1][1], b""))
    return splices


def _text(data: bytes, element: Element) -> bytes:
    """Bytes of an element."""
    return element if isinstance(element, bytes) else data[element[0] : element[1]]


def line_span(data: bytes, span: Span) -> Span:
    """A span with the rest of its lines, if they are blank; the span itself otherwise."""
    start, end = line_start(data, span[0]), span[1]
    while data[end : end + 1] and data[end] in _BLANK:
        end += 1
    if (start and data[start - 1] not in _BREAK) or not data[end : end + 1]:
        return span
    if data.startswith(b"\r\n", end):
        return start, end + 2
    return (start, end + 1) if data[end] in _BREAK else span


def line_start(data: bytes, offset: int) -> int:
    """Begin of the line if only blanks stand before the offset, else the offset."""
    start = offset
    while start and data[start - 1] in _BLANK:
        start -= 1
    return start if not start or data[start - 1] in _BREAK else offset


def spliced(data: bytes, splices: Iterable[Splice], *, start: int, end: int) -> bytes:
    """The bytes from ``start`` to ``end`` with the splices that begin there."""
    pieces: list[bytes] = []
    position = start
    for first, last, text in sorted(splices):
        if start <= first < end:
            pieces += [data[position:first], text]
            position = last
    return b"".join([*pieces, data[position:end]])
