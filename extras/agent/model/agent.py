"""The agent: observations of a device model, and the documents that clients ask for.

Running state; everything happens in one thread, that of the event loop which serves it.

Requests of MTConnect clients: their parameters, checked.

References
----------
.. [1] ANSI/MTC1.4-2018, MTConnect Standard, Part 1, Overview and Fundamentals, 8.3: HTTP.
"""

import asyncio
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from extras.agent.model.buffer import (
    SIZE,
    AssetReference,
    ConditionValue,
    ObservationBuffer,
    Value,
)
from extras.agent.model.documents import DocumentWriter, RequestFault, timestamp
from extras.agent.model.model import DeviceModel, PathFault, selected
from simulator.motion.segments import Ints

USUAL_COUNT = 100
USUAL_HEARTBEAT = 10_000
"""ms"""

LONGEST_WAIT = 2**31 - 1
"""ms, of an interval or a heartbeat"""

LEAST_HEARTBEAT = 2
"""ms"""


class RequestRefused(Exception):
    """A request with faults; each is listed in the answer."""

    def __init__(self, status: int, *faults: RequestFault) -> None:
        super().__init__(faults[0].message if faults else "")
        self.status = status
        self.faults = faults


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamQuery:
    """Parameters of ``current`` and ``sample``."""

    chosen: frozenset[int] | None
    """data items; None: all"""
    at: int | None = None
    start: int | None = None
    """``from``"""
    end: int | None = None
    """``to``"""
    count: int = USUAL_COUNT
    interval: int | None = None
    """ms; None: one document"""
    heartbeat: int = USUAL_HEARTBEAT
    """ms"""


class _Parameters:
    """Query parameters as they are read; faults are gathered."""

    def __init__(self, values: Mapping[str, str]) -> None:
        self.faults: list[RequestFault] = []
        self._values = values

    def number(self, name: str, low: int, high: int, *, message: str = "") -> int | None:
        """A whole number within bounds; None where it is absent or at fault."""
        text = self._values.get(name)
        if text is None:
            return None
        try:
            value = int(text)
        except ValueError:
            self._add("INVALID_PARAMETER_VALUE", name, text, f"'{name}' is not an integer")
            return None
        if not low <= value <= high:
            bound = f"'{name}' must be at least {low}"
            if value > high:
                bound = f"'{name}' must be at most {high}"
            self._add("OUT_OF_RANGE", name, text, message or bound, low, high)
            return None
        return value

    def refuse(self, name: str, message: str, low: int, high: int) -> None:
        """Add a fault of a number that contradicts another."""
        self._add("OUT_OF_RANGE", name, self._values.get(name, ""), message, low, high)

    def finish(self) -> None:
        """Refuse the request if anything was at fault."""
        if self.faults:
            raise RequestRefused(400, *self.faults)

    def _add(
        self,
        code: str,
        name: str,
        value: str,
        message: str,
        low: int | None = None,
        high: int | None = None,
    ) -> None:
        fault = RequestFault(
            code=code,
            message=message,
            parameter=name,
            value=value[:200],
            type="integer",
            format="int64",
            minimum=low,
            maximum=high,
        )
        self.faults.append(fault)


def current_query(
    values: Mapping[str, str],
    model: DeviceModel,
    buffer: ObservationBuffer,
    *,
    device: int | None,
) -> StreamQuery:
    """Parameters of ``current``.

    Raises
    ------
    RequestRefused
    """
    read = _Parameters(values)
    at = read.number("at", buffer.first, buffer.last)
    interval = read.number("interval", 0, LONGEST_WAIT)
    if at is not None and interval is not None:
        read.refuse("interval", "'interval' and 'at' exclude each other", 0, LONGEST_WAIT)
    chosen = _chosen(values, model, device, read)
    read.finish()
    return StreamQuery(chosen=chosen, at=at, interval=interval)


