"""SHDR over real sockets: an agent that listens to adapters, and one that feeds another."""

import asyncio
import socket
from collections.abc import Awaitable, Callable
from contextlib import suppress
from functools import partial

import numpy as np
import pytest

from extras.agent.model import adapters
from extras.agent.model.adapters import (
    AdapterAddress,
    AdapterClock,
    AdapterIntake,
    ShdrServer,
    listen_to,
)
from extras.agent.model.agent import Agent
from extras.agent.model.documents import timestamp
from extras.agent.model.shdr import ShdrObservation
from tests.every_case import every_case
from tests.extras.agent.model.test_model import TYPES, model_from

T0 = "2026-01-02T03:04:05.6Z"


def new_agent() -> Agent:
    return Agent(model=model_from(TYPES), clock=lambda: 1_700_000_000_000_000, size=200_000)


def text_of(agent: Agent, id: str) -> object:
    return agent.buffer.state[agent.model.index[id]][0].value


def values_of(agent: Agent, id: str) -> list[object]:
    span = np.arange(agent.buffer.first, agent.buffer.next)
    items, _ = agent.buffer.take(span)
    return [agent.buffer.value(at) for at in span[items == agent.model.index[id]].tolist()]


async def until(check: Callable[[], bool], seconds: float = 20.0) -> None:
    """Wait for what others bring about."""
    async with asyncio.timeout(seconds):
        while not check():
            await asyncio.sleep(0.01)


