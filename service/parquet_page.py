"""Headers of the pages of a Parquet file, read without the pages.

The footer of a file may state anything about its pages; what a reader makes room for stands in
their own headers.

References
----------
.. [1] Apache Parquet format, ``parquet.thrift``: PageHeader.
.. [2] Apache Thrift, compact protocol.
"""

import mmap
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from pyarrow import parquet

DEEPEST = 8
"""Structures within each other in a header."""

SIZE, PACKED, DATA, DICTIONARY, DATA_2 = 2, 3, 5, 7, 8
"""Fields of PageHeader: bytes unpacked and packed, and what is known of each kind of page."""

COUNT, ENCODING, ENCODING_2 = 1, 2, 4
"""Fields of what is known of a page: number of values, and encoding, also of a data page of the
second version."""

STOP, TRUE, FALSE, BYTE, INTEGERS, DOUBLE, BINARY, STRUCT = 0, 1, 2, 3, (4, 5, 6), 7, 8, 12
"""Types of the compact protocol that a header may have."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ParquetPage:
    """A page of a column."""

    size: int
    """Bytes of the page once it is unpacked."""
    count: int
    """Number of its values."""
    encoding: int
    """Number of the encoding of the values; -1: not known."""
    is_dictionary: bool


def pages(content: mmap.mmap, chunk: parquet.ColumnChunkMetaData) -> Iterator[ParquetPage]:
    """Yield the pages of one column in one group of rows.

    Parameters
    ----------
    content : mmap
        The whole file.
    chunk : ColumnChunkMetaData

    Raises
    ------
    ValueError
        When a header is damaged.
    """
    at = int(chunk.data_page_offset)
    dictionary = chunk.dictionary_page_offset
    if dictionary and 0 < dictionary < at:
        at = int(dictionary)
    end = at + chunk.total_compressed_size
    while at < end:
        try:
            header, at = _struct(content, at, 0)
        except IndexError as error:
            raise ValueError("the header of a page breaks off") from error
        size, packed = header.get(SIZE), header.get(PACKED)
        if not isinstance(size, int) or not isinstance(packed, int) or min(size, packed) < 0:
            raise ValueError("the header of a page has no sizes")
        at += packed
        kind = next((each for each in (DATA, DICTIONARY, DATA_2) if each in header), None)
        about = {} if kind is None else header[kind]
        yield ParquetPage(
            size=size,
            count=about.get(COUNT, 0),
            encoding=about.get(ENCODING_2 if kind == DATA_2 else ENCODING, -1),
            is_dictionary=kind == DICTIONARY,
        )


def _struct(content: mmap.mmap, at: int, depth: int) -> tuple[dict[int, Any], int]:
    """Fields of a structure by their ids, and the offset behind it."""
    if depth > DEEPEST:
        raise ValueError("the header of a page is nested too deeply")
    found: dict[int, Any] = {}
    id = 0
    while (head := content[at]) != STOP:
        at += 1
        if head >> 4:
            id += head >> 4
        else:
            id, at = _integer(content, at)
        found[id], at = _value(content, at, head & 15, depth)
    return found, at + 1


def _value(content: mmap.mmap, at: int, kind: int, depth: int) -> tuple[Any, int]:
    """Value of a field, None for what nobody asks for, and the offset behind it."""
    if kind in {TRUE, FALSE}:
        return None, at
    if kind == BYTE:
        return None, at + 1
    if kind in INTEGERS:
        return _integer(content, at)
    if kind == DOUBLE:
        return None, at + 8
    if kind == BINARY:
        size, at = _varint(content, at)
        return None, at + size
    if kind == STRUCT:
        return _struct(content, at, depth + 1)
    raise ValueError(f"the header of a page has a value of the type {kind}")


def _integer(content: mmap.mmap, at: int) -> tuple[int, int]:
    value, at = _varint(content, at)
    return (value >> 1) ^ -(value & 1), at


def _varint(content: mmap.mmap, at: int) -> tuple[int, int]:
    value = 0
    for shift in range(0, 64, 7):
        byte = content[at]
        at += 1
        value |= (byte & 127) << shift
        if byte < 128:
            return value, at
    raise ValueError("the header of a page has a number without an end")
