"""The agent: observations of a device model, and the documents that clients ask for.

Running state; everything happens in one thread, that of the event loop which serves it.
"""

import asyncio
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from simulator.agent.buffer import (
    SIZE,
    AssetReference,
    ConditionValue,
    ObservationBuffer,
    Value,
)
from simulator.agent.documents import DocumentWriter, RequestFault, timestamp
from simulator.agent.model import DeviceModel
from simulator.agent.requests import RequestRefused, StreamQuery
from simulator.motion.segments import Ints

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
            elif item.type == "ASSET_CHANGED" and self._is_told(at, asset):
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
            sequences, following = self._found(query)
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

    def _asset_document(self, found: Sequence[Asset]) -> bytes:
        texts = [
            f'<{each.type} removed="true"{each.text[len(each.type) + 1 :]}'
            if each.is_removed
            else each.text
            for each in found
        ]
        return self.writer.assets(texts, count=len(self.assets))

    def _found(self, query: StreamQuery) -> tuple[Ints, int]:
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

    def _is_told(self, item: int, asset: Asset) -> bool:
        """Whether a data item names an asset."""
        held = self.buffer.state[item]
        value = held[0].value if held else None
        return isinstance(value, AssetReference) and value.id == asset.id

    def _at(self, key: str) -> int:
        return self.model.index.get(key, -1)

    def _begin_agent(self, device: int) -> None:
        for at in self.model.items_of(device):
            if self.model.items[at].type == "AVAILABILITY":
                self.tell({self.model.items[at].id: "AVAILABLE"}, time=self.begin)
