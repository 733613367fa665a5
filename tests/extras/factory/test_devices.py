"""Devices of a shop, and words for its states."""

from pathlib import Path

from extras.agent.model.buffer import ConditionValue
from extras.factory.devices import device_names, first_values, shop_devices, state_values
from extras.factory.model.shop_file import read_shop
from extras.factory.model.states import MachineState
from tests.extras.factory.shops import program_file, timed_shop


def test_each_machine_is_a_device_with_what_is_known_of_it(tmp_path: Path) -> None:
    shop = read_shop(program_file(tmp_path))
    devices = shop_devices(shop)
    assert [device.name for device in devices.model.devices] == [
        "Agent", "saw", "mill-1", "mill-2",
    ]  # fmt: skip
    index = devices.model.index
    assert {"mill-1_xpos", "mill-2_speed", "saw_watt", "saw_exec", "mill-1_wait"} <= set(index)
    # Nothing of the stand-in for a machine of which only times are known.
    assert not {"saw_xpos", "saw_speed", "saw_cutforce", "saw_coolant"} & set(index)


def test_names_become_names_of_xml() -> None:
    found = device_names(["saw 1", "saw_1", "2nd", "Agent", "Fräse"])
    assert found == ("saw_1", "saw_1_2", "m_2nd", "Agent_2", "Fr_se")


def test_a_failure_interrupts_a_cut_and_stops_what_stands() -> None:
    cut = state_values(MachineState.FAILED, MachineState.MACHINING)
    stood = state_values(MachineState.REPAIR, MachineState.STARVED)
    assert (cut["exec"], stood["exec"]) == ("INTERRUPTED", "STOPPED")
    assert cut["system"] == ConditionValue(level="FAULT", native_code="failed", text="failed")
    well = state_values(MachineState.BLOCKED, MachineState.BLOCKED)
    assert (well["exec"], well["wait"]) == ("WAIT", "MATERIAL_UNLOAD")
    assert well["system"] == ConditionValue(level="NORMAL")


def test_off_shift_nothing_is_known() -> None:
    off = state_values(MachineState.OFF, MachineState.OFF)
    assert (off["avail"], off["exec"], off["function"]) == ("UNAVAILABLE", None, None)


def test_every_state_has_words() -> None:
    for state in MachineState:
        assert state_values(state, state)


def test_first_values_are_items_of_the_device(tmp_path: Path) -> None:
    devices = shop_devices(timed_shop(tmp_path))
    first = first_values(devices.shown[0], devices.names[0], 200.0)
    assert set(first) <= set(devices.model.index)
    assert (first["saw_1_exec"], first["saw_1_watt"]) == ("READY", 200.0)
