"""The device model of a machine of the library, by its file."""

from collections.abc import Collection, Iterable, Iterator
from copy import deepcopy
from dataclasses import dataclass
from functools import cache
from math import isfinite
from uuid import NAMESPACE_DNS, uuid5

from lxml import etree

from extras.agent.model.model import DeviceModel, model_of
from simulator.client.document_choices import NameSet, SchemaVersion
from simulator.spec import Machine, MachineKind
from stepnc_model.units import SECONDS_PER_MINUTE, rpm_from_rev_s

AGENT_UUID = uuid5(NAMESPACE_DNS, "agent.stepnc-optimiser")


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineItem:
    """A data item of a machine, and the column of the virtual machine that it shows."""

    place: str
    """component: path of elements with names, ``Axes/Linear:X``; empty: the device"""
    id: str
    """short; the device's id stands before it"""
    type: str
    category: str = "SAMPLE"
    sub_type: str = ""
    units: str = ""
    source: str = ""
    """column of the samples; empty: another part of the agent reports it"""
    axis: int | None = None
    scale: float = 1.0
    """units of the data item per unit of the column"""
    digits: int = 4
    """decimals of a number"""
    words: tuple[str, ...] = ()
    """of an event, by the number in the column"""
    since: str = "1.3"
    until: str = ""
    """first schema version without it; empty: none"""
    mill: str = ""
    """id in paper 003 (milling)"""
    lathe: str = ""
    """id in paper 000 (turning)"""
    constant: str = ""
    is_sum: bool = False
    """the sum of others, as a meter shows it: not among the data items of the papers"""

    def is_in(self, version: str) -> bool:
        """True if a schema version knows it."""
        return _key(self.since) <= _key(version) and (
            not self.until or _key(version) < _key(self.until)
        )


def _key(version: str) -> tuple[int, ...]:
    return tuple(map(int, version.split(".")))


SIGNS = ("NEGATIVE", "", "POSITIVE")
"""of an axis that stands the standard has no word: the last one holds"""

EXECUTIONS = ("READY", "ACTIVE", "WAIT", "PROGRAM_STOPPED", "PROGRAM_COMPLETED")
TURNS = ("COUNTER_CLOCKWISE", "", "CLOCKWISE")


def _linear(axis: str, row: int) -> tuple[MachineItem, ...]:
    place, low = f"Axes/Linear:{axis}", axis.lower()
    return (
        MachineItem(
            place=place,
            id=f"{low}pos",
            type="POSITION",
            sub_type="ACTUAL",
            units="MILLIMETER",
            source="position",
            axis=row,
            mill=f"{low}_axis_position_sample",
            lathe=f"{low}_axis_position_actual",
        ),
        MachineItem(
            place=place,
            id=f"{low}frt",
            type="AXIS_FEEDRATE",
            sub_type="ACTUAL",
            units="MILLIMETER/SECOND",
            source="velocity",
            axis=row,
        ),
        MachineItem(
            place=place,
            id=f"{low}watt",
            type="WATTAGE",
            sub_type="ACTUAL",
            units="WATT",
            source="axis_power",
            axis=row,
            digits=3,
            mill=f"{low}_axis_wattage_sample",
            lathe=f"{low}_axis_wattage",
        ),
        MachineItem(
            place=place,
            id=f"{low}dir",
            type="DIRECTION",
            category="EVENT",
            sub_type="LINEAR",
            source="direction",
            axis=row,
            words=SIGNS,
        ),
        MachineItem(place=place, id=f"{low}travel", type="POSITION", category="CONDITION"),
    )


SPINDLE = "Axes/Rotary:C"
CONTROLLER = "Controller:controller"
PATH = f"{CONTROLLER}/Path:path"
PROCESS = "Processes:processes/ProcessOccurrence:process"
ELECTRIC = "Systems/Electric:electric"
COOLANT = "Systems/Coolant:coolant"

