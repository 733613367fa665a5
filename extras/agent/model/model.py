"""Device models of MTConnect: what may be observed, and where it belongs.

A model is a ``Devices`` element without namespaces, as XPath expressions of clients are written
without prefixes. Data items are numbered in document order; observations refer to the number.

Choice of data items by an XPath expression of a client, within bounds.

References
----------
.. [1] ANSI/MTC1.4-2018, MTConnect Standard, Part 2, Device Information Model.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

from lxml import etree

from simulator.client.xml_text import (
    MOST_BYTES,
    content_of,
    parsed,
    without_namespaces,
)
from simulator.errors import AgentError

SPECIAL_NAMES = {"MTCONNECT_VERSION": "MTConnectVersion", "PH": "PH"}
"""types whose element is not their words with capitals"""

FACTORS = {
    ("INCH", "MILLIMETER"): 25.4,
    ("INCH/SECOND", "MILLIMETER/SECOND"): 25.4,
    ("INCH/MINUTE", "MILLIMETER/SECOND"): 25.4 / 60.0,
    ("FOOT/MINUTE", "MILLIMETER/SECOND"): 304.8 / 60.0,
    ("MILLIMETER/MINUTE", "MILLIMETER/SECOND"): 1.0 / 60.0,
    ("METER/SECOND", "MILLIMETER/SECOND"): 1000.0,
    ("CENTIMETER/MINUTE", "MILLIMETER/SECOND"): 10.0 / 60.0,
    ("INCH_3D", "MILLIMETER_3D"): 25.4,
    ("KILOWATT", "WATT"): 1000.0,
    ("HORSEPOWER", "WATT"): 745.699872,
    ("KILOWATT_HOUR", "WATT_SECOND"): 3.6e6,
    ("WATT_HOUR", "WATT_SECOND"): 3600.0,
    ("POUND", "KILOGRAM"): 0.45359237,
    ("POUND_FORCE", "NEWTON"): 4.4482216152605,
    ("MINUTE", "SECOND"): 60.0,
    ("HOUR", "SECOND"): 3600.0,
    ("MILLISECOND", "SECOND"): 0.001,
    ("REVOLUTION/SECOND", "REVOLUTION/MINUTE"): 60.0,
    ("RADIAN", "DEGREE"): 57.29577951308232,
    ("RADIAN/SECOND", "DEGREE/SECOND"): 57.29577951308232,
    ("RADIAN/MINUTE", "DEGREE/SECOND"): 57.29577951308232 / 60.0,
    ("DEGREE/MINUTE", "DEGREE/SECOND"): 1.0 / 60.0,
    ("PSI", "PASCAL"): 6894.757293168,
    ("BAR", "PASCAL"): 1e5,
    ("GALLON/MINUTE", "LITER/SECOND"): 3.785411784 / 60.0,
}
"""units per native unit"""

FAHRENHEIT = ("FAHRENHEIT", "CELSIUS")


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamDevice:
    """A device as documents of streams name it."""

    name: str
    uuid: str
    is_agent: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamComponent:
    """A component that has data items."""

    device: int
    tag: str
    id: str
    name: str
    native_name: str = ""
    uuid: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class ObservedItem:
    """A data item."""

    id: str
    name: str
    category: str
    type: str
    sub_type: str = ""
    representation: str = "VALUE"
    component: int
    """index of its component in the model"""
    scale: float = 1.0
    """units per native unit"""
    offset: float = 0.0
    """units at zero of the native unit"""
    constant: str | None = None
    """value of an item that is constrained to one"""
    period: float = 0.0
    """least time between observations, s; 0: no filter"""
    minimum_delta: float = 0.0
    """least change of the value; 0: no filter"""
    sample_rate: str = ""
    composition: str = ""
    is_discrete: bool = False
    """equal values in a row are observations of their own"""

    @property
    def element(self) -> str:
        """Name of the element of an observation."""
        name = SPECIAL_NAMES.get(self.type) or "".join(
            word.capitalize() for word in self.type.split(":")[-1].split("_")
        )
        suffix = {"TIME_SERIES": "TimeSeries", "DATA_SET": "DataSet", "TABLE": "Table"}
        return name + suffix.get(self.representation, "")


@dataclass(frozen=True, kw_only=True)
class DeviceModel:
    """Devices with their components and data items."""

    version: str
    root: Any
    """``Devices`` element without namespaces"""
    devices: tuple[StreamDevice, ...]
    components: tuple[StreamComponent, ...]
    items: tuple[ObservedItem, ...]

    @cached_property
    def index(self) -> dict[str, int]:
        """Numbers of data items by id, and by name where that is unique."""
        found: dict[str, int] = {}
        names = [item.name for item in self.items]
        for number, item in enumerate(self.items):
            if item.name and names.count(item.name) == 1:
                found[item.name] = number
        found.update({item.id: number for number, item in enumerate(self.items)})
        return found

    def index_of(self, device: int) -> dict[str, int]:
        """Numbers of the data items of a device by id or name."""
        return self._indices[device]

    @cached_property
    def _indices(self) -> tuple[dict[str, int], ...]:
        found: tuple[dict[str, int], ...] = tuple({} for _ in self.devices)
        for number, item in enumerate(self.items):
            own = found[self.components[item.component].device]
            own.setdefault(item.id, number)
            if item.name:
                own.setdefault(item.name, number)
        return found

    def device_of(self, name: str) -> int | None:
        """Index of a device by its name or uuid."""
        for number, device in enumerate(self.devices):
            if name in {device.name, device.uuid}:
                return number
        return None

    def items_of(self, device: int) -> frozenset[int]:
        """Numbers of the data items of a device."""
        return frozenset(
            number
            for number, item in enumerate(self.items)
            if self.components[item.component].device == device
        )


def model_of(root: Any, version: str) -> DeviceModel:
    """Model of a ``Devices`` element without namespaces.

    Raises
    ------
    AgentError
        For ids that are missing or not unique.
    """
    devices: list[StreamDevice] = []
    components: list[StreamComponent] = []
    items: list[ObservedItem] = []
    ids: set[str] = set()
    for device in root:
        if not isinstance(device.tag, str):
            continue
        name, uuid = device.get("name", ""), device.get("uuid", "")
        is_agent = device.tag == "Agent"
        devices.append(StreamDevice(name=name, uuid=uuid, is_agent=is_agent))
        for owner in _owners(device):
            own = owner.find("DataItems")
            if own is None:
                continue
            components.append(
                StreamComponent(
                    device=len(devices) - 1,
                    tag=owner.tag,
                    id=owner.get("id", ""),
                    name=owner.get("name", ""),
                    native_name=owner.get("nativeName", ""),
                    uuid=owner.get("uuid", "") if owner is not device else "",
                )
            )
            for each in own.iterfind("DataItem"):
                item = _item(each, component=len(components) - 1)
                if not item.id or item.id in ids:
                    fault = f"data item id '{item.id}': missing or not unique"
                    raise AgentError(fault)
                ids.add(item.id)
                items.append(item)
    return DeviceModel(
        version=version,
        root=root,
        devices=tuple(devices),
        components=tuple(components),
        items=tuple(items),
    )


def read_model(path: Path) -> DeviceModel:
    """Device model of an XML file, in the schema version of its namespace.

    Raises
    ------
    AgentError
        When the file cannot be read or is no document of devices.
    """
    root = parsed(content_of(path, most=MOST_BYTES), what=str(path))
    found = re.fullmatch(r"\{urn:mtconnect\.org:MTConnectDevices:(\d+\.\d+)\}.*", root.tag)
    if found is None:
        raise AgentError(f"{path}: root element {root.tag}; expected MTConnectDevices")
    plain = without_namespaces(root)
    devices = plain.find("Devices")
    if devices is None or not len(devices):
        raise AgentError(f"{path}: no Devices element")
    return model_of(devices, found[1])


def devices_text(model: DeviceModel) -> str:
    """Return the ``Devices`` element of a model as text."""
    return etree.tostring(model.root, encoding="unicode")


def _owners(device: Any) -> Iterator[Any]:
    """The device and its components, in document order."""
    yield device
    for components in device.iterfind("Components"):
        for each in components:
            if isinstance(each.tag, str):
                yield from _owners(each)


def _item(element: Any, *, component: int) -> ObservedItem:
    units, native = element.get("units", ""), element.get("nativeUnits", "")
    scale, offset = FACTORS.get((native, units), 1.0), 0.0
    if (native, units) == FAHRENHEIT:
        scale, offset = 5.0 / 9.0, -160.0 / 9.0
    native_scale = _number(element.get("nativeScale"))
    if native_scale:
        scale /= native_scale
    values = element.findall("Constraints/Value")
    period = minimum = 0.0
    for each in (*element.findall("Filters/Filter"), *element.findall("Constraints/Filter")):
        if each.get("type", "MINIMUM_DELTA") == "PERIOD":
            period = _number(each.text)
        else:
            minimum = _number(each.text)
    return ObservedItem(
        id=element.get("id", ""),
        name=element.get("name", ""),
        category=element.get("category", ""),
        type=element.get("type", ""),
        sub_type=element.get("subType", ""),
        representation=element.get("representation", "VALUE"),
        component=component,
        scale=scale,
        offset=offset,
        constant=(values[0].text or "").strip() if len(values) == 1 else None,
        period=period,
        minimum_delta=minimum,
        sample_rate=element.get("sampleRate", ""),
        composition=element.get("compositionId", ""),
        is_discrete=element.get("discrete") == "true",
    )


def _number(text: str | None) -> float:
    try:
        return float(text or 0.0)
    except ValueError:
        return 0.0


LONGEST = 1024
"""characters of an expression"""

MOST_STEPS = 8
"""descendant steps, whose cost multiplies"""

FUNCTIONS = frozenset(["contains", "starts-with", "not", "name", "local-name", "text", "node"])
"""functions that an expression may call: none that goes through the document"""

_CALL = re.compile(r"([\w-]+)\s*\(")
_TEXT = re.compile(r"'[^']*'|\"[^\"]*\"")


class PathFault(ValueError):
    """An expression that is not valid, too costly, or finds nothing."""


@lru_cache(maxsize=256)
def selected(model: DeviceModel, path: str) -> frozenset[int]:
    """Numbers of the data items that an expression finds, with those of components below.

    Raises
    ------
    PathFault
        For an expression that is not valid, costs too much, or finds nothing.
    """
    bare = _TEXT.sub("''", path)
    if len(path) > LONGEST:
        raise PathFault(f"longer than {LONGEST} characters")
    if bare.count("//") + bare.count("descendant") + bare.count("*") > MOST_STEPS:
        raise PathFault(f"more than {MOST_STEPS} descendant steps or wildcards")
    inside = re.findall(r"\[([^\]]*)", bare)
    if any("//" in each or "descendant" in each or "::" in each for each in inside):
        raise PathFault("descendant steps or axes in a condition")
    for name in _CALL.findall(bare):
        if name not in FUNCTIONS and name not in {"or", "and"}:
            raise PathFault(f"function {name}() is not supported")
    try:
        found = model.root.xpath(path)
    except (etree.XPathError, ValueError) as error:
        raise PathFault(f"is not valid: {error}") from error
    if not isinstance(found, list):
        raise PathFault("finds no elements")
    ids: set[str] = set()
    for element in found:
        if not isinstance(getattr(element, "tag", None), str):
            raise PathFault("finds no elements")
        ids.update(each.get("id", "") for each in element.iter("DataItem"))
    numbers = frozenset(at for at, item in enumerate(model.items) if item.id in ids)
    if not numbers:
        raise PathFault("finds no data items")
    return numbers
