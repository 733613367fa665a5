"""An agent that publishes to a real broker, and to ones that are lost, silent or refuse."""

import asyncio
import json
import shutil
import socket
import subprocess
import sys
import threading
import time
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from paho.mqtt import client as mqtt
from paho.mqtt.enums import CallbackAPIVersion

from extras.agent.model import mqtt as publishing
from extras.agent.model.agent import Agent, Asset, StreamQuery
from extras.agent.model.documents import as_json
from extras.agent.model.mqtt import MqttPublisher
from extras.agent.requests import AgentRequest
from extras.agent.run import AgentFiles, serve_agent
from service.simulation.run import RunFiles
from stepnc_model.errors import StepNcError
from tests.extras.agent.model.conftest import BEGIN, mill
from tests.service.waiting import ended

MODEL = mill("2.7")
OWN, UUID = (each.uuid for each in MODEL.devices)
PROGRAM = shutil.which("mosquitto") or shutil.which(
    "mosquitto", path="/usr/sbin:/usr/local/sbin"
)


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return int(listener.getsockname()[1])


@contextmanager
def broker(port: int, folder: Path) -> Iterator[None]:
    """Mosquitto on loopback."""
    if PROGRAM is None:
        pytest.skip("the MQTT broker mosquitto is not installed (apt-get install mosquitto)")
    with (folder / "mosquitto.log").open("ab") as log:
        process = subprocess.Popen([PROGRAM, "-p", str(port)], stdout=log, stderr=log)
        try:
            until(lambda: process.poll() is not None or is_open(port))
            assert process.poll() is None, (folder / "mosquitto.log").read_text("utf-8")
            yield
        finally:
            process.kill()
            ended(process)


def is_open(port: int) -> bool:
    with suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=1.0):
        return True
    return False


def until(check: Callable[[], bool], seconds: float = 20.0) -> None:
    end = time.monotonic() + seconds
    while not check():
        assert time.monotonic() < end, "not in time"
        time.sleep(0.01)


async def becomes(check: Callable[[], bool], seconds: float = 30.0) -> None:
    async with asyncio.timeout(seconds):
        while not check():
            await asyncio.sleep(0.01)


class Reader:
    """A client that subscribes to all topics."""

    def __init__(self, port: int) -> None:
        self.seen: list[tuple[str, bytes, bool]] = []
        self._client = mqtt.Client(CallbackAPIVersion.VERSION2)
        self._client.on_connect = lambda client, *_: client.subscribe("MTConnect/#", qos=1)
        self._client.on_message = lambda _, __, message: self.seen.append((
            message.topic, bytes(message.payload), message.retain
        ))  # fmt: skip
        self._client.reconnect_delay_set(1, 1)
        self._client.connect("127.0.0.1", port)
        self._client.loop_start()

    def __enter__(self) -> "Reader":
        return self

    def __exit__(self, *_: object) -> None:
        self._client.disconnect()
        self._client.loop_stop()

    def of(self, topic: str) -> list[Any]:
        """Documents of a topic."""
        return [json.loads(text) for name, text, _ in list(self.seen) if name == topic]

    def words(self, topic: str) -> list[bytes]:
        return [text for name, text, _ in list(self.seen) if name == topic]


def new_agent(**words: Any) -> Agent:
    return Agent(model=MODEL, clock=lambda: BEGIN, **words)


def add(agent: Agent, values: list[float]) -> None:
    number = agent.model.index["vmc15_xpos"]
    agent.add(np.full(len(values), number), BEGIN + np.arange(len(values)), values)


def asset(id: str, *, is_removed: bool = False) -> Asset:
    text = f'<File assetId="{id}" name="O1"/>'
    return Asset(id=id, type="File", text=text, device=1, is_removed=is_removed)


@asynccontextmanager
async def published(
    agent: Agent, port: int, told: list[str], **words: float
) -> AsyncIterator[MqttPublisher]:
    publisher = MqttPublisher(
        agent=agent, host="127.0.0.1", port=port, tell=told.append, **words
    )
    task = asyncio.create_task(publisher.run())
    try:
        yield publisher
    finally:
        task.cancel()
        await asyncio.wait([task])
        assert task.cancelled(), task.exception()


