"""Rows of a run on their way to a Parquet or CSV file, written as they come.

The file gets its name when it is whole. A run that is broken off leaves what it has under
``.partial``, closed and readable.
"""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pyarrow as pa
from pyarrow import compute, csv, parquet

from service.formula import FIRST
from service.growing_file import GrowingFile
from stepnc_model.errors import WriteError

SUFFIXES = (".parquet", ".csv")

WORDS = pa.dictionary(pa.int32(), pa.string())
"""words that come again and again"""


class RunFile:
    """A file that grows. Running state; what ends it stands in :meth:`closing`.

    Parameters
    ----------
    path : Path
        Ends with ``.parquet`` or ``.csv``.
    schema : Schema
        Columns with their units as metadata.

    Raises
    ------
    WriteError
        When the ending is another, or the disk refuses.
    """

    def __init__(self, path: Path, schema: pa.Schema) -> None:
        self.path = path
        self.rows = 0
        self._is_text = require_suffix(path) == ".csv"
        self._names = schema.names
        self._file = GrowingFile(path)
        try:
            self._writer = self._opened(schema)
        except OSError as error:
            raise self._file.refused(error) from error

    @property
    def place(self) -> Path | None:
        """Name of the file once it is closed."""
        return self._file.place

    @property
    def partial(self) -> Path:
        """Name of the file that an interrupted run leaves."""
        return self._file.partial

    def write(self, columns: Sequence[pa.Array]) -> None:
        """More rows, as columns in the order of the schema.

        Raises
        ------
        WriteError
            When the disk refuses.
        """
        arrays = [_plain(column) for column in columns] if self._is_text else columns
        batch = pa.record_batch(arrays, names=self._names)
        try:
            self._writer.write(batch)
        except OSError as error:
            raise self._file.refused(error) from error
        self.rows += batch.num_rows

    @contextmanager
    def closing(self, *, is_whole: bool) -> Iterator[None]:
        """Write the last rows within it; then the file gets its name, or is left as partial.

        A file without rows is left only when it is whole.

        Raises
        ------
        WriteError
            When the disk refuses; nothing is left.
        """
        with self._file.closing(is_whole=is_whole, has_content=lambda: bool(self.rows)):
            yield
            self._writer.close()

    def _opened(self, schema: pa.Schema) -> parquet.ParquetWriter | csv.CSVWriter:
        if self._is_text:
            return csv.CSVWriter(self._file.stream, _spelled_out(schema))
        floats = [field.name for field in schema if pa.types.is_floating(field.type)]
        return parquet.ParquetWriter(
            self._file.stream,
            schema,
            compression="zstd",
            # Measured values hardly repeat; their bytes compress when each has its stream.
            use_dictionary=[name for name in schema.names if name not in floats],
            use_byte_stream_split=floats,
        )


def require_suffix(path: Path) -> str:
    """The ending of a file for a run, in small letters.

    Raises
    ------
    WriteError
        When it is neither of the two.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise WriteError(f"a run is written as {' or '.join(SUFFIXES)}", path=str(path))
    return suffix


def _spelled_out(schema: pa.Schema) -> pa.Schema:
    """Words as they are: text has no dictionaries."""
    return pa.schema([
        field.with_type(pa.string()) if pa.types.is_dictionary(field.type) else field
        for field in schema
    ])


def _plain(column: pa.Array) -> pa.Array:
    """Words spelled out, none of them a formula; numbers as they are."""
    if not isinstance(column, pa.DictionaryArray):
        return column
    return compute.replace_substring_regex(
        column.dictionary_decode(), pattern=f"^([{re.escape(FIRST)}])", replacement=r"'\1"
    )
