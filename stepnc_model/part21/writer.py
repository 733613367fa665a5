"""Writing of values, and edits of a file that leave all other bytes unchanged.

New instances are inserted before the ENDSEC of the last DATA section, one per line, with ids
above the largest that is kept. Text is ASCII; line ends are those of the file.

Edits are byte splices: byte spans with the text that replaces them.
"""

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from stepnc_model.part21.grammar import KEYWORD, skip_blank
from stepnc_model.part21.index import parse_record
from stepnc_model.part21.places import line_break
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.tokens import decode, encode
from stepnc_model.part21.values import Binary, Derived, Enumeration, Real, Ref, Typed, Value

Span: TypeAlias = tuple[int, int]
"""Byte span in the file: start and end offset."""
Element: TypeAlias = Span | bytes
"""Element of a list: a span in the file, or new text."""
Splice: TypeAlias = tuple[int, int, bytes]
"""Start and end of a byte span, and the text that replaces it."""

_BLANK = b" \t"
_BREAK = b"\r\n"


def list_splices(
    data: bytes, elements: Sequence[Element], *, spans: Sequence[Span], close: int
) -> list[Splice]:
    """Splices that change a bracketed list into another list.

    Parameters
    ----------
    data : bytes
        Contents of the file.
    elements : sequence of span or bytes
        Elements of the new list.
    spans : sequence of span
        Spans of the current elements.
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
    """Bytes of a list element, from the file or new."""
    return element if isinstance(element, bytes) else data[element[0] : element[1]]


def line_span(data: bytes, span: Span) -> Span:
    """Span extended to whole lines if the rest of them is blank; otherwise unchanged."""
    start, end = line_start(data, span[0]), span[1]
    while data[end : end + 1] and data[end] in _BLANK:
        end += 1
    if (start and data[start - 1] not in _BREAK) or not data[end : end + 1]:
        return span
    if data.startswith(b"\r\n", end):
        return start, end + 2
    return (start, end + 1) if data[end] in _BREAK else span


def line_start(data: bytes, offset: int) -> int:
    """Start of the line if only blanks precede the offset, else the offset."""
    start = offset
    while start and data[start - 1] in _BLANK:
        start -= 1
    return start if not start or data[start - 1] in _BREAK else offset


def spliced(data: bytes, splices: Iterable[Splice], *, start: int, end: int) -> bytes:
    """Bytes from ``start`` to ``end`` with the splices that begin there."""
    pieces: list[bytes] = []
    position = start
    for first, last, text in sorted(splices):
        if start <= first < end:
            pieces += [data[position:first], text]
            position = last
    return b"".join([*pieces, data[position:end]])


_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*+", re.ASCII)
_BINARY = re.compile(r"[0-3][0-9A-F]*+")


def format_value(value: Value) -> bytes:
    """Format a value as Part 21 text, such that reading it returns the value.

    A real that was read keeps its characters; others get the shortest text for the same number.

    Raises
    ------
    TypeError
        If the value has no form in ISO 10303-21.
    ValueError
        If a number is not finite, or an enumeration or binary contains characters that are not
        allowed.
    """
    pieces: list[bytes] = []
    pending: list[Value | bytes] = [value]
    while pending:
        item = pending.pop()
        if isinstance(item, bytes):
            pieces.append(item)
        elif isinstance(item, tuple):
            pending.extend(reversed(_bracketed(item)))
        elif isinstance(item, Typed):
            pending.extend((b")", item.value, _keyword(item.keyword) + b"("))
        else:
            pieces.append(_scalar(item).encode("ascii"))
    return b"".join(pieces)


def _bracketed(values: tuple[Value, ...]) -> "list[Value | bytes]":
    """List values with brackets and commas between them."""
    items: list[Value | bytes] = [b"("]
    for position, value in enumerate(values):
        items += [b",", value] if position else [value]
    return [*items, b")"]


def _keyword(keyword: str) -> bytes:
    """Keyword as bytes, after a check of its characters."""
    name = keyword.encode("ascii", errors="replace")
    if KEYWORD.fullmatch(name) is None:
        raise ValueError(f"{keyword!r} is not a valid keyword")
    return name


def _scalar(value: Value) -> str:
    """Text of a value that contains no other values."""
    if value is None:
        return "$"
    if isinstance(value, Derived):
        return "*"
    if isinstance(value, float):
        return _real(value)
    if isinstance(value, int) and not isinstance(value, bool):
        return f"#{int(value)}" if isinstance(value, Ref) else str(int(value))
    if isinstance(value, Enumeration):
        return f".{_checked(value, _NAME)}."
    if isinstance(value, Binary):
        return f'"{_checked(value, _BINARY)}"'
    if isinstance(value, str):
        return f"'{encode(value)}'"
    raise TypeError(f"{value!r} has no form in ISO 10303-21")


def _checked(value: str, pattern: re.Pattern[str]) -> str:
    """Return the value if it matches the pattern of allowed characters."""
    if pattern.fullmatch(value) is None:
        raise ValueError(f"{value!r} is not a valid {type(value).__name__.lower()}")
    return str.__str__(value)


def _real(value: float) -> str:
    """Text of a real: as it was read, or else the shortest with a point."""
    lexeme = value.lexeme if isinstance(value, Real) else ""
    if lexeme:
        return lexeme
    if not math.isfinite(value):
        raise ValueError(f"{float(value)} cannot be written")
    mantissa, _, exponent = float.__repr__(value).partition("e")
    mantissa = mantissa.removesuffix(".0")
    point = "" if "." in mantissa else "."
    return f"{mantissa}{point}E{exponent}" if exponent else f"{mantissa}{point}"


class Edits:
    """Changes of one file, collected and then applied at once.

    The object has state, but the file itself never changes; an instance that was added can be
    edited and removed like an instance of the file.

    Parameters
    ----------
    file : Part21File
        File to be edited.
    """

    def __init__(self, file: Part21File) -> None:
        self.file = file
        self._changed: dict[int, list[Element]] = {}
        self._in_parts: dict[tuple[int, int, int], bytes] = {}
        self._removed: set[int] = set()
        self._added: dict[int, _Added] = {}
        self._schemas: list[Element] | None = None
        self._largest: int | None = None

    def __contains__(self, id: int) -> bool:
        return id in self._added or (id in self.file and id not in self._removed)

    def replace_parameter(self, id: int, position: int, value: Value) -> None:
        """Replace a parameter of an instance; positions count from 0.

        Raises
        ------
        KeyError, IndexError
            If there is no such instance or parameter.
        Part21Error
            If the instance is malformed or complex.
        """
        parameters = self._parameters(id)
        if not 0 <= position < len(parameters):
            raise IndexError(
                f"#{id} has {len(parameters)} parameters, none at position {position}"
            )
        parameters[position] = format_value(value)

    def replace_in_part(self, id: int, part: int, position: int, value: Value) -> None:
        """Replace a parameter in one part of an instance of the file.

        Parameters
        ----------
        id, part, position : int
            Instance, its part, and the place in the part, counted from 0; a simple instance
            has one part.

        Raises
        ------
        KeyError, IndexError
            If there is no such instance or parameter.
        """
        if id not in self:
            raise KeyError(id)
        if self.file.keyword(id):
            self.replace_parameter(id, position, value)
            return
        self._in_parts[id, part, position] = format_value(value)

    def append_parameter(self, id: int, value: Value) -> None:
        """Add a parameter to an instance after its last one."""
        self._parameters(id).append(format_value(value))

    def remove_parameter(self, id: int, position: int) -> None:
        """Remove a parameter, counted from 0; those behind it move up.

        Raises
        ------
        IndexError
            If there is no such parameter.
        """
        parameters = self._parameters(id)
        if not 0 <= position < len(parameters):
            raise IndexError(
                f"#{id} has {len(parameters)} parameters, none at position {position}"
            )
        del parameters[position]

    def next_id(self) -> int:
        """Id of the next added instance: one above the largest id kept."""
        if self._largest is None:
            kept = (id for id in self.file.ids() if id not in self._removed)
            self._largest = max((*self._added, max(kept, default=0)))
        return self._largest + 1

    def add(self, keyword: str, parameters: tuple[Value, ...]) -> Ref[object]:
        """Add an instance at the end of the last DATA section; return its reference."""
        id = self.next_id()
        texts: list[Element] = [format_value(value) for value in parameters]
        self._added[id] = _Added(keyword=_keyword(keyword), parameters=texts)
        self._largest = id
        return Ref(id)

    def add_complex(self, parts: Sequence[tuple[str, tuple[Value, ...]]]) -> Ref[object]:
        """Add a complex instance, as :meth:`add` does a simple one; return its reference."""
        id = self.next_id()
        texts = (_keyword(keyword) + format_value(values) for keyword, values in parts)
        self._added[id] = _Added(keyword=b"", parameters=[b"".join(texts)])
        self._largest = id
        return Ref(id)

    def remove(self, id: int) -> None:
        """Remove an instance, and its line if it contains nothing else.

        Raises
        ------
        KeyError
            If there is no such instance.
        """
        if id not in self:
            raise KeyError(id)
        if id in self._added:
            del self._added[id]
        else:
            self._removed.add(id)
            self._changed.pop(id, None)
            for key in [key for key in self._in_parts if key[0] == id]:
                del self._in_parts[key]
        if id == self._largest:
            self._largest = None

    def add_schema(self, name: str) -> None:
        """Add a name to FILE_SCHEMA unless it is already there."""
        if not any(_is_schema(text, name) for text in self._schema_names()):
            self._schema_elements().append(format_value(name))

    def remove_schema(self, name: str) -> None:
        """Remove a schema name from FILE_SCHEMA."""
        names = self._schema_names()
        elements = self._schema_elements()
        self._schemas = [
            element
            for text, element in zip(names, elements, strict=True)
            if not _is_schema(text, name)
        ]

    def apply(self) -> bytes:
        """Bytes of the file with all changes; without changes, its own bytes."""
        data = self.file.data
        splices = self._splices()
        if not self._added:
            return spliced(data, splices, start=0, end=len(data))
        place = line_start(data, self.file.structure.data_end)
        newline = line_break(data)
        before = spliced(data, splices, start=0, end=place)
        gap = b"" if before.endswith((b"\n", b"\r")) else newline
        lines = b"".join(added.text(id) + newline for id, added in self._added.items())
        return before + gap + lines + spliced(data, splices, start=place, end=len(data))

    def _splices(self) -> list[Splice]:
        """Splices for all changes within the existing text of the file."""
        file = self.file
        splices: list[Splice] = []
        for id, elements in self._changed.items():
            spans, close = file.parameter_spans(id), file.closing_bracket(id)
            splices += list_splices(file.data, elements, spans=spans, close=close)
        for (id, part, position), text in self._in_parts.items():
            start, end = file.part_spans(id)[part][position]
            if file.data[start:end] != text:
                splices.append((start, end, text))
        for id in self._removed:
            splices.append((*line_span(file.data, file.span(id)), b""))
        if self._schemas is not None:
            close = file.schema_list_span()[1]
            spans = self._schema_spans()
            splices += list_splices(file.data, self._schemas, spans=spans, close=close)
        return splices

    def _parameters(self, id: int) -> list[Element]:
        """Current parameters of an instance, as a list to be modified in place."""
        if id in self._added:
            return self._added[id].parameters
        if id not in self:
            raise KeyError(id)
        if id not in self._changed:
            self._changed[id] = list(self.file.parameter_spans(id))
        return self._changed[id]

    def _schema_spans(self) -> tuple[Span, ...]:
        """Byte spans of the names in FILE_SCHEMA."""
        start, end = self.file.schema_list_span()
        opening = "LIST("
        inner = self.file.data[start:end].decode("latin-1")
        origin = start - len(opening)
        spans = parse_record(f"{opening}{inner});").spans
        return tuple((origin + first, origin + last) for first, last in spans)

    def _schema_elements(self) -> list[Element]:
        """Current names in FILE_SCHEMA, as a list to be modified in place."""
        if self._schemas is None:
            self._schemas = list(self._schema_spans())
        return self._schemas

    def _schema_names(self) -> list[str]:
        """Current names in FILE_SCHEMA as text without apostrophes."""
        data = self.file.data
        texts = (
            element if isinstance(element, bytes) else data[element[0] : element[1]]
            for element in self._schema_elements()
        )
        return [decode(text[1:-1].decode("latin-1")) for text in texts]


@dataclass(slots=True, kw_only=True)
class _Added:
    """Instance that is not yet in the file."""

    keyword: bytes
    parameters: list[Element]

    def text(self, id: int) -> bytes:
        """Line of the instance, without line break."""
        texts = (element for element in self.parameters if isinstance(element, bytes))
        return b"#%d=%s(%s);" % (id, self.keyword, b",".join(texts))


def _is_schema(text: str, name: str) -> bool:
    """True if an entry of FILE_SCHEMA names a schema, ignoring an object identifier."""
    return text.partition("{")[0].strip().upper() == name.strip().upper()


def described_as(
    source: Part21File, schemas: Sequence[str], instances: Iterable[bytes]
) -> bytes:
    """File with the description and the name of another, of given schemas and instances."""
    header = [
        source.data[statement.start : statement.end] + b";"
        for statement in source.structure.statements
        if statement.keyword in ("FILE_DESCRIPTION", "FILE_NAME")
    ]
    names = b",".join(format_value(name) for name in schemas)
    return b"\n".join([
        b"ISO-10303-21;",
        b"HEADER;",
        *header,
        b"FILE_SCHEMA((%s));" % names,
        b"ENDSEC;",
        b"DATA;",
        *instances,
        b"ENDSEC;",
        b"END-ISO-10303-21;",
        b"",
    ])
