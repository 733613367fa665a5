"""Rows of a data set, read in pieces: its folder, a Parquet file or a CSV file.

Nothing larger than a piece is in memory at a time, so tables of any size are read.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa
from pyarrow import csv

from extras.learning.dataset_folder import MANIFEST, SCHEMA, DatasetFolder
from service.files import read_bytes, require_regular
from service.outputs.parquet_pieces import parquet_file, parquet_pieces
from stepnc_model.errors import StepNcError

PIECE = 16_384
"""Rows of a piece."""

BLOCK = 1 << 20
"""Bytes of a CSV file that are read at a time."""

MOST_ROWS = 10_000_000
"""Rows of a table that are read at most."""

MOST_HELD = 1 << 30
"""Bytes of a table that is held as a whole."""

TYPES = {each.name: each.type for each in SCHEMA if each.name != "row"}
"""Types of known columns in CSV files."""


@dataclass(frozen=True, slots=True)
class RowSource:
    """Rows at a path."""

    path: Path

    def table(self, first: int, last: int) -> pa.Table:
        """Rows from number ``first``, counted from 0, to before ``last``, or to the end.

        Raises
        ------
        StepNcError
            When the path holds no data set, or no rows.
        """
        pieces: list[pa.Table] = []
        size = 0
        for piece in self.pieces(first, last):
            size += piece.nbytes
            if size > MOST_HELD:
                raise StepNcError(
                    f"{self.path}: the rows take more than {MOST_HELD} bytes, the most that is "
                    "held at once: leave out columns that are not needed, or split the table"
                )
            pieces.append(piece)
        if not pieces:
            raise StepNcError(f"{self.path}: no rows yet")
        return pa.concat_tables(pieces)

    def pieces(
        self, first: int, last: int, columns: Sequence[str] | None = None
    ) -> Iterator[pa.Table]:
        """Yield the same rows in pieces of ``PIECE``, with some columns or all.

        Raises
        ------
        StepNcError
            When the path holds no data set.
        """
        held: list[pa.Table] = []
        size = at = 0
        for piece in self._read(columns):
            end = at + piece.num_rows
            wanted = piece.slice(max(0, first - at), max(0, min(end, last) - max(at, first)))
            at = end
            if wanted.num_rows:
                held.append(wanted)
                size += wanted.num_rows
            if size >= PIECE:
                yield pa.concat_tables(held)
                held, size = [], 0
            if at >= last:
                break
        if held:
            yield pa.concat_tables(held)

    def _read(self, columns: Sequence[str] | None) -> Iterator[pa.Table]:
        """Tables of the rows, as the files hold them."""
        if self.path.is_dir():
            if not (self.path / MANIFEST).exists():
                raise StepNcError(f"{self.path}: has no {MANIFEST}, so it is no data set")
            for table in DatasetFolder(self.path).tables(MOST_ROWS):
                yield table if columns is None else table.select(columns)
            return
        if not self.path.is_file():
            read_bytes(self.path)
        try:
            if self.path.suffix == ".csv":
                yield from self._of_csv(columns)
                return
            _require_parquet(self.path)
            for batch in parquet_pieces(self.path, rows=PIECE, columns=columns):
                yield pa.Table.from_batches([batch])
        except (pa.ArrowException, UnicodeDecodeError) as error:
            text = str(error).split("\n", maxsplit=1)[0]
            raise StepNcError(f"{self.path}: cannot be read: {text}") from error
        except OSError as error:
            raise StepNcError(f"{self.path}: {error.strerror or error}") from error

    def _of_csv(self, columns: Sequence[str] | None) -> Iterator[pa.Table]:
        options = csv.ConvertOptions(column_types=TYPES, include_columns=columns or [])
        reading = csv.ReadOptions(block_size=BLOCK)
        with csv.open_csv(self.path, read_options=reading, convert_options=options) as reader:
            for batch in reader:
                yield pa.Table.from_batches([batch])


def read_table(path: Path) -> pa.Table:
    """Read all rows at a path.

    Raises
    ------
    StepNcError
        When it holds no data set, or no rows.
    """
    return RowSource(path).table(0, MOST_ROWS)


def _require_parquet(path: Path) -> None:
    """Refuse a file that is no Parquet file.

    Raises
    ------
    StepNcError
    """
    require_regular(path)
    try:
        parquet_file(path).close()
    except pa.ArrowInvalid as error:
        text = str(error).split("\n", maxsplit=1)[0]
        raise StepNcError(f"{path}: is not a Parquet file: {text}") from error
