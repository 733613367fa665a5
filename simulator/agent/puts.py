"""Requests of clients that write: assets, and values of data items, in one device.

References
----------
.. [1] MTConnect C++ agent, README, configuration ``AllowPut``.
.. [2] ANSI/MTC1.4-2018, MTConnect Standard, Part 4, Assets.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from lxml import etree

from simulator.agent.agent import Agent, Asset
from simulator.agent.buffer import Value
from simulator.agent.documents import RequestFault, timestamp
from simulator.agent.model import parsed, without_namespaces
from simulator.agent.requests import RequestRefused
from simulator.agent.shdr import read_time, read_value
from simulator.errors import AgentError

MOST_BODY = 1 << 20
"""bytes of an asset"""

LONGEST_ID = 256
"""characters of the id of an asset"""

NOT_VALUES = frozenset({"time", "device", "format", "pretty"})
"""parameters that are no data items"""

_ID = re.compile(r"[^\s/;<>&'\"\x00-\x1f]+")


def put_asset(agent: Agent, body: bytes, *, id: str, kind: str, device: int) -> bytes:
    """Keep an asset, and return its document.

    Parameters
    ----------
    agent : Agent
    body : bytes
        The element of the asset.
    id : str
        Replaces the id in the element; empty: that of the element.
    kind : str
        Type that it must have; empty: any.
    device : int
        Index of the device that has it.

    Raises
    ------
    RequestRefused
        For XML that is not well formed or not safe, another type, or an id that cannot be.
    """
    try:
        root = without_namespaces(parsed(body, what="the asset"))
    except AgentError as error:
        raise _invalid(str(error)) from error
    if not re.fullmatch(r"[\w.-]+", root.tag):
        raise _invalid(f"'{root.tag[:200]}' is no asset of MTConnect")
    if kind and kind != root.tag:
        raise _invalid(f"the asset is a {root.tag[:200]}, not a {kind[:200]}")
    words = dict(root.attrib)
    name = id or words.get("assetId", "")
    if len(name) > LONGEST_ID or not _ID.fullmatch(name):
        raise _invalid(
            f"assetId '{name[:200]}' is empty, too long, or has signs it may not have"
        )
    is_removed = words.pop("removed", "") == "true"
    words.setdefault("timestamp", timestamp(agent.clock()))
    words.update(assetId=name, deviceUuid=agent.model.devices[device].uuid)
    root.attrib.clear()
    root.attrib.update(words)
    text = etree.tostring(root, encoding="unicode", with_tail=False)
    agent.put(Asset(id=name, type=root.tag, text=text, device=device, is_removed=is_removed))
    return agent.assets_by_id([name])


def remove_assets(agent: Agent, ids: Sequence[str]) -> bytes:
    """Mark assets as removed, and return their document.

    Raises
    ------
    RequestRefused
        When none of them is there.
    """
    for id in ids:
        asset = agent.assets.get(id)
        if asset is not None and not asset.is_removed:
            agent.put(replace(asset, is_removed=True))
    return agent.assets_by_id(ids)


def remove_all_assets(agent: Agent, *, kind: str, device: int | None) -> bytes:
    """Mark the assets of a type and a device as removed, and return their document."""
    ids = [
        each.id
        for each in agent.assets.values()
        if not each.is_removed
        and (not kind or each.type == kind)
        and (device is None or each.device == device)
    ]
    return remove_assets(agent, ids) if ids else agent.assets_of(count=0, device=device)


def put_observations(agent: Agent, values: Mapping[str, str], *, device: int) -> None:
    """Take values of data items of a device, all of them or none.

    Parameters
    ----------
    agent : Agent
    values : mapping
        Values by id or name, in the form of SHDR; ``time`` is the time of all of them.
    device : int
        Index of the device.

    Raises
    ------
    RequestRefused
        With a fault for each data item that is not there, or cannot have its value.
    """
    index, faults = agent.model.index_of(device), []
    found: dict[int, Value] = {}
    for key, text in values.items():
        number = index.get(key)
        if key in NOT_VALUES:
            continue
        if number is None:
            faults.append(_fault(f"no data item '{key[:200]}'"))
        elif agent.model.items[number].constant is not None:
            faults.append(_fault(f"'{key}' is constant in the device model"))
        else:
            try:
                found[number] = read_value(text, agent.model.items[number])
            except ValueError as error:
                faults.append(_fault(f"'{key}': {error}"))
    if not found and not faults:
        faults.append(_fault("names no data items: expected KEY=VALUE"))
    if faults:
        raise RequestRefused(400, *faults)
    times = np.full(len(found), _time(agent, values.get("time")))
    agent.add(np.array(list(found), dtype=np.int64), times, list(found.values()))


def _time(agent: Agent, text: str | None) -> int:
    """Time of a request, µs since 1970; not in the future, as stamps never go back."""
    latest = agent.stamp()
    if text is None:
        return latest
    time = read_time(text, lambda: -1)
    if time < 0:
        raise _invalid(f"time '{text[:100]}': expected ISO 8601, as 2026-01-02T03:04:05Z")
    return min(time, latest)


def _fault(message: str) -> RequestFault:
    return RequestFault(code="INVALID_REQUEST", message=message)


def _invalid(message: str) -> RequestRefused:
    return RequestRefused(400, _fault(message))
