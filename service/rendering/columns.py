"""Columns of a result: defined once, rendered as text, HTML, CSV, Parquet and JSON.

A result is a sequence of rows, which are frozen dataclasses. A column defines how one value of
a row is named and shown: its key in files, its heading on screens, its format, and a help text
with the symbol used in the papers.

Rendering of rows as JSON and as lines of files.

Keys carry their units and never change, because other programs read them.
"""

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from itertools import groupby
from math import isfinite
from typing import Any, Generic, TypeVar, cast

from service.outputs.flat_file import FileColumn, Row, Value
from stepnc_model.errors import Finding

R = TypeVar("R")


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """Value before and after a change; shown once if both look the same."""

    before: "Cell"
    after: "Cell"


Cell = str | float | int | bool | datetime | Change | Sequence[object] | None
"""Value of a table cell; None: unknown."""

BLANK = " "
"""Content of a cell that stays empty because the column does not apply to the row."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Column(Generic[R]):
    """Column of a result table.

    Examples
    --------
    >>> time = Column(key="time_s", heading="time s", form=".1f", value=lambda row: row)
    >>> time.text(Change(before=12.04, after=9.5))
    '12.0 -> 9.5'
    >>> time.text(None)
    ''
    """

    value: Callable[[R], Cell]
    """Function that returns the value of a row, in the user's unit."""
    key: str = ""
    """Name in files and JSON, including the unit; dots nest in JSON; empty: not written."""
    heading: str = ""
    """Heading on screens, including the unit; empty: not shown."""
    form: str = ""
    """Format specification of numbers."""
    scale: float = 1.0
    """Factor from the unit in files to the unit on screens."""
    kind: type = float
    """Type in files: str, float, int, bool or datetime."""
    group: str = ""
    """Heading of the group to which the column belongs."""
    help: str = ""
    """Description of the column, with the symbol used in the papers."""
    is_right: bool = False
    """Whether text tables align the column to the right."""
    is_words: bool = False
    """Whether HTML pages align the column to the left."""
    is_of_row: bool = False
    """Whether all lines of a row share the cell."""
    is_key: bool = False
    """Whether the column is repeated where a table is broken into blocks."""
    is_optional: bool = False
    """Whether the column is omitted when no row has a value."""
    css: Callable[[R], str] | None = None
    """Function that returns the CSS class of a row's cell on HTML pages."""

    def text(self, row: R, *, arrow: str = "->", nothing: str = "") -> str:
        """Return the cell text as shown on screens."""
        value = _scaled(self.value(row), self.scale)
        return shown(value, self.form, arrow=arrow, nothing=nothing)


def _scaled(value: Cell, scale: float) -> Cell:
    """Scale a number, or both numbers of a change; other values stay as they are."""
    if scale == 1.0 or value is None:
        return value
    if isinstance(value, Change):
        return Change(before=_scaled(value.before, scale), after=_scaled(value.after, scale))
    return value * scale if isinstance(value, int | float) else value


def shown(value: Cell, form: str = "", *, arrow: str = "->", nothing: str = "") -> str:
    """Format a value for people; times are in the local time zone.

    Parameters
    ----------
    form : str
        Format specification of numbers.
    arrow : str
        Separator between a value before and after.
    nothing : str
        Text for a value that is unknown or not finite.

    Examples
    --------
    >>> shown([0.03, 1234.6], ".3g")
    '0.03, 1235'
    >>> shown(None, nothing="–")
    '–'
    """
    if isinstance(value, Change):
        pair = [shown(each, form) for each in (value.before, value.after)]
        known = list(dict.fromkeys(each for each in pair if each))
        return f" {arrow} ".join(known) or nothing
    if value is None or (isinstance(value, float) and not isfinite(value)):
        return nothing
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float):
        return _number(value, form)
    if isinstance(value, datetime):
        return f"{value.astimezone():%Y-%m-%d %H:%M}"
    if isinstance(value, list | tuple):
        return ", ".join(shown(each, form) for each in value) or nothing
    return str(value) or nothing


def _number(value: float, form: str) -> str:
    """Format a number; large numbers in a "g" format get no exponent."""
    text = format(value, form)
    return f"{value:.0f}" if form.endswith("g") and "e+" in text else text


def visible(columns: Sequence[Column[R]], rows: Sequence[R]) -> list[Column[R]]:
    """Return columns with a heading, without optional ones that are empty in all rows."""
    return [
        column
        for column in columns
        if column.heading
        and not (column.is_optional and not any(column.text(row) for row in rows))
    ]


def grouped(columns: Sequence[Column[R]]) -> list[tuple[str, list[Column[R]]]]:
    """Group adjacent columns by the name of their group."""
    groups = groupby(columns, key=lambda column: column.group)
    return [(name, list(members)) for name, members in groups]


def clock(seconds: float) -> str:
    """Format a duration in hours, minutes and seconds, for people."""
    if seconds < 120.0:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02d} min" if hours else f"{minutes} min {rest:02d} s"


def record(columns: Sequence[Column[R]], row: R) -> dict[str, Any]:
    """Return a row as an object; keys with dots nest.

    Examples
    --------
    >>> columns = [Column(key="force_n.mean", value=lambda row: row)]
    >>> record(columns, 12.0)
    {'force_n': {'mean': 12.0}}
    """
    found: dict[str, Any] = {}
    for column in columns:
        if column.key:
            *path, last = column.key.split(".")
            place = found
            for name in path:
                place = place.setdefault(name, {})
            place[last] = plain(column.value(row))
    return found


def records(columns: Sequence[Column[R]], rows: Iterable[R]) -> list[dict[str, Any]]:
    """Return an object for each row."""
    return [record(columns, row) for row in rows]


def file_columns(columns: Sequence[Column[R]]) -> tuple[FileColumn, ...]:
    """Return the columns of a CSV or Parquet file."""
    return tuple(FileColumn(name=each.key, kind=each.kind) for each in columns if each.key)


def file_rows(columns: Sequence[Column[R]], rows: Iterable[R]) -> Iterator[Row]:
    """Yield the rows of a CSV or Parquet file."""
    keyed = [each for each in columns if each.key]
    for row in rows:
        yield {each.key: cast(Value, each.value(row)) for each in keyed}


def finding_record(finding: Finding) -> dict[str, Any]:
    """Return a finding as an object."""
    return {
        "severity": finding.severity.value,
        "message": finding.message,
        "entity": finding.entity,
        "attribute": finding.attribute,
        "line": finding.line,
        "rule": finding.rule,
    }


def plain(value: Any) -> Any:
    """Convert a value for JSON; numbers that are not finite become null."""
    match value:
        case float():
            return float(value) if isfinite(value) else None
        case datetime():
            return value.isoformat()
        case Change(before=before, after=after):
            return {"before": plain(before), "after": plain(after)}
        case dict():
            return {key: plain(each) for key, each in value.items()}
        case list() | tuple():
            return [plain(each) for each in value]
    return value


def bare(value: Any) -> Any:
    """Convert numbers of Part 21 files to those of Python, in containers too."""
    match value:
        case bool():
            return value
        case float():
            return float(value)
        case int():
            return int(value)
        case dict():
            return {key: bare(each) for key, each in value.items()}
        case list() | tuple():
            return [bare(each) for each in value]
    return value


def dump(value: object) -> str:
    """Return readable JSON without NaN."""
    return json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False, default=str)
