"""Signals of a monitored machine, named as those of a simulated run."""

from collections.abc import Mapping
from math import isnan, nan

from simulator.client.columns import Cell
from stepnc_model.units import mm_min_from_speed

MM_MIN = mm_min_from_speed(1.0)
"""Feed of 1 mm/s in mm/min."""

COLUMNS: Mapping[str, tuple[str, float]] = {
    "x_mm": ("x_axis_position_actual", 1.0),
    "y_mm": ("y_axis_position_actual", 1.0),
    "z_mm": ("z_axis_position_actual", 1.0),
    "feed_programmed_mm_min": ("path_feedrate_programmed", MM_MIN),
    "feed_actual_mm_min": ("path_feedrate_actual", MM_MIN),
    "spindle_speed_rpm": ("rotary_velocity_actual", 1.0),
    "spindle_power_w": ("c_axis_wattage", 1.0),
    "cutting_force_n": ("cutting_force", 1.0),
    "tool": ("tool_number", 1.0),
}
"""Column of :mod:`simulator.client.columns`, and factor from its unit, of each signal."""

TOTAL = "electric_wattage"

PARTS = (
    "x_axis_wattage", "y_axis_wattage", "z_axis_wattage", "c_axis_wattage",
    "coolant_wattage", "load_wattage",
)  # fmt: skip
"""Columns that add up to the total power of a machine that does not tell it."""

READ = frozenset({TOTAL, *PARTS, *(column for column, _ in COLUMNS.values())})
"""Columns of which the signals are made."""

SIGNALS = (*COLUMNS, "total_power_w")
"""Names of all signals, each with its unit."""


def signals_of(row: Mapping[str, Cell]) -> dict[str, float]:
    """Return the signals of a row of :class:`simulator.client.columns.RowMaker`.

    NaN is a value that the machine does not tell. The total power is the machine's own, or else
    the sum of the powers that it tells.
    """
    found = {
        name: factor * _number(row.get(column)) for name, (column, factor) in COLUMNS.items()
    }
    return {**found, "total_power_w": _total(row)}


def _total(row: Mapping[str, Cell]) -> float:
    total = _number(row.get(TOTAL))
    if not isnan(total):
        return total
    known = [value for name in PARTS if not isnan(value := _number(row.get(name)))]
    return sum(known) if known else nan


def _number(cell: Cell) -> float:
    return cell if isinstance(cell, float) else nan
