"""The MTConnect agent: requests a second beside a bare uvicorn route, and what is taken in.

SHDR lines come from an adapter in a process of its own: positions of three axes, line numbers
and conditions.
Agent and bare route are one process each and are asked in turn by the same four connections;
the route answers with the bytes of the agent's own answer. With ``--streams`` as many clients
listen to the agent meanwhile, which takes observations at 10 Hz.

``current_ratio`` is the row of ``benchmarks.promises``: observations arrive at 20 Hz.
"""

import argparse
import asyncio
import multiprocessing
import resource
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from datetime import UTC, datetime, timedelta
from multiprocessing.connection import Connection
from statistics import median
from typing import Any

import numpy as np
import uvicorn
import uvloop

from extras.agent.model.adapters import AdapterAddress, AdapterIntake, listen_to
from extras.agent.model.agent import Agent
from extras.agent.model.http import application
from extras.agent.model.machine_model import machine_model
from extras.agent.model.model import DeviceModel
from extras.agent.run import listening
from simulator.library import load_machine

CONNECTIONS = 4
PATHS = ("/probe", "/current", "/sample?count=100", "/sample?count=1000")
FILL = 1 << 17
BATCH = 5000
LINES = 200_000
ARRIVALS = 10.0
"""Hz at which observations of all items arrive while clients ask."""


def main(arguments: list[str] | None = None) -> None:
    """Print a row for each address."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=2.0)
    parser.add_argument("--streams", type=int, default=200)
    options = parser.parse_args(arguments)
    rate, memory = _ingest()
    print(f"observations taken: {rate:.3g} a second; {memory:.0f} MiB at {FILL} observations")
    lines, observations = asyncio.run(_shdr())
    print(f"SHDR lines taken: {lines:.3g} a second; {observations:.3g} observations a second")
    print(f"{'':24}{'bytes':>8}{'requests/s':>12}{'p99 ms':>8}{'bare/s':>9}{'ratio':>7}")
    with _process(_agent) as ours:
        for streams in (0, options.streams):
            asyncio.run(_rows(ours, streams, options.seconds))


def current_ratio(arrivals: float = 20.0, rounds: int = 7, seconds: float = 1.0) -> float:
    """Requests a second of ``/current`` over those of a bare route, while observations arrive.

    Both are asked in turn, and the median of the rounds is taken: others use the machine too.
    """
    return asyncio.run(_current_ratio(arrivals, rounds, seconds))


async def _current_ratio(arrivals: float, rounds: int, seconds: float) -> float:
    found: list[float] = []
    with ExitStack() as servers:
        ours = servers.enter_context(_process(_agent, arrivals))
        peer = servers.enter_context(_process(_bare, await _once(ours, "/current")))
        for _ in range(rounds):
            rate, _ = await _load(ours, "/current", seconds)
            bare, _ = await _load(peer, "/", seconds)
            found.append(rate / bare)
    return median(found)


async def _rows(port: int, streams: int, seconds: float) -> None:
    head = await _once(port, "/current")
    following = int(head.partition(b'nextSequence="')[2].partition(b'"')[0])
    listeners = [asyncio.create_task(_listen(port, following)) for _ in range(streams)]
    if streams:
        print(f"with {streams} streams:")
        await asyncio.sleep(2.0)
    for path in PATHS:
        body = await _once(port, path)
        with _process(_bare, body) as peer:
            rate, p99 = await _load(port, path, seconds)
            bare, _ = await _load(peer, "/", seconds)
        print(f"{path:24}{len(body):8}{rate:12.0f}{p99:8.1f}{bare:9.0f}{rate / bare:7.2f}")
    told = [each.result() if each.done() else None for each in listeners]
    for each in listeners:
        each.cancel()
    if streams:
        print(f"streams that ended early: {sum(each is not None for each in told)}")


def _ingest() -> tuple[float, float]:
    """Observations a second, and what the buffer takes in MiB when it is full and written."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    agent = Agent(model=_model(), clock=lambda: time.time_ns() // 1000)
    begin = time.perf_counter()
    count = _fill(agent, 1_000_000)
    rate = count / (time.perf_counter() - begin)
    for start in range(agent.buffer.first, agent.buffer.next):
        agent.buffer.rendered(start, agent.writer.observation)
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return rate, (after - before) / 1024.0


