"""Recorded runs as tables: columns of Parquet and CSV files, read in pieces.

The columns are those that ``stepnc simulate``, ``control`` and ``record`` write. CSV files may
use semicolons or tabs, and decimal commas then.
"""

import csv
from collections.abc import Iterator, Mapping
from pathlib import Path

import pyarrow as pa
from pyarrow import csv as arrow_csv

from service.files import require_regular
from service.parquet_pieces import parquet_file, parquet_pieces
from stepnc_model.errors import StepNcError

TABLES = frozenset({".parquet", ".csv"})
"""Suffixes of tables."""

ROWS = 8192
"""Most rows in one piece of a Parquet file."""

BLOCK = 1 << 20
"""Bytes in one piece of a CSV file."""

LONGEST_HEADING = 1 << 16
"""Most characters of the heading line."""

UNKNOWN = ("", "nan", "NaN", "UNAVAILABLE")
"""Cells without a value."""

FAULTS = (pa.ArrowException, OSError, UnicodeDecodeError, csv.Error)
"""Errors of files that cannot be read."""


def headings(path: Path) -> list[str]:
    """Return the names of the columns.

    Raises
    ------
    StepNcError
        When the file cannot be read.
    """
    if not path.is_file():
        raise StepNcError(f"{path}: no such file")
    try:
        if path.suffix.lower() == ".parquet":
            with parquet_file(path) as file:
                return list(file.schema_arrow.names)
        line = _first_line(path)
        return next(csv.reader([line], delimiter=_delimiter(line)), [])
    except FAULTS as error:
        raise StepNcError(f"{path}: cannot be read: {error}") from error


def batches(path: Path, kinds: Mapping[str, pa.DataType]) -> Iterator[pa.RecordBatch]:
    """Yield columns of a table in pieces, in the given order and of the given types.

    Parameters
    ----------
    path : Path
    kinds : mapping
        Types of the wanted columns, which the file has.

    Raises
    ------
    StepNcError
        When the file cannot be read, or a cell is not of its type.
    """
    schema = pa.schema(list(kinds.items()))
    try:
        for piece in _pieces(path, kinds):
            if piece.num_rows:
                columns = {name: piece.column(name).cast(kind) for name, kind in kinds.items()}
                yield pa.record_batch(columns, schema=schema)
    except FAULTS as error:
        raise StepNcError(f"{path}: cannot be read: {error}") from error


def _pieces(path: Path, kinds: Mapping[str, pa.DataType]) -> Iterator[pa.RecordBatch]:
    require_regular(path)
    if path.suffix.lower() == ".parquet":
        yield from parquet_pieces(path, rows=ROWS, columns=list(kinds))
        return
    mark = _delimiter(_first_line(path))
    yield from arrow_csv.open_csv(
        path,
        read_options=arrow_csv.ReadOptions(block_size=BLOCK),
        parse_options=arrow_csv.ParseOptions(delimiter=mark),
        convert_options=arrow_csv.ConvertOptions(
            column_types=kinds,
            include_columns=list(kinds),
            null_values=list(UNKNOWN),
            strings_can_be_null=True,
            decimal_point="." if mark == "," else ",",
        ),
    )


def _first_line(path: Path) -> str:
    require_regular(path)
    with path.open(encoding="utf-8-sig", newline="") as file:
        return file.readline(LONGEST_HEADING)


def _delimiter(heading: str) -> str:
    return next((mark for mark in (";", "\t") if mark in heading), ",")
