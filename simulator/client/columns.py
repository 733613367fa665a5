"""Columns of a machine's observations, named as the virtual machine names its own.

A row stands for a moment at which a numeric observation came; other columns hold their last
value. The names are those of :mod:`simulator.machine.timeline`, so that whatever reads a
simulated run reads a recorded one; data items without such a column have one by their id.

Observations of a document of MTConnect streams in a file, without its device model.

A document names component, type and sub type of each data item, which is enough to name its
column.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from math import inf, nan
from pathlib import Path
from typing import Any

from lxml import etree

from simulator.client.connection import ClientItem, ClientObservation, observation_of
from simulator.client.xml_text import read_streams_root
from simulator.errors import AgentError

Cell = float | str | None

NAMED = {
    "x_axis_position_sample": "x_axis_position_actual",
    "y_axis_position_sample": "y_axis_position_actual",
    "z_axis_position_sample": "z_axis_position_actual",
    "x_axis_wattage_sample": "x_axis_wattage",
    "y_axis_wattage_sample": "y_axis_wattage",
    "z_axis_wattage_sample": "z_axis_wattage",
    "c_axis_wattage_sample": "c_axis_wattage",
    "coolant_wattage_sample": "coolant_wattage",
    "electric_wattage_sample": "load_wattage",
    "load_wattage": "load_wattage",
}
"""columns of data items with the ids of the papers"""

OF_AXIS = {
    ("POSITION", "ACTUAL"): "position_actual",
    ("AXIS_FEEDRATE", "ACTUAL"): "velocity_actual",
    ("WATTAGE", "ACTUAL"): "wattage",
    ("WATTAGE", ""): "wattage",
}
"""ends of the names of columns of linear axes, by type and sub type"""

BY_TYPE = {
    ("Rotary", "ROTARY_VELOCITY", "ACTUAL"): "rotary_velocity_actual",
    ("Rotary", "SPINDLE_SPEED", "ACTUAL"): "rotary_velocity_actual",
    ("Rotary", "ROTARY_VELOCITY", "PROGRAMMED"): "rotary_velocity_programmed",
    ("Rotary", "WATTAGE", "ACTUAL"): "c_axis_wattage",
    ("Rotary", "WATTAGE", ""): "c_axis_wattage",
    ("Rotary", "LINEAR_FORCE", ""): "cutting_force",
    ("Coolant", "WATTAGE", "ACTUAL"): "coolant_wattage",
    ("Controller", "WATTAGE", "ACTUAL"): "load_wattage",
    ("Electric", "WATTAGE", "ACTUAL"): "electric_wattage",
    ("Electric", "WATTAGE", ""): "electric_wattage",
    ("Path", "PATH_FEEDRATE", "ACTUAL"): "path_feedrate_actual",
    ("Path", "PATH_FEEDRATE", "PROGRAMMED"): "path_feedrate_programmed",
    ("Path", "EXECUTION", ""): "execution",
    ("Path", "PROGRAM", ""): "program",
    ("Path", "PROGRAM", "MAIN"): "program",
    ("Path", "LINE", ""): "line",
    ("Path", "LINE_NUMBER", "ABSOLUTE"): "line",
    ("Path", "LINE_NUMBER", ""): "line",
    ("Path", "TOOL_NUMBER", ""): "tool_number",
    ("Path", "WORK_OFFSET", ""): "work_offset",
    ("Path", "PATH_POSITION", "ACTUAL"): "path_position",
    ("Path", "PATH_POSITION", ""): "path_position",
    ("ProcessOccurrence", "PROCESS_KIND_ID", "ISO_STEP_EXECUTABLE"): "workingstep",
}
"""columns by component, type and sub type"""

TIME = "time_s"

LATE = 5.0
"""s that an observation may come after its moment; later the clock has been set back"""

EXECUTION = "execution"
RUNNING = frozenset({"ACTIVE", "WAIT", "FEED_HOLD", "INTERRUPTED"})
"""words of ``execution`` while a program runs; a tool change is a wait"""

WORDS = frozenset({"execution", "program", "workingstep", "work_offset"})
"""columns of texts"""

PLACES = frozenset({"path_position"})
"""values of three coordinates; each has a column whose name ends with its axis"""


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedColumn:
    """A column with the data item that fills it."""

    name: str
    id: str
    units: str
    is_text: bool
    axis: int | None = None
    """Index of the coordinate in a value of three; None: the value is the number."""


def columns_of(items: Iterable[ClientItem]) -> tuple[RecordedColumn, ...]:
    """Columns of the samples of a device model, and of the events that a run has.

    Where two data items would fill one column, the first does; the other has one by its id.
    """
    found: dict[str, RecordedColumn] = {}
    for item in items:
        name = column_name(item)
        if not name and item.category != "SAMPLE":
            continue
        if name in PLACES:
            for axis, letter in enumerate("xyz"):
                found.setdefault(
                    f"{name}_{letter}",
                    RecordedColumn(
                        name=f"{name}_{letter}",
                        id=item.id,
                        units=item.units.removesuffix("_3D"),
                        is_text=False,
                        axis=axis,
                    ),
                )
            continue
        name = name if name and name not in found else item.id
        found[name] = RecordedColumn(
            name=name, id=item.id, units=item.units, is_text=name in WORDS
        )
    return tuple(found.values())


def column_name(item: ClientItem) -> str:
    """Name of the column of a data item as the virtual machine names it; empty: none."""
    if item.id in NAMED:
        return NAMED[item.id]
    kind = item.type, item.sub_type
    axis = item.component_name[:1].lower()
    if item.component == "Linear" and axis in set("xyz"):
        end = OF_AXIS.get(kind, "")
        return f"{axis}_axis_{end}" if end else ""
    return BY_TYPE.get((item.component, *kind), "")


@dataclass(kw_only=True)
class RowMaker:
    """Makes rows of observations. Running state: the last value of each column.

    Observations of several adapters may come in another order than that of their times. Those
    that come together are put in order; one that comes late has no row of its own.
    """

    columns: tuple[RecordedColumn, ...]
    begin: float | None = None
    """time of the first row, s since 1970; None: there is none yet"""
    _held: dict[str, Cell] = field(default_factory=dict)
    _numeric: dict[str, bool] = field(default_factory=dict)
    _since: dict[str, float] = field(default_factory=dict)
    _open: float | None = None
    _latest: float = -inf

    def __post_init__(self) -> None:
        self._places = {each.id for each in self.columns if each.axis is not None}
        self._numeric = {each.id: not each.is_text for each in self.columns}

    def rows(self, observations: Iterable[ClientObservation]) -> list[Mapping[str, Cell]]:
        """Rows that are complete once these observations have come."""
        found: list[Mapping[str, Cell]] = []
        for each in sorted(observations, key=lambda observation: observation.time):
            if self._open is not None and not self._open - LATE <= each.time <= self._open:
                found.append(self._row(self._open))
                self._latest, self._open = self._open, None
            is_numeric = self._numeric.get(each.id)
            if is_numeric is None:
                continue
            if each.time < self._since.get(each.id, -inf) <= each.time + LATE:
                # Older than what is known: its moment has passed.
                continue
            self._since[each.id] = each.time
            is_whole = not is_numeric or each.id in self._places
            self._held[each.id] = each.value if is_whole else _number(each.value)
            if is_numeric and each.value is not None and not self._is_late(each.time):
                self._open = each.time
        return found

    def _is_late(self, time: float) -> bool:
        """True if a moment has passed; of a clock that is set back, it has not."""
        last = self._latest if self._open is None else self._open
        return last - LATE <= time < last

    def last(self) -> list[Mapping[str, Cell]]:
        """The row that waits for more observations of its moment."""
        if self._open is None:
            return []
        self._latest, self._open = self._open, None
        return [self._row(self._latest)]

    def held(self, name: str) -> Cell:
        """Last value of a column; None where there is none."""
        id = next((each.id for each in self.columns if each.name == name), "")
        return self._held.get(id)

    def interrupt(self) -> None:
        """Nothing is known any more of what holds."""
        self._held.clear()
        self._since.clear()

    def _row(self, time: float) -> Mapping[str, Cell]:
        if self.begin is None:
            self.begin = time
        row: dict[str, Cell] = {TIME: round(time - self.begin, 6)}
        for each in self.columns:
            held = self._held.get(each.id, None if each.is_text else nan)
            row[each.name] = held if each.axis is None else _coordinate(held, each.axis)
        return row


def _coordinate(held: Cell, axis: int) -> float:
    """One of three numbers that a text holds; NaN where it does not."""
    words = held.split() if isinstance(held, str) else []
    return _number(words[axis]) if len(words) == 3 else nan


def _number(text: str | None) -> float:
    """A number; NaN where it is none or unavailable."""
    try:
        return float(text) if text is not None else nan
    except ValueError:
        return nan


@dataclass(frozen=True, slots=True, kw_only=True)
class ReadDocument:
    """Data items and observations of a document, in the order of their sequence."""

    items: tuple[ClientItem, ...]
    observations: tuple[ClientObservation, ...]

    def rows(self) -> list[Mapping[str, Cell]]:
        """Rows of the columns that the virtual machine has, one for each moment."""
        maker = RowMaker(columns=columns_of(self.items))
        return [*maker.rows(self.observations), *maker.last()]


def read_document(path: Path) -> ReadDocument:
    """Read a document of streams of any agent.

    Raises
    ------
    AgentError
        When the file cannot be read, is no document of streams, has a faulty stamp, or tells
        of several machines.
    """
    items: dict[str, ClientItem] = {}
    found: list[ClientObservation] = []
    for element in read_streams_root(path).iter():
        if not isinstance(element.tag, str) or element.get("sequence") is None:
            continue
        try:
            found.append(observation_of(element))
        except (TypeError, ValueError) as error:
            raise AgentError(f"{path}: line {element.sourceline}: {error}") from error
        if found[-1].id not in items:
            items[found[-1].id] = _item(element)
    _require_one_machine(items.values(), path)
    found.sort(key=lambda each: each.sequence)
    return ReadDocument(items=tuple(items.values()), observations=tuple(found))


def _require_one_machine(items: Iterable[ClientItem], path: Path) -> None:
    """Refuse a document from which a run would get columns of several machines."""
    devices = dict.fromkeys(item.device for item in items if column_name(item))
    if len(devices) > 1:
        names = ", ".join(f"'{name}'" for name in devices)
        raise AgentError(
            f"{path}: tells of {len(devices)} devices, {names}: ask the agent for one of them, "
            f"as in http://HOST:PORT/{next(iter(devices))}/sample"
        )


def _item(element: Any) -> ClientItem:
    """Data item of an observation, by the elements around it."""
    stream = element.getparent().getparent()
    words = re.findall("[A-Z][a-z0-9]*", etree.QName(element).localname)
    device = next(element.iterancestors("{*}DeviceStream"), None)
    return ClientItem(
        id=element.get("dataItemId", ""),
        name=element.get("name", ""),
        category=etree.QName(element.getparent()).localname.rstrip("s").upper(),
        type="_".join(words).upper(),
        sub_type=element.get("subType", ""),
        units="",
        component=stream.get("component", ""),
        component_name=stream.get("name", ""),
        device="" if device is None else device.get("name", ""),
    )
