"""Acts of the machine are values."""

from dataclasses import FrozenInstanceError, fields
from typing import get_args

import pytest

from simulator.machine import acts
from stepnc_model.post.blocks import Coolant, CoolantKind


def test_acts_with_the_same_content_are_equal() -> None:
    assert acts.SpindleTo(speed=10.0) == acts.SpindleTo(speed=10.0)
    assert acts.ProgramAct(line=3, act=acts.Wait(seconds=1.0)) != acts.ProgramAct(
        line=4, act=acts.Wait(seconds=1.0)
    )


def test_an_act_does_not_change() -> None:
    act = acts.ToolTo(number=3)
    with pytest.raises(FrozenInstanceError):
        act.number = 4  # type: ignore[misc]


def test_coolant_is_off_unless_said() -> None:
    assert acts.CoolantTo().coolant == Coolant()
    flood = Coolant(kinds=frozenset({CoolantKind.FLOOD}))
    assert acts.CoolantTo(coolant=flood).coolant.kinds


def test_every_act_of_the_module_belongs_to_the_union() -> None:
    classes = {each for each in vars(acts).values() if isinstance(each, type)}
    made = {each for each in classes if each.__module__ == acts.__name__} - {acts.ProgramAct}
    assert made == set(get_args(acts.Act))
    assert [field.name for field in fields(acts.ProgramAct)] == ["line", "act"]
