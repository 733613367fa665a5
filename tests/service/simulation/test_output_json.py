"""The JSON is whole, carries its units, and adds up."""

import json
from typing import Any

import pytest

from service.rendering.columns import dump
from service.simulation.facts import CarbonFactor
from service.simulation.run import Simulation
from service.verbs.simulate.result import SimulateResult


@pytest.fixture(scope="module")
def wire(simulation: Simulation) -> dict[str, Any]:
    factor = CarbonFactor(grams_per_kwh=36.0, source="our roof")
    found: dict[str, Any] = json.loads(
        dump(SimulateResult(simulation=simulation, carbon=factor).record())
    )
    return found


def test_workingsteps_add_up(wire: dict[str, Any]) -> None:
    steps, total = wire["workingsteps"], wire["total"]
    for key in ("time_s", "cutting_time_s", "air_time_s", "waiting_time_s", "volume_mm3"):
        assert sum(step[key] for step in steps) == pytest.approx(total[key])
    for name, energy in total["energy_j"].items():
        assert sum(step["energy_j"][name] for step in steps) == pytest.approx(energy)


def test_components_add_up(wire: dict[str, Any]) -> None:
    energy = dict(wire["total"]["energy_j"])
    total = energy.pop("total")
    assert sum(energy.values()) == pytest.approx(total)
    assert wire["carbon"]["total_g"] == pytest.approx(total / 1e5)


def test_what_comes_before_the_first_has_no_id(wire: dict[str, Any]) -> None:
    assert [step["id"] for step in wire["workingsteps"]][::2] == [None, "FINISH"]
    assert [step["begin_s"] for step in wire["workingsteps"]] == [0.0, 1.0, 61.0]


def test_peaks_have_time_and_line(wire: dict[str, Any]) -> None:
    assert wire["total"]["peak_spindle_power"] == {
        "value_w": 4500.0,
        "time_s": 30.0,
        "line": 12,
    }
    assert wire["total"]["peak_cutting_force"]["value_n"] == 950.0
    assert wire["total"]["peak_chip_thickness"]["value_mm"] == 0.12
    assert wire["total"]["peak_tool_deflection"]["value_mm"] == 0.0234