ITEMS = (
    MachineItem(place="", id="avail", type="AVAILABILITY", category="EVENT"),
    MachineItem(place="", id="asset_chg", type="ASSET_CHANGED", category="EVENT"),
    MachineItem(place="", id="asset_rem", type="ASSET_REMOVED", category="EVENT"),
    *(item for row, axis in enumerate("XYZ") for item in _linear(axis, row)),
    MachineItem(
        place=SPINDLE, id="speed", type="ROTARY_VELOCITY", sub_type="ACTUAL",
        units="REVOLUTION/MINUTE", source="spindle_speed", scale=SECONDS_PER_MINUTE,
    ),
    MachineItem(
        place=SPINDLE, id="speed_prog", type="ROTARY_VELOCITY", sub_type="PROGRAMMED",
        units="REVOLUTION/MINUTE", source="spindle_programmed", scale=SECONDS_PER_MINUTE,
    ),
    MachineItem(
        place=SPINDLE, id="cwatt", type="WATTAGE", sub_type="ACTUAL", units="WATT",
        source="spindle_power", digits=3, mill="c_axis_wattage_sample", lathe="c_axis_wattage",
    ),
    MachineItem(
        place=SPINDLE, id="cload", type="LOAD", units="PERCENT", source="spindle_load",
        digits=2,
    ),
    MachineItem(
        place=SPINDLE, id="cutforce", type="LINEAR_FORCE", units="NEWTON",
        source="cutting_force", digits=2,
    ),
    MachineItem(
        place=SPINDLE, id="ctemp", type="TEMPERATURE", units="CELSIUS",
    ),
    MachineItem(
        place=SPINDLE, id="cmode", type="ROTARY_MODE", category="EVENT", constant="SPINDLE",
    ),
    MachineItem(
        place=SPINDLE, id="cdir", type="DIRECTION", category="EVENT", sub_type="ROTARY",
        source="rotation", words=TURNS,
    ),
    MachineItem(place=SPINDLE, id="cload_cond", type="LOAD", category="CONDITION"),
    MachineItem(place=CONTROLLER, id="estop", type="EMERGENCY_STOP", category="EVENT"),
    MachineItem(
        place=CONTROLLER, id="run_time", type="ACCUMULATED_TIME", units="SECOND",
        source="time", digits=3,
    ),
    MachineItem(
        place=CONTROLLER, id="basewatt", type="WATTAGE", sub_type="ACTUAL", units="WATT",
        source="base_power", digits=3, mill="electric_wattage_sample", lathe="load_wattage",
    ),
    MachineItem(place=CONTROLLER, id="system", type="SYSTEM", category="CONDITION"),
    MachineItem(place=CONTROLLER, id="logic", type="LOGIC_PROGRAM", category="CONDITION"),
    MachineItem(
        place=PATH, id="exec", type="EXECUTION", category="EVENT", source="execution",
        words=EXECUTIONS,
    ),
    MachineItem(place=PATH, id="mode", type="CONTROLLER_MODE", category="EVENT"),
    MachineItem(place=PATH, id="program", type="PROGRAM", category="EVENT"),
    MachineItem(place=PATH, id="block", type="BLOCK", category="EVENT"),
    MachineItem(
        place=PATH, id="line", type="LINE", category="EVENT", source="line", until="1.4",
    ),
    MachineItem(
        place=PATH, id="line", type="LINE_NUMBER", category="EVENT", sub_type="ABSOLUTE",
        source="line", since="1.4",
    ),
    MachineItem(place=PATH, id="tool", type="TOOL_NUMBER", category="EVENT", source="tool"),
    MachineItem(
        place=PATH, id="tool_asset", type="TOOL_ASSET_ID", category="EVENT", source="tool",
    ),
    MachineItem(place=PATH, id="parts", type="PART_COUNT", category="EVENT"),
    MachineItem(place=PATH, id="part", type="PART_ID", category="EVENT", until="2.0"),
    MachineItem(place=PATH, id="part", type="PART_UNIQUE_ID", category="EVENT", since="2.0"),
    MachineItem(
        place=PATH, id="batch", type="PART_GROUP_ID", category="EVENT", sub_type="BATCH",
        since="2.0",
    ),
    MachineItem(
        place=PATH, id="pathmode", type="PATH_MODE", category="EVENT", constant="INDEPENDENT",
    ),
    MachineItem(
        place=PATH, id="feed", type="PATH_FEEDRATE", sub_type="ACTUAL",
        units="MILLIMETER/SECOND", source="path_speed",
    ),
    MachineItem(
        place=PATH, id="feed_prog", type="PATH_FEEDRATE", sub_type="PROGRAMMED",
        units="MILLIMETER/SECOND", source="feed_programmed", since="1.4",
    ),
    MachineItem(
        place=PATH, id="feed_over", type="PATH_FEEDRATE_OVERRIDE", category="EVENT",
        sub_type="PROGRAMMED",
    ),
    MachineItem(place=PATH, id="motion", type="MOTION_PROGRAM", category="CONDITION"),
    MachineItem(
        place=PROCESS, id="workingstep", type="PROCESS_KIND_ID", category="EVENT",
        sub_type="ISO_STEP_EXECUTABLE", source="workingstep", since="2.0",
    ),
    MachineItem(
        place=ELECTRIC, id="watt", type="WATTAGE", sub_type="ACTUAL", units="WATT",
        source="total_power", digits=3, is_sum=True,
    ),
    MachineItem(
        place=ELECTRIC, id="energy", type="ELECTRICAL_ENERGY", sub_type="ACTUAL",
        units="WATT_SECOND", source="energy", digits=1, since="1.4",
    ),
    MachineItem(
        place=COOLANT, id="coolwatt", type="WATTAGE", sub_type="ACTUAL", units="WATT",
        source="coolant_power", digits=3, mill="coolant_wattage_sample",
        lathe="coolant_wattage",
    ),
    MachineItem(
        place=COOLANT, id="coolant", type="ACTUATOR_STATE", category="EVENT",
        source="coolant", words=("INACTIVE", "ACTIVE"),
    ),
)  # fmt: skip
"""in the order of the document; items of one component stand together"""


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineModel:
    """Device model of a machine."""

    model: DeviceModel
    shown: tuple[tuple[int, MachineItem], ...]
    """number of each data item of the machine in the model"""
    left_out: tuple[str, ...]
    """types that the schema version does not know"""