async def adapter(
    work: Callable[[asyncio.StreamReader, asyncio.StreamWriter], Awaitable[None]],
) -> tuple[asyncio.Server, AdapterAddress]:
    async def connected(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        with suppress(asyncio.CancelledError, OSError):
            await work(reader, writer)
        writer.close()

    server = await asyncio.start_server(connected, "127.0.0.1", 0)
    host, port = server.sockets[0].getsockname()
    return server, AdapterAddress(host=host, port=port)


def test_values_of_two_adapters_meet_in_one_device() -> None:
    agent = new_agent()

    async def control(_: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(f"{T0}|feed|60\n{T0}|cond|FAULT|1||HI".encode())
        await writer.drain()
        writer.write(b"GH|hot\n")
        await asyncio.sleep(30)

    async def sensor(_: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(f"{T0}|temp|212\n".encode())
        await asyncio.sleep(30)

    async def run() -> None:
        intake = AdapterIntake(agent=agent)
        made = [await adapter(each) for each in (control, sensor)]
        tasks = [asyncio.create_task(listen_to(address, intake)) for _, address in made]
        await until(lambda: text_of(agent, "temp") is not None)
        await until(lambda: text_of(agent, "feed") is not None)
        await until(lambda: getattr(text_of(agent, "cond"), "level", "") == "FAULT")
        for task in tasks:
            task.cancel()
        for server, _ in made:
            server.close()

    asyncio.run(run())
    assert text_of(agent, "temp") == pytest.approx(100.0)
    assert text_of(agent, "feed") == pytest.approx(25.4)
    assert text_of(agent, "avail") == "AVAILABLE"


def test_a_lost_adapter_makes_its_values_unavailable_until_it_is_back(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(adapters, "AGAIN", 0.05)
    agent, calls = new_agent(), [0]

    async def work(_: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        calls[0] += 1
        writer.write(f"{T0}|temp|{calls[0]}\n".encode())
        await writer.drain()
        await until(lambda: text_of(agent, "temp") is not None)
        writer.close()

    async def run() -> None:
        server, address = await adapter(work)
        task = asyncio.create_task(listen_to(address, AdapterIntake(agent=agent)))
        await until(lambda: calls[0] >= 3)
        task.cancel()
        server.close()

    asyncio.run(run())
    seen = values_of(agent, "temp")
    assert seen[0] is seen[2] is None
    assert [seen[1], seen[3]] == pytest.approx([-17.2222, -16.6667], abs=1e-3)


def test_small_and_early_changes_are_left_out() -> None:
    agent = new_agent()

    async def work(_: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        for second, inches in ((0, 60), (3, 60.5), (4, 120), (5, 240), (9, 240)):
            writer.write(f"2026-01-02T03:04:0{second}Z|feed|{inches}\n".encode())
        writer.write(f"{T0}|msg||end\n".encode())
        await asyncio.sleep(30)

    async def run() -> None:
        server, address = await adapter(work)
        task = asyncio.create_task(listen_to(address, AdapterIntake(agent=agent)))
        await until(lambda: text_of(agent, "msg") is not None)
        task.cancel()
        server.close()

    asyncio.run(run())
    kept = values_of(agent, "feed")
    # 60.5 differs by 0.2 mm/s, less than the filter's 0.5; 240 comes after 1 s, not 2.
    assert (
        kept[1:]
        == [pytest.approx(25.4), pytest.approx(50.8), pytest.approx(101.6)][: len(kept) - 1]
    )
    assert len(kept) == 4 or kept[1:] == [pytest.approx(25.4), pytest.approx(50.8)]


def test_an_adapter_that_does_not_answer_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(adapters, "AGAIN", 0.05)
    agent, calls = new_agent(), [0]

    async def work(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        calls[0] += 1
        assert (await reader.readline()) == b"* PING\n"
        writer.write(b"* PONG 100\n")
        await asyncio.sleep(30)

    async def run() -> None:
        server, address = await adapter(work)
        task = asyncio.create_task(listen_to(address, AdapterIntake(agent=agent)))
        await until(lambda: calls[0] >= 2)
        task.cancel()
        server.close()

    asyncio.run(run())


def test_a_line_without_end_ends_the_connection(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(adapters, "AGAIN", 0.05)
    agent, calls = new_agent(), [0]

    async def work(_: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        calls[0] += 1
        writer.write(b"x" * (4 * adapters.LONGEST_LINE))
        await asyncio.sleep(30)

    async def run() -> None:
        server, address = await adapter(work)
        task = asyncio.create_task(listen_to(address, AdapterIntake(agent=agent)))
        await until(lambda: calls[0] >= 2)
        task.cancel()
        server.close()

    asyncio.run(run())


def test_one_agent_feeds_another() -> None:
    first, second = new_agent(), new_agent()

    async def run() -> None:
        listener = socket.create_server(("127.0.0.1", 0))
        host, port = listener.getsockname()
        server = await ShdrServer(first, heartbeat=200).serve(listener)
        first.tell({"avail": "AVAILABLE", "msg": "before"})
        address = AdapterAddress(host=host, port=port)
        task = asyncio.create_task(listen_to(address, AdapterIntake(agent=second)))
        await until(lambda: text_of(second, "avail") == "AVAILABLE")
        number = first.model.index["avail"]
        words = [f"word{n}" for n in range(5000)]
        first.add(np.full(5000, number), np.arange(5000), words)
        await until(lambda: text_of(second, "avail") == "word4999")
        task.cancel()
        server.close()

    asyncio.run(run())
    told = values_of(second, "avail")
    assert told[-5000:] == [f"word{n}" for n in range(5000)]


def served_samples(behind: float, count: int = 8) -> tuple[Agent, list[int], list[str]]:
    """Agent, stamps and messages of samples 0.5 s apart, by a clock that is wrong."""
    now = [1_700_000_000_000_000]
    agent = Agent(model=model_from(TYPES), clock=lambda: now[0], size=200_000)
    told: list[str] = []

    def has(number: int) -> bool:
        return len(values_of(agent, "temp")) == number

    async def work(_: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        for number in range(count):
            now[0] += 500_000
            stamp = timestamp(now[0] - int(1e6 * behind))
            writer.write(f"{stamp}|temp|{number}\n".encode())
            await writer.drain()
            await until(partial(has, number + 2))
        await asyncio.sleep(30)

    async def run() -> None:
        server, address = await adapter(work)
        intake = AdapterIntake(agent=agent, tell=told.append)
        task = asyncio.create_task(listen_to(address, intake))
        await until(partial(has, count + 1))
        task.cancel()
        server.close()

    asyncio.run(run())
    span = np.arange(agent.buffer.first, agent.buffer.next)
    items, times = agent.buffer.take(span)
    return agent, times[items == agent.model.index["temp"]].tolist()[1:], told


@every_case(
    ("behind", "said"), [(0.0, ""), (300.0, "300.0 s behind"), (-40.0, "40.0 s ahead of")]
)
def test_stamps_are_those_of_the_adapter_and_a_wrong_clock_is_told(
    behind: float, said: str
) -> None:
    agent, stamps, told = served_samples(behind)
    assert set(np.diff(stamps).tolist()) == {500_000}
    assert agent.clock() - stamps[-1] == 1e6 * behind
    assert len(told) == bool(said)
    assert all(said in each for each in told)


def test_a_clock_is_judged_by_what_is_new() -> None:
    """At first an adapter tells what holds since long, and the net may be slow."""
    clock = AdapterClock()
    second = 1_000_000
    assert clock.skew([0], 900 * second) is None
    assert clock.skew([], 901 * second) is None
    assert clock.skew([0], 902 * second) is None
    assert clock.skew([903 * second], 930 * second) is None
    assert clock.skew([931 * second], 931 * second) is None
    assert clock.skew([932 * second], 990 * second) is None
    assert clock.is_judged


def test_values_after_a_clock_was_set_back_are_taken() -> None:
    agent = new_agent()
    intake = AdapterIntake(agent=agent)
    feed = agent.model.index["feed"]
    for time, value in ((900, 10.0), (100, 20.0), (101, 30.0), (103, 40.0)):
        intake.take([ShdrObservation(feed, time * 1_000_000, value)])
    assert values_of(agent, "feed")[1:] == [10.0, 20.0, 40.0]