def sample_query(
    values: Mapping[str, str],
    model: DeviceModel,
    buffer: ObservationBuffer,
    *,
    device: int | None,
) -> StreamQuery:
    """Parameters of ``sample``.

    Raises
    ------
    RequestRefused
    """
    read = _Parameters(values)
    count = read.number("count", -buffer.size, buffer.size)
    start = read.number("from", buffer.first, buffer.next)
    end = read.number("to", buffer.first, buffer.last)
    interval = read.number("interval", 0, LONGEST_WAIT)
    heartbeat = read.number("heartbeat", LEAST_HEARTBEAT, LONGEST_WAIT)
    if count == 0:
        read.refuse("count", "'count' must not be 0", -buffer.size, buffer.size)
    if end is not None and end < (start or buffer.first):
        read.refuse("to", "'to' must not lie before 'from'", start or buffer.first, buffer.last)
    if count is not None and count < 0:
        if end is not None:
            read.refuse("count", "'count' must be positive beside 'to'", 1, buffer.size)
        if interval is not None:
            read.refuse("count", "'count' must be positive in a stream", 1, buffer.size)
    chosen = _chosen(values, model, device, read)
    read.finish()
    return StreamQuery(
        chosen=chosen,
        start=start,
        end=end,
        count=USUAL_COUNT if count is None else count,
        interval=interval,
        heartbeat=USUAL_HEARTBEAT if heartbeat is None else heartbeat,
    )


def _chosen(
    values: Mapping[str, str], model: DeviceModel, device: int | None, read: _Parameters
) -> frozenset[int] | None:
    """Data items of a device, a kind of device and a path; None: all."""
    chosen = None if device is None else model.items_of(device)
    wanted = values.get("deviceType")
    if wanted is not None:
        if wanted not in {"Device", "Agent"}:
            fault = RequestFault(
                code="INVALID_PARAMETER_VALUE",
                message="'deviceType' must be 'Device' or 'Agent'",
                parameter="deviceType",
                value=wanted[:200],
                type="string",
            )
            read.faults.append(fault)
        kinds = [
            model.items_of(at)
            for at, each in enumerate(model.devices)
            if each.is_agent is (wanted == "Agent")
        ]
        of_kind = frozenset[int]().union(*kinds)
        chosen = of_kind if chosen is None else chosen & of_kind
    path = values.get("path")
    if path is None:
        return chosen
    try:
        found = selected(model, path)
    except PathFault as error:
        message = f"path '{path[:200]}': {error}"
        read.faults.append(RequestFault(code="INVALID_XPATH", message=message))
        return chosen
    both = found if chosen is None else found & chosen
    if not both:
        message = f"path '{path[:200]}' finds no data items of this device"
        read.faults.append(RequestFault(code="INVALID_XPATH", message=message))
    return both


CACHED = 64
"""bodies of documents that are kept for other clients which ask for the same"""

