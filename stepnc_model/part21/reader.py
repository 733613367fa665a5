r"""Read access to an ISO 10303-21 file: an index at once, parameters on request.

The HEADER section is read as far as it follows the standard [1]_.

Apostrophes that the directive ``\S\`` takes as its character.

``\S\`` is followed by one character of the basic alphabet, which includes the apostrophe [2]_:
``\S\'`` is a section sign, and does not end the string. All patterns of this package take an
apostrophe for the end of a string, so they scan bytes of the same length in which that
apostrophe is masked. The bytes of the file themselves stay as they are.

References
----------
.. [1] ISO 10303-21:2016, 8.2 (file_description, file_name, file_schema).
.. [2] ISO 10303-21:2016, 6.4.3: ``page = \S\ character``.
"""

import re
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from heapq import merge
from typing import Self

from stepnc_model.errors import Finding, FindingList, SchemaError, Severity
from stepnc_model.part21.compression import unpacked
from stepnc_model.part21.grammar import closing, skip_blank
from stepnc_model.part21.index import Index, InstanceRecord, Part, parse_record, part_spans
from stepnc_model.part21.places import Lines, SyntaxSlip, error_at
from stepnc_model.part21.structure import FileStructure, Statement, read_structure
from stepnc_model.part21.tokens import is_tidy, tidy_values
from stepnc_model.part21.values import Value
from stepnc_model.plurals import counted

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


def _mask(flags: bytearray, data: bytes, start: int, end: int) -> None:
    """Mask the apostrophes that directives between two offsets take."""
    for directive in _DIRECTIVE.finditer(data, start, end):
        if directive[0] == _TAKEN:
            flags[directive.end() - 1] |= MASK


_ARITY = {"FILE_DESCRIPTION": 2, "FILE_NAME": 7, "FILE_SCHEMA": 1}


@dataclass(frozen=True, slots=True, kw_only=True)
class HeaderReading:
    """Schemas named in a header, and deviations in it."""

    schemas: tuple[str, ...]
    """Schema names as written, without blank ones."""
    slips: tuple[SyntaxSlip, ...]


def read_header(data: bytes, statements: tuple[Statement, ...]) -> HeaderReading:
    """Read the header statements of a file; deviations are noted and never fatal."""
    slips: list[SyntaxSlip] = []
    values: dict[str, tuple[Value, ...]] = {}
    for statement in statements:
        if statement.keyword not in _ARITY:
            continue
        if statement.keyword in values:
            message = f"{statement.keyword} is given twice; the first one is used"
            slips.append(SyntaxSlip(offset=statement.start, message=message))
            continue
        values[statement.keyword] = _parameters(data, statement, slips=slips)
    missing = (keyword for keyword in _ARITY if keyword not in values)
    slips.extend(SyntaxSlip(offset=0, message=f"{keyword} is missing") for keyword in missing)
    schemas = (name for name in _texts(values.get("FILE_SCHEMA", ())) if name.strip())
    return HeaderReading(schemas=tuple(schemas), slips=tuple(slips))


def _parameters(
    data: bytes, statement: Statement, *, slips: list[SyntaxSlip]
) -> tuple[Value, ...]:
    """Values of one header statement; empty if they cannot be read."""
    record = parse_record(data[statement.start : statement.end].decode("latin-1"))
    slips.extend(replace(slip, offset=statement.start + slip.offset) for slip in record.slips)
    if record.error is not None:
        message = f"{statement.keyword}: {record.error.message}"
        slips.append(SyntaxSlip(offset=statement.start + record.error.offset, message=message))
        return ()
    values = record.parts[0][1]
    expected = _ARITY[statement.keyword]
    if len(values) != expected:
        message = (
            f"{statement.keyword} has {counted(len(values), 'parameter')} instead of {expected}"
        )
        slips.append(SyntaxSlip(offset=statement.start, message=message))
    return values


def _texts(value: Value) -> tuple[str, ...]:
    """All strings in a value, in order."""
    found: list[str] = []
    pending = [value]
    while pending:
        item = pending.pop()
        if isinstance(item, tuple):
            pending.extend(reversed(item))
        elif isinstance(item, str):
            found.append(item)
    return tuple(found)


_RULE = "ISO 10303-21"