def machine_model(
    machine: Machine,
    *,
    version: SchemaVersion = SchemaVersion.V2_7,
    names: NameSet = NameSet.MODERN,
    more: tuple[MachineItem, ...] = (),
    left_out: Collection[str] = (),
) -> MachineModel:
    """Device model of a machine.

    Parameters
    ----------
    more : tuple of MachineItem
        Further data items, of components that the machine has.
    left_out : collection of str
        Short ids of data items that the device does not have.
    """
    known = [item for item in (*_items_of(machine), *more) if item.id not in left_out]
    chosen = [
        item
        for item in known
        if item.is_in(version) and not (item.is_sum and names is NameSet.PAPERS)
    ]
    root = etree.Element("Devices")
    if _key(version) >= (1, 7):
        _add_agent(root, version)
    device = etree.SubElement(
        root, "Device", id=machine.name, uuid=device_uuid(machine), name=machine.name
    )
    etree.SubElement(
        device, "Description", manufacturer="stepnc-optimiser"
    ).text = machine.title
    ids: dict[str, MachineItem] = {}
    for item in chosen:
        own = _component(device, machine, item.place, version)
        holder = own.find("DataItems")
        if holder is None:
            holder = etree.Element("DataItems")
            before = own.find("Components")
            own.insert(len(own) if before is None else own.index(before), holder)
        id = _id(item, machine, names)
        ids[id] = item
        words = {"category": item.category, "id": id, "type": item.type, "name": item.id}
        given = {"subType": item.sub_type, "units": item.units}
        words |= {key: text for key, text in given.items() if text}
        element = etree.SubElement(holder, "DataItem", words)
        if item.constant:
            constraints = etree.SubElement(element, "Constraints")
            etree.SubElement(constraints, "Value").text = item.constant
    model = model_of(root, version)
    shown = ((model.index[id], item) for id, item in ids.items())
    present = {item.id for item in chosen}
    return MachineModel(
        model=model,
        shown=tuple(sorted(shown, key=lambda each: each[0])),
        left_out=tuple(
            item.type for item in known if item.id not in present and not item.is_sum
        ),
    )


def shop_model(machines: Iterable[MachineModel]) -> DeviceModel:
    """Return one model of the devices of several machines, with one agent device.

    Parameters
    ----------
    machines : iterable of MachineModel
        Of one schema version, with different names.
    """
    root = etree.Element("Devices")
    version = ""
    for shown in machines:
        version = shown.model.version
        for device in shown.model.root:
            if device.tag != "Agent" or root.find("Agent") is None:
                root.append(deepcopy(device))
    return model_of(root, version)


