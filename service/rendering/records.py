"""Rendering of rows as JSON and as lines of files.

Keys carry their units and never change, because other programs read them.
"""

import json
from collections.abc import Iterable, Iterator, Sequence
from datetime import datetime
from math import isfinite
from typing import Any, cast

from service.flat_file import FileColumn, Row, Value
from service.rendering.columns import Change, Column, R
from stepnc_model.errors import Finding


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
