"""Tool table as CSV: one tool a line, the keys of a ``[[tool]]`` row as column headings.

Columns are separated by commas, semicolons or tabulators; numbers have decimal points, or
decimal commas where no comma separates. Empty cells are absent keys. Lines that begin with
``#`` are remarks; Excel's line ``sep=;`` is passed.
"""

import csv
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from simulator.errors import LibraryError
from simulator.tool_files.placed_row import FileValue, PlacedRow, ToolRows, placed_row
from simulator.tools.tool_table import ToolRow

SEPARATORS = ",;\t"

DECIMAL_COMMA = re.compile(r"[-+]?[0-9]*,[0-9]+")
EXCEL_LINE = re.compile(r"sep=.", re.I)
"""First line by which Excel tells the separator."""

TEXTS = {"id", "kind", "cutting_material", "hand", "grade"}
"""Columns whose cells are texts, even when they look like numbers."""

FLAGS = {"true": True, "yes": True, "false": False, "no": False}

FLAG_COLUMNS = {"centre_cutting", "wiper", "inside"}

NEEDED = ("number", "kind")
"""Columns that every table has."""

Row = tuple[int, list[str]]
"""Line, counted from 1, and cells."""


def read_csv(text: str, path: Path) -> ToolRows:
    """Read the rows of a CSV table.

    Parameters
    ----------
    path : Path
        The file, for messages.

    Raises
    ------
    LibraryError
        With the line, the column, the value, the bound and the unit.
    """
    rows = _rows(text, path)
    at, heading = next(rows, (1, []))
    columns = [cell.strip().lower() for cell in heading]
    _require_columns(columns, path, at)
    has_commas = _separator(_first_line(text)) != ","
    return ToolRows(
        rows=tuple(_placed(columns, row, path, has_commas=has_commas) for row in rows)
    )


def is_heading(line: str) -> bool:
    """True if a line is the heading of such a table."""
    cells = {cell.strip().strip('"').lower() for cell in line.split(_separator(line))}
    return set(NEEDED) <= cells


def _separator(line: str) -> str:
    return max(SEPARATORS, key=line.count)


def _first_line(text: str) -> str:
    """First line that is neither empty nor a remark nor Excel's."""
    lines = (line.strip() for line in text.splitlines())
    return next((each for each in lines if each and not is_passed(each)), "")


def is_passed(line: str) -> bool:
    """True if a line is a remark, or tells the separator to Excel."""
    return line.startswith("#") or EXCEL_LINE.fullmatch(line) is not None


def _rows(text: str, path: Path) -> Iterator[Row]:
    """Lines with cells, without remarks and empty lines."""
    lines = ["" if EXCEL_LINE.fullmatch(line) else line for line in text.splitlines()]
    reader = csv.reader(lines, delimiter=_separator(_first_line(text)), strict=True)
    begin = 1
    try:
        for cells in reader:
            if any(cell.strip() for cell in cells) and not cells[0].lstrip().startswith("#"):
                yield begin, cells
            begin = reader.line_num + 1
    except csv.Error as error:
        raise LibraryError(f"is not CSV: {error}", path=str(path), line=begin) from error


def _require_columns(columns: list[str], path: Path, line: int) -> None:
    """Refuse headings that are missing, unknown or there twice."""
    known = ", ".join(sorted(ToolRow.__struct_fields__))
    for column, count in Counter(columns).items():
        if column not in ToolRow.__struct_fields__:
            message = f"unknown column; known: {known}"
            raise LibraryError(message, path=str(path), key=column or "''", line=line)
        if count > 1:
            message = f"{count} columns have this heading"
            raise LibraryError(message, path=str(path), key=column, line=line)
    for column in NEEDED:
        if column not in columns:
            message = f"missing; the heading has {', '.join(columns)}"
            raise LibraryError(message, path=str(path), key=column, line=line)


def _placed(columns: list[str], row: Row, path: Path, *, has_commas: bool) -> PlacedRow:
    line, cells = row
    if len(cells) > len(columns):
        message = f"{len(cells)} cells; the heading has {len(columns)}"
        raise LibraryError(message, path=str(path), line=line)
    given = {
        column: FileValue(
            value=_value(column, cell.strip(), has_commas=has_commas), place=column
        )
        for column, cell in zip(columns, cells, strict=False)
        if cell.strip()
    }
    return placed_row(given, path, line=line)


def _value(column: str, cell: str, *, has_commas: bool) -> object:
    """Cell as the type of its column; what cannot be converted stays a text."""
    if column in TEXTS:
        return cell
    if column in FLAG_COLUMNS:
        return FLAGS.get(cell.lower(), cell)
    is_comma = has_commas and DECIMAL_COMMA.fullmatch(cell) is not None
    try:
        return float(cell.replace(",", ".") if is_comma else cell)
    except ValueError:
        return cell