MAX_EXAMINED = 1 << 23
"""Limit for checking instances in non-plain form, bytes; their parsing is ten times slower."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Part21File:
    """Immutable view of one file's bytes.

    The class has no slots: line numbers, header and instances by keyword are computed on
    first use and cached.
    """

    data: bytes
    name: str
    structure: FileStructure

    @classmethod
    def from_bytes(cls, data: bytes, *, name: str = "") -> Self:
        """Index the instances of a file.

        Parameters
        ----------
        data : bytes
            Contents of the whole file, also compressed as ZIP archive or with gzip.
        name : str
            File name for messages.

        Raises
        ------
        Part21Error
            If the bytes are not an exchange structure, break off within an instance, string or
            comment, define an id twice, or exceed a limit of the reader.
        """
        plain = unpacked(data)
        return cls(data=plain, name=name, structure=read_structure(masked(plain)))

    def __contains__(self, id: int) -> bool:
        return id in self._index.positions

    def __len__(self) -> int:
        return len(self._index.ids)

    def ids(self) -> Sequence[int]:
        """Ids of the instances of all DATA sections in file order."""
        return self._index.ids

    def ids_of(self, keyword: str) -> Sequence[int]:
        """Ids of all instances of a keyword in file order."""
        return self._ids_by_keyword.get(keyword.upper(), ())

    def keyword(self, id: int) -> str:
        """Entity name in upper case; empty for a complex instance."""
        return self._index.keywords[self._index.codes[self._position(id)]]

    def parameters(self, id: int) -> tuple[Value, ...]:
        """Parameters of a simple instance as Python values.

        Raises
        ------
        Part21Error
            If they are malformed, or if the instance is complex: see :meth:`parts`.
        """
        text = self._text(id)
        if is_tidy(text):
            return tidy_values(text)
        return self._simple(id).parts[0][1]

    def parts(self, id: int) -> tuple[Part, ...]:
        """Keywords and parameters of a complex instance; a simple one has one part.

        Raises
        ------
        Part21Error
            If a part is malformed.
        """
        text = self._text(id)
        if is_tidy(text):
            return ((self.keyword(id), tidy_values(text)),)
        return self._record(id).parts

    def parameter_spans(self, id: int) -> tuple[tuple[int, int], ...]:
        """Byte spans of the parameters of a simple instance, without comments around them.

        Raises
        ------
        Part21Error
            If the parameters are malformed, or if the instance is complex.
        """
        origin = self._body(id)
        return tuple((origin + a, origin + b) for a, b in self._simple(id).spans)

    def part_spans(self, id: int) -> tuple[tuple[tuple[int, int], ...], ...]:
        """Byte spans of the parameters of each part of a complex instance.

        Raises
        ------
        Part21Error
            If the instance is malformed.
        """
        self._record(id)
        origin = self._body(id)
        text = self._text(id).partition("=")[2]
        return tuple(
            tuple((origin + a, origin + b) for a, b in spans) for spans in part_spans(text)
        )

    def closing_bracket(self, id: int) -> int:
        """Offset of the ``)`` that ends the parameters of a simple instance."""
        return self._body(id) + self._simple(id).end

    def span(self, id: int) -> tuple[int, int]:
        """Byte span of an instance's text, ``#id=...;``."""
        position = self._position(id)
        return self._index.starts[position], self._index.ends[position]

    def line(self, id: int) -> int:
        """Line on which the instance begins, counted from 1."""
        return self._lines.line(self.span(id)[0])

    def label(self, id: int) -> str:
        """Name of an instance in messages, ``#19 PLANE_FINISH_MILLING``."""
        return f"#{id} {self.keyword(id)}".rstrip()

    @property
    def schemas(self) -> tuple[str, ...]:
        """Schema names in FILE_SCHEMA as written, without blank ones."""
        return self._header.schemas

    def schema_list_span(self) -> tuple[int, int]:
        """Byte span between the inner brackets of FILE_SCHEMA.

        Raises
        ------
        Part21Error
            If the file has no FILE_SCHEMA.
        """
        for statement in self.structure.statements:
            if statement.keyword == "FILE_SCHEMA":
                inner = skip_blank(self.scanned, statement.bracket + 1, slips=[])
                if self.data.startswith(b"(", inner):
                    return inner + 1, closing(self.scanned, inner) - 1
                return statement.bracket + 1, statement.end - 1
        raise error_at(self.data, 0, "FILE_SCHEMA is missing")

    @cached_property
    def scanned(self) -> bytes:
        r"""Bytes to search for strings: those of the file, with ``\S\'`` masked."""
        return masked(self.data)

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """Deviations from the syntax, in file order.

        Malformed parameters, which :meth:`parameters` rejects, are findings of severity
        ``ERROR``. All instances are inspected on first use; of very many findings, the
        first are listed and the rest counted.
        """
        found = FindingList()
        frame = ((slip, None) for slip in (*self.structure.slips, *self._header.slips))
        for slip, id in merge(sorted(frame, key=_offset), self._within(found), key=_offset):
            if found.has_room(slip.severity):
                found.add(self._finding(slip, "" if id is None else self.label(id)))
            else:
                found.count(slip.severity)
        if self._unexamined:
            found.add(self._not_examined())
        return found.all()

    @cached_property
    def _index(self) -> Index:
        """Index of the file's instances."""
        return self.structure.index

    @cached_property
    def _lines(self) -> Lines:
        return Lines(self.data)

    @cached_property
    def _header(self) -> HeaderReading:
        return read_header(self.scanned, self.structure.statements)

    @cached_property
    def _ids_by_keyword(self) -> "dict[str, array[int]]":
        """Ids by keyword, regardless of letter case."""
        found: dict[str, array[int]] = {name: array("q") for name in self._index.keywords}
        columns = [found[name] for name in self._index.keywords]
        for id, code in zip(self._index.ids, self._index.codes, strict=True):
            columns[code].append(id)
        return found

    def _position(self, id: int) -> int:
        """Position of an instance in the index.

        Raises
        ------
        SchemaError
            If the file has no such instance: a fault of the file that refers to it.
        """
        try:
            return self._index.positions[id]
        except KeyError:
            raise self._missing(int(id)) from None

    def _missing(self, id: int) -> SchemaError:
        """Error about an instance that does not exist, with the first that refers to it."""
        pattern = re.compile(rb"#0*%d(?![0-9])(?!\s*=)" % id)
        for other in self._index.ids:
            start, end = self.span(other)
            if (found := pattern.search(self.data, start, end)) is not None:
                return SchemaError(
                    f"#{id} does not exist in this file",
                    entity=self.label(other),
                    line=self._lines.line(found.start()),
                )
        return SchemaError("does not exist in this file", entity=f"#{id}")

    def _body(self, id: int) -> int:
        """Offset behind the ``=`` of an instance."""
        start, end = self.span(id)
        return self.data.index(b"=", start, end) + 1

    def _text(self, id: int) -> str:
        """Text of an instance from ``#`` to ``;``, one character per byte."""
        start, end = self.span(id)
        return self.scanned[start:end].decode("latin-1")

    def _read(self, id: int) -> InstanceRecord:
        return parse_record(self._text(id).partition("=")[2])

    def _record(self, id: int) -> InstanceRecord:
        """Parsed instance; an error if it is malformed."""
        record = self._read(id)
        if record.error is not None:
            offset = self._body(id) + record.error.offset
            raise error_at(self.data, offset, f"{self.label(id)}: {record.error.message}")
        return record

    def _simple(self, id: int) -> InstanceRecord:
        """Parsed instance; an error if it is malformed or complex."""
        record = self._record(id)
        if record.is_complex:
            message = f"#{id} is a complex instance, which has parts instead of parameters"
            raise error_at(self.data, self.span(id)[0], message)
        return record

    def is_examined(self, id: int) -> bool:
        """True if a check of the whole file inspects an instance.

        All instances in the plain form of the standard are inspected; of the others, which are
        slow to parse, up to ``MAX_EXAMINED`` bytes. :meth:`parameters` reads every instance.
        """
        return id not in self._unexamined

    @cached_property
    def _untidy(self) -> "array[int]":
        """Ids of the instances that are not in the plain form, in file order."""
        return array("q", (id for id in self._index.ids if not is_tidy(self._text(id))))

    @cached_property
    def _unexamined(self) -> frozenset[int]:
        """Ids of non-plain instances beyond the limit of ``MAX_EXAMINED`` bytes."""
        left, found = MAX_EXAMINED, set()
        for id in self._untidy:
            start, end = self.span(id)
            left -= end - start
            if left < 0:
                found.add(id)
        return frozenset(found)

    def _not_examined(self) -> Finding:
        """Finding about the instances that were not checked."""
        first = min(self._unexamined, key=self.span)
        return Finding(
            severity=Severity.WARNING,
            message=(
                f"{counted(len(self._unexamined), 'instance')} from here on not in the plain "
                "form of the standard and not checked: more than "
                f"{MAX_EXAMINED >> 20} MB of them"
            ),
            entity=self.label(first),
            line=self.line(first),
            rule=_RULE,
        )

    def _within(self, findings: FindingList) -> "Iterator[tuple[SyntaxSlip, int | None]]":
        """Deviations within instances; an error that stops the parsing comes last."""
        for id in self._untidy:
            if not self.is_examined(id):
                continue
            record, origin = self._read(id), self._body(id)
            for slip in (*record.slips, *filter(None, (record.error,))):
                yield replace(slip, offset=origin + slip.offset), id
            findings.count(Severity.WARNING, record.unlisted)

    def _finding(self, slip: SyntaxSlip, label: str = "") -> Finding:
        """Convert a syntax deviation to a finding."""
        return Finding(
            severity=slip.severity,
            message=slip.message,
            entity=label,
            line=self._lines.line(slip.offset),
            rule=_RULE,
        )


def _offset(item: tuple[SyntaxSlip, int | None]) -> int:
    return item[0].offset
