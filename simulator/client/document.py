"""Observations of a document of MTConnect streams in a file, without its device model.

A document names component, type and sub type of each data item, which is enough to name its
column.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lxml import etree

from simulator.agent.model import read_streams_root
from simulator.client.columns import Cell, RowMaker, column_name, columns_of
from simulator.client.connection import ClientItem, ClientObservation, observation_of
from simulator.errors import AgentError


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
