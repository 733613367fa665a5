"""Predictions: within the trained box only, for one part or a table."""

from pathlib import Path
from typing import Any

import pytest

import stepnc
from extras.learning.model_file import save_model
from stepnc_model.errors import StepNcError
from tests.extras.learning.tables import law_table, written

ASKED: dict[str, Any] = {
    "feed_mm_s": 50.0,
    "spindle_rad_s": 100.0,
    "depth_mm": 3.0,
    "machine": "b",
}


@pytest.fixture
def model(tmp_path: Path) -> Path:
    table = written(tmp_path, law_table(200, machines=("a", "b")))
    path = tmp_path / "model.skops"
    save_model(stepnc.learn(table, model="power-law", train=100, test=60).model, path)
    return path


def test_one_part_is_predicted(model: Path) -> None:
    (value,) = stepnc.predict(model, **ASKED).values
    assert value == pytest.approx(2 * 10.0 * 50.0**0.5 * 100.0**0.3)


def test_rows_of_a_table_are_predicted(model: Path, tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    header = "feed_mm_s,spindle_rad_s,depth_mm,machine"
    path.write_text(f"{header}\n50,100,3,a\n60,100,3,b\n", encoding="utf-8")
    result = stepnc.predict(model, path)
    values = result.values
    exact = [10.0 * 50.0**0.5 * 100.0**0.3, 20.0 * 60.0**0.5 * 100.0**0.3]
    assert values.tolist() == pytest.approx(exact)
    assert result.table()["total_power_w"].to_pylist() == pytest.approx(exact)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"feed_mm_s": 95.0}, r"feed_mm_s 95 mm/s exceeds 89\.\d+ mm/s, the bound"),
        (
            {"spindle_rad_s": 10.0},
            r"spindle_rad_s 10 rad/s is below 7\d\.?\d* rad/s",
        ),
        ({"machine": "c"}, "machine 'c' was not trained; known: a, b"),
        ({"machine": None}, "the model needs --machine too"),
        ({"depth_mm": float("nan")}, "depth_mm is no finite number"),
    ],
)
def test_outside_the_trained_box_is_refused(
    model: Path, changed: dict[str, Any], message: str
) -> None:
    with pytest.raises(StepNcError, match=message):
        stepnc.predict(model, **ASKED | changed)


def test_a_bad_table_is_refused(model: Path, tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    path.write_text("feed_mm_s,machine\n50,a\n", encoding="utf-8")
    with pytest.raises(StepNcError, match="column spindle_rad_s, depth_mm is missing"):
        stepnc.predict(model, path)
    with pytest.raises(StepNcError, match="a table or settings, not both"):
        stepnc.predict(model, path, **ASKED)
