"""The client against our agent over HTTP, and against servers that do as they should not."""

import http.server
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import islice

import pytest

from extras.agent.model.agent import Agent
from simulator.client.connection import AgentClient, StreamPart
from simulator.errors import AgentError
from tests.every_case import every_case
from tests.extras.agent.model.conftest import BEGIN, ServedAgent

Serve = Callable[..., ServedAgent]


def no_wait(_: float) -> None:
    """Try again at once."""


def values(parts: list[StreamPart], id: str) -> list[str | None]:
    return [each.value for part in parts for each in part.observations if each.id == id]


def until(parts: Iterator[StreamPart], check: Callable[[StreamPart], bool]) -> list[StreamPart]:
    """Parts up to the first that satisfies a condition."""
    found: list[StreamPart] = []
    for part in islice(parts, 200):
        found.append(part)
        if check(part):
            return found
    raise AssertionError(found[-5:])


def has(id: str, value: str) -> Callable[[StreamPart], bool]:
    return lambda part: (id, value) in [(each.id, each.value) for each in part.observations]


def test_items_and_state_of_an_agent(serve: Serve) -> None:
    served = serve()
    served.add("vmc15_xpos", [1.5])
    client = AgentClient(f"{served.url}/vmc15")
    items = {item.id: item for item in client.items()}
    assert len(items) == len(served.agent.model.items) - 4
    found = items["vmc15_xpos"]
    assert (found.type, found.sub_type, found.units) == ("POSITION", "ACTUAL", "MILLIMETER")
    assert (found.component, found.component_name, found.device) == ("Linear", "X", "vmc15")
    state = {each.id: each for each in client.state()}
    assert state["vmc15_xpos"].value == "1.5"
    assert state["vmc15_xpos"].time == pytest.approx(BEGIN / 1e6)
    assert state["vmc15_ypos"].value is None
    assert state["vmc15_system"].value is None


def test_a_stream_goes_on_where_the_state_was(serve: Serve) -> None:
    served = serve()
    client = AgentClient(served.url, wait=no_wait)
    client.state()
    served.add("vmc15_xpos", [float(n) for n in range(2500)])
    parts = until(client.stream(), has("vmc15_xpos", "2499"))
    assert values(parts, "vmc15_xpos") == [f"{n}" for n in range(2500)]


def test_what_the_agent_dropped_is_reported(serve: Serve) -> None:
    served = serve(size=1000)
    client = AgentClient(served.url, wait=no_wait)
    client.state()
    served.add("vmc15_xpos", [float(n) for n in range(5000)])
    parts = until(client.stream(), has("vmc15_xpos", "4999"))
    assert sum(part.lost for part in parts) == 4000
    assert values(parts, "vmc15_xpos") == [f"{n}" for n in range(4000, 5000)]


def test_an_agent_that_begins_anew_is_told_and_read_from_its_start(serve: Serve) -> None:
    served = serve()
    client = AgentClient(served.url, wait=no_wait)
    client.state()
    stream = client.stream()
    served.add("vmc15_xpos", [1.0])
    until(stream, has("vmc15_xpos", "1"))

    def begin_anew() -> None:
        old = served.agent
        new = Agent(model=old.model, clock=lambda: BEGIN + 90_000_000)
        old.buffer, old.writer = new.buffer, new.writer

    served.do(begin_anew)
    served.add("vmc15_xpos", [7.0])
    parts = until(stream, has("vmc15_xpos", "7"))
    assert sum(part.is_restarted for part in parts) == 1


def test_a_lost_connection_is_told_and_taken_up_again(serve: Serve) -> None:
    served = serve()
    client = AgentClient(served.url, wait=no_wait)
    client.state()
    stream = client.stream()
    client._port = 9  # nobody listens there
    assert next(stream).fault
    client._port = int(served.url.rpartition(":")[2])
    served.add("vmc15_xpos", [3.0])
    until(stream, has("vmc15_xpos", "3"))


@contextmanager
def answering(body: bytes, *, status: int = 200, kind: str = "text/xml") -> Iterator[str]:
    """A server that gives one answer to everything."""

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(status)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: object) -> None:
            """Be silent."""

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


SPACE = 'xmlns="urn:mtconnect.org:MTConnectStreams:2.7"'


