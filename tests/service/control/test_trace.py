"""A row a revolution: with units, whole, and the same for the same seed."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import csv, parquet

from controller.cycle import LoopCycle
from service.control.run import ControlRun, control, prepare
from service.control.trace import COLUMNS, ControlSignal
from service.live.runner import Moment
from service.outputs.run_file import arrow_schema
from simulator.plant.controlled_machine import TrueState
from tests.asking import AskedControl

Controlled = Callable[..., AskedControl]


@pytest.fixture(scope="module")
def written(controlled: Controlled, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("trace") / "run.parquet"
    control(*controlled(disturbances=("hardness:+40%@7.5s",), output=path))
    return path


@pytest.fixture(scope="module")
def table(written: Path) -> pa.Table:
    return parquet.read_table(written)


def numbers(table: pa.Table, name: str) -> np.ndarray:
    return np.asarray(table[name].to_numpy(zero_copy_only=False), dtype=np.float64)


def test_columns_have_units(written: Path) -> None:
    schema = parquet.read_schema(written)
    assert schema.equals(arrow_schema(COLUMNS), check_metadata=True)
    assert len(COLUMNS) == len(Moment._fields)
    for column in COLUMNS:
        assert schema.field(column.name).metadata[b"unit"].decode() == column.unit


def test_time_and_progress_ascend(table: pa.Table) -> None:
    for name in ("time_s", "progress_s"):
        assert (np.diff(numbers(table, name)) > 0.0).all()


def test_a_row_is_a_revolution(table: pa.Table) -> None:
    """At 3000 rpm, 20 ms; without a revolution at least a quarter of a second."""
    apart = np.diff(numbers(table, "time_s"))
    has_revolution = ~np.isnan(numbers(table, "force_measured"))[1:]
    np.testing.assert_allclose(np.median(apart[has_revolution]), 0.02, rtol=1e-6)
    assert (apart[~has_revolution][:-1] > 0.2).all()


def test_measured_is_true_but_for_the_noise(table: pa.Table) -> None:
    measured, true = numbers(table, "force_measured"), numbers(table, "force_true")
    cuts = true > 100.0
    ratio = measured[cuts] / true[cuts]
    assert abs(ratio.mean() - 1.0) < 0.01
    assert 0.0 < ratio.std() < 0.05
    assert (numbers(table, "force_peak")[cuts] >= measured[cuts]).all()


def test_the_factor_is_measured_over_expected(table: pa.Table) -> None:
    ratio = numbers(table, "force_ratio")
    known = ~np.isnan(ratio)
    measured, expected = numbers(table, "force_measured"), numbers(table, "force_expected")
    np.testing.assert_allclose(ratio[known] * expected[known], measured[known], rtol=1e-5)
    assert known.any()


def test_forces_and_set_points_have_no_value_where_there_is_none(table: pa.Table) -> None:
    rapid = table.filter(pa.compute.equal(table["path_feedrate_programmed"], 0.0))
    assert rapid["force_measured"].null_count == rapid.num_rows
    assert set(table["level"].to_pylist()) <= {"safe", "warning", "over"}
    assert {"no chips", "tool deflection", "strength of the tool"} & set(
        table["holding"].to_pylist()
    )


def test_every_event_stands_in_its_row(controlled: Controlled, tmp_path: Path) -> None:
    output = tmp_path / "run.csv"
    run = control(*controlled(disturbances=("tooth:1@7s", "mode:QC@2s"), output=output))
    table = csv.read_csv(output)
    told = [text for text in table["event"].to_pylist() if text]
    assert "; ".join(told) == "; ".join(
        f"{event.kind.value}: {event.text}" for event in run.events
    )
    assert run.samples == table.num_rows
    assert table["time_s"][-1].as_py() == pytest.approx(run.time)


def test_the_same_seed_makes_the_same_bytes(
    controlled: Controlled, written: Path, tmp_path: Path
) -> None:
    again, other = tmp_path / "again.parquet", tmp_path / "other.parquet"
    request, files = controlled(disturbances=("hardness:+40%@7.5s",), output=again)
    control(request, files)
    control(replace(request, seed=1), replace(files, output=other))
    assert again.read_bytes() == written.read_bytes()
    assert other.read_bytes() != written.read_bytes()


def test_plots_show_what_the_file_holds(controlled: Controlled, tmp_path: Path) -> None:
    output = tmp_path / "run.parquet"
    run = control(*controlled(output=output, report=tmp_path / "run.html"))
    assert run.trace is not None
    table = parquet.read_table(output)
    for signal, name in (
        (ControlSignal.FORCE_MEASURED, "force_measured"),
        (ControlSignal.REMOVAL_RATE, "removal_rate"),
        (ControlSignal.OVERRIDE_COMMANDED, "override_commanded"),
    ):
        curve = run.trace.curve(signal)
        assert np.nanmax(curve.high) == pytest.approx(np.nanmax(numbers(table, name)))


def test_memory_is_bounded_by_rows(
    controlled: Controlled, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.control.trace.ROWS", 50)
    output = tmp_path / "run.parquet"
    control(*controlled(output=output))
    groups = parquet.ParquetFile(output).metadata
    sizes = [groups.row_group(row).num_rows for row in range(groups.num_row_groups)]
    assert set(sizes[:-1]) == {50}
    assert len(sizes) > 2


def test_what_was_removed_is_the_slot(control_run: ControlRun, controlled: Controlled) -> None:
    """Rate times time, whatever the override was."""
    volumes = []

    def watch(cycle: LoopCycle, truth: TrueState) -> None:
        volumes.append(truth.removal_rate * cycle.reading.period)

    for law in ("none", "log-pi"):
        volumes.clear()
        control(*controlled(law=law), watchers=[watch])
        # 2 mm deep, 10 mm wide, from the edge of the stock to x = 20 mm and half a round end.
        whole = sum(volumes)
        if law == "none":
            unheeded = whole
    assert whole == pytest.approx(unheeded, rel=0.01)
    assert control_run.progress > 0.0


def test_a_sink_is_given_each_row_at_once(
    controlled: Controlled, written: Path, table: pa.Table, tmp_path: Path
) -> None:
    rows: list[Moment] = []
    output = tmp_path / "run.parquet"
    session = prepare(*controlled(disturbances=("hardness:+40%@7.5s",), output=output))
    trace = session.trace(rows.append)
    with trace:
        for cycle in session.cycles([trace]):
            if cycle.revolution is not None:
                assert rows[-1].time == cycle.reading.time
    assert [row.time for row in rows] == table["time_s"].to_pylist()
    assert output.read_bytes() == written.read_bytes()
