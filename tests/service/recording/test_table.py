"""Tables of recorded runs."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from service.recording.table import BLOCK, ROWS, batches, headings
from stepnc_model.errors import StepNcError

KINDS = {"b": pa.string(), "a": pa.float64()}


def rows(path: Path) -> list[dict[str, object]]:
    return [row for batch in batches(path, KINDS) for row in batch.to_pylist()]


@pytest.mark.parametrize(
    "text",
    [
        "a,b\n1.5,x\n,\nnan,UNAVAILABLE\n",
        "\ufeffa;b\n1,5;x\n;\nnan;UNAVAILABLE\n",
        'c\tb\ta\n9\tx\t1,5\n9\t\t\n9\t""\tNaN\n',
    ],
)
def test_columns_are_read_in_the_wanted_order(tmp_path: Path, text: str) -> None:
    file = tmp_path / "run.csv"
    file.write_text(text, encoding="utf-8")
    assert set(headings(file)) >= {"a", "b"}
    assert rows(file) == [{"b": "x", "a": 1.5}, *[{"b": None, "a": None}] * 2]


def test_words_of_parquet_are_texts_and_numbers_are_long(tmp_path: Path) -> None:
    file = tmp_path / "run.parquet"
    table = pa.table({
        "a": pa.array([1.5, None], pa.float32()),
        "b": pa.array(["x", None]).dictionary_encode(),
    })
    parquet.write_table(table, file)
    assert headings(file) == ["a", "b"]
    assert rows(file) == [{"b": "x", "a": 1.5}, {"b": None, "a": None}]


def test_a_long_file_comes_in_pieces(tmp_path: Path) -> None:
    file = tmp_path / "run.csv"
    count = 3 * BLOCK // 8
    file.write_text("a,b\n" + "1.25,x\n" * count, encoding="utf-8")
    pieces = [len(batch) for batch in batches(file, KINDS)]
    assert sum(pieces) == count
    assert len(pieces) > 1


def test_memory_does_not_grow_with_a_parquet_file(tmp_path: Path) -> None:
    file = tmp_path / "run.parquet"
    values = np.random.default_rng(1).uniform(size=64 * ROWS)
    parquet.write_table(pa.table({"a": values}), file, row_group_size=ROWS)
    kept = pa.total_allocated_bytes()
    most = max(pa.total_allocated_bytes() - kept for _ in batches(file, {"a": pa.float64()}))
    assert most < file.stat().st_size / 4


@pytest.mark.parametrize("name", ["missing.csv", "missing.parquet"])
def test_a_missing_file_is_told(tmp_path: Path, name: str) -> None:
    with pytest.raises(StepNcError, match="no such file"):
        headings(tmp_path / name)


def test_a_cell_that_is_not_a_number_is_told(tmp_path: Path) -> None:
    file = tmp_path / "run.csv"
    file.write_text("a,b\nbutter,x\n", encoding="utf-8")
    with pytest.raises(StepNcError, match=r"cannot be read: .*butter"):
        rows(file)