MOST_ASSET_SIGNS = 1 << 26
"""characters of all assets together; the oldest go first"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Asset:
    """An asset as XML."""

    id: str
    type: str
    """name of its element"""
    text: str
    device: int = 0
    is_removed: bool = False


@dataclass(kw_only=True)
class Agent:
    """An agent with its buffer and assets."""

    model: DeviceModel
    clock: Callable[[], int]
    """µs since 1970"""
    sender: str = "stepnc-optimiser"
    size: int = SIZE
    has_quirk: bool = False
    begin: int | None = None
    """µs since 1970 of the first observations; None: now"""
    is_scaled: bool = False
    """stamps of what is published are not those of the clock"""
    allows_put: bool = False
    """clients may write observations and assets"""
    assets: OrderedDict[str, Asset] = field(default_factory=OrderedDict)
    """by id, the oldest first"""
    watchers: list[Callable[[Ints, Ints, Sequence[Value]], None]] = field(default_factory=list)
    """take data items, times and values of what is added, after the buffer has them"""
    buffer: ObservationBuffer = field(init=False)
    writer: DocumentWriter = field(init=False)

    def __post_init__(self) -> None:
        now = self.clock()
        begin = now if self.begin is None else self.begin
        self.buffer = ObservationBuffer(model=self.model, size=self.size, now=begin)
        self.writer = DocumentWriter(
            model=self.model,
            sender=self.sender,
            instance=now // 1_000_000,
            changed=timestamp(now),
            has_quirk=self.has_quirk,
        )
        self._bodies: OrderedDict[object, tuple[bytes, int]] = OrderedDict()
        self._arrival = asyncio.Event()
        for at, device in enumerate(self.model.devices):
            if device.is_agent:
                self._begin_agent(at)

    def add(self, items: Ints, times: Ints, values: Sequence[Value]) -> None:
        """Take observations in the order of time, and wake the streams."""
        if not len(items):
            return
        self.buffer.append(items, times, values)
        for watch in self.watchers:
            watch(items, times, values)
        self._arrival.set()
        self._arrival = asyncio.Event()

    def tell(self, values: Mapping[str, Value], *, time: int | None = None) -> None:
        """Take a value each of some data items, by id or name; unknown ones are left out."""
        known = [(at, value) for key, value in values.items() if (at := self._at(key)) >= 0]
        when = self.clock() if time is None else time
        numbers = np.array([at for at, _ in known], dtype=np.int64)
        self.add(numbers, np.full(len(known), when), [value for _, value in known])

    def stamp(self) -> int:
        """Time of what clients or the agent itself tell, µs since 1970."""
        return self.buffer.last_time if self.is_scaled else self.clock()

    def lose(self, items: Sequence[int]) -> None:
        """Make data items unavailable whose source is lost."""
        values: list[Value] = [
            ConditionValue(level="UNAVAILABLE")
            if self.model.items[at].category == "CONDITION"
            else None
            for at in items
            if self.model.items[at].constant is None
        ]
        numbers = [at for at in items if self.model.items[at].constant is None]
        self.add(np.array(numbers, dtype=np.int64), np.full(len(numbers), self.clock()), values)

    def put(self, asset: Asset) -> None:
        """Keep an asset; the oldest go when there are too many."""
        self.assets.pop(asset.id, None)
        self.assets[asset.id] = asset
        size = sum(len(each.text) for each in self.assets.values())
        while len(self.assets) > self.writer.asset_size or size > MOST_ASSET_SIGNS:
            size -= len(self.assets.popitem(last=False)[1].text)
        told: dict[str, Value] = {}
        for at in sorted(self.model.items_of(asset.device)):
            item = self.model.items[at]
            if item.type == ("ASSET_REMOVED" if asset.is_removed else "ASSET_CHANGED"):
                told[item.id] = AssetReference(id=asset.id, type=asset.type)
            elif item.type == "ASSET_CHANGED" and self._names_asset(at, asset):
                told[item.id] = None
        self.tell(told, time=self.stamp())

    def probe(self, device: int | None) -> bytes:
        """Document of devices."""
        return self.writer.devices(device, assets=len(self.assets), size=self.size)

    def current(self, query: StreamQuery) -> bytes:
        """Document of what holds, or held at a sequence number."""
        buffer = self.buffer
        # Within a buffer a past state does not change, but the present one with each arrival.
        key = ("current", query.chosen, buffer.next if query.at is None else query.at)
        kept = self._kept(key)
        if kept is None:
            state = buffer.state if query.at is None else buffer.state_at(query.at)
            kept = self._keep(key, self.writer.held(state, query.chosen), buffer.next)
        return self.writer.streams(buffer, kept[0], buffer.next)

    def sample(self, query: StreamQuery) -> tuple[bytes, int]:
        """Document of observations, and the sequence number that follows."""
        buffer = self.buffer
        key = (query.chosen, query.start, query.end, query.count, buffer.next)
        kept = self._kept(key)
        if kept is None:
            sequences, following = self._sequence_numbers(query)
            items, _ = buffer.take(sequences)
            body = self.writer.observations(
                (item, buffer.rendered(sequence, self._rendered))
                for item, sequence in zip(items.tolist(), sequences.tolist(), strict=True)
            )
            kept = self._keep(key, body, following)
        return self.writer.streams(buffer, *kept), kept[1]

    def _kept(self, key: object) -> tuple[bytes, int] | None:
        """Body and following sequence number that another client asked for."""
        if key not in self._bodies:
            return None
        self._bodies.move_to_end(key)
        return self._bodies[key]

    def _keep(self, key: object, body: bytes, following: int) -> tuple[bytes, int]:
        """Keep a body for others; the one that was not asked for longest goes."""
        self._bodies[key] = body, following
        if len(self._bodies) > CACHED:
            self._bodies.popitem(last=False)
        return body, following

    async def wait(self, after: int, seconds: float) -> bool:
        """Wait for an observation that a client has not seen; False: there was none in time."""
        if self.buffer.next > after:
            return True
        try:
            # Not wait_for: in Python 3.11 it loses a cancellation that comes with the arrival.
            async with asyncio.timeout(seconds):
                await self._arrival.wait()
        except TimeoutError:
            return False
        return True

    def assets_of(
        self, *, kind: str = "", count: int = 100, is_removed: bool = False, device: int | None
    ) -> bytes:
        """Document of assets, the newest first."""
        found = [
            each
            for each in reversed(self.assets.values())
            if (not kind or each.type == kind)
            and (is_removed or not each.is_removed)
            and (device is None or each.device == device)
        ]
        return self._asset_document(found[:count])

    def assets_by_id(self, ids: Sequence[str]) -> bytes:
        """Document of the assets among some ids that are there.

        Raises
        ------
        RequestRefused
            When none of them is.
        """
        found = [self.assets[id] for id in ids if id in self.assets]
        if not found:
            faults = [
                RequestFault(code="ASSET_NOT_FOUND", message=f"no asset '{id}'", value=id)
                for id in ids[:20]
            ]
            raise RequestRefused(404, *faults)
        return self._asset_document(found)

    def _asset_document(self, assets: Sequence[Asset]) -> bytes:
        texts = [
            f'<{each.type} removed="true"{each.text[len(each.type) + 1 :]}'
            if each.is_removed
            else each.text
            for each in assets
        ]
        return self.writer.assets(texts, count=len(self.assets))

    def _sequence_numbers(self, query: StreamQuery) -> tuple[Ints, int]:
        """Sequence numbers of a query in ascending order, and the one that follows."""
        buffer = self.buffer
        if query.count < 0:
            last = buffer.last if query.start is None else min(query.start, buffer.last)
            span = np.arange(buffer.first, last + 1)
            return self._matching(span, query)[query.count :], last + 1
        start = buffer.first if query.start is None else query.start
        last = buffer.last if query.end is None else query.end
        if query.chosen is None:
            last = min(last, start + query.count - 1)
            return np.arange(start, last + 1), max(start, last + 1)
        matching = self._matching(np.arange(start, last + 1), query)
        if len(matching) < query.count:
            return matching, max(start, last + 1)
        matching = matching[: query.count]
        return matching, int(matching[-1]) + 1

    def _matching(self, span: Ints, query: StreamQuery) -> Ints:
        if query.chosen is None:
            return span
        is_chosen = np.zeros(len(self.model.items), dtype=bool)
        is_chosen[list(query.chosen)] = True
        items, _ = self.buffer.take(span)
        return span[is_chosen[items]]

    def _rendered(self, item: int, time: int, sequence: int, value: Value) -> bytes:
        return self.writer.observation(item, time, sequence, value)

    def _names_asset(self, item: int, asset: Asset) -> bool:
        """True if a data item names an asset."""
        held = self.buffer.state[item]
        value = held[0].value if held else None
        return isinstance(value, AssetReference) and value.id == asset.id

    def _at(self, key: str) -> int:
        return self.model.index.get(key, -1)

    def _begin_agent(self, device: int) -> None:
        for at in self.model.items_of(device):
            if self.model.items[at].type == "AVAILABILITY":
                self.tell({self.model.items[at].id: "AVAILABLE"}, time=self.begin)
