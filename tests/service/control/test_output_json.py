"""The JSON is whole, carries its units, and adds up."""

import json
from typing import Any

import pytest

from service.control.run import ControlRun
from service.rendering.columns import dump
from service.verbs.control.result import ControlResult


@pytest.fixture(scope="module")
def wire(control_run: ControlRun) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(dump(ControlResult(run=control_run).record()))
    return found


def test_workingsteps_add_up(wire: dict[str, Any]) -> None:
    steps, total = wire["workingsteps"], wire["total"]
    for key in ("cutting_time_s", "over_set_point_s", "excess_impulse_n_s", "holds"):
        assert sum(step[key] for step in steps) == pytest.approx(total[key])
    for key in ("programmed", "actual"):
        assert sum(step["time_s"][key] for step in steps) == pytest.approx(total["time_s"][key])
    assert total["time_s"]["programmed"] == pytest.approx(total["program_time_s"])


def test_shares_are_of_the_whole_cut(wire: dict[str, Any]) -> None:
    slot = wire["workingsteps"][-1]
    assert slot["id"] == "MILL SLOT"
    assert sum(slot["held_by"].values()) == pytest.approx(1.0)
    assert slot["override"]["least"] <= slot["override"]["mean"] <= slot["override"]["greatest"]
    assert slot["kc_factor"]["readings"] > 10


def test_what_was_asked_for_is_told(wire: dict[str, Any]) -> None:
    assert wire["law"] == "log-pi"
    assert wire["look_ahead_revolutions"] is None
    assert wire["override_band"] == [0.2, 1.2]
    assert wire["disturbances"][-1] == {"word": "mode:QC@900s", "has_come": False}


def test_events_have_time_kind_and_text(wire: dict[str, Any], control_run: ControlRun) -> None:
    assert len(wire["events"]) == len(control_run.events)
    assert set(wire["events"][0]) == {"time_s", "kind", "text"}
    assert wire["limits_exceeded"] == []
