"""Publication of an agent's documents to an MQTT broker, as the reference agent does it.

For each device ``MTConnect/Probe/UUID``, ``MTConnect/Current/UUID`` and
For each device ``MTConnect/Probe/UUID``, ``MTConnect/Current/UUID`` and
the JSON documents of the HTTP side. One message at a time is on its way and confirmed by the
broker, so that a slow or lost broker takes no memory: observations wait in the agent's buffer.

References
----------
.. [1] MTConnect C++ agent, README, section MQTT Sink.
.. [2] OASIS, MQTT Version 3.1.1, 2014.
"""

import asyncio
import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from paho.mqtt import client as mqtt
from paho.mqtt.enums import CallbackAPIVersion

from extras.agent.model.agent import Agent, Asset, StreamQuery
from extras.agent.model.documents import as_json, has_observations
from stepnc_model.plurals import counted

COUNT = 1000
"""observations of a message"""

KEEPALIVE = 15
"""s without a sign of the broker until it is asked for one; it has as long to answer"""

PAUSES = (1, 30)
"""s before the first and the longest wait for another attempt; each is twice the one before"""

CONNECT = 3.0
"""s for a connection to be made"""

FAREWELL = 1.0
"""s for the broker to confirm the last message"""

AT_LEAST_ONCE = 1
"""quality of service"""

_WILD = re.compile(r"[+#/\x00]")


class BrokerLost(Exception):
    """The connection to the broker was lost before a message was confirmed."""


