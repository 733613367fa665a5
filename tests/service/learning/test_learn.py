"""Learning: trained on the first rows, tested on the next, beside what is simpler."""

from dataclasses import replace
from pathlib import Path

import pyarrow as pa
import pytest
from pyarrow import csv

from service.learning.learn import learn
from service.requests.learning import LearnRequest
from stepnc_model.errors import StepNcError
from tests.service.learning.tables import law_table, written

ASKED = LearnRequest(model="power-law", train=100, test=60)


def test_the_first_rows_train_and_the_next_ones_test(tmp_path: Path) -> None:
    table = law_table(200)
    result = learn(written(tmp_path, table), ASKED)
    assert result.model.low["feed_mm_s"] == min(table["feed_mm_s"].to_pylist()[:100])
    assert result.actual.tolist() == table["total_power_w"].to_pylist()[100:160]
    assert result.scored[0].name == "power-law"
    assert result.scored[0].scores.r2.value == pytest.approx(1.0)


def test_the_physics_is_the_ceiling_of_a_target_with_noise(tmp_path: Path) -> None:
    path = written(tmp_path, law_table(200, noise=0.2))
    result = learn(path, replace(ASKED, model="forest"))
    scores = {each.name: each.scores for each in result.scored}
    assert set(scores) == {"forest", "mean", "power-law", "physics"}
    assert result.ceiling == scores["physics"].r2
    assert scores["mean"].r2.value < 0.05 < scores["forest"].r2.value
    assert scores["forest"].r2.value < scores["physics"].r2.value < 0.99
    exact = learn(path, replace(ASKED, target="total_power_exact_w"))
    assert exact.ceiling is None
    assert exact.scored[0].scores.r2.value == pytest.approx(1.0)


def test_a_csv_is_read_as_well(tmp_path: Path) -> None:
    table = law_table(200)
    csv.write_csv(table, tmp_path / "data.csv")
    one, other = learn(tmp_path / "data.csv", ASKED), learn(written(tmp_path, table), ASKED)
    assert one.predicted == pytest.approx(other.predicted)


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        (replace(ASKED, model="oracle"), "unknown model 'oracle'; known: mlp, gp"),
        (replace(ASKED, target="power"), "unknown target 'power'; known: time_s"),
        (replace(ASKED, target="time_s"), "time_s of the training rows: all are 10"),
        (replace(ASKED, train=150), "200 rows, but --train 150 and --test 60 need 210"),
        (replace(ASKED, train=9), "train 9: it must be 10 to"),
    ],
)
def test_a_bad_request_is_refused(tmp_path: Path, request_: LearnRequest, message: str) -> None:
    path = written(tmp_path, law_table(200))
    with pytest.raises(StepNcError, match=message):
        learn(path, request_)


def changed(table: pa.Table, name: str, values: list[object]) -> pa.Table:
    return table.set_column(table.column_names.index(name), name, pa.array(values))


def test_a_bad_table_is_refused(tmp_path: Path) -> None:
    table, name = law_table(200), "total_power_w"
    bad = {
        "column feed_mm_s is missing; the table has row": table.drop_columns("feed_mm_s"),
        f"column {name} is not of numbers": changed(table, name, ["x"] * 200),
        f"row 1: {name} is no finite": changed(table, name, [float("nan"), *[1.0] * 199]),
        "training rows: 0 must be positive": changed(table, name, [*range(200)]),
    }
    for message, each in bad.items():
        with pytest.raises(StepNcError, match=message):
            learn(written(tmp_path, each), ASKED)
    (tmp_path / "data.parquet").write_bytes(b"nothing")
    with pytest.raises(StepNcError, match=r"data\.parquet: is not a Parquet file"):
        learn(tmp_path / "data.parquet", ASKED)
    with pytest.raises(StepNcError, match=r"has no manifest\.json"):
        learn(tmp_path, ASKED)
