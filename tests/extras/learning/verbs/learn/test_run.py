"""Learning: trained on the first rows, tested on the next, beside what is simpler."""

from dataclasses import asdict, replace
from hashlib import sha256
from pathlib import Path

import pyarrow as pa
import pytest
from pyarrow import csv

import stepnc
from extras.learning.verbs.learn.request import LearnRequest
from extras.learning.verbs.learn.result import LearnResult
from stepnc_model.errors import StepNcError
from tests.every_case import every_case
from tests.extras.learning.tables import changed, law_table, written

ASKED = LearnRequest(model="power-law", train=100, test=60)


def learn(path: Path, request: LearnRequest) -> LearnResult:
    return stepnc.learn(path, **asdict(request))


def test_the_first_rows_train_and_the_next_ones_test(tmp_path: Path) -> None:
    table = law_table(200)
    result = learn(written(tmp_path, table), ASKED)
    assert result.model.low["feed_mm_s"] == min(table["feed_mm_s"].to_pylist()[:100])
    assert result.actual.tolist() == table["total_power_w"].to_pylist()[100:160]
    assert result.scored[0].name == "power-law"
    assert r2_of(result, "power-law") == pytest.approx(1.0)


def r2_of(result: LearnResult, name: str) -> float:
    (score,) = (each.scores.r2 for each in result.scored if each.name == name)
    assert score is not None
    return score.value


def test_the_physics_is_the_ceiling_of_a_target_with_noise(tmp_path: Path) -> None:
    path = written(tmp_path, law_table(200, noise=0.2))
    result = learn(path, replace(ASKED, model="forest"))
    scores = {each.name: each.scores for each in result.scored}
    assert set(scores) == {"forest", "mean", "power-law", "physics"}
    assert result.ceiling == scores["physics"].r2
    assert r2_of(result, "mean") < 0.05 < r2_of(result, "forest")
    assert r2_of(result, "forest") < r2_of(result, "physics") < 0.99
    exact = learn(path, replace(ASKED, target="total_power_exact_w"))
    assert exact.ceiling is None
    assert r2_of(exact, "power-law") == pytest.approx(1.0)


def test_a_csv_is_read_as_well(tmp_path: Path) -> None:
    table = law_table(200)
    csv.write_csv(table, tmp_path / "data.csv")
    one, other = learn(tmp_path / "data.csv", ASKED), learn(written(tmp_path, table), ASKED)
    assert one.predicted == pytest.approx(other.predicted)


@every_case(
    ("request_", "message"),
    [
        (replace(ASKED, model="oracle"), "model 'oracle'"),
        (replace(ASKED, target="power"), "target 'power'"),
        (replace(ASKED, target="time_s"), "all are 10"),
        (replace(ASKED, train=150), "200 rows, but --train 150 and --test 60 need 210"),
        (replace(ASKED, train=9), "train 9"),
        (replace(ASKED, model="gp", train=5_001), "--model gp with 5001 rows: .* 5000"),
        (replace(ASKED, test=200_001), "--test 200001"),
        (
            replace(ASKED, target="peak_power_w", is_on_physics=True),
            "--on-physics: peak_power_w has no physics; total_power_w, energy_j have",
        ),
    ],
)
def test_a_bad_request_is_refused(tmp_path: Path, request_: LearnRequest, message: str) -> None:
    path = written(tmp_path, law_table(200))
    with pytest.raises(StepNcError, match=message):
        learn(path, request_)


