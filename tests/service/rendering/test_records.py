"""Rows as JSON and as lines of files."""

from datetime import UTC, datetime
from math import inf

from service.outputs.flat_file import FileColumn
from service.rendering.columns import (
    Change,
    Column,
    dump,
    file_columns,
    file_rows,
    record,
    records,
)

AT = datetime(2026, 3, 5, tzinfo=UTC)

COLUMNS: tuple[Column[float], ...] = (
    Column(heading="screen only", value=lambda row: row),
    Column(key="force_n.mean", value=lambda row: row),
    Column(key="force_n.most", value=lambda _: inf),
    Column(key="at", kind=datetime, value=lambda _: AT),
    Column(key="time_s", value=lambda row: Change(before=row, after=None)),
)


def test_keys_with_dots_nest_and_values_are_plain() -> None:
    told = {
        "force_n": {"mean": 2.0, "most": None},
        "at": AT.isoformat(),
        "time_s": {"before": 2.0, "after": None},
    }
    assert record(COLUMNS, 2.0) == told
    assert records(COLUMNS, [2.0]) == [told]
    assert dump({"µ": None}) == '{\n  "µ": null\n}'


def test_files_have_the_columns_with_keys() -> None:
    columns = (COLUMNS[0], COLUMNS[1], COLUMNS[3])
    assert file_columns(columns) == (
        FileColumn(name="force_n.mean", kind=float),
        FileColumn(name="at", kind=datetime),
    )
    assert list(file_rows(columns, [2.0])) == [{"force_n.mean": 2.0, "at": AT}]
