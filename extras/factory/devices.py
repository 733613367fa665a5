"""MTConnect devices of the machines of a shop, and the words that stand for their states.

A machine that cuts is ACTIVE; one that sets up or ejects a part waits for it (WAIT with
PART_LOAD or PART_UNLOAD), a blocked one for room (MATERIAL_UNLOAD). A machine that failed while
it cut is INTERRUPTED, another one STOPPED, both with a FAULT of the system; off shift it is
UNAVAILABLE.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from extras.agent.model.buffer import ConditionValue, Value
from extras.agent.model.machine_feed import beginning
from extras.agent.model.machine_model import (
    CONTROLLER,
    ITEMS,
    PATH,
    MachineItem,
    MachineModel,
    machine_model,
    shop_model,
)
from extras.agent.model.model import DeviceModel
from extras.factory.model.shop import Shop, ShopMachine
from extras.factory.model.states import MachineState
from simulator.library import load_machine

STAND_IN = "vmc15"
"""Machine of the library whose parts a machine without a file does not show."""

SHOP_ITEMS = (
    MachineItem(place=CONTROLLER, id="function", type="FUNCTIONAL_MODE", category="EVENT"),
    MachineItem(
        place=PATH, id="wait", type="WAIT_STATE", category="EVENT", since="1.5",
    ),
)  # fmt: skip
"""Data items that machines of a shop have besides."""

LEFT_OUT = ("tool_asset", "run_time", "block")
"""Short ids of data items that machines of a shop do not have."""

TIMED = (
    "avail", "estop", "exec", "mode", "system", "program", "parts", "part", "batch", "watt",
    "energy", "function", "wait",
)  # fmt: skip
"""Short ids of the data items of a machine of which only times and powers are known."""


class StateWords(NamedTuple):
    """Words of MTConnect for a state."""

    execution: str | None
    mode: str | None
    """FUNCTIONAL_MODE"""
    wait: str | None = None
    """WAIT_STATE"""
    fault: str = ""
    """Native code of a fault of the system; empty: none."""


_S = MachineState

WORDS: Mapping[MachineState, StateWords] = {
    _S.IDLING: StateWords("READY", "PRODUCTION"),
    _S.STARVED: StateWords("READY", "PRODUCTION"),
    _S.BATCH_SETUP: StateWords("READY", "SETUP"),
    _S.PART_SETUP: StateWords("WAIT", "PRODUCTION", "PART_LOAD"),
    _S.MACHINING: StateWords("ACTIVE", "PRODUCTION"),
    _S.PART_EJECTION: StateWords("WAIT", "PRODUCTION", "PART_UNLOAD"),
    _S.BATCH_EJECTION: StateWords("READY", "TEARDOWN"),
    _S.BLOCKED: StateWords("WAIT", "PRODUCTION", "MATERIAL_UNLOAD"),
    _S.WAITING: StateWords("WAIT", "PRODUCTION", "SECONDARY_PROCESS"),
    _S.FAILED: StateWords("INTERRUPTED", "MAINTENANCE", fault="failed"),
    _S.REPAIR: StateWords("INTERRUPTED", "MAINTENANCE", fault="repair"),
    _S.MAINTENANCE: StateWords("STOPPED", "MAINTENANCE"),
    _S.OFF: StateWords(None, None),
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ShopDevices:
    """Devices of a shop, one for each machine, in its order."""

    names: tuple[str, ...]
    """Names of the devices, fit for XML."""
    shown: tuple[MachineModel, ...]
    model: DeviceModel
    """Of all devices, with that of the agent."""


def shop_devices(shop: Shop) -> ShopDevices:
    """Device model of a shop."""
    names = device_names([machine.name for machine in shop.machines])
    shown = tuple(
        _shown(machine, name) for machine, name in zip(shop.machines, names, strict=True)
    )
    return ShopDevices(names=names, shown=shown, model=shop_model(shown))


def device_names(names: list[str]) -> tuple[str, ...]:
    """Names as XML allows them in ids, different from each other."""
    found: list[str] = []
    for name in names:
        plain = re.sub(r"[^A-Za-z0-9_.-]", "_", name)
        plain = plain if re.match(r"[A-Za-z_]", plain) else f"m_{plain}"
        chosen, number = plain, 2
        while chosen in found or chosen.lower() == "agent":
            chosen, number = f"{plain}_{number}", number + 1
        found.append(chosen)
    return tuple(found)


def state_values(state: MachineState, before: MachineState) -> dict[str, Value]:
    """Values of data items, by short id, when a machine enters a state.

    Parameters
    ----------
    before : MachineState
        State from which a failed machine comes.
    """
    words = WORDS[state]
    is_on = state is not MachineState.OFF
    execution = words.execution
    if words.fault and before is not MachineState.MACHINING:
        execution = "STOPPED"
    system = ConditionValue(level="NORMAL" if is_on else "UNAVAILABLE")
    if words.fault:
        system = ConditionValue(level="FAULT", native_code=words.fault, text=state.value)
    return {
        "avail": "AVAILABLE" if is_on else "UNAVAILABLE",
        "exec": execution,
        "mode": "AUTOMATIC" if is_on else None,
        "function": words.mode,
        "wait": words.wait,
        "system": system,
    }


def first_values(shown: MachineModel, name: str, power: float) -> dict[str, Value]:
    """Values of a machine, by id, at the beginning."""
    own = state_values(MachineState.IDLING, MachineState.IDLING)
    more: dict[str, Value] = {"program": None, "energy": 0.0, "watt": power, "basewatt": power}
    known = beginning(shown, program="", part_count=0)
    found = known | {f"{name}_{short}": value for short, value in (own | more).items()}
    return {id: value for id, value in found.items() if id in shown.model.index}


def _shown(machine: ShopMachine, name: str) -> MachineModel:
    if machine.machine is not None:
        spec = replace(machine.machine, name=name, title=machine.name)
        return machine_model(spec, more=SHOP_ITEMS, left_out=LEFT_OUT)
    spec = replace(load_machine(STAND_IN), name=name, title=machine.name)
    unknown = {item.id for item in ITEMS} - set(TIMED)
    return machine_model(spec, more=SHOP_ITEMS, left_out=unknown)