def sequences(documents: list[Any]) -> list[int]:
    found: list[int] = []

    def walk(value: Any) -> None:
        if isinstance(value, dict):
            if "sequence" in value:
                found.append(value["sequence"])
            for each in value.values():
                walk(each)
        elif isinstance(value, list):
            for each in value:
                walk(each)

    walk(documents)
    return sorted(found)


def without_time(document: Any) -> Any:
    (inner,) = document.values()
    inner["Header"].pop("creationTime")
    return inner


def test_documents_are_those_of_the_http_side_on_the_topics_of_the_reference(
    tmp_path: Path,
) -> None:
    port, agent, told = free_port(), new_agent(), list[str]()
    agent.put(asset("F+1"))
    start = agent.buffer.next

    async def run(reader: Reader) -> None:
        async with published(agent, port, told, current_s=0.3, sample_s=0.1):
            await becomes(lambda: len(reader.of(f"MTConnect/Current/{UUID}")) >= 2)
            # More than one message of them.
            add(agent, [float(each) for each in range(2500)])
            agent.put(asset("F2"))
            agent.put(asset("F+1", is_removed=True))
            last = agent.buffer.last
            topic = f"MTConnect/Sample/{UUID}"
            await becomes(lambda: sequences(reader.of(topic))[-1:] == [last])
            await becomes(lambda: len(reader.of(f"MTConnect/Asset/{UUID}/F_1")) >= 2)
            at = len(reader.of(f"MTConnect/Current/{UUID}"))
            await becomes(lambda: len(reader.of(f"MTConnect/Current/{UUID}")) >= at + 2)

    with broker(port, tmp_path), Reader(port) as reader:
        asyncio.run(run(reader))
        availability = f"MTConnect/Probe/{OWN}/Availability"
        until(lambda: reader.words(availability)[-1:] == [b"UNAVAILABLE"])
        assert reader.words(availability)[0] == b"AVAILABLE"
        for at, uuid in enumerate((OWN, UUID)):
            (probe,) = reader.of(f"MTConnect/Probe/{uuid}")
            expected = without_time(json.loads(as_json(agent.probe(at))))
            found = without_time(probe)
            expected["Header"].pop("assetCount"), found["Header"].pop("assetCount")
            assert found == expected
        query = StreamQuery(chosen=agent.model.items_of(1))
        current = reader.of(f"MTConnect/Current/{UUID}")[-1]
        assert without_time(current) == without_time(json.loads(as_json(agent.current(query))))
        samples = reader.of(f"MTConnect/Sample/{UUID}")
        assert sequences(samples) == list(range(start, agent.buffer.next))
        assert all(len(sequences([each])) <= 1000 for each in samples)
        first, *_, last = reader.of(f"MTConnect/Asset/{UUID}/F_1")
        assert "removed" not in first["MTConnectAssets"]["Assets"]["File"][0]
        assert last["MTConnectAssets"]["Assets"]["File"][0]["removed"] == "true"
        # What is kept is told to somebody who comes later.
        with Reader(port) as late:
            until(lambda: len(late.of(f"MTConnect/Asset/{UUID}/F2")) == 1)
            until(lambda: len(late.of(f"MTConnect/Current/{OWN}")) == 1)
            until(lambda: len(late.of(f"MTConnect/Probe/{UUID}")) == 1)
            assert all(is_kept for _, _, is_kept in late.seen)
            assert late.of(f"MTConnect/Sample/{UUID}") == []
    assert told == [f"MQTT: published to 127.0.0.1:{port}, topics MTConnect/#"]


def test_an_asset_that_is_gone_is_cleared(tmp_path: Path) -> None:
    port, agent = free_port(), new_agent()
    agent.writer.asset_size = 2
    topic = f"MTConnect/Asset/{UUID}/F0"

    async def run(reader: Reader) -> None:
        async with published(agent, port, [], sample_s=0.05):
            agent.put(asset("F0"))
            await becomes(lambda: len(reader.words(topic)) == 1)
            agent.put(asset("F1"))
            agent.put(asset("F2"))
            await becomes(lambda: reader.words(topic)[1:] == [b""])

    with broker(port, tmp_path), Reader(port) as reader:
        asyncio.run(run(reader))


