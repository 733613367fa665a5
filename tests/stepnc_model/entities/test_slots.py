"""Annotations become slots."""

import pytest

from stepnc_model.entities.conversion import AttributeSlot, slots_of
from stepnc_model.entities.enums import Logical, SpeedName
from stepnc_model.entities.executables import Workplan
from stepnc_model.entities.geometry import CartesianPoint, CompositeCurve, TrimmedCurve
from stepnc_model.entities.measures import (
    LimitsAndFits,
    PlusMinusValue,
    TolerancedLengthMeasure,
)
from stepnc_model.entities.operations import CutterLocationTrajectory, ToolpathSpeed
from stepnc_model.entities.tools import MillingToolBody
from stepnc_model.part21.values import Typed


def test_slots_follow_the_order_of_the_parameters() -> None:
    assert list(slots_of(MillingToolBody)) == [
        "dimension",
        "number_of_teeth",
        "hand_of_cut",
        "coolant_through_tool",
        "pilot_length",
    ]


def test_optional_number() -> None:
    slot = slots_of(MillingToolBody)["number_of_teeth"]
    assert slot == AttributeSlot(is_optional=True, plain=(int,))


def test_select_of_entities() -> None:
    slot = slots_of(TolerancedLengthMeasure)["implicit_tolerance"]
    assert slot == AttributeSlot(references=(PlusMinusValue, LimitsAndFits))


def test_list_of_entities() -> None:
    slot = slots_of(Workplan)["its_elements"]
    assert slot.items is not None
    assert slot.items.references[0].express_name() == "executable"


def test_list_of_a_select() -> None:
    slot = slots_of(TrimmedCurve)["trim_1"]
    assert slot.items is not None
    assert slot.items.references == (CartesianPoint,)
    assert set(slot.items.plain) == {Typed, float}


def test_select_of_curve_name_and_factor() -> None:
    slot = slots_of(CutterLocationTrajectory)["its_speed"]
    assert slot.references == (ToolpathSpeed,)
    assert slot.enumeration is SpeedName
    assert set(slot.plain) == {Typed, float}


@pytest.mark.parametrize(
    ("slot", "words"),
    [
        (slots_of(TolerancedLengthMeasure)["implicit_tolerance"], "plus_minus_value or limits"),
        (slots_of(CompositeCurve)["self_intersect"], "one of .T., .F., .U."),
        (slots_of(Workplan)["its_elements"], "a list"),
        (slots_of(MillingToolBody)["coolant_through_tool"], "a truth value"),
        (AttributeSlot(enumeration=Logical, plain=(float, Typed)), "a number or one of"),
    ],
)
def test_slot_names_what_it_takes(slot: AttributeSlot, words: str) -> None:
    assert words in slot.expected()
