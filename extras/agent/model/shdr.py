"""Lines of SHDR, in which adapters tell an agent what they observe.

``timestamp|key|value|key|value``; conditions, time series, data sets and messages in forms of
their own. Keys are names or ids of data items, with a device before a colon if need be.

Requests of clients that write: assets, and values of data items, in one device.

References
----------
.. [1] MTConnect C++ agent, README, section Adapter Agent Protocol Version 2.0.
.. [2] MTConnect C++ agent, README, configuration ``AllowPut``.
.. [3] ANSI/MTC1.4-2018, MTConnect Standard, Part 4, Assets.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from math import isfinite

import numpy as np
from lxml import etree

from extras.agent.model.agent import Agent, Asset, RequestRefused
from extras.agent.model.buffer import (
    CONDITIONS,
    AssetReference,
    ConditionValue,
    TimeSeriesValue,
    Value,
)
from extras.agent.model.documents import RequestFault, timestamp
from extras.agent.model.model import DeviceModel, ObservedItem
from simulator.client.xml_text import parsed, without_namespaces
from simulator.errors import AgentError
from stepnc_model.units import US_PER_SECOND

UNAVAILABLE = "UNAVAILABLE"

_ENTRY = re.compile(r"""([^\s={}'"]+)(?:=(?:'([^']*)'|"([^"]*)"|\{([^}]*)\}|(\S*)))?""")


@dataclass(frozen=True, slots=True)
class ShdrObservation:
    """A value of a data item, as a line tells it."""

    item: int
    time: int
    """µs since 1970"""
    value: Value


def read_line(line: str, model: DeviceModel, clock: Callable[[], int]) -> list[ShdrObservation]:
    """Observations of a line; what no data item is known for is left out.

    Parameters
    ----------
    line : str
        Without its end.
    clock : callable
        Time in µs since 1970, for lines without a timestamp.
    """
    fields = line.split("|")
    if len(fields) < 3:
        return []
    time = read_time(fields[0], clock)
    at = 1
    found: list[ShdrObservation] = []
    while at + 1 < len(fields):
        number = item_of(fields[at].strip(), model)
        item = None if number is None else model.items[number]
        taken, value = _value(item, fields[at + 1 :])
        if number is not None and value is not _NOTHING:
            found.append(ShdrObservation(number, time, value))  # type: ignore[arg-type]
        at += 1 + taken
    return found


def item_of(key: str, model: DeviceModel) -> int | None:
    """Number of a data item by its key; None: there is none."""
    number = model.index.get(key)
    if number is None and ":" in key:
        device, _, name = key.partition(":")
        at = model.device_of(device)
        return None if at is None else model.index_of(at).get(name)
    return number


def read_value(text: str, item: ObservedItem) -> Value:
    """Value of a data item in the form of a line: several fields with ``|`` between them.

    Raises
    ------
    ValueError
        When the data item cannot have it.
    """
    fields = text.split("|")
    taken, value = _value(item, fields)
    if value is _NOTHING or len(fields) > taken:
        raise ValueError(f"'{text[:100]}' is no value of {item.type}")
    return value  # type: ignore[return-value]


def read_time(text: str, clock: Callable[[], int]) -> int:
    """µs since 1970 of a timestamp in ISO 8601, without a zone in UTC; else the clock."""
    text = text.partition("@")[0].strip()
    try:
        moment = datetime.fromisoformat(text.replace("Z", "+00:00"))
    except ValueError:
        return clock()
    if moment.tzinfo is None:
        moment = moment.replace(tzinfo=UTC)
    elapsed = moment - datetime(1970, 1, 1, tzinfo=UTC)
    return (elapsed.days * 86400 + elapsed.seconds) * US_PER_SECOND + elapsed.microseconds


def written(model: DeviceModel, item: int, time: int, value: Value) -> Iterator[str]:
    """Lines of an observation."""
    of = model.items[item]
    key, stamp = of.id, timestamp(time)
    match value:
        case ConditionValue():
            parts = (value.level, value.native_code, value.native_severity, value.qualifier)
            fields = "|".join(_plain(each) for each in (*parts, value.text))
            yield f"{stamp}|{key}|{fields}"
        case TimeSeriesValue():
            numbers = " ".join(f"{each:.9g}" for each in value.values)
            rate = f"{value.rate:g}" if value.rate else ""
            yield f"{stamp}|{key}|{len(value.values)}|{rate}|{numbers}"
        case dict():
            entries = (
                name if text is None else f"{name}={{{_plain(str(text))}}}"
                for name, text in value.items()
            )
            yield f"{stamp}|{key}|{' '.join(entries)}"
        case AssetReference():
            yield f"{stamp}|{key}|{_plain(value.id)}"
        case None if of.category == "CONDITION":
            yield f"{stamp}|{key}|unavailable||||"
        case None:
            yield f"{stamp}|{key}|{UNAVAILABLE}"
        case str():
            yield f"{stamp}|{key}|{_plain(value)}"
        case _:
            yield f"{stamp}|{key}|{value:.10g}"


_NOTHING = object()
"""a value that cannot be read"""


def _value(item: ObservedItem | None, fields: list[str]) -> tuple[int, object]:
    """Value, with the number of fields that it takes."""
    if item is None:
        return 1, _NOTHING
    if item.category == "CONDITION":
        level, code, severity, qualifier, text = (*fields[:5], "", "", "", "", "")[:5]
        level = level.strip().upper()
        if level not in CONDITIONS:
            return 5, _NOTHING
        value = ConditionValue(
            level=level,
            native_code=code.strip(),
            native_severity=severity.strip(),
            qualifier=qualifier.strip().upper(),
            text=text.strip(),
        )
        return 5, value
    if item.representation == "TIME_SERIES":
        return 3, _series(fields)
    text = fields[0].strip()
    if item.type in {"MESSAGE", "ALARM"} and len(fields) > 1:
        return (2 if item.type == "MESSAGE" else 5), fields[-1].strip()
    if text == UNAVAILABLE:
        return 1, None
    if item.representation in {"DATA_SET", "TABLE"}:
        return 1, _entries(text)
    if item.category == "SAMPLE":
        return 1, _number(text, item)
    return 1, text


def _number(text: str, item: ObservedItem) -> object:
    """A number in the units of a data item; three of them as text."""
    try:
        numbers = [item.scale * float(each) + item.offset for each in text.split()]
    except ValueError:
        return _NOTHING
    if not numbers or not all(map(isfinite, numbers)):
        return _NOTHING
    return numbers[0] if len(numbers) == 1 else " ".join(f"{each:.10g}" for each in numbers)


def _series(fields: list[str]) -> object:
    count, rate, text = (*fields[:3], "", "", "")[:3]
    if count.strip() == UNAVAILABLE:
        return None
    try:
        values = tuple(map(float, text.split()))
        expected, frequency = int(count), float(rate or 0.0)
    except ValueError:
        return _NOTHING
    if len(values) != expected or not all(map(isfinite, (*values, frequency))):
        return _NOTHING
    return TimeSeriesValue(values=values, rate=frequency)


def _entries(text: str) -> dict[str, str | None]:
    found: dict[str, str | None] = {}
    for key, single, double, braced, bare in _ENTRY.findall(text.partition(":")[2] or text):
        value = single or double or braced or bare
        found[key] = value or None
    return found


def _plain(text: str) -> str:
    """A text without the signs that end fields and lines."""
    return text.replace("|", "/").replace("\n", " ").replace("\r", " ")


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
