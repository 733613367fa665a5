"""The JSON of a calibration carries its units, and what is not a number is null."""

import json
from typing import Any

import pytest

from extras.calibration.verbs.calibrate.result import CalibrationResult


@pytest.fixture(scope="module")
def wire(calibration: CalibrationResult) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(json.dumps(calibration.record()))
    return found


def test_parameters_carry_their_units(wire: dict[str, Any]) -> None:
    base, cutting = wire["parameters"]
    assert base == {
        "parameter": "base power",
        "unit": "W",
        "value": 1200.0,
        "low": 1190.0,
        "high": 1210.0,
        "is_identified": True,
        "reason": "",
    }
    assert (cutting["unit"], cutting["is_identified"]) == ("", False)


def test_an_open_end_is_null(wire: dict[str, Any]) -> None:
    assert wire["parameters"][1]["high"] is None
    assert wire["drive_delay"]["high_s"] is None
    assert wire["drive_delay"]["is_identified"] is False


def test_a_share_of_no_energy_is_null(wire: dict[str, Any]) -> None:
    coolant, spindle, _ = wire["held_out"]
    assert coolant["energy_error"] is coolant["energy_skill"] is None
    assert coolant["rmse_w"] == 2.0
    assert spindle["energy_error"] == pytest.approx(0.01)
    assert spindle["energy_skill"] == pytest.approx(0.9)


def test_keys_of_quantities_end_in_their_unit(wire: dict[str, Any]) -> None:
    assert wire["cycle_times"] == [{"run": "run", "measured_s": 100.0, "simulated_s": 101.0}]
    bare = {"run", "power", "energy_error", "baseline_energy_error", "energy_skill"}
    assert all(key.endswith(("_w", "_j")) for key in wire["held_out"][0].keys() - bare)
    assert wire["findings"][0]["message"] == "gap of 2 s"