def device_uuid(machine: Machine) -> str:
    """The same for the same name, on every computer."""
    return str(uuid5(NAMESPACE_DNS, f"{machine.name}.machine.stepnc-optimiser"))


def _items_of(machine: Machine) -> Iterator[MachineItem]:
    axes = {axis.name.upper() for axis in machine.axes} or set("XYZ")
    is_lathe = machine.kind is MachineKind.LATHE
    for item in ITEMS:
        axis = item.place.partition(":")[2] if item.place.startswith("Axes/Linear") else ""
        if not axis or (axis in axes and not (is_lathe and axis == "Y")):
            yield item


def _id(item: MachineItem, machine: Machine, names: NameSet) -> str:
    printed = item.lathe if machine.kind is MachineKind.LATHE else item.mill
    if names is NameSet.PAPERS and printed:
        return printed
    return f"{machine.name}_{item.id}"


def _component(
    device: etree._Element, machine: Machine, place: str, version: str
) -> etree._Element:
    """Element of a component, made where it is not there yet."""
    own = device
    for step in filter(None, place.split("/")):
        tag, _, name = step.partition(":")
        holder = own.find("Components")
        if holder is None:
            holder = etree.SubElement(own, "Components")
        words = {"name": name or tag.lower()}
        found = next(
            (each for each in holder if each.tag == tag and each.get("name") == words["name"]),
            None,
        )
        if found is None:
            short = f"{machine.name}_{tag.lower()}_{words['name'].lower()}"
            found = etree.SubElement(holder, tag, {"id": short, **words})
            if _key(version) >= (2, 0):
                _add_specifications(found, machine, tag, name)
        own = found
    return own


def _add_specifications(element: etree._Element, machine: Machine, tag: str, name: str) -> None:
    """Travel and greatest feed of an axis, greatest speed of the spindle."""
    rows: list[tuple[str, str, str, float | None, float | None]] = []
    if tag == "Linear":
        for axis in machine.axes:
            if axis.name.upper() == name:
                low, high = axis.travel
                rows.append(("travel", "POSITION", "MILLIMETER", high, low))
                feed = axis.max_feed
                rows.append(("max_feed", "AXIS_FEEDRATE", "MILLIMETER/SECOND", feed, None))
    if tag == "Rotary":
        high_speed, low_speed = machine.spindle.max_speed, machine.spindle.min_speed
        rows.append((
            "max_speed", "ROTARY_VELOCITY", "REVOLUTION/MINUTE",
            None if high_speed is None else rpm_from_rev_s(high_speed),
            None if low_speed is None else rpm_from_rev_s(low_speed),
        ))  # fmt: skip
    known = [
        (key, kind, units, [("Maximum", high), ("Minimum", low)])
        for key, kind, units, high, low in rows
        if any(end is not None and isfinite(end) for end in (high, low))
    ]
    if not known:
        return
    configuration = etree.SubElement(element, "Configuration")
    holder = etree.SubElement(configuration, "Specifications")
    for key, kind, units, ends in known:
        one = etree.SubElement(
            holder, "Specification", type=kind, units=units, name=f"{name}_{key}",
            id=f"{element.get('id')}_{key}",
        )  # fmt: skip
        for end, value in ends:
            if value is not None and isfinite(value):
                etree.SubElement(one, end).text = f"{value:.10g}"


@cache
def _agent_rows() -> tuple[tuple[str, str], ...]:
    return (
        ("agent_avail", "AVAILABILITY"),
        ("agent_device_added", "DEVICE_ADDED"),
        ("agent_device_removed", "DEVICE_REMOVED"),
        ("agent_device_changed", "DEVICE_CHANGED"),
    )


def _add_agent(root: etree._Element, version: str) -> None:
    """The device that stands for the agent itself."""
    agent = etree.SubElement(
        root, "Agent", id="agent", uuid=str(AGENT_UUID), name="Agent", mtconnectVersion=version
    )
    holder = etree.SubElement(agent, "DataItems")
    for id, kind in _agent_rows():
        etree.SubElement(holder, "DataItem", category="EVENT", id=id, type=kind)
