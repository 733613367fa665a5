"""A file that grows: whole under its name, or readable beside it."""

from pathlib import Path

import pyarrow as pa
import pytest
from pyarrow import csv, parquet

from service.run_file import WORDS, RunFile, require_suffix
from stepnc_model.errors import WriteError

SCHEMA = pa.schema([
    pa.field("time_s", pa.float64(), metadata={"unit": "s"}),
    pa.field("step", WORDS, metadata={"unit": ""}),
])


def columns(*words: str | None) -> list[pa.Array]:
    times = pa.array([float(row) for row in range(len(words))])
    return [times, pa.array(words, pa.string()).dictionary_encode()]


def read(path: Path) -> pa.Table:
    return parquet.read_table(path) if path.suffix == ".parquet" else csv.read_csv(path)


@pytest.mark.parametrize("suffix", [".parquet", ".csv"])
def test_words_that_change_from_batch_to_batch_are_kept(tmp_path: Path, suffix: str) -> None:
    file = RunFile(tmp_path / f"run{suffix}", SCHEMA)
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
        file = RunFile(tmp_path / f"run{suffix}", SCHEMA)
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
    file = RunFile(tmp_path / "run.parquet", SCHEMA)
    with file.closing(is_whole=True):
        file.write(columns("A"))
    assert parquet.read_schema(file.path).field("time_s").metadata == {b"unit": b"s"}


@pytest.mark.parametrize("suffix", [".parquet", ".csv"])
def test_what_is_broken_off_stays_beside_the_old_file(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"run{suffix}"
    path.write_text("old", encoding="ascii")
    file = RunFile(path, SCHEMA)
    with file.closing(is_whole=False):
        file.write(columns("A", "B"))
    assert path.read_text(encoding="ascii") == "old"
    assert file.place == tmp_path / f"run.partial{suffix}"
    assert read(file.place).num_rows == 2


def test_an_error_among_the_last_rows_leaves_nothing(tmp_path: Path) -> None:
    file = RunFile(tmp_path / "run.csv", SCHEMA)
    with pytest.raises(ZeroDivisionError), file.closing(is_whole=True):
        raise ZeroDivisionError
    assert file.place is None
    assert not list(tmp_path.iterdir())


def test_only_two_endings_are_known() -> None:
    assert require_suffix(Path("a.b.CSV")) == ".csv"
    with pytest.raises(WriteError, match=r"a run is written as .parquet or .csv"):
        require_suffix(Path("run.xlsx"))
