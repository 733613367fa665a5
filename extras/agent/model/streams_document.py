"""Reads documents of streams: observations of any agent, for a device model."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from lxml import etree

from extras.agent.model.buffer import ConditionValue, TimeSeriesValue, Value
from extras.agent.model.model import DeviceModel, ObservedItem
from extras.agent.model.shdr import UNAVAILABLE, read_time
from simulator.client.xml_text import read_streams_root
from simulator.errors import AgentError
from simulator.motion.segments import Ints


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StreamsDocument:
    """N observations in the order of their sequence."""

    items: Ints
    """Numbers of the data items, (N,)."""
    times: Ints
    """Timestamps, (N,), µs since 1970; none is before the one before it."""
    values: list[Value]
    unknown: tuple[str, ...]
    """Ids that the device model does not have."""


def read_streams(path: Path, model: DeviceModel) -> StreamsDocument:
    """Read the observations of devices in a document of streams.

    Raises
    ------
    AgentError
        When the file cannot be read or is not a document of streams.
    """
    found: list[tuple[int, int, int, Value]] = []
    unknown: dict[str, None] = {}
    # What an agent tells of itself is not part of a run.
    own = {
        item
        for at, device in enumerate(model.devices)
        if device.is_agent
        for item in model.items_of(at)
    }
    for element in read_streams_root(path).iter():
        if isinstance(element.tag, str) and element.get("sequence") is not None:
            id = element.get("dataItemId", "")
            item = model.index.get(id)
            if item is None:
                unknown[id] = None
            elif item not in own:
                found.append(_observation(element, item, model.items[item], path))
    found.sort(key=lambda each: each[0])
    times = np.array([time for _, time, _, _ in found], dtype=np.int64)
    return StreamsDocument(
        items=np.array([item for _, _, item, _ in found], dtype=np.int64),
        times=np.maximum.accumulate(times),
        values=[value for *_, value in found],
        unknown=tuple(unknown),
    )


def _observation(
    element: Any, item: int, of: ObservedItem, path: Path
) -> tuple[int, int, int, Value]:
    """Return sequence, time, data item and value of an observation."""
    stamp = element.get("timestamp", "")
    time = read_time(stamp, lambda: -1)
    place = f"{path}: line {element.sourceline}: {of.id}"
    if time < 0:
        raise AgentError(f"{place}: timestamp '{stamp}' is not in ISO 8601")
    try:
        return int(element.get("sequence")), time, item, _value(element, of)
    except ValueError as error:
        raise AgentError(f"{place}: {error}") from error


def _value(element: Any, of: ObservedItem) -> Value:
    text = (element.text or "").strip()
    if of.category == "CONDITION":
        return ConditionValue(
            level=etree.QName(element).localname.upper(),
            native_code=element.get("nativeCode", ""),
            native_severity=element.get("nativeSeverity", ""),
            qualifier=element.get("qualifier", ""),
            text=text,
        )
    entries = [each for each in element if isinstance(each.tag, str)]
    if of.representation == "DATA_SET" and entries:
        return {
            each.get("key", ""): None
            if each.get("removed") == "true"
            else (each.text or "").strip()
            for each in entries
        }
    if text == UNAVAILABLE:
        return None
    if of.representation == "TIME_SERIES":
        numbers = tuple(map(float, text.split()))
        return TimeSeriesValue(values=numbers, rate=float(element.get("sampleRate", 0.0)))
    if of.category == "SAMPLE" and of.representation == "VALUE" and " " not in text:
        return float(text)
    return text