def test_a_bad_table_is_refused(tmp_path: Path) -> None:
    table, name = law_table(200), "total_power_w"
    bad = {
        "column feed_mm_s is missing; the table has row": table.drop_columns("feed_mm_s"),
        f"column {name} is not of numbers": changed(table, name, ["x"] * 200),
        f"row 1: {name} is no finite": changed(table, name, [float("nan"), *[1.0] * 199]),
        f"row 1: {name} 0 W: it must be positive": changed(table, name, [*range(200)]),
        "row 3: feed_mm_s -1 mm/s: it must be pos": changed(
            table, "feed_mm_s", [50.0, 60.0, -1.0, *[70.0] * 197]
        ),
        "column feed_mm_s is in m/s; expected mm/s": table.cast(
            table.schema.set(
                table.schema.get_field_index("feed_mm_s"),
                pa.field("feed_mm_s", pa.float64(), metadata={"unit": "m/s"}),
            )
        ),
        f"column {name} is missing": table.drop_columns(name),
        "none of feed_mm_s, .* varies": changed(
            changed(changed(table, "feed_mm_s", [50.0] * 200), "depth_mm", [3.0] * 200),
            "spindle_rad_s",
            [100.0] * 200,
        ),
    }
    for message, each in bad.items():
        with pytest.raises(StepNcError, match=message):
            learn(written(tmp_path, each), ASKED)
    (tmp_path / "data.parquet").write_bytes(b"nothing")
    with pytest.raises(StepNcError, match=r"data\.parquet: is not a Parquet file"):
        learn(tmp_path / "data.parquet", ASKED)
    many = changed(pa.concat_tables([table] * 6), "machine", list(map(str, range(1200))))
    with pytest.raises(StepNcError, match="machine: more than 1000 different names"):
        learn(written(tmp_path, many), replace(ASKED, train=1100))
    (tmp_path / "data.csv").write_text("feed_mm_s,depth_mm\n1,x\n", encoding="utf-8")
    with pytest.raises(StepNcError, match=r"data\.csv: cannot be read: .* invalid value 'x'"):
        learn(tmp_path / "data.csv", ASKED)
    with pytest.raises(StepNcError, match=r"missing\.parquet: No such file"):
        learn(tmp_path / "missing.parquet", ASKED)
    with pytest.raises(StepNcError, match=r"has no manifest\.json"):
        learn(tmp_path, ASKED)


def test_a_learning_curve_ends_with_the_model(tmp_path: Path) -> None:
    path = written(tmp_path, law_table(400, noise=0.1))
    result = learn(path, replace(ASKED, model="mlp", train=160, has_curve=True))
    assert [each.rows for each in result.curve] == [20, 40, 80, 160]
    assert result.curve[-1].scores == result.scored[0].scores
    assert result.curve[0].scores.rmse.value > 1.1 * result.curve[-1].scores.rmse.value
    assert learn(path, ASKED).curve == ()


def hidden_table(count: int) -> pa.Table:
    """Measured runs: 15 % more force than the physics says, 7 W more idle power, noise."""
    table = law_table(count, noise=0.01)
    power = table["total_power_w"].to_numpy() + 0.15 * table["cutting_power_w"].to_numpy() + 7
    return changed(table, "total_power_w", power)


def test_a_model_on_the_physics_learns_what_the_physics_lacks(tmp_path: Path) -> None:
    path = written(tmp_path, hidden_table(400))
    asked = replace(ASKED, is_on_physics=True, train=150, test=250)
    result = learn(path, asked)
    rmse = {each.name: each.scores.rmse.value for each in result.scored}
    assert set(rmse) == {
        "power-law", "mean", "power-law alone", "physics", "k_c and idle power"
    }  # fmt: skip
    assert rmse["power-law"] < 1.01 * rmse["power-law alone"] < rmse["mean"]
    assert rmse["power-law"] < 0.3 * rmse["physics"]
    assert rmse["k_c and idle power"] < 1.02 * rmse["power-law"]
    assert (result.ceiling, result.model.physics) == (None, "total_power_exact_w")
    found = result.factor
    assert found is not None
    assert abs(found.factor - 1.15) < 3 * found.factor_error < 0.1
    assert abs(found.offset - 7.0) < 3 * found.offset_error < 3.0
    assert learn(path, replace(asked, is_on_physics=False)).factor is None


def test_a_model_on_the_physics_needs_its_column(tmp_path: Path) -> None:
    table = law_table(200).drop_columns("total_power_exact_w")
    with pytest.raises(StepNcError, match="column total_power_exact_w is missing"):
        learn(written(tmp_path, table), replace(ASKED, is_on_physics=True))


def test_the_manifest_of_the_data_set_is_kept(tmp_path: Path) -> None:
    table = law_table(200)
    told = table.replace_schema_metadata({"stepnc_manifest": "{}"})
    path = written(tmp_path, told)
    assert learn(path, ASKED).model.manifest == sha256(b"{}").hexdigest()
    assert learn(written(tmp_path, table), ASKED).model.manifest == ""
