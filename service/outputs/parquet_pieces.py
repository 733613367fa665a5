"""Parquet files in pieces, with budgets that are checked before memory is spent.

Dictionaries, runs and compression let some kilobytes of Parquet stand for gigabytes. The
budgets grow with the file: a large log is read, and a small file cannot become a large table.

Headers of the pages of a Parquet file, read without the pages.

The footer of a file may state anything about its pages; what a reader makes room for stands in
their own headers.

References
----------
.. [1] Apache Parquet format, ``parquet.thrift``: PageHeader.
.. [2] Apache Thrift, compact protocol.
"""

import mmap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
from pyarrow import compute, parquet

from service.files import require_regular
from stepnc_model.errors import StepNcError

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


MOST_ROWS = 1_000_000
"""Rows of a file of any size. Each further row needs a byte of the file: one of a log, whose
times ascend, takes 10 to 50."""

MOST_TEXT = 1 << 28
"""Bytes of all texts of a file of any size."""

TEXT_PER_BYTE = 16
"""Further bytes of text for each byte of the file."""

MOST_OF_PIECE = 1 << 26
"""Bytes of the texts in one piece."""

LARGEST_PAGE = 1 << 25
"""Bytes of an unpacked page; writers make pages of 1 MB."""

LARGEST_DICTIONARY = 1 << 23
"""Bytes of an unpacked dictionary of texts, all of which are looked at for each piece."""

MOST_OPEN = 1 << 28
"""Bytes of the largest pages of all columns that are read, which are unpacked at once."""

MOST_PAGES = 200_000
"""Pages that are read; some 30 000 hold 10 million rows of a log in groups of 8192."""

LONGEST_TEXT = 1 << 12
"""Mean bytes of the texts in a page without a dictionary."""

MOST_MEMBERS = 100_000
"""Members of a list in the footer, such as groups of rows."""

LONGEST_WORD = 1 << 24
"""Bytes of a text in the footer, such as the metadata of a run."""

TEXTS = (pa.string(), pa.large_string(), pa.binary(), pa.large_binary())

IN_DICTIONARY = frozenset({2, 8})
"""Encodings of pages whose values are places in a dictionary."""

WITH_LENGTHS = frozenset({0, 3, 6})
"""Encodings in which each text takes its own length; another repeats the start of the last."""


def parquet_file(path: Path, *, texts: Sequence[str] = ()) -> parquet.ParquetFile:
    """Open a file, and refuse one with far more rows than its size explains.

    Parameters
    ----------
    texts : sequence of str
        Columns that are read as dictionaries.

    Raises
    ------
    StepNcError
        With the number of rows and the bound.
    """
    require_regular(path)
    size = path.stat().st_size
    # Buffers of the reader would keep the columns of the whole file.
    file = parquet.ParquetFile(
        path,
        pre_buffer=False,
        read_dictionary=list(texts),
        thrift_string_size_limit=LONGEST_WORD,
        thrift_container_size_limit=MOST_MEMBERS,
    )
    rows, most = file.metadata.num_rows, MOST_ROWS + size
    if rows > most:
        file.close()
        raise StepNcError(
            f"{path}: {rows} rows in a file of {size} bytes; at most {most} are accepted, "
            f"{MOST_ROWS} and one for each byte: write equal rows once, or as CSV"
        )
    return file


def parquet_pieces(
    path: Path, *, rows: int, columns: Sequence[str] | None = None
) -> Iterator[pa.RecordBatch]:
    """Yield the rows of a file in pieces, with some columns or all; no text is a dictionary.

    Parameters
    ----------
    rows : int
        Most rows of a piece.
    columns : sequence of str, optional

    Raises
    ------
    StepNcError
        When rows, pages or texts exceed their budget, with the value and the bound.
    """
    with parquet_file(path) as file:
        schema = file.schema_arrow
    names = list(schema.names if columns is None else columns)
    plain = pa.schema([_plain(schema.field(name)) for name in names], metadata=schema.metadata)
    texts = [field.name for field in plain if field.type in TEXTS]
    left = MOST_TEXT + TEXT_PER_BYTE * path.stat().st_size
    with parquet_file(path, texts=texts) as file:
        budget = _PageBudget(path, file.metadata, names)
        # A piece across groups would gather the dictionaries of all of them first.
        for group in range(file.num_row_groups):
            if not file.metadata.row_group(group).num_rows:
                # It has no pages.
                continue
            budget.require(group)
            for batch in file.iter_batches(rows, row_groups=[group], columns=names):
                left -= _require_texts(batch, left, path)
                arrays = [_as_plain(batch.column(each.name), each.type) for each in plain]
                yield pa.RecordBatch.from_arrays(arrays, schema=plain)


