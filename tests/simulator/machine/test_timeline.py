"""Columns of a run as the outside reads them."""

from dataclasses import fields
from enum import IntEnum

import pytest

from simulator.machine.samples import (
    Condition,
    Execution,
    PathMode,
    Rotation,
    Samples,
    TravelDirection,
)
from simulator.machine.timeline import COLUMNS, DataItem
from tests.every_case import every_case

NAMED = {column.name: column for column in COLUMNS}

UNITS = {"s", "mm", "mm/s", "W", "rpm", "N", "mm³/s", ""}
"""MTConnect's own, apart from the removal rate, which it has not"""


def test_names_are_unique() -> None:
    assert len(NAMED) == len(COLUMNS)


@every_case("column", COLUMNS)
def test_source_is_a_column_of_the_samples(column: DataItem) -> None:
    assert hasattr(Samples, column.source)
    has_three = column.source in {"position", "velocity", "direction", "axis_power"}
    assert has_three == (column.axis is not None)
    assert column.unit in UNITS


def test_every_column_of_the_samples_is_told() -> None:
    assert {field.name for field in fields(Samples)} <= {column.source for column in COLUMNS}


def test_axes_are_in_order() -> None:
    for suffix in ("position_actual", "velocity_actual", "wattage"):
        assert [NAMED[f"{name}_axis_{suffix}"].axis for name in "xyz"] == [0, 1, 2]


@every_case(
    ("name", "kind"),
    [
        ("execution", Execution),
        ("path_mode", PathMode),
        ("overload", Condition),
        ("x_axis_direction", TravelDirection),
        ("z_axis_direction", TravelDirection),
        ("rotary_direction", Rotation),
    ],
)
def test_words_are_the_names_of_the_events(name: str, kind: type[IntEnum]) -> None:
    words = NAMED[name].words
    assert words is not None
    assert list(words) == [each.name for each in sorted(kind)]
    assert [int(each) for each in sorted(kind)] == list(range(len(words)))


def test_coolant_is_off_or_on() -> None:
    assert NAMED["coolant"].words == ("OFF", "ON")


@pytest.mark.parametrize("name", ["rotary_velocity_programmed", "rotary_velocity_actual"])
def test_spindle_speeds_are_in_rpm(name: str) -> None:
    assert (NAMED[name].unit, NAMED[name].scale) == ("rpm", 60.0)


def test_only_the_spindle_changes_its_unit() -> None:
    scaled = {column.name for column in COLUMNS if column.scale != 1.0}
    assert scaled == {"rotary_velocity_programmed", "rotary_velocity_actual"}


def test_running_workingstep_is_always_there() -> None:
    assert COLUMNS[-1].name == COLUMNS[-1].source == "workingstep"
