"""Rows in files: JSON and Parquet keep every value, CSV makes no formula of a name."""

import csv
import io
import json
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.outputs.flat_file import FileColumn, Format, Row, csv_lines, json_lines, write_rows
from stepnc_model.errors import WriteError

FIELDS = (
    FileColumn(name="name", kind=str),
    FileColumn(name="force_n", kind=float),
    FileColumn(name="count", kind=int),
    FileColumn(name="is_whole", kind=bool),
    FileColumn(name="at", kind=datetime),
)

texts = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"))
rows = st.lists(
    st.fixed_dictionaries({
        "name": texts,
        "force_n": st.none() | st.floats(allow_nan=False, allow_infinity=False),
        "count": st.integers(-(2**63), 2**63 - 1),
        "is_whole": st.booleans(),
        "at": st.none()
        | st.datetimes(datetime(1800, 1, 1), datetime(2200, 1, 1), timezones=st.just(UTC)),
    })
)


def lines(number: int) -> list[Row]:
    at = datetime(2026, 3, 5, tzinfo=UTC)
    return [
        {"name": f"n{each}", "force_n": 0.1 * each, "count": each, "is_whole": True, "at": at}
        for each in range(number)
    ]


@given(rows)
def test_json_reads_back_equal(found: list[Row]) -> None:
    back = json.loads("\n".join(json_lines(FIELDS, found)))
    for row in back:
        row["at"] = None if row["at"] is None else datetime.fromisoformat(row["at"])
    assert back == found


@given(rows)
def test_parquet_reads_back_equal(
    tmp_path_factory: pytest.TempPathFactory, found: list[Row]
) -> None:
    path = tmp_path_factory.mktemp("rows") / "rows.parquet"
    assert write_rows(path, FIELDS, found, form=Format.PARQUET) == len(found)
    assert pq.read_table(path).to_pylist() == found


@given(rows)
def test_csv_has_every_value_and_no_formula(found: list[Row]) -> None:
    text = "\n".join(csv_lines(FIELDS, found))
    head, *back = csv.reader(io.StringIO(text, newline=""))
    assert head == [field.name for field in FIELDS]
    assert len(back) == len(found)
    for cells, row in zip(back, found, strict=True):
        name = str(row["name"])
        assert not cells[0].startswith(("=", "+", "-", "@", "\t", "\r"))
        assert cells[0].removeprefix("'") == name.removeprefix("'")
        assert cells[1] == ("" if row["force_n"] is None else repr(row["force_n"]))
        assert int(cells[2]) == row["count"]
        assert cells[3] == str(row["is_whole"]).lower()


def test_a_formula_becomes_a_text() -> None:
    row: Row = {**lines(1)[0], "name": '=HYPERLINK("http://evil")', "force_n": -5.0}
    line = list(csv_lines(FIELDS, [row]))[1]
    assert line.startswith("\"'=HYPERLINK(")
    assert ",-5.0," in line


@pytest.mark.parametrize("form", list(Format))
def test_no_rows_are_a_file_all_the_same(form: Format, tmp_path: Path) -> None:
    path = tmp_path / f"rows.{form}"
    assert write_rows(path, FIELDS, [], form=form) == 0
    assert path.stat().st_size > 0


def broken(number: int) -> Iterator[Row]:
    yield from lines(number)
    raise KeyboardInterrupt


@pytest.mark.parametrize("form", [Format.CSV, Format.JSON])
def test_text_that_is_broken_off_leaves_what_was_there(form: Format, tmp_path: Path) -> None:
    path = tmp_path / f"rows.{form}"
    path.write_text("before", encoding="ascii")
    with pytest.raises(KeyboardInterrupt):
        write_rows(path, FIELDS, broken(3), form=form)
    assert path.read_text(encoding="ascii") == "before"
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


def test_parquet_that_is_broken_off_is_left_as_partial(tmp_path: Path) -> None:
    path = tmp_path / "rows.parquet"
    with pytest.raises(KeyboardInterrupt):
        write_rows(path, FIELDS, broken(10_001), form=Format.PARQUET)
    assert [each.name for each in tmp_path.iterdir()] == ["rows.partial.parquet"]
    assert pq.read_table(tmp_path / "rows.partial.parquet").num_rows == 10_000


def test_parquet_wants_its_ending(tmp_path: Path) -> None:
    with pytest.raises(WriteError, match=r"ends with \.parquet"):
        write_rows(tmp_path / "rows.pq", FIELDS, [], form=Format.PARQUET)
    with pytest.raises(WriteError, match="No such file"):
        write_rows(tmp_path / "none" / "rows.csv", FIELDS, [], form=Format.CSV)
