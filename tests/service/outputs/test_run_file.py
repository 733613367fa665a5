"""A file that grows: whole under its name, or readable beside it."""

from math import inf, nan
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import csv, parquet

from service.outputs.run_file import (
    ColumnKind,
    RunColumn,
    RunFile,
    Values,
    require_suffix,
    words_of,
)
from stepnc_model.errors import WriteError

COLUMNS = (
    RunColumn(name="time_s", kind=ColumnKind.EXACT, unit="s"),
    RunColumn(name="step", kind=ColumnKind.WORDS),
)


def columns(*words: str | None) -> list[Values]:
    return [np.arange(len(words), dtype=float), words_of(words)]


def read(path: Path) -> pa.Table:
    return parquet.read_table(path) if path.suffix == ".parquet" else csv.read_csv(path)


@pytest.mark.parametrize("suffix", [".parquet", ".csv"])
def test_words_that_change_from_batch_to_batch_are_kept(tmp_path: Path, suffix: str) -> None:
    file = RunFile(tmp_path / f"run{suffix}", COLUMNS)
    with file.closing(is_whole=True):
        file.write(columns("A", "B, C"))
        file.write(columns("D", "A", "A"))
    assert file.rows == 5
    assert file.place == file.path
    table = read(file.path)
    assert table["step"].to_pylist() == ["A", "B, C", "D", "A", "A"]
    assert [each.name for each in tmp_path.iterdir()] == [f"run{suffix}"]


def test_csv_makes_no_formula_of_a_name(tmp_path: Path) -> None:
    names = ["=HYPERLINK(1)", "+1", "-1", "@A1", "\tx", "\rx", "a=b", None, "two\n=3"]
    for suffix, before in ((".csv", "'"), (".parquet", "")):
        file = RunFile(tmp_path / f"run{suffix}", COLUMNS)
        with file.closing(is_whole=True):
            file.write(columns(*names))
        assert file.place is not None
        if suffix == ".csv":
            options = csv.ParseOptions(newlines_in_values=True)
            convert = csv.ConvertOptions(
                strings_can_be_null=True, quoted_strings_can_be_null=False
            )
            table = csv.read_csv(file.place, parse_options=options, convert_options=convert)
        else:
            table = read(file.place)
        expected = [f"{before}{name}" for name in names[:6] if name] + names[6:]
        assert table["step"].to_pylist() == expected


def test_units_are_metadata(tmp_path: Path) -> None:
    file = RunFile(tmp_path / "run.parquet", COLUMNS)
    with file.closing(is_whole=True):
        file.write(columns("A"))
    assert parquet.read_schema(file.path).field("time_s").metadata == {b"unit": b"s"}


@pytest.mark.parametrize("suffix", [".parquet", ".csv"])
def test_what_is_broken_off_stays_beside_the_old_file(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"run{suffix}"
    path.write_text("old", encoding="ascii")
    file = RunFile(path, COLUMNS)
    with file.closing(is_whole=False):
        file.write(columns("A", "B"))
    assert path.read_text(encoding="ascii") == "old"
    assert file.place == tmp_path / f"run.partial{suffix}"
    assert read(file.place).num_rows == 2


def test_an_error_among_the_last_rows_leaves_nothing(tmp_path: Path) -> None:
    file = RunFile(tmp_path / "run.csv", COLUMNS)
    with pytest.raises(ZeroDivisionError), file.closing(is_whole=True):
        raise ZeroDivisionError
    assert file.place is None
    assert not list(tmp_path.iterdir())


def test_only_two_endings_are_known() -> None:
    assert require_suffix(Path("a.b.CSV")) == ".csv"
    with pytest.raises(WriteError, match=r"a run is written as .parquet or .csv"):
        require_suffix(Path("run.xlsx"))


@pytest.mark.parametrize("suffix", [".parquet", ".csv"])
def test_numbers_keep_their_digits_and_missing_ones_are_empty(
    tmp_path: Path, suffix: str
) -> None:
    values = {
        ColumnKind.EXACT: [0.1, 1e-300, -2.5e20, nan],
        ColumnKind.NUMBER: [0.1, 3e-5, -7.0, nan],
        ColumnKind.COUNT: [0, -1, 2**31 - 1, 5],
        ColumnKind.INTEGER: [0, 2**60, -(2**60), 5],
        ColumnKind.TRUTH: [True, False, True, False],
    }
    file = RunFile(
        tmp_path / f"run{suffix}", [RunColumn(name=kind.name, kind=kind) for kind in values]
    )
    arrays = {kind: np.array(found, kind.value) for kind, found in values.items()}
    with file.closing(is_whole=True):
        file.write(list(arrays.values()))
    table = read(file.path)
    for kind, array in arrays.items():
        found = table[kind.name].to_numpy().astype(kind.value)
        np.testing.assert_array_equal(found, array)
    assert table["EXACT"].null_count == 1


def test_infinite_numbers_are_words_of_a_csv_file(tmp_path: Path) -> None:
    file = RunFile(tmp_path / "run.csv", [RunColumn(name="x"), RunColumn(name="y")])
    with file.closing(is_whole=True):
        file.write([np.array([inf, -inf, nan]), np.array([1.0, 2.0, 3.0])])
    assert file.path.read_bytes() == b'"x","y"\ninf,1.0\n-inf,2.0\n,3.0\n'