@every_case(
    ("body", "status", "message"),
    [
        (b"<html/>", 200, "html instead of MTConnectStreams"),
        (b"not xml", 200, "not well-formed"),
        (b"<a>" * 60 + b"</a>" * 60, 200, "nested more than"),
        (b'<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>', 200, "document type"),
        (b"<e><m>gone</m></e>", 404, "status 404: gone"),
        (f"<MTConnectStreams {SPACE}/>".encode(), 200, "without a header"),
        (f"<MTConnectStreams {SPACE}><Header/></MTConnectStreams>".encode(), 200, "faulty num"),
        (
            f'<MTConnectStreams {SPACE}><Header firstSequence="1" nextSequence="3"/><S><X '
            'sequence="1" timestamp="yesterday">1</X></S></MTConnectStreams>'.encode(),
            200,
            "faulty number or time",
        ),
        (b"<a>" + b" " * (1 << 22) + b"</a>", 200, "more than"),
    ],
)
def test_a_document_that_is_none_is_refused(body: bytes, status: int, message: str) -> None:
    with answering(body, status=status) as url, pytest.raises(AgentError, match=message):
        AgentClient(url).state()


@pytest.mark.parametrize(
    "body",
    [
        b"no parts at all",
        b"--x\r\nContent-length: 99999999999\r\n\r\n",
        b"--x\r\nContent-length: nine\r\n\r\n",
        b"--x\r\nContent-length: 50\r\n\r\nshort",
        b"x: y\r\n" * 100,
    ],
)
def test_a_stream_that_is_none_is_a_fault_and_no_end(body: bytes) -> None:
    with answering(body, kind="multipart/mixed;boundary=x") as url:
        parts = list(islice(AgentClient(url, wait=no_wait).stream(), 3))
    assert all(part.fault for part in parts)


@every_case("url", ["ftp://host", "http://", "http://host:port", "http://host:99999"])
def test_an_address_that_is_none_is_told(url: str) -> None:
    with pytest.raises(AgentError):
        AgentClient(url)
    with pytest.raises(AgentError, match=r"127\.0\.0\.1:9"):
        AgentClient("127.0.0.1:9").items()


def test_another_thread_ends_what_a_client_waits_for(serve: Serve) -> None:
    client = AgentClient(serve().url)
    client.state()
    found: list[StreamPart] = []
    thread = threading.Thread(target=lambda: found.append(next(client.stream())))
    thread.start()
    deadline = time.monotonic() + 10.0
    while thread.is_alive() and time.monotonic() < deadline:
        client.interrupt()
        thread.join(0.05)
    # In words of the place where the connection was just then.
    assert [bool(part.fault) for part in found] == [True]
    client.interrupt()


def test_the_oldest_state_is_followed_by_all_that_the_agent_keeps(serve: Serve) -> None:
    served = serve(size=1000)
    served.add("vmc15_ypos", [7.5])
    served.add("vmc15_xpos", [float(n) for n in range(5000)])
    client = AgentClient(served.url, wait=no_wait)
    state = {each.id: each.value for each in client.oldest_state()}
    assert (state["vmc15_xpos"], state["vmc15_ypos"]) == ("4000", "7.5")
    parts = until(client.stream(), has("vmc15_xpos", "4999"))
    assert values(parts, "vmc15_xpos") == [f"{n}" for n in range(4001, 5000)]


def test_what_an_agent_keeps_is_read_to_its_end(serve: Serve) -> None:
    served = serve(size=5000)
    served.add("vmc15_xpos", [float(n) for n in range(7000)])
    client = AgentClient(served.url, wait=no_wait)
    client.oldest_state()
    parts = list(client.kept())
    assert values(parts, "vmc15_xpos") == [f"{n}" for n in range(2001, 7000)]
    assert list(client.kept()) == []


def test_what_an_agent_drops_while_it_is_read_is_lost(serve: Serve) -> None:
    served = serve(size=5000)
    served.add("vmc15_xpos", [float(n) for n in range(5000)])
    client = AgentClient(served.url, wait=no_wait)
    client.rewind()
    parts = client.kept()
    first = next(parts)
    served.add("vmc15_ypos", [float(n) for n in range(3000)])
    rest = list(parts)
    assert (len(first.observations), rest[0].lost) == (1000, 2000)
    assert values(rest, "vmc15_xpos") == [f"{n}" for n in range(3000, 5000)]


def test_an_agent_that_begins_anew_while_it_is_read_is_refused(serve: Serve) -> None:
    served = serve()
    served.add("vmc15_xpos", [float(n) for n in range(5000)])
    client = AgentClient(served.url, wait=no_wait)
    client.rewind()
    parts = client.kept()
    next(parts)
    new = Agent(model=served.agent.model, clock=lambda: BEGIN + 90_000_000)
    served.do(lambda: setattr(served.agent, "writer", new.writer))
    with pytest.raises(AgentError, match="begun anew"):
        list(parts)
    client._port = 9  # nobody listens there
    with pytest.raises(AgentError, match="refused"):
        list(client.kept())
