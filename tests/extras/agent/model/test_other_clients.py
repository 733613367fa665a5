"""Clients that others wrote, or that need only the standard, read the agent over HTTP."""

import http.client
from collections.abc import Callable, Generator
from contextlib import closing
from typing import Any

import pytest
from lxml import etree
from pymtconnect import mtconnect_client

from extras.agent.model.buffer import ConditionValue
from tests.extras.agent.model.conftest import ServedAgent, header, observations

Serve = Callable[..., ServedAgent]


def filled(served: ServedAgent) -> ServedAgent:
    served.add("vmc15_exec", ["READY", "ACTIVE"])
    served.add("vmc15_line", [1, 2, 3])
    served.add("vmc15_xpos", [0.5, 1.5])
    served.add(
        "vmc15_cload_cond", [ConditionValue(level="WARNING", native_code="7", text="hot")]
    )
    return served


def values(seen: list[Any], id: str) -> list[Any]:
    return [each.result for each in seen if each.data_item_id == id]


def test_pymtconnect_reads_the_device_model(serve: Serve) -> None:
    served = serve()
    head, devices = mtconnect_client.probe(served.url)
    assert (head.version, head.buffer_size) == ("2.7.0.0", 131072)
    assert [(each.name, each.uuid) for each in devices] == [
        (each.name, each.uuid) for each in served.agent.model.devices if not each.is_agent
    ]


def test_pymtconnect_reads_what_holds_and_what_was(serve: Serve) -> None:
    served = filled(serve())
    head, events, conditions = mtconnect_client.current(served.url)
    assert head.next_sequence == served.agent.buffer.next
    assert values(events, "vmc15_exec") == ["ACTIVE"]
    (held,) = (each for each in conditions if each.data_item_id == "vmc15_cload_cond")
    assert (held.native_code, held.type) == ("7", "LOAD")
    start = served.agent.buffer.next - 8
    head, events, conditions = mtconnect_client.sample(served.url, from_seq=start, count=5)
    assert head.next_sequence == start + 5
    assert values(events, "vmc15_exec") == ["READY", "ACTIVE"]


def test_pymtconnect_reads_the_stream(serve: Serve) -> None:
    served = filled(serve())
    at = served.agent.buffer.next
    stream = mtconnect_client.stream_sample(served.url, interval=50, from_seq=at, timeout=120.0)
    with closing(stream):
        served.add("vmc15_exec", ["FEED_HOLD"])
        head, events, _ = next(stream)
        while not events:
            head, events, _ = next(stream)
        assert values(events, "vmc15_exec") == ["FEED_HOLD"]
        served.add("vmc15_exec", ["STOPPED"])
        _, events, _ = next(stream)
        while not events:
            _, events, _ = next(stream)
        assert values(events, "vmc15_exec") == ["STOPPED"]
        assert head.next_sequence == at + 1


class PlainClient:
    """A client of lxml and http.client alone."""

    def __init__(self, url: str) -> None:
        self._place = url.removeprefix("http://")

    def document(self, path: str) -> Any:
        with closing(http.client.HTTPConnection(self._place, timeout=120.0)) as connection:
            connection.request("GET", path)
            answer = connection.getresponse()
            assert answer.status == http.client.OK
            return etree.fromstring(answer.read())

    def stream(self, path: str) -> Generator[Any, None, None]:
        with closing(http.client.HTTPConnection(self._place, timeout=120.0)) as connection:
            connection.request("GET", path)
            answer = connection.getresponse()
            kind, _, boundary = answer.headers["Content-Type"].partition(";boundary=")
            assert kind == "multipart/mixed"
            while True:
                assert answer.readline().strip() == b"--" + boundary.encode()
                words = dict[bytes, bytes]()
                while line := answer.readline().strip():
                    key, _, text = line.partition(b": ")
                    words[key.lower()] = text
                yield etree.fromstring(answer.read(int(words[b"content-length"])))
                assert answer.readline() == b"\r\n"


def text_of(root: Any, id: str) -> list[str]:
    return [each.text for each in observations(root) if each.get("dataItemId") == id]


@pytest.mark.parametrize("device", ["", "/vmc15"])
def test_a_plain_client_reads_everything(serve: Serve, device: str) -> None:
    served = filled(serve())
    client = PlainClient(served.url)
    probe = client.document(f"{device}/probe")
    ids = {each.get("id") for each in probe.iter("{*}DataItem")}
    current = client.document(f"{device}/current")
    assert {each.get("dataItemId") for each in observations(current)} == ids
    assert text_of(current, "vmc15_xpos") == ["1.5"]
    sample = client.document(f"{device}/sample?count=1000")
    assert text_of(sample, "vmc15_line") == ["UNAVAILABLE", "1", "2", "3"]
    following = header(sample)["nextSequence"]
    query = f"interval=20&heartbeat=200&from={following}"
    with closing(client.stream(f"{device}/sample?{query}")) as parts:
        served.add("vmc15_line", [4])
        seen: list[str] = []
        while not seen:
            seen = text_of(next(parts), "vmc15_line")
    assert seen == ["4"]