async def _shdr() -> tuple[float, float]:
    """Lines, and observations in them, a second through a connection on loopback."""
    agent = Agent(model=_model(), clock=lambda: time.time_ns() // 1000, size=1 << 20)
    last = agent.model.index["vmc15_block"]
    with _process(_adapter) as port:
        address = AdapterAddress(host="127.0.0.1", port=port)
        begin, before = time.perf_counter(), agent.buffer.next
        task = asyncio.create_task(listen_to(address, AdapterIntake(agent=agent)))
        while not _is_told(agent, last):
            await asyncio.sleep(0.001)
        seconds = time.perf_counter() - begin
        task.cancel()
    return LINES / seconds, (agent.buffer.next - before) / seconds


def _is_told(agent: Agent, item: int) -> bool:
    return agent.buffer.state[item][0].value == "end"


def _adapter(pipe: Connection) -> None:
    listener = listening("127.0.0.1", 0)
    text = "".join(f"{line}\n" for line in _lines()).encode()
    pipe.send(listener.getsockname()[1])
    connection, _ = listener.accept()
    with connection, suppress(OSError):
        connection.sendall(text)
        while connection.recv(1000):
            pass


def _lines() -> Iterator[str]:
    begin = datetime.now(UTC)
    for at in range(LINES - 1):
        stamp = f"{begin + timedelta(microseconds=100 * at):%Y-%m-%dT%H:%M:%S.%fZ}"
        if at % 20 == 19:
            level = "NORMAL||||" if at % 40 == 19 else "WARNING|7||HIGH|hot"
            yield f"{stamp}|cload_cond|{level}"
        elif at % 3 == 2:
            yield f"{stamp}|line|{at}"
        else:
            yield f"{stamp}|xpos|{0.001 * at:.4f}|ypos|{-0.002 * at:.4f}|zpos|{0.01 * at:.3f}"
    yield f"{stamp}|block|end"


def _fill(agent: Agent, count: int) -> int:
    numbers = np.flatnonzero([item.category == "SAMPLE" for item in agent.model.items])
    values = np.random.default_rng(1).normal(0.0, 100.0, BATCH).round(4).tolist()
    for begin in range(0, count, BATCH):
        items = numbers[np.arange(begin, begin + BATCH) % len(numbers)]
        agent.add(items, agent.clock() + np.arange(BATCH), values)
    return count


def _model() -> DeviceModel:
    return machine_model(load_machine("vmc15")).model


def _agent(pipe: Connection, arrivals: float = ARRIVALS) -> None:
    agent = Agent(model=_model(), clock=lambda: time.time_ns() // 1000)
    _fill(agent, FILL)

    async def feed() -> None:
        numbers = np.flatnonzero([item.category == "SAMPLE" for item in agent.model.items])
        value = 0.0
        while True:
            value += 1.0
            stamps = np.full(len(numbers), agent.clock())
            agent.add(numbers, stamps, [value] * len(numbers))
            await asyncio.sleep(1.0 / arrivals)

    _run(_serve(application(agent), pipe, feed()))


def _bare(pipe: Connection, body: bytes) -> None:
    head = [(b"content-type", b"text/xml"), (b"content-length", str(len(body)).encode())]

    async def route(_scope: Any, _receive: Any, send: Any) -> None:
        await send({"type": "http.response.start", "status": 200, "headers": head})
        await send({"type": "http.response.body", "body": body})

    _run(_serve(route, pipe, None))


def _run(work: Any) -> None:
    with asyncio.Runner(loop_factory=uvloop.new_event_loop) as runner:
        runner.run(work)


async def _serve(app: Any, pipe: Connection, work: Any) -> None:
    listener = listening("127.0.0.1", 0)
    pipe.send(listener.getsockname()[1])
    task = None if work is None else asyncio.create_task(work)
    config = uvicorn.Config(
        app, log_config=None, access_log=False, lifespan="off", ws="none",
        timeout_graceful_shutdown=1,
    )  # fmt: skip
    await uvicorn.Server(config).serve(sockets=[listener])
    if task is not None:
        task.cancel()


@contextmanager
def _process(target: Any, *arguments: Any) -> Iterator[int]:
    """Port of a server in a process of its own."""
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=target, args=(theirs, *arguments), daemon=True)
    process.start()
    try:
        port: int = ours.recv()
        yield port
    finally:
        process.terminate()
        process.join()


async def _once(port: int, path: str) -> bytes:
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    body = await _ask(reader, writer, path)
    writer.close()
    return body


async def _load(port: int, path: str, seconds: float) -> tuple[float, float]:
    """Requests a second of all connections, and the 99th percentile of their times in ms."""
    times: list[float] = []

    async def work() -> None:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        end = time.perf_counter() + seconds
        while (begin := time.perf_counter()) < end:
            await _ask(reader, writer, path)
            times.append(time.perf_counter() - begin)
        writer.close()

    await asyncio.gather(*(work() for _ in range(CONNECTIONS)))
    return len(times) / seconds, 1000.0 * float(np.quantile(times, 0.99))


async def _ask(reader: asyncio.StreamReader, writer: asyncio.StreamWriter, path: str) -> bytes:
    writer.write(f"GET {path} HTTP/1.1\r\nHost: x\r\n\r\n".encode())
    head = await reader.readuntil(b"\r\n\r\n")
    length = int(head.lower().partition(b"content-length:")[2].partition(b"\r\n")[0])
    return await reader.readexactly(length)


async def _listen(port: int, following: int) -> None:
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    path = f"/sample?interval=100&count=1000&from={following}"
    writer.write(f"GET {path} HTTP/1.1\r\nHost: x\r\n\r\n".encode())
    while await reader.read(1 << 16):
        pass
    writer.close()


if __name__ == "__main__":
    main()
