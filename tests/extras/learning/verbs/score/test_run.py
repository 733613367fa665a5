"""Scores of measured runs: beside what is simpler, within the trained box, with an alarm."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import csv, parquet

import stepnc
from extras.learning.model_file import save_model
from extras.learning.scores import MEAN, PHYSICS_ALONE
from service.cli.main import main
from stepnc_model.errors import StepNcError
from tests.extras.learning.tables import changed, law_table, written

NOISE = 0.02


@pytest.fixture
def model(tmp_path: Path) -> Path:
    path = written(tmp_path, law_table(400, noise=NOISE))
    found = stepnc.learn(path, model="mlp", train=200, test=200)
    save_model(found.model, tmp_path / "model.skops")
    return tmp_path / "model.skops"


def runs(folder: Path, *, factor: float = 1.0, rows: slice = slice(400, 460)) -> Path:
    table = law_table(460, noise=NOISE)[rows]
    power = table["total_power_w"].to_numpy() * factor
    path = folder / "runs.parquet"
    parquet.write_table(changed(table, "total_power_w", power), path)
    return path


def test_runs_as_the_model_was_trained_raise_no_alarm(model: Path, tmp_path: Path) -> None:
    result = stepnc.score(model, runs(tmp_path))
    assert [each.name for each in result.scored] == ["mlp", MEAN, "power-law", PHYSICS_ALONE]
    assert len(result.rows) + len(result.left_out) == 60
    assert result.drift.alarm is None
    rmse = {each.name: each.scores.rmse.value for each in result.scored}
    assert rmse["mlp"] < 1.2 * rmse["physics"] < 0.3 * rmse["mean"]


def test_a_factor_on_all_runs_raises_an_alarm(model: Path, tmp_path: Path) -> None:
    drift = stepnc.score(model, runs(tmp_path, factor=1.1)).drift
    assert drift.alarm is not None
    assert drift.alarm < 10
    assert drift.after.low < 0.1 < drift.after.high


def test_runs_outside_the_trained_box_are_left_out_and_told(
    model: Path, tmp_path: Path
) -> None:
    table = law_table(20, noise=NOISE)
    feeds = table["feed_mm_s"].to_pylist()
    path = tmp_path / "runs.csv"
    csv.write_csv(changed(table, "feed_mm_s", [*feeds[:3], 120.0, *feeds[4:]]), path)
    result = stepnc.score(model, path)
    assert 4 not in result.rows
    assert (
        result.left_out[0][0], result.left_out[0][1][:26]
    ) == (4, "feed_mm_s 120 mm/s exceeds")  # fmt: skip
    csv.write_csv(changed(table, "feed_mm_s", [120.0] * 20), path)
    with pytest.raises(StepNcError, match=r"0 runs in the trained box: .* 5; row 1: f"):
        stepnc.score(model, path)


def test_equal_settings_have_no_r2(model: Path, tmp_path: Path) -> None:
    table = pa.concat_tables([law_table(1)] * 6)
    result = stepnc.score(model, written(tmp_path, table))
    assert result.scored[0].scores.r2 is None


def test_recordings_tell_what_was_measured(model: Path, tmp_path: Path) -> None:
    table = law_table(6).drop_columns("total_power_w")
    exact = law_table(6)["total_power_exact_w"].to_pylist()
    for row, power in enumerate(exact):
        # Idle before the program; then a triangle of power, whose mean is half its height.
        recorded = pa.table({
            "time_s": [0.0, 1.0, 2.0, 6.0, 10.0, 11.0],
            "electric_wattage": [9.0, 0.0, 0.5 * power, 2.0 * power, 0.0, 9.0],
            "execution": ["READY", "ACTIVE", "ACTIVE", "ACTIVE", "ACTIVE", "READY"],
        })
        parquet.write_table(recorded, tmp_path / f"run{row}.parquet")
    names = pa.array([f"run{row}.parquet" for row in range(6)])
    path = tmp_path / "runs.parquet"
    parquet.write_table(table.append_column("recording", names), path)
    result = stepnc.score(model, path)
    mean = (0.25 * 1 + 1.25 * 4 + 1.0 * 4) / 9
    found = next(each for each in result.scored if each.name == "physics")
    assert found.scores.mape.value == pytest.approx(100 * abs(1 / mean - 1))
    (tmp_path / "run3.parquet").unlink()
    with pytest.raises(StepNcError, match=r"run3\.parquet: no such file"):
        stepnc.score(model, path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda table: table.drop_columns("total_power_w"), "column total_power_w is missing"),
        (lambda table: table.drop_columns("feed_mm_s"), "column feed_mm_s is missing"),
        (lambda table: table.slice(0, 0), "no rows"),
        (
            lambda table: changed(table, "total_power_w", np.full(60, -1.0)),
            "row 1: total_power_w -1 W: it must be positive",
        ),
    ],
)
def test_a_bad_table_is_refused(
    model: Path, tmp_path: Path, change: object, message: str
) -> None:
    table = change(law_table(60))  # type: ignore[operator]
    parquet.write_table(table, tmp_path / "runs.parquet")
    with pytest.raises(StepNcError, match=message):
        stepnc.score(model, tmp_path / "runs.parquet")
    with pytest.raises(StepNcError, match=r"false alarm 0: it must be 0\.001 to 0\.5"):
        stepnc.score(model, tmp_path / "runs.parquet", false_alarm=0.0)


def test_an_alarm_is_an_exit_code(
    model: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = exit_of(["score", str(model), str(runs(tmp_path))])
    assert code == 0
    assert "no drift: sum" in capsys.readouterr().out
    assert exit_of(["score", str(model), str(runs(tmp_path, factor=1.2)), "--json"]) == 5
    assert '"is_alarm": true' in capsys.readouterr().out


def exit_of(arguments: list[str]) -> int:
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    return int(ended.value.code or 0)
