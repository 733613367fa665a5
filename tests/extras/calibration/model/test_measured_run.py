"""Files of measured runs: what is read, what is refused and what is reported."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from extras.calibration.model.measured_run import (
    POSITIONS,
    Component,
    MeasuredRun,
    read_run,
    thinned,
)
from simulator.errors import CalibrationError
from tests.every_case import every_case

HEADINGS = ("time_s", *POSITIONS, "c_axis_wattage", "electric_wattage", "workingstep")


def rows(count: int = 20) -> list[list[str]]:
    return [
        [f"{0.1 * i:.1f}", f"{i}", "0", "5", f"{100 + i}", f"{900 + 2 * i}", "WS1"]
        for i in range(count)
    ]


def written(folder: Path, table: Sequence[Sequence[str]], headings: Sequence[str]) -> Path:
    path = folder / "run.csv"
    lines = [",".join(row) for row in (headings, *table)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def refused(folder: Path, table: list[list[str]]) -> CalibrationError:
    with pytest.raises(CalibrationError) as caught:
        read_run(written(folder, table, HEADINGS))
    return caught.value


def test_columns_are_read_by_name(tmp_path: Path) -> None:
    run = read_run(written(tmp_path, rows(), HEADINGS))
    assert set(run.power) == {Component.SPINDLE, Component.TOTAL}
    np.testing.assert_allclose(run.time, 0.1 * np.arange(20))
    np.testing.assert_allclose(run.position[:, 0], np.arange(20))
    np.testing.assert_allclose(run.durations, 0.1)
    assert run.findings == ()


def test_axis_without_a_column_has_no_position(tmp_path: Path) -> None:
    table = [[row[0], row[5]] for row in rows()]
    run = read_run(written(tmp_path, table, ("time_s", "electric_wattage")))
    assert np.isnan(run.position).all()


def test_gap_is_reported_and_its_energy_left_out(tmp_path: Path) -> None:
    table = rows()
    run = read_run(written(tmp_path, table[:8] + table[14:], HEADINGS))
    (finding,) = run.findings
    assert finding.line == 10
    assert "gap of 0.7 s" in finding.message
    assert run.durations[7] == 0.0


def test_row_with_an_empty_cell_is_a_gap(tmp_path: Path) -> None:
    table = rows(30)
    for row in table[10:13]:
        row[4] = ""
    run = read_run(written(tmp_path, table, HEADINGS))
    assert len(run) == 27
    assert "gap of 0.4 s" in run.findings[0].message


@pytest.mark.parametrize("time", ["0.3", "0.4"])
def test_time_that_does_not_ascend_is_refused_with_its_line(tmp_path: Path, time: str) -> None:
    table = rows()
    table[5][0] = time
    error = refused(tmp_path, table)
    assert (error.line, error.column) == (7, "time_s")
    assert "must ascend" in str(error)


def test_time_in_another_unit_is_refused(tmp_path: Path) -> None:
    table = rows()
    for i, row in enumerate(table):
        row[0] = str(100_000 * i)
    assert "sampling interval 100000 s" in str(refused(tmp_path, table))


def test_position_in_another_unit_is_refused(tmp_path: Path) -> None:
    table = rows()
    for i, row in enumerate(table):
        row[1] = str(1000 * i)  # micrometres
    error = refused(tmp_path, table)
    assert (error.line, error.column) == (3, "x_axis_position_actual")
    assert "10000 mm/s" in str(error)


def test_kilowatts_are_refused(tmp_path: Path) -> None:
    table = rows()
    for row in table:
        row[5] = str(float(row[5]) / 1000.0)
    error = refused(tmp_path, table)
    assert error.column == "electric_wattage"
    assert "kW" in str(error)


def test_constant_power_is_left_out_and_reported(tmp_path: Path) -> None:
    table = rows()
    for row in table:
        row[4] = "100"
    run = read_run(written(tmp_path, table, HEADINGS))
    assert set(run.power) == {Component.TOTAL}
    assert run.findings[0].attribute == "c_axis_wattage"


def test_nothing_but_constant_powers_is_refused(tmp_path: Path) -> None:
    table = rows()
    for row in table:
        row[4], row[5] = "100", "900"
    assert "nothing can be fitted" in str(refused(tmp_path, table))


@every_case("cell", ["two", "nan", "inf"])
def test_what_is_no_number_is_refused_with_its_place(tmp_path: Path, cell: str) -> None:
    table = rows()
    table[3][4] = cell
    error = refused(tmp_path, table)
    assert (error.line, error.column) == (5, "c_axis_wattage")


def test_row_of_another_length_is_refused(tmp_path: Path) -> None:
    table = rows()
    table[2].append("1")
    assert refused(tmp_path, table).line == 4


def test_too_few_samples_are_refused(tmp_path: Path) -> None:
    assert "9 complete samples" in str(refused(tmp_path, rows(9)))


@pytest.mark.parametrize("missing", ["time_s", "power"])
def test_missing_column_is_refused(tmp_path: Path, missing: str) -> None:
    kept = [
        i
        for i, name in enumerate(HEADINGS)
        if name != missing and not (missing == "power" and "wattage" in name)
    ]
    table = [[row[i] for i in kept] for row in rows()]
    with pytest.raises(CalibrationError, match=r"missing|is needed"):
        read_run(written(tmp_path, table, [HEADINGS[i] for i in kept]))


@every_case("content", [b"", b"\xff\xfe\x00", b"time_s\n"])
def test_what_is_no_table_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "run.csv"
    path.write_bytes(content)
    with pytest.raises(CalibrationError):
        read_run(path)


def test_missing_file_is_an_error_of_the_tree(tmp_path: Path) -> None:
    with pytest.raises(CalibrationError, match=r"none\.csv"):
        read_run(tmp_path / "none.csv")


def test_a_long_run_is_thinned_and_says_so() -> None:
    count = 1000
    run = MeasuredRun(
        name="long",
        time=np.linspace(0.0, 9.99, count),
        position=np.zeros((count, 3)),
        power={Component.TOTAL: np.arange(count, dtype=np.float64)},
    )
    found = thinned(run, most=300)
    assert len(found) == 250
    assert found.time[1] == pytest.approx(0.04)
    assert found.power[Component.TOTAL][:3].tolist() == [0.0, 4.0, 8.0]
    assert found.durations.sum() == pytest.approx(10.0)
    assert "one in 4" in found.findings[-1].message
    assert thinned(run, most=1000) is run