def test_a_broker_that_is_lost_is_told_once_and_told_what_it_missed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(publishing, "PAUSES", (1, 1))
    port, agent, told = free_port(), new_agent(), list[str]()
    start, topic = agent.buffer.next, f"MTConnect/Sample/{UUID}"

    async def run() -> list[int]:
        async with published(agent, port, told, sample_s=0.05):
            await becomes(lambda: len(told) == 1)
            with broker(port, tmp_path), Reader(port) as reader:
                await becomes(lambda: len(told) == 2)
                add(agent, [1.0, 2.0])
                await becomes(lambda: len(sequences(reader.of(topic))) == 2)
                before = sequences(reader.of(topic))
            await becomes(lambda: len(told) == 3)
            add(agent, [float(each) for each in range(3, 2003)])
            with broker(port, tmp_path), Reader(port) as reader:
                await becomes(lambda: sequences(reader.of(topic))[-1:] == [agent.buffer.last])
                return before + sequences(reader.of(topic))

    seen = asyncio.run(run())
    # At least once: the reader may come after the first message of the second broker.
    assert seen[:2] == [start, start + 1]
    assert set(seen) <= set(range(start, agent.buffer.next))
    fault = f"MQTT broker 127.0.0.1:{port}: "
    assert [each.startswith(fault) for each in told[:4]] == [True, False, True, False]
    assert told[0] == f"{fault}not reached; tried again until it is there"


@contextmanager
def silent_broker(reason: int) -> Iterator[tuple[int, list[bytes]]]:
    """A server that answers to the greeting, then reads and confirms nothing."""
    received: list[bytes] = []
    listener = socket.create_server(("127.0.0.1", 0))

    def serve() -> None:
        with suppress(OSError):
            while True:
                connection, _ = listener.accept()
                with connection:
                    connection.recv(1000)
                    connection.sendall(bytes([0x20, 2, 0, reason]))
                    while data := connection.recv(1 << 16):
                        received.append(data)

    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    try:
        yield listener.getsockname()[1], received
    finally:
        listener.shutdown(socket.SHUT_RDWR)
        listener.close()
        thread.join(120.0)


def test_a_broker_that_confirms_nothing_takes_no_memory_and_stops_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(publishing, "FAREWELL", 0.1)
    agent, told = new_agent(size=5000), list[str]()

    async def run(port: int, received: list[bytes]) -> None:
        async with published(agent, port, told, sample_s=0.01, current_s=0.01):
            await becomes(lambda: bool(received))
            for _ in range(100):
                add(agent, [float(each) for each in range(1000)])
                await asyncio.sleep(0)
            assert sum(map(len, received)) < 200

    with silent_broker(0) as (port, received):
        asyncio.run(run(port, received))
    assert agent.buffer.last > 100_000
    assert len(told) == 1


def test_observations_that_left_the_buffer_are_told(tmp_path: Path) -> None:
    port, agent, told = free_port(), new_agent(size=1000), list[str]()

    async def run(reader: Reader) -> None:
        async with published(agent, port, told, sample_s=0.05):
            add(agent, [float(each) for each in range(5000)])
            topic = f"MTConnect/Sample/{UUID}"
            await becomes(lambda: sequences(reader.of(topic))[-1:] == [agent.buffer.last])

    with broker(port, tmp_path), Reader(port) as reader:
        asyncio.run(run(reader))
    assert told[1:] == [
        f"MQTT broker 127.0.0.1:{port}: 4000 observations left the buffer unpublished"
    ]


def test_a_broker_that_refuses_is_told_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(publishing, "PAUSES", (1, 1))
    told: list[str] = []

    async def run(port: int) -> None:
        async with published(new_agent(), port, told):
            await becomes(lambda: bool(told))

    with silent_broker(5) as (port, _):
        asyncio.run(run(port))
    assert told == [
        f"MQTT broker 127.0.0.1:{port}: Not authorized; tried again until it is there"
    ]


def test_the_command_refuses_a_bad_address_and_a_missing_library(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    files = AgentFiles(run=RunFiles())
    with pytest.raises(StepNcError, match="MQTT broker 'shop': expected HOST:PORT"):
        serve_agent(AgentRequest(mqtt="shop", port=0), files)
    monkeypatch.delitem(sys.modules, "extras.agent.model.mqtt")
    monkeypatch.setitem(sys.modules, "paho.mqtt", None)
    with pytest.raises(StepNcError, match=r"pip install 'stepnc-optimiser\[mqtt\]'"):
        serve_agent(AgentRequest(mqtt="127.0.0.1:1883", port=0), files)
