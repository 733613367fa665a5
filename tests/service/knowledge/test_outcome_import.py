"""Outcomes of real runs come in as others go out."""

import json
from pathlib import Path
from typing import Any

import pytest

import stepnc
from kbe.errors import OutcomeDiffers
from kbe.store import open_store
from service.knowledge.outcome_import import add_outcomes
from stepnc_model.errors import StepNcError
from tests.every_case import every_case

LEAST = {
    "machine": "DMU 50",
    "material": "c45",
    "tool": "MILL 18MM",
    "program": "part.stpnc",
    "workingstep": "ROUGH THE FACE",
    "feature_id": "FACE",
    "feature_kind": "planar_face",
    "is_finishing": False,
    "mode": "TC",
    "strategy": "",
    "trace": "",
    "run": "shift 3",
    "recorded_at": "2026-03-02T08:00:00+01:00",
    "recorded_by": "Ada",
    "force_measured_n": 812,
}


def written(folder: Path, rows: Any) -> Path:
    path = folder / "outcomes.json"
    path.write_text(json.dumps(rows), encoding="utf-8")
    return path


def test_what_was_exported_is_added_unchanged(kb: str, tmp_path: Path) -> None:
    file, place = tmp_path / "out.json", str(tmp_path / "new.db")
    count = stepnc.kbe_export("outcomes", kb=kb, output=file).rows
    assert add_outcomes(place, file).new == count
    with open_store(kb) as old, open_store(place) as new:
        assert list(new.outcomes()) == list(old.outcomes())


def test_what_nobody_measured_may_be_left_out(tmp_path: Path) -> None:
    place = str(tmp_path / "new.db")
    assert add_outcomes(place, written(tmp_path, [LEAST])).new == 1
    with open_store(place) as store:
        (outcome,) = store.outcomes()
    assert outcome.force.measured == 812.0
    assert outcome.force.predicted is None
    assert outcome.force_ratio is None
    assert outcome.context.machine == "DMU 50"


@every_case(
    ("rows", "message"),
    [
        ({}, "at least one"),
        ([], "at least one"),
        ([3], "an object"),
        ([LEAST, {**LEAST, "colour": "red"}], "outcome 2: unknown key"),
        ([{**LEAST, "tool": None}], "'tool' is missing"),
        ([{**LEAST, "tool": 7}], "'tool' is 7"),
        ([{**LEAST, "is_finishing": 1}], "true or false"),
        ([{**LEAST, "force_measured_n": "much"}], "'much'"),
        ([{**LEAST, "force_measured_n": True}], "True"),
        ([{**LEAST, "force_measured_n": float("nan")}], "nan"),
        ([{**LEAST, "force_measured_n": 10**400}], "'force_measured_n' is 1000"),
        ([{**LEAST, "recorded_at": "2026-03-02T08:00:00"}], "zone"),
        ([{**LEAST, "recorded_at": 5}], "zone"),
        ([{**LEAST, "immersion": "sideways"}], "'sideways'"),
    ],
)
def test_what_is_no_outcome_is_refused_and_nothing_kept(
    rows: Any, message: str, tmp_path: Path
) -> None:
    place = tmp_path / "new.db"
    with pytest.raises(StepNcError) as caught:
        add_outcomes(str(place), written(tmp_path, rows))
    assert message in str(caught.value)
    assert not place.exists()


def test_a_refusal_names_file_row_field_and_value(tmp_path: Path) -> None:
    file = written(tmp_path, [{**LEAST, "tool": 7}])
    with pytest.raises(StepNcError) as caught:
        add_outcomes(str(tmp_path / "new.db"), file)
    assert str(caught.value) == f"{file}, outcome 1: 'tool' is 7, but must be text"


def test_what_is_no_json_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "x.json"
    path.write_bytes(b"\xff{")
    with pytest.raises(StepNcError, match="is not valid JSON"):
        add_outcomes(str(tmp_path / "new.db"), path)


def test_a_file_that_is_added_again_adds_nothing(tmp_path: Path) -> None:
    """A workingstep that ran twice is two outcomes; a row that stands there twice is one."""
    place = str(tmp_path / "new.db")
    again = {**LEAST, "recorded_at": "2026-03-02T09:00:00+01:00", "mode": "QC"}
    file = written(tmp_path, [LEAST, again, LEAST])
    assert str(add_outcomes(place, file)) == "2 outcomes (already recorded: 1 of 3)"
    assert str(add_outcomes(place, file)) == "0 outcomes (already recorded: 3 of 3)"
    with pytest.raises(OutcomeDiffers):
        add_outcomes(place, written(tmp_path, [{**LEAST, "mode": "EC"}]))
