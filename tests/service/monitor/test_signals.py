"""Signals have the names and units of a simulated run."""

from math import isnan, nan

import pytest

from service.monitor.signals import SIGNALS, signals_of
from service.simulation.live import COLUMNS


def test_signals_are_columns_of_a_simulated_run() -> None:
    assert set(SIGNALS) <= set(COLUMNS)


def test_units_are_converted_and_the_rest_is_unknown() -> None:
    found = signals_of({"path_feedrate_actual": 5.0, "x_axis_position_actual": -2.5})
    assert tuple(found) == SIGNALS
    assert found["feed_actual_mm_min"] == pytest.approx(300.0)
    assert found["x_mm"] == -2.5
    assert isnan(found["y_mm"])
    assert isnan(found["total_power_w"])


def test_the_total_power_is_told_or_added_up() -> None:
    parts = {"x_axis_wattage": 10.0, "c_axis_wattage": 200.0, "coolant_wattage": nan}
    assert signals_of({**parts, "electric_wattage": 500.0})["total_power_w"] == 500.0
    assert signals_of(parts)["total_power_w"] == 210.0
    assert signals_of({**parts, "electric_wattage": nan})["total_power_w"] == 210.0
