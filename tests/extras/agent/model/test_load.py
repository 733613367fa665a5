"""Many clients at once, and one that reads nothing."""

import asyncio
import re
import socket
from collections.abc import Callable, Coroutine
from typing import Any, TypeVar

import numpy as np
import pytest

from extras.agent.model import http
from tests.extras.agent.model.conftest import ServedAgent

Serve = Callable[..., ServedAgent]
Found = TypeVar("Found")
CLIENTS = 200
ROUNDS = 20
SEQUENCE = re.compile(rb'sequence="(\d+)"')


async def listen(port: int, start: int, last: int) -> list[int]:
    """Sequence numbers that a client is told, until the last one."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port, limit=1 << 20)
    path = f"/sample?interval=100&heartbeat=2000&count=500&from={start}"
    writer.write(f"GET {path} HTTP/1.1\r\nHost: x\r\n\r\n".encode())
    seen: list[int] = []
    rest = b""
    async with asyncio.timeout(60):
        while not seen or seen[-1] < last:
            data = await reader.read(1 << 16)
            assert data
            # Within a document observations stand by component.
            *documents, rest = (rest + data).split(b"</MTConnectStreams>")
            for each in documents:
                seen += sorted(map(int, SEQUENCE.findall(each)))
    writer.close()
    return seen


async def tasks() -> int:
    """Number of tasks of a server, one for each connection, and of this one."""
    return len(asyncio.all_tasks())


async def dropped(alone: int) -> None:
    """Wait until a server serves nobody."""
    async with asyncio.timeout(60):
        while await tasks() > alone:
            await asyncio.sleep(0.05)


def on(loop: asyncio.AbstractEventLoop, work: Coroutine[Any, Any, Found]) -> Found:
    """Result of work on the loop of a server."""
    return asyncio.run_coroutine_threadsafe(work, loop).result(90.0)


def test_two_hundred_streams_get_everything_once_and_in_order(
    serve: Serve, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(http, "PATIENCE", 1.0)
    served = serve(size=20_000)
    port = int(served.url.rpartition(":")[2])
    alone = on(served.loop, tasks())
    start = served.agent.buffer.next
    numbers = np.flatnonzero([item.category == "SAMPLE" for item in served.agent.model.items])
    # What is sent to a client that reads nothing soon fills its buffers.
    lazy = socket.socket()
    lazy.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    lazy.connect(("127.0.0.1", port))
    lazy.sendall(b"GET /current?interval=1 HTTP/1.1\r\nHost: x\r\n\r\n")

    async def feed() -> None:
        for number in range(ROUNDS):
            stamps = np.full(len(numbers), served.agent.clock() + number)
            served.agent.add(numbers, stamps, [float(number)] * len(numbers))
            await asyncio.sleep(0.1)

    async def run() -> list[list[int]]:
        last = start + ROUNDS * len(numbers) - 1
        clients = [asyncio.create_task(listen(port, start, last)) for _ in range(CLIENTS)]
        fed = asyncio.run_coroutine_threadsafe(feed(), served.loop)
        found = await asyncio.gather(*clients)
        await asyncio.wrap_future(fed)
        return list(found)

    for seen in asyncio.run(run()):
        assert seen == list(range(start, start + ROUNDS * len(numbers)))
    # Not before: who reads again is served on, without end.
    on(served.loop, dropped(alone))
    lazy.settimeout(30.0)
    with lazy:
        received = 0
        while data := lazy.recv(1 << 16):  # what was on its way; then the end
            received += len(data)
    assert received > 0
