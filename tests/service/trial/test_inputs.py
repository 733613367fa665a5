"""Inputs know their bounds, and say them with their units."""

from dataclasses import fields, replace
from math import inf, nan

import pytest

from controller.orders import Criterion
from service.trial.inputs import (
    FIELDS,
    InputField,
    Inputs,
    MillingType,
    change_words,
    changed,
    differing,
)
from stepnc_model.errors import StepNcError
from tests.every_case import every_case

INPUTS = Inputs()


@every_case("field", FIELDS)
def test_both_bounds_can_be_had_and_nothing_beyond(field: InputField) -> None:
    # A slow and large cutter, so that no spindle speed stands in the way.
    slow = replace(INPUTS, tool_diameter_mm=150.0)
    for value in (field.low, field.high):
        calm = {} if field.name == "cutting_speed_m_min" else {"cutting_speed_m_min": 20.0}
        made = changed(slow, **calm, **{field.name: value})
        assert getattr(made, field.name) == value
    for value in (0.99 * field.low, 1.01 * field.high, nan, inf):
        with pytest.raises(StepNcError, match=rf"^{field.words} ") as caught:
            changed(slow, **{field.name: value})
        if not field.is_whole:
            assert f"it must be {field.low:g} to {field.high:g} {field.unit}".rstrip() in str(
                caught.value
            )


@every_case(
    ("changes", "message"),
    [
        ({"axial_depth_mm": 25}, "depth 25 mm"),
        ({"motor_power_kw": 0.0}, "motor power 0 kW"),
        ({"efficiency": 1.1}, "efficiency 1.1"),
        ({"feed_per_tooth_mm": "much"}, "chip load 'much'"),
        ({"feed_per_tooth_mm": True}, "chip load 'True'"),
        ({"teeth": 2.5}, "whole number"),
        ({"material": "butter"}, "material 'butter'"),
        ({"material": "../c45.toml"}, "material '../c45.toml'"),
        ({"milling_type": "side"}, "milling type 'side'"),
        ({"mode": "EC"}, "mode 'EC'"),
        ({"is_on": "yes"}, "control 'yes'"),
        ({"coolant": 1}, "input 'coolant'"),
        (
            {"milling_type": "up", "radial_width_mm": 60.0},
            "radial width 60 mm",
        ),
        (
            {"tool_diameter_mm": 4.0},
            "spindle speed 17507 rpm, from cutting speed 220 m/min and tool diameter 4 mm: "
            "it must be at most 12000 rpm",
        ),
    ],
)
def test_what_cannot_be_is_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(StepNcError) as caught:
        changed(INPUTS, **changes)
    assert message in str(caught.value)


def test_inputs_are_checked_however_they_are_made() -> None:
    with pytest.raises(StepNcError, match=r"chip load 2 mm: it must be 0\.01 to 1 mm"):
        Inputs(feed_per_tooth_mm=2.0)


def test_a_full_slot_does_not_look_at_the_width() -> None:
    slot = changed(INPUTS, radial_width_mm=160.0)
    assert slot.milling_type is MillingType.FULL


def test_enumerations_come_as_words() -> None:
    made = changed(INPUTS, mode="qc", milling_type="down", is_on=False)
    assert made.mode is Criterion.QC
    assert made.milling_type is MillingType.DOWN
    assert differing(INPUTS, made) == ("milling_type", "mode", "is_on")
    assert differing(made, made) == ()


@every_case(
    ("changes", "words"),
    [
        ({"axial_depth_mm": 4}, "depth 2 -> 4 mm"),
        ({"teeth": 2}, "teeth 4 -> 2"),
        ({"material": "al7075"}, "material c45 -> al7075"),
        ({"milling_type": "up"}, "milling type full -> up"),
        ({"mode": "QC"}, "mode TC -> QC"),
        ({"is_on": False}, "control on -> off"),
    ],
)
def test_a_change_is_told_with_both_values(changes: dict[str, object], words: str) -> None:
    (name,) = changes
    after = changed(INPUTS, **changes)
    assert change_words(INPUTS, after, name) == words
    assert change_words(after, INPUTS, name) != words


def test_every_number_has_bounds() -> None:
    numbers = {
        field.name
        for field in fields(Inputs)
        if isinstance(getattr(INPUTS, field.name), int | float)
    }
    assert numbers - {"is_on"} == {field.name for field in FIELDS}