def _plain(field: pa.Field) -> pa.Field:
    """Field without a dictionary."""
    kind = field.type
    return field.with_type(kind.value_type) if pa.types.is_dictionary(kind) else field


def _as_plain(array: pa.Array, kind: pa.DataType) -> pa.Array:
    found = array.dictionary_decode() if pa.types.is_dictionary(array.type) else array
    return found if found.type == kind else found.cast(kind)


def _require_texts(batch: pa.RecordBatch, left: int, path: Path) -> int:
    """Bytes that the texts of a piece take once they are no dictionary any more.

    Raises
    ------
    StepNcError
        When they exceed their budget, with the column of most.
    """
    sizes = [_text_size(column) for column in batch.columns]
    size = sum(sizes)
    if size <= min(left, MOST_OF_PIECE):
        return size
    column = batch.schema.names[sizes.index(max(sizes))]
    if size > MOST_OF_PIECE:
        text = f"the texts of {batch.num_rows} rows take {size} bytes; at most {MOST_OF_PIECE}"
    else:
        text = (
            f"the texts of the file take more than {MOST_TEXT} bytes and {TEXT_PER_BYTE} for "
            "each byte of the file; no more"
        )
    raise StepNcError(f"{path}: column {column}: {text} are accepted")


def _text_size(column: pa.Array) -> int:
    """Bytes of the texts of a column; 0 if it has none."""
    if not pa.types.is_dictionary(column.type):
        return int(column.nbytes) if column.type in TEXTS else 0
    if column.dictionary.type not in TEXTS:
        return 0
    lengths = compute.binary_length(column.dictionary).cast(pa.int64())
    return int(compute.sum(lengths.take(column.indices)).as_py() or 0)


@dataclass
class _PageBudget:
    """Check of the pages of some columns. Running state: how many there were."""

    path: Path
    metadata: parquet.FileMetaData
    names: Sequence[str]
    count: int = 0

    def __post_init__(self) -> None:
        schema, wanted = self.metadata.schema, set(self.names)
        columns = [(at, schema.column(at)) for at in range(self.metadata.num_columns)]
        self._places = []
        for at, column in columns:
            if column.path.partition(".")[0] not in wanted:
                continue
            # One row of a list may stand for any number of values.
            if column.max_repetition_level:
                raise StepNcError(f"{self.path}: column {column.path}: lists are not accepted")
            self._places.append(at)

    def require(self, group: int) -> None:
        """Refuse a group of rows whose pages unpack to too much."""
        row_group, opened = self.metadata.row_group(group), 0
        with (
            self.path.open("rb") as file,
            mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content,
        ):
            for place in self._places:
                opened += self._opened(row_group.column(place), content)
        if opened > MOST_OPEN:
            raise StepNcError(
                f"{self.path}: the largest pages of {len(self._places)} columns unpack to "
                f"{opened} bytes; at most {MOST_OPEN} are accepted"
            )

    def _opened(self, chunk: parquet.ColumnChunkMetaData, content: mmap.mmap) -> int:
        """Bytes of a column that are unpacked at once."""
        largest = {True: 0, False: 0}
        is_text, name = chunk.physical_type == "BYTE_ARRAY", chunk.path_in_schema
        try:
            for page in pages(content, chunk):
                self.count += 1
                _require_page(page, is_text=is_text)
                largest[page.is_dictionary] = max(largest[page.is_dictionary], page.size)
        except ValueError as error:
            raise StepNcError(f"{self.path}: column {name}: {error}") from error
        if self.count > MOST_PAGES:
            raise StepNcError(f"{self.path}: more than {MOST_PAGES} pages")
        return sum(largest.values())


def _require_page(page: ParquetPage, *, is_text: bool) -> None:
    """Refuse a page that unpacks to too much, or whose values may.

    Raises
    ------
    ValueError
    """
    most = LARGEST_DICTIONARY if is_text and page.is_dictionary else LARGEST_PAGE
    if page.size > most:
        raise ValueError(f"a page unpacks to {page.size} bytes; at most {most} are accepted")
    if page.is_dictionary:
        # Room is made for the values before they are looked for.
        if page.count > page.size:
            raise ValueError(f"a dictionary of {page.size} bytes states {page.count} values")
        return
    if not is_text or page.encoding in IN_DICTIONARY or page.size <= LONGEST_TEXT:
        return
    if page.encoding not in WITH_LENGTHS:
        raise ValueError("texts that repeat parts of others (DELTA_BYTE_ARRAY) are not read")
    if page.size > LONGEST_TEXT * max(page.count, 1):
        raise ValueError(
            f"{page.count} texts take {page.size} bytes; at most {LONGEST_TEXT} each are "
            "accepted"
        )
