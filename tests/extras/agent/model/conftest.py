"""Agents over real HTTP, in a thread of their own."""

import asyncio
import socket
import threading
from collections.abc import Callable, Coroutine, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import httpx
import numpy as np
import pytest
import uvicorn
from lxml import etree

from extras.agent.model.agent import Agent
from extras.agent.model.buffer import Value
from extras.agent.model.http import application
from extras.agent.model.machine_model import machine_model
from extras.agent.model.model import DeviceModel
from simulator.client.document_choices import SchemaVersion
from simulator.library import load_machine

T = TypeVar("T")

SCHEMAS = Path(__file__).parents[5] / "shared" / "mtconnect" / "schemas"
BEGIN = 1_760_000_000_000_000
"""µs since 1970 of the first observation"""


@cache
def schema(kind: str, version: str) -> Any:
    """Official schema; a test that needs it skips where it is not there."""
    file = SCHEMAS / f"MTConnect{kind}_{version}_1.0.xsd"
    if not file.is_file():
        pytest.skip(f"the schemas of MTConnect are not at {SCHEMAS.parent.name}/schemas")
    return etree.XMLSchema(etree.parse(str(file)))


def require_valid(document: bytes, version: str) -> Any:
    """Root of a document that the schema of its kind accepts."""
    root = etree.fromstring(document)
    kind = etree.QName(root).localname.removeprefix("MTConnect")
    found = schema(kind, version)
    assert found.validate(root), found.error_log
    return root


@dataclass
class ServedAgent:
    """An agent that is served on loopback."""

    agent: Agent
    url: str
    loop: asyncio.AbstractEventLoop

    def do(self, work: Callable[[], T]) -> T:
        """Run a function in the agent's thread."""

        async def run() -> T:
            return work()

        return self.wait(run())

    def wait(self, work: Coroutine[Any, Any, T]) -> T:
        """Run a coroutine in the agent's thread."""
        return asyncio.run_coroutine_threadsafe(work, self.loop).result(30)

    def add(self, id: str, values: Sequence[Value], *, begin: int = BEGIN) -> None:
        """Observations of a data item, 0.1 s apart."""
        number = self.agent.model.index[id]
        count = len(values)
        times = begin + 100_000 * np.arange(count)
        self.do(lambda: self.agent.add(np.full(count, number), times, values))

    def get(self, path: str, **headers: str) -> httpx.Response:
        """Answer to a request."""
        return httpx.get(self.url + path, headers=headers, timeout=120.0)

    def root(self, path: str, *, status: int = 200) -> Any:
        """Root of the document that answers a request."""
        answer = self.get(path)
        assert answer.status_code == status, answer.text[:500]
        return etree.fromstring(answer.content)


@pytest.fixture
def serve() -> Iterator[Callable[..., ServedAgent]]:
    """Serve agents until the test is over."""
    ended: list[Callable[[], None]] = []

    def begin(
        model: DeviceModel | None = None, *, size: int = 1 << 17, **words: Any
    ) -> ServedAgent:
        listener = socket.create_server(("127.0.0.1", 0))
        clock = [BEGIN]
        chosen = mill("2.7") if model is None else model
        agent = Agent(model=chosen, clock=lambda: clock[0], size=size, **words)
        config = uvicorn.Config(
            application(agent), log_config=None, access_log=False, lifespan="off", ws="none",
            timeout_graceful_shutdown=1,
        )  # fmt: skip
        server = uvicorn.Server(config)
        loop = asyncio.new_event_loop()
        thread = threading.Thread(
            target=lambda: loop.run_until_complete(server.serve(sockets=[listener]))
        )
        thread.start()

        def end() -> None:
            server.should_exit = True
            thread.join(120.0)
            loop.close()

        ended.append(end)
        host, port = listener.getsockname()
        return ServedAgent(agent=agent, url=f"http://{host}:{port}", loop=loop)

    yield begin
    for each in ended:
        each()


def mill(version: str) -> DeviceModel:
    """Device model of a mill."""
    return machine_model(load_machine("vmc15"), version=SchemaVersion(version)).model


def local(element: Any) -> str:
    """Name of an element without its namespace."""
    return str(etree.QName(element).localname)


def observations(root: Any) -> list[Any]:
    """Observations of a document of streams in the order of their sequence."""
    found = [each for each in root.iter() if each.get("sequence") is not None]
    return sorted(found, key=lambda each: int(each.get("sequence")))


def header(root: Any) -> dict[str, str]:
    """Attributes of the header."""
    return dict(next(each for each in root if local(each) == "Header").attrib)


def error_codes(root: Any) -> list[str]:
    """Codes of an error document in either form."""
    (errors,) = (each for each in root if local(each) == "Errors")
    return [each.get("errorCode") or local(each) for each in errors]
