"""Recorded runs as tables: columns of Parquet and CSV files, read in pieces.

The columns are those that ``stepnc simulate``, ``control`` and ``record`` write. CSV files may
use semicolons or tabs, and decimal commas then.

Signals of a recorded run that the control loop needs, from a table of columns.
"""

import csv
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import csv as arrow_csv

from service.files import require_regular
from service.outputs.parquet_pieces import parquet_file, parquet_pieces
from simulator.client.columns import EXECUTION, RUNNING, TIME
from simulator.motion.segments import Floats
from simulator.plant.recorded_machine import RecordedSignals
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


POSITIONS = tuple(f"{axis}_axis_position_actual" for axis in "xyz")
FEED = ("path_feedrate_actual",)
FORCE = ("cutting_force", "force_measured")
POWER = ("c_axis_wattage", "spindle_power")
"""Columns as ``simulate`` and ``record`` name them, and as ``control`` does."""


def read_signals(path: Path) -> RecordedSignals:
    """Read a recorded run, from its start to its completion where the file says so.

    Raises
    ------
    StepNcError
        When the file cannot be read, lacks a column, or times do not ascend.
    """
    if path.suffix.lower() not in TABLES:
        raise StepNcError(f"{path}: expected a .parquet or .csv file of `stepnc record`")
    names = headings(path)
    for needed in ((TIME,), POSITIONS, FORCE + POWER, FEED):
        if not any(name in names for name in needed):
            raise StepNcError(f"{path}: no column {' or '.join(needed)}")
    kinds = {TIME: pa.float64()}
    kinds |= {
        name: pa.float64() for name in (*POSITIONS, *FEED, *FORCE, *POWER) if name in names
    }
    if EXECUTION in names:
        kinds[EXECUTION] = pa.string()
    table = pa.Table.from_batches(
        list(batches(path, kinds)), schema=pa.schema(list(kinds.items()))
    )
    time = _numbers(table, TIME)
    if not (np.diff(time) >= 0.0).all():
        at = int(np.flatnonzero(~(np.diff(time) >= 0.0))[0])
        raise StepNcError(
            f"{path}: row {at + 2}: time {time[at + 1]:g} s: it must not be before "
            f"{time[at]:g} s"
        )
    rows = _running(table)
    return RecordedSignals(
        time=time[rows],
        position=np.column_stack([_first(table, (name,)) for name in POSITIONS])[rows],
        feed=_first(table, FEED)[rows],
        force=_first(table, FORCE)[rows],
        power=_first(table, POWER)[rows],
    )


def _numbers(table: pa.Table, name: str) -> Floats:
    return np.asarray(table.column(name).to_numpy(), dtype=np.float64)


def _first(table: pa.Table, names: tuple[str, ...]) -> Floats:
    """Return the first column that is there; NaN without any."""
    found = next((name for name in names if name in table.column_names), None)
    return np.full(len(table), np.nan) if found is None else _numbers(table, found)


def _running(table: pa.Table) -> slice:
    """Return the rows of the first run of the program; all where it is not told."""
    if EXECUTION not in table.column_names:
        return slice(None)
    words = table.column(EXECUTION).to_pylist()
    begin = next((row for row, word in enumerate(words) if word in RUNNING), 0)
    ends = (row for row in range(begin, len(words)) if words[row] == "PROGRAM_COMPLETED")
    return slice(begin, next(ends, len(words)) + 1)