@dataclass(kw_only=True)
class MqttPublisher:
    """Publishes one agent to one broker. Running state.

    Everything happens in the event loop of the agent; the library's thread only connects,
    sends and reports.
    """

    agent: Agent
    host: str
    port: int
    tell: Callable[[str], None]
    """takes messages for the user"""
    current_s: float = 10.0
    """s between documents of the current state"""
    sample_s: float = 0.5
    """s within which observations go into one document"""
    _next: list[int] = field(init=False)
    """by device, sequence number of the first observation that no broker has confirmed"""
    _assets: dict[str, Asset] = field(init=False, default_factory=dict)
    _confirmed: dict[int, "asyncio.Future[None]"] = field(init=False, default_factory=dict)
    _is_fault_reported: bool = field(init=False, default=False)
    _is_over: bool = field(init=False, default=False)

    def __post_init__(self) -> None:
        self._next = [self.agent.buffer.next] * len(self.agent.model.devices)

    async def run(self) -> None:
        """Publish until cancelled; a lost broker is called again."""
        self._loop = asyncio.get_running_loop()
        self._connected, self._lost = asyncio.Event(), asyncio.Event()
        self._client = self._new_client()
        self._client.connect_async(self.host, self.port, keepalive=KEEPALIVE)
        self._client.loop_start()
        try:
            while True:
                await self._connected.wait()
                with suppress(BrokerLost):
                    await self._session()
        finally:
            self._leave()

    def _new_client(self) -> mqtt.Client:
        client = mqtt.Client(CallbackAPIVersion.VERSION2)
        client.connect_timeout = CONNECT
        client.reconnect_delay_set(*PAUSES)
        client.will_set(self._availability, b"UNAVAILABLE", qos=AT_LEAST_ONCE, retain=True)
        client.on_connect = lambda *words: self._post(self._begin, words[3])
        client.on_connect_fail = lambda *_: self._post(self._end, "not reached")
        client.on_disconnect = lambda *words: self._post(self._end, str(words[3]))
        client.on_publish = lambda *words: self._post(self._confirm, words[2])
        return client

    @property
    def _availability(self) -> str:
        """Topic of whether the agent is there: below its own device, or the first one."""
        devices = self.agent.model.devices
        own = next((each for each in devices if each.is_agent), devices[0])
        return f"{_topic('Probe', own.uuid)}/Availability"

    async def _session(self) -> None:
        """Publish all that holds, then what is new, until the connection is lost."""
        agent = self.agent
        await self._publish(self._availability, b"AVAILABLE", is_kept=True)
        await self._clear_assets()
        self._assets.clear()
        for at, device in enumerate(agent.model.devices):
            await self._publish(
                _topic("Probe", device.uuid), as_json(agent.probe(at)), is_kept=True
            )
        due = self._loop.time()
        while True:
            begin = self._loop.time()
            if begin >= due:
                await self._publish_currents()
                due = begin + self.current_s
            await self._publish_assets()
            await self._publish_samples()
            end = min(begin + self.sample_s, max(due, begin))
            with suppress(TimeoutError):
                async with asyncio.timeout_at(end):
                    await self._lost.wait()
            if self._lost.is_set():
                raise BrokerLost

    async def _publish_currents(self) -> None:
        for at, device in enumerate(self.agent.model.devices):
            query = StreamQuery(chosen=self.agent.model.items_of(at))
            document = as_json(self.agent.current(query))
            await self._publish(_topic("Current", device.uuid), document, is_kept=True)

    async def _publish_assets(self) -> None:
        """Publish assets that are new or changed."""
        await self._clear_assets()
        agent = self.agent
        for id, asset in list(agent.assets.items()):
            if self._assets.get(id) is not asset:
                await self._publish(
                    self._asset_topic(asset), as_json(agent.assets_by_id([id])), is_kept=True
                )
                self._assets[id] = asset

    async def _clear_assets(self) -> None:
        """Clear the topics of assets that are gone."""
        for id in [id for id in self._assets if id not in self.agent.assets]:
            await self._publish(self._asset_topic(self._assets[id]), b"", is_kept=True)
            del self._assets[id]

    async def _publish_samples(self) -> None:
        """Publish the observations that are there by now."""
        agent, end = self.agent, self.agent.buffer.next
        for at, device in enumerate(agent.model.devices):
            chosen = agent.model.items_of(at)
            while self._next[at] < end:
                lost = agent.buffer.first - self._next[at]
                if lost > 0:
                    self._tell_fault(
                        f"{counted(lost, 'observation')} left the buffer unpublished"
                    )
                start = max(self._next[at], agent.buffer.first)
                query = StreamQuery(chosen=chosen, start=start, count=COUNT)
                document, following = agent.sample(query)
                if has_observations(document):
                    topic = _topic("Sample", device.uuid)
                    await self._publish(topic, as_json(document), is_kept=False)
                self._next[at] = following

    def _asset_topic(self, asset: Asset) -> str:
        uuid = self.agent.model.devices[asset.device].uuid
        return f"{_topic('Asset', uuid)}/{_WILD.sub('_', asset.id)}"

    async def _publish(self, topic: str, payload: bytes, *, is_kept: bool) -> None:
        """Send a message, and wait until the broker confirms it."""
        if self._lost.is_set():
            raise BrokerLost
        sent = self._client.publish(topic, payload, qos=AT_LEAST_ONCE, retain=is_kept)
        future = self._confirmed[sent.mid] = self._loop.create_future()
        try:
            await future
        finally:
            self._confirmed.pop(sent.mid, None)

    def _post(self, work: Callable[..., None], *words: Any) -> None:
        """Let the event loop do something; called in the library's thread."""
        with suppress(RuntimeError):  # the loop is closed
            self._loop.call_soon_threadsafe(work, *words)

    def _begin(self, reason: Any) -> None:
        if reason.is_failure:
            self._end(str(reason))
            return
        self._lost.clear()
        self._connected.set()
        self._is_fault_reported = False
        self.tell(f"MQTT: published to {self.host}:{self.port}, topics MTConnect/#")

    def _end(self, reason: str) -> None:
        self._connected.clear()
        self._lost.set()
        for future in self._confirmed.values():
            if not future.done():
                future.set_exception(BrokerLost())
        if not self._is_over:
            self._tell_fault(f"{reason}; tried again until it is there")

    def _confirm(self, mid: int) -> None:
        future = self._confirmed.get(mid)
        if future is not None and not future.done():
            future.set_result(None)

    def _tell_fault(self, message: str) -> None:
        """Tell the first fault since the last connection."""
        if not self._is_fault_reported:
            self.tell(f"MQTT broker {self.host}:{self.port}: {message}")
        self._is_fault_reported = True

    def _leave(self) -> None:
        """Say that the agent is gone, and end the connection."""
        self._is_over = True
        is_stuck = False
        if self._connected.is_set():
            last = self._client.publish(
                self._availability, b"UNAVAILABLE", qos=AT_LEAST_ONCE, retain=True
            )
            with suppress(RuntimeError, ValueError):  # the broker has gone just now
                last.wait_for_publish(FAREWELL)
                is_stuck = not last.is_published()
        self._client.disconnect()
        if not is_stuck:  # else its thread would wait for the broker; it ends with the process
            self._client.loop_stop()


def _topic(kind: str, uuid: str) -> str:
    """Topic of a document, without signs that have a meaning in topics."""
    return f"MTConnect/{kind}/{_WILD.sub('_', uuid)}"
