"""Heads and streams that never end, on a small server in this process."""

import asyncio
import logging
import socket
from collections.abc import Awaitable, Callable
from contextlib import suppress

import pytest
import uvicorn
from starlette.types import ASGIApp, Receive, Scope, Send

from service.web import http_protocol
from service.web.http_protocol import HEAD_BYTES, BoundedHttpProtocol

Talk = Callable[[asyncio.StreamReader, asyncio.StreamWriter], Awaitable[None]]

WHOLE = b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"


async def hello(scope: Scope, receive: Receive, send: Send) -> None:
    """Answers to what has a head; a body is left where it is."""
    assert scope["type"] == "http"
    headers = [(b"content-length", b"5")]
    await send({"type": "http.response.start", "status": 200, "headers": headers})
    await send({"type": "http.response.body", "body": b"hello"})


async def named(scope: Scope, receive: Receive, send: Send) -> None:
    """Answers with the Host headers and the path of a request."""
    hosts = [value for name, value in scope["headers"] if name == b"host"]
    body = b"|".join((*hosts, scope["path"].encode()))
    headers = [(b"content-length", str(len(body)).encode())]
    await send({"type": "http.response.start", "status": 200, "headers": headers})
    await send({"type": "http.response.body", "body": body})


def talked(talk: Talk, app: ASGIApp = hello) -> None:
    """A client says something to the server, and both end."""

    async def both() -> None:
        with socket.create_server(("127.0.0.1", 0)) as line:
            config = uvicorn.Config(
                app,
                http=BoundedHttpProtocol,
                ws="none",
                lifespan="off",
                log_config=None,
                workers=1,
            )
            server = uvicorn.Server(config)
            serving = asyncio.create_task(server.serve(sockets=[line]))
            reader, writer = await asyncio.open_connection(*line.getsockname())
            async with asyncio.timeout(20.0):
                await talk(reader, writer)
            writer.close()
            with suppress(ConnectionError):
                await writer.wait_closed()
            server.should_exit = True
            await serving

    asyncio.run(both())


async def greeted(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    """One request that is answered."""
    writer.write(WHOLE)
    head = await reader.readuntil(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 200")
    assert await reader.readexactly(5) == b"hello"


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(http_protocol, "HEAD_S", 0.2)


@pytest.mark.usefixtures("short")
@pytest.mark.parametrize("begun", [b"", b"\r\n", b"GET", b"GET / HTTP/1.1\r\nHost: loc"])
def test_who_begins_and_does_not_end_is_left(begun: bytes) -> None:
    async def talk(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(begun)
        assert await reader.read() == b""

    talked(talk)


@pytest.mark.usefixtures("short")
@pytest.mark.parametrize("begun", [b"\r\n", b"GET / HTTP/1.1\r\nHost: loc"])
def test_nor_is_a_later_request_waited_for_without_end(begun: bytes) -> None:
    async def talk(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await greeted(reader, writer)
        writer.write(begun)
        assert await reader.read() == b""

    talked(talk)


@pytest.mark.usefixtures("short")
def test_a_request_that_is_whole_may_wait_for_the_next() -> None:
    async def talk(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        for _ in range(3):
            await greeted(reader, writer)
            with pytest.raises(TimeoutError):
                async with asyncio.timeout(2.5 * http_protocol.HEAD_S):
                    await reader.read(1)

    talked(talk)


@pytest.mark.parametrize("before", [0, 2])
def test_a_head_without_end_is_refused(before: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(http_protocol, "HEAD_S", 1000.0)  # its size ends it, or nothing does

    async def talk(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        for _ in range(before):
            await greeted(reader, writer)
        writer.write(WHOLE[:-2])
        with suppress(ConnectionError):
            for _ in range(4_000_000 // HEAD_BYTES):
                writer.write(b"X-More: " + b"x" * HEAD_BYTES + b"\r\n")
                await writer.drain()
            said = await reader.read()
            assert said.startswith(b"HTTP/1.1 400") or not said

    talked(talk)


def test_requests_behind_one_another_are_all_answered() -> None:
    async def talk(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(WHOLE * 100)
        for _ in range(100):
            await reader.readuntil(b"\r\n\r\n")
            assert await reader.readexactly(5) == b"hello"

    talked(talk)


def test_the_rest_of_a_refused_body_is_no_head() -> None:
    async def talk(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        size = 4 * HEAD_BYTES
        writer.write(b"POST / HTTP/1.1\r\nHost: localhost\r\n")
        writer.write(b"Content-Length: %d\r\n\r\n" % size)
        await reader.readuntil(b"\r\n\r\n")
        assert await reader.readexactly(5) == b"hello"
        for _ in range(4):
            writer.write(b"x" * HEAD_BYTES)
            await writer.drain()
        await greeted(reader, writer)

    talked(talk)


@pytest.mark.parametrize("reads", [True, False])
def test_a_stream_ends_with_its_server(reads: bool, caplog: pytest.LogCaptureFixture) -> None:
    ended: list[str] = []

    async def stream(scope: Scope, receive: Receive, send: Send) -> None:
        """Much until nothing more is taken, then nothing; until the client is gone."""
        assert scope["type"] == "http"
        await receive()
        await send({"type": "http.response.start", "status": 200, "headers": []})
        body = {"type": "http.response.body", "body": b"x" * 65536, "more_body": True}
        with suppress(TimeoutError):
            async with asyncio.timeout(0.2):
                while not reads:
                    await send(body)
                    await asyncio.sleep(0.0)  # else a send after the end would not wait
        ended.append((await receive())["type"])

    async def both() -> None:
        with socket.create_server(("127.0.0.1", 0)) as line:
            config = uvicorn.Config(stream, http=BoundedHttpProtocol, ws="none", lifespan="off",
                                    log_config=None, timeout_graceful_shutdown=60)  # fmt: skip
            server = uvicorn.Server(config)
            serving = asyncio.create_task(server.serve(sockets=[line]))
            reader, writer = await asyncio.open_connection(*line.getsockname(), limit=1024)
            writer.write(WHOLE)
            await reader.readuntil(b"\r\n\r\n")
            server.should_exit = True
            async with asyncio.timeout(20.0):
                await serving
            writer.close()
            with suppress(ConnectionError):
                await writer.wait_closed()

    with caplog.at_level(logging.ERROR):
        asyncio.run(both())
    assert ended == ["http.disconnect"]
    assert not caplog.records


@pytest.mark.parametrize(
    ("head", "told"),
    [
        (b"GET /a HTTP/1.1\r\nHost: localhost", b"localhost|/a"),
        (b"GET http://evil:80/a?b HTTP/1.1\r\nHost: localhost", b"evil:80|/a"),
        (b"GET http://evil/?b=://c HTTP/1.1\r\nHost: localhost", b"evil|/"),
        (b"GET http://evil/ HTTP/1.0\r\nAccept: */*", b"evil|/"),
        (b"GET http://evil/ HTTP/1.1\r\nHost: a\r\nHost: b", b"evil|evil|/"),
        (b"GET /a://evil/ HTTP/1.1\r\nHost: localhost", b"localhost|/a://evil/"),
    ],
)
def test_an_absolute_target_names_the_host(head: bytes, told: bytes) -> None:
    async def ask(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(head + b"\r\n\r\n")
        answer = await reader.readuntil(b"\r\n\r\n")
        assert answer.startswith(b"HTTP/1.1 200")
        assert (await reader.readexactly(len(told))) == told

    talked(ask, named)
