"""Rows in pieces: the same from folder, Parquet and CSV, whatever the size of a piece."""

from pathlib import Path

import pytest
from pyarrow import csv, parquet

from extras.learning import source
from extras.learning.dataset_folder import DatasetFolder
from extras.learning.source import RowSource
from stepnc_model.errors import StepNcError
from tests.extras.learning.tables import law_table


@pytest.fixture(params=["folder", "data.parquet", "data.csv"])
def place(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    path, table = tmp_path / str(request.param), law_table(250)
    if path.suffix == ".parquet":
        parquet.write_table(table, path, row_group_size=70)
    elif path.suffix == ".csv":
        csv.write_csv(table, path)
    else:
        folder = DatasetFolder(path)
        folder.prepare({})
        for number in range(3):
            folder.write(number, table.slice(100 * number, 100))
    return path


@pytest.mark.parametrize(("first", "last"), [(0, 250), (30, 31), (99, 240), (240, 900)])
def test_pieces_are_the_rows_in_order(
    place: Path, first: int, last: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(source, "PIECE", 40)
    pieces = list(RowSource(place).pieces(first, last, ["row", "feed_mm_s"]))
    rows = [row for piece in pieces for row in piece["row"].to_pylist()]
    assert rows == list(range(first + 1, min(last, 250) + 1))
    assert all(piece.column_names == ["row", "feed_mm_s"] for piece in pieces)
    expected = law_table(250)["feed_mm_s"].to_pylist()[first:last]
    table = RowSource(place).table(first, last)
    assert table["feed_mm_s"].to_pylist() == pytest.approx(expected)


def test_no_rows_are_told(place: Path) -> None:
    with pytest.raises(StepNcError, match="no rows yet"):
        RowSource(place).table(250, 300)
