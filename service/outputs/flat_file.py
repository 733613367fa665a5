"""Rows of named values as CSV, JSON or Parquet, written as they come, in bounded memory.

JSON and Parquet keep every value as it is. CSV is for spreadsheets: an empty cell is no value,
and a text that a spreadsheet would take for a formula gets an apostrophe before it.
"""

import csv
import io
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from itertools import islice
from pathlib import Path

from service.files import write_lines
from service.outputs.formula import disarmed
from stepnc_model.errors import WriteError

Value = str | float | int | bool | datetime | None
Row = Mapping[str, Value]

AT_ONCE = 10_000
"""rows in memory; those of one group of a Parquet file"""


class Format(StrEnum):
    """Format of a file of rows."""

    CSV = "csv"
    JSON = "json"
    PARQUET = "parquet"


@dataclass(frozen=True, slots=True, kw_only=True)
class FileColumn:
    """One column."""

    name: str
    """with its unit"""
    kind: type
    """str, float, int, bool or datetime"""


def write_rows(
    path: Path, fields: Sequence[FileColumn], rows: Iterable[Row], *, form: Format
) -> int:
    """Write rows; how many there were.

    A file appears whole or not at all; a Parquet file that is broken off stays as
    ``.partial``, closed and readable.

    Raises
    ------
    WriteError
        When the ending does not fit the format, or the disk refuses.
    """
    if form is Format.PARQUET:
        return _write_parquet(path, fields, rows)
    counted = _Counted(rows)
    write_lines(path, LINES[form](fields, counted))
    return counted.count


def csv_lines(fields: Sequence[FileColumn], rows: Iterable[Row]) -> Iterator[str]:
    """Header and rows; numbers with all their digits, times in ISO 8601."""
    names = [field.name for field in fields]
    yield _csv_line(names)
    for row in rows:
        yield _csv_line([_csv_cell(row[name]) for name in names])


def json_lines(fields: Sequence[FileColumn], rows: Iterable[Row]) -> Iterator[str]:
    """One array of objects, an object in each line."""
    names = [field.name for field in fields]
    yield "["
    before = ""
    for row in rows:
        if before:
            yield f"{before},"
        values = {name: _json_value(row[name]) for name in names}
        before = json.dumps(values, ensure_ascii=False, allow_nan=False)
    if before:
        yield before
    yield "]"


LINES: Mapping[Format, Callable[[Sequence[FileColumn], Iterable[Row]], Iterator[str]]] = {
    Format.CSV: csv_lines,
    Format.JSON: json_lines,
}


class _Counted:
    """Rows on their way. Running state: how many have passed."""

    def __init__(self, rows: Iterable[Row]) -> None:
        self.count = 0
        self._rows = rows

    def __iter__(self) -> Iterator[Row]:
        for row in self._rows:
            self.count += 1
            yield row


def _csv_line(cells: Sequence[str]) -> str:
    """Cells with quotes where they need them."""
    line = io.StringIO()
    # It puts in quotes what is in its own end of a line only.
    csv.writer(line, lineterminator="\r\n").writerow(cells)
    return line.getvalue().removesuffix("\r\n")


def _csv_cell(value: Value) -> str:
    """A value as a spreadsheet reads it; no text becomes a formula."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, datetime):
        return value.isoformat()
    if isinstance(value, str):
        return disarmed(value)
    return repr(value)


def _json_value(value: Value) -> Value:
    return value.isoformat() if isinstance(value, datetime) else value


def _write_parquet(path: Path, fields: Sequence[FileColumn], rows: Iterable[Row]) -> int:
    """Groups of rows, as they come."""
    from service.outputs.run_file import ColumnKind, RunColumn, RunFile  # noqa: PLC0415 (numpy)

    if path.suffix.lower() != ".parquet":
        raise WriteError("the name of a Parquet file ends with .parquet", path=str(path))
    kinds = {
        str: ColumnKind.TEXT,
        float: ColumnKind.EXACT,
        int: ColumnKind.INTEGER,
        bool: ColumnKind.TRUTH,
        datetime: ColumnKind.MOMENT,
    }
    file = RunFile(path, [RunColumn(name=each.name, kind=kinds[each.kind]) for each in fields])
    rest = iter(rows)
    try:
        while group := list(islice(rest, AT_ONCE)):
            file.write([[row[each.name] for row in group] for each in fields])
    except BaseException:
        with file.closing(is_whole=False):
            pass
        raise
    with file.closing(is_whole=True):
        pass
    return file.rows
