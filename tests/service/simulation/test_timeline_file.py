"""A run on disk: whole under its name, or readable beside it; small; with units."""

import stat
from dataclasses import fields
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import csv, parquet

from service.outputs.run_file import arrow_schema
from service.simulation import run_collector as gathering
from service.simulation.run_collector import ROWS, TimelineFile, timeline_columns
from simulator.machine.samples import Samples
from simulator.machine.timeline import COLUMNS
from stepnc_model.errors import WriteError
from tests.every_case import every_case

INTEGERS = {"execution", "path_mode", "coolant", "overload", "line", "tool", "workingstep"}
VECTORS = {"position", "velocity", "axis_power"}


def samples(count: int, *, first: int = 0) -> Samples:
    """Samples that can be told apart."""
    time = np.arange(first, first + count) / 10.0
    columns: dict[str, np.ndarray] = {}
    for number, field in enumerate(fields(Samples)):
        value = time + number
        if field.name in INTEGERS:
            value = np.zeros(count, dtype=np.int64)
        elif field.name in VECTORS:
            value = np.stack([value, 2.0 * value, 3.0 * value], axis=1)
        columns[field.name] = value
    return Samples(**{**columns, "time": time})


def written(path: Path, *parts: Samples, workingsteps: tuple[str, ...] = ()) -> pa.Table:
    """What is read of what was written."""
    with TimelineFile(path, workingsteps) as file:
        for part in parts:
            file.add(part)
    return parquet.read_table(path) if path.suffix == ".parquet" else csv.read_csv(path)


@pytest.mark.parametrize("name", ["run.parquet", "run.CSV"])
def test_what_is_written_is_read(tmp_path: Path, name: str) -> None:
    one, two = samples(3), samples(4, first=3)
    two.workingstep[:] = 2
    two.line[:] = 17
    two.cutting_force[1] = np.nan
    path = tmp_path / name
    table = written(path, one, two, workingsteps=("FIRST", 'NEXT, "A"'))
    assert table.column_names == [column.name for column in COLUMNS]
    np.testing.assert_array_equal(table["time_s"], np.arange(7) / 10.0)
    np.testing.assert_array_equal(table["z_axis_position_actual"][:3], one.position[:, 2])
    np.testing.assert_allclose(
        table["rotary_velocity_actual"][:3], 60.0 * one.spindle_speed, rtol=1e-6
    )
    np.testing.assert_allclose(table["electric_wattage"][:3], one.total_power, rtol=1e-6)
    assert table["cutting_force"].null_count == 1
    assert table["line"].to_pylist() == [0] * 3 + [17] * 4
    assert table["execution"].to_pylist() == ["READY"] * 7
    assert table["workingstep"].to_pylist()[2:4] == ["", 'NEXT, "A"']
    assert [each.name for each in tmp_path.iterdir()] == [name]


def test_columns_say_their_units_and_keep_the_digits_they_need(tmp_path: Path) -> None:
    path = tmp_path / "run.parquet"
    written(path, samples(2))
    schema = parquet.read_schema(path)
    assert schema.equals(arrow_schema(timeline_columns()), check_metadata=True)
    assert schema.field("time_s").type == pa.float64()
    assert schema.field("y_axis_position_actual").type == pa.float64()
    assert schema.field("c_axis_wattage").type == pa.float32()
    assert schema.field("line").type == pa.int32()
    for name in ("execution", "workingstep"):
        assert schema.field(name).type == pa.dictionary(pa.int32(), pa.string())
    for column in COLUMNS:
        assert schema.field(column.name).metadata[b"unit"].decode() == column.unit


def test_groups_of_rows_are_bounded_however_samples_come(tmp_path: Path) -> None:
    path = tmp_path / "run.parquet"
    written(path, samples(ROWS - 1), samples(ROWS, first=ROWS - 1), samples(5, first=ROWS))
    groups = parquet.ParquetFile(path).metadata
    sizes = [groups.row_group(row).num_rows for row in range(groups.num_row_groups)]
    assert sizes == [2 * ROWS - 1, 5]


def test_single_samples_make_the_same_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(gathering, "MOST_PARTS", 4)
    whole, parts = tmp_path / "whole.parquet", tmp_path / "parts.parquet"
    written(whole, samples(21))
    written(parts, *(samples(1, first=row) for row in range(21)))
    assert whole.read_bytes() == parts.read_bytes()


def test_repeated_words_cost_next_to_nothing(tmp_path: Path) -> None:
    path = tmp_path / "run.parquet"
    written(path, samples(ROWS), workingsteps=("A LONG NAME OF A WORKINGSTEP",) * 3)
    group = parquet.ParquetFile(path).metadata.row_group(0)
    for row, column in enumerate(COLUMNS):
        if column.words is not None or column.source == "workingstep":
            assert group.column(row).total_compressed_size < 300


@pytest.mark.parametrize("suffix", [".parquet", ".csv"])
def test_a_broken_off_run_is_left_readable_beside_the_old_one(
    tmp_path: Path, suffix: str
) -> None:
    path = tmp_path / f"run{suffix}"
    path.write_text("old", encoding="ascii")
    file = TimelineFile(path, ())
    file.add(samples(3))
    with pytest.raises(KeyboardInterrupt), file:
        raise KeyboardInterrupt
    assert path.read_text(encoding="ascii") == "old"
    assert file.place == file.partial == tmp_path / f"run.partial{suffix}"
    left = csv.read_csv(file.partial) if suffix == ".csv" else parquet.read_table(file.partial)
    assert left.num_rows == file.rows == 3
    assert len(list(tmp_path.iterdir())) == 2


def test_a_run_broken_off_before_its_first_sample_leaves_nothing(tmp_path: Path) -> None:
    file = TimelineFile(tmp_path / "run.csv", ())
    with pytest.raises(KeyboardInterrupt), file:
        raise KeyboardInterrupt
    assert file.place is None
    assert not list(tmp_path.iterdir())


def test_permissions_are_those_of_the_old_file_or_of_a_new_one(tmp_path: Path) -> None:
    path, plain = tmp_path / "run.csv", tmp_path / "plain"
    plain.touch()
    written(path, samples(1))
    assert stat.S_IMODE(path.stat().st_mode) == stat.S_IMODE(plain.stat().st_mode)
    path.chmod(0o604)
    written(path, samples(1))
    assert stat.S_IMODE(path.stat().st_mode) == 0o604


@every_case(
    ("place", "words"),
    [
        ("run.txt", r"run.txt: a run is written as .parquet or .csv"),
        ("missing/run.csv", r"run.csv: No such file or directory"),
        ("n" * 300 + ".csv", r"File name too long"),
    ],
)
def test_a_place_that_cannot_be_written_is_named(
    tmp_path: Path, place: str, words: str
) -> None:
    with pytest.raises(WriteError, match=words) as caught:
        TimelineFile(tmp_path / place, ())
    assert caught.value.path == str(tmp_path / place)
    assert not list(tmp_path.iterdir())
