"""Predictions: within the trained box only, for one part or a table."""

from dataclasses import replace
from pathlib import Path

import pytest

from service.learning.learn import learn
from service.learning.model_file import save_model
from service.learning.predict import predict
from service.requests.learning import LearnRequest, PredictRequest
from stepnc_model.errors import StepNcError
from tests.service.learning.tables import law_table, written

ASKED = PredictRequest(feed_mm_s=50.0, spindle_rad_s=100.0, depth_mm=3.0, machine="b")


@pytest.fixture
def model(tmp_path: Path) -> Path:
    table = written(tmp_path, law_table(200, machines=("a", "b")))
    path = tmp_path / "model.skops"
    save_model(learn(table, LearnRequest(model="power-law", train=100, test=60)).model, path)
    return path


def test_one_part_is_predicted(model: Path) -> None:
    (value,) = predict(model, ASKED).values
    assert value == pytest.approx(2 * 10.0 * 50.0**0.5 * 100.0**0.3)


def test_rows_of_a_table_are_predicted(model: Path, tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    header = "feed_mm_s,spindle_rad_s,depth_mm,machine"
    path.write_text(f"{header}\n50,100,3,a\n60,100,3,b\n", encoding="utf-8")
    values = predict(model, PredictRequest(), table=path).values
    exact = [10.0 * 50.0**0.5 * 100.0**0.3, 20.0 * 60.0**0.5 * 100.0**0.3]
    assert values.tolist() == pytest.approx(exact)


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        (replace(ASKED, feed_mm_s=95.0), r"feed_mm_s 95 mm/s exceeds 89\.\d+ mm/s, the bound"),
        (
            replace(ASKED, spindle_rad_s=10.0),
            r"spindle_rad_s 10 rad/s is below 7\d\.?\d* rad/s",
        ),
        (replace(ASKED, machine="c"), "machine 'c' was not trained; known: a, b"),
        (replace(ASKED, machine=None), "the model needs --machine too"),
        (replace(ASKED, depth_mm=float("nan")), "depth_mm is no finite number"),
    ],
)
def test_outside_the_trained_box_is_refused(
    model: Path, request_: PredictRequest, message: str
) -> None:
    with pytest.raises(StepNcError, match=message):
        predict(model, request_)


def test_a_bad_table_is_refused(model: Path, tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    path.write_text("feed_mm_s,machine\n50,a\n", encoding="utf-8")
    with pytest.raises(StepNcError, match="column spindle_rad_s, depth_mm is missing"):
        predict(model, PredictRequest(), table=path)
    with pytest.raises(StepNcError, match="a table or settings, not both"):
        predict(model, ASKED, table=path)
