"""Requests and answers of the agent, row by row as MTConnect clients expect them."""

import time
from collections.abc import Callable
from typing import Any

import httpx
import pytest
from lxml import etree

from extras.agent.model.agent import Asset
from extras.agent.model.buffer import ConditionValue, TimeSeriesValue
from tests.every_case import every_case
from tests.extras.agent.model.conftest import (
    BEGIN,
    ServedAgent,
    error_codes,
    header,
    local,
    mill,
    observations,
    require_valid,
)
from tests.extras.agent.model.test_model import TYPES, model_from

Serve = Callable[..., ServedAgent]
UUID = "bb09c3d6-7115-51a2-909e-c83cb05478bf"
TOOL = (
    '<CuttingTool assetId="{id}" serialNumber="1" toolId="T1" timestamp="2026-01-01T00:00:00Z"'
    ' deviceUuid="bb09c3d6-7115-51a2-909e-c83cb05478bf">'
    "<CuttingToolLifeCycle><CutterStatus><Status>NEW</Status></CutterStatus>"
    "</CuttingToolLifeCycle></CuttingTool>"
)


@pytest.fixture
def served(serve: Serve) -> ServedAgent:
    """An agent for all cases of a table."""
    return serve()


def names_of(root: Any) -> set[str]:
    return {each.get("name") for each in root.iter() if local(each) in {"Device", "Agent"}}


def test_probe_tells_the_devices(serve: Serve) -> None:
    served = serve()
    roots = [served.root(path) for path in ("/probe", "/")]
    for root in roots:
        assert root.tag == "{urn:mtconnect.org:MTConnectDevices:2.7}MTConnectDevices"
        assert names_of(root) == {"Agent", "vmc15"}
        assert "sequence" not in etree.tostring(root).decode().lower()
        words = header(root)
        for name in ("creationTime", "sender", "instanceId", "version", "bufferSize",
                     "assetBufferSize", "assetCount", "deviceModelChangeTime"):  # fmt: skip
            assert name in words
        assert words["creationTime"].endswith("Z")
        assert words["bufferSize"] == "131072"
    ids = [each.get("id") for each in roots[0].iter() if each.get("id")]
    assert len(ids) == len(set(ids))
    assert header(roots[0])["instanceId"] == header(roots[1])["instanceId"]
    types = {each.get("type") for each in roots[0].iter() if local(each) == "DataItem"}
    assert {"AVAILABILITY", "ASSET_CHANGED", "ASSET_REMOVED"} <= types


@pytest.mark.parametrize("path", ["/vmc15", "/vmc15/probe", f"/{UUID}/probe"])
def test_probe_of_one_device_tells_it_alone(serve: Serve, path: str) -> None:
    root = serve().root(path)
    devices = next(each for each in root if local(each) == "Devices")
    assert [(local(each), each.get("name")) for each in devices] == [("Device", "vmc15")]


def test_a_device_that_is_not_there_is_told(serve: Serve) -> None:
    root = serve().root("/NoSuchDevice/probe", status=404)
    (error,) = next(each for each in root if local(each) == "Errors")
    assert local(error) == "NoDevice"
    parts = {local(each): each.text for each in error}
    assert parts["URI"] == "/NoSuchDevice/probe"
    assert parts["Request"] == "MTConnectDevices"
    assert "NoSuchDevice" in (parts["ErrorMessage"] or "")


@pytest.mark.parametrize("version", ["1.3", "2.0", "2.7"])
def test_every_document_is_valid_in_every_version(serve: Serve, version: str) -> None:
    served = serve(mill(version))
    served.add("vmc15_xpos", [1.5, 2.5])
    served.add("vmc15_exec", ["READY", "ACTIVE"])
    served.add(
        "vmc15_cload_cond",
        [
            ConditionValue(level="NORMAL"),
            ConditionValue(level="WARNING", native_code="7", text="hot & <dry>"),
            ConditionValue(
                level="FAULT", native_code="8", native_severity="2", qualifier="HIGH"
            ),
        ],
    )
    served.do(lambda: served.agent.put(asset("A1")))
    for path in ("/probe", "/vmc15/probe", "/current", "/sample", "/sample?from=1&count=9",
                 "/assets", "/asset/A1"):  # fmt: skip
        root = require_valid(served.get(path).content, version)
        has_time = "deviceModelChangeTime" in header(root)
        assert has_time is (version != "1.3")
    for path in ("/nope", "/current/blah", "/sample?count=abc", "/current?at=0", "/asset/NOPE",
                 "/current?path=//////Linear"):  # fmt: skip
        answer = served.get(path)
        assert 400 <= answer.status_code < 500
        root = require_valid(answer.content, version)
        assert "nextSequence" not in header(root)


def test_the_agent_itself_is_a_device_from_1_7_on(serve: Serve) -> None:
    devices = next(each for each in serve().root("/probe") if local(each) == "Devices")
    assert local(devices[0]) == "Agent"
    devices = next(
        each for each in serve(mill("1.3")).root("/probe") if local(each) == "Devices"
    )
    assert [local(each) for each in devices] == ["Device"]


def test_current_has_one_observation_of_each_data_item(serve: Serve) -> None:
    served = serve()
    probe, current = served.root("/probe"), served.root("/current")
    items = {
        each.get("id"): each.get("category")
        for each in probe.iter()
        if local(each) == "DataItem"
    }
    seen = [each.get("dataItemId") for each in observations(current)]
    assert sorted(seen) == sorted(items)
    for each in observations(current):
        is_condition = items[each.get("dataItemId")] == "CONDITION"
        assert is_condition is (local(each.getparent()) == "Condition")
        if is_condition:
            assert local(each) == "Unavailable"
            assert each.get("type")
        assert each.get("timestamp").endswith("Z")
    by_id = {each.get("dataItemId"): each.text for each in observations(current)}
    assert by_id["vmc15_cmode"] == "SPINDLE"
    assert by_id["vmc15_xpos"] == "UNAVAILABLE"
    words = {key: int(text) for key, text in header(current).items() if "Sequence" in key}
    assert words["nextSequence"] == words["lastSequence"] + 1
    assert words["firstSequence"] <= words["lastSequence"]
    assert all(
        int(each.get("sequence")) <= words["lastSequence"] for each in observations(current)
    )


def test_current_of_one_device_tells_it_alone(serve: Serve) -> None:
    root = serve().root("/vmc15/current")
    found = [each for each in root.iter() if local(each) == "DeviceStream"]
    assert [(each.get("name"), each.get("uuid")) for each in found] == [("vmc15", UUID)]
    root = serve().root("/current?deviceType=Agent")
    found = [each for each in root.iter() if local(each) == "DeviceStream"]
    assert [each.get("name") for each in found] == ["Agent"]


@pytest.mark.parametrize(
    ("path", "components", "names"),
    [
        ('//Linear[@name="X"]', {"Linear"}, None),
        ('//DataItem[@type="POSITION"]', {"Linear"}, {"Position", "Unavailable"}),
        (
            '//Rotary//DataItem[@category="SAMPLE" or @category="CONDITION"]',
            {"Rotary"},
            {"RotaryVelocity", "Wattage", "Load", "LinearForce", "Temperature", "Unavailable"},
        ),
        ("//Linear|//Rotary", {"Linear", "Rotary"}, None),
        ("//Axes", {"Linear", "Rotary"}, None),
    ],
)
def test_a_path_chooses(
    serve: Serve, path: str, components: set[str], names: set[str] | None
) -> None:
    answer = httpx.get(serve().url + "/current", params={"path": path})
    assert answer.status_code == 200
    root = etree.fromstring(answer.content)
    streams = [each for each in root.iter() if local(each) == "ComponentStream"]
    assert {each.get("component") for each in streams} == components
    if names is not None:
        assert {local(each) for each in observations(root)} == names


@every_case(
    "path",
    [
        "//////Linear",
        "//Axes?//Linear",
        '//Device[@name="NOPE"]',
        "//*[count(//*[count(//*) > 0]) > 0]",
        "//*[//*[//*[//*]]]",
        "//*//*//*//*//*//*//*",
        "document('/etc/passwd')",
        "1 + 1",
        "//@id",
        "//" + "x" * 2000,
    ],
)
def test_a_bad_path_is_refused_at_once(served: ServedAgent, path: str) -> None:
    begin = time.monotonic()
    answer = httpx.get(served.url + "/current", params={"path": path})
    assert answer.status_code == 400
    assert error_codes(etree.fromstring(answer.content)) == ["InvalidXPath"]
    # What goes over all paths through the document takes hours.
    assert time.monotonic() - begin < 60.0


@every_case(
    ("query", "codes"),
    [
        ("current?at=NaN", ["InvalidParameterValue"]),
        ("current?at=0", ["OutOfRange"]),
        ("current?at=100000", ["OutOfRange"]),
        ("current?at=-1", ["OutOfRange"]),
        ("sample?from=100000", ["OutOfRange"]),
        ("sample?from=0", ["OutOfRange"]),
        ("sample?from=abc", ["InvalidParameterValue"]),
        ("sample?count=0", ["OutOfRange"]),
        ("sample?count=131073", ["OutOfRange"]),
        ("sample?count=-131073", ["OutOfRange"]),
        ("sample?count=abc", ["InvalidParameterValue"]),
        ("sample?from=20&to=18", ["OutOfRange"]),
        ("sample?to=100000", ["OutOfRange"]),
        ("sample?to=20&count=-5", ["OutOfRange"]),
        ("sample?interval=abc", ["InvalidParameterValue"]),
        ("sample?interval=-1", ["OutOfRange"]),
        ("sample?interval=10&heartbeat=0", ["OutOfRange"]),
        ("sample?count=abc&from=xyz", ["InvalidParameterValue", "InvalidParameterValue"]),
        ("current?deviceType=Robot", ["InvalidParameterValue"]),
        ("assets?count=abc", ["InvalidParameterValue"]),
    ],
)
def test_a_parameter_that_cannot_be_is_told(
    served: ServedAgent, query: str, codes: list[str]
) -> None:
    answer = served.get(f"/{query}")
    assert answer.status_code == 400
    root = etree.fromstring(answer.content)
    assert error_codes(root) == codes
    require_valid(answer.content, "2.7")


def test_unknown_parameters_are_ignored(serve: Serve) -> None:
    served = serve()
    assert served.get("/current?unknownParam=1&device=x").status_code == 200
    assert served.get("/current?" + "&".join(f"a{n}=1" for n in range(100))).status_code == 200


def sequences(root: Any) -> list[int]:
    return [int(each.get("sequence")) for each in observations(root)]


def test_samples_by_their_sequence(serve: Serve) -> None:
    served = serve()
    served.add("vmc15_xpos", [float(n) for n in range(300)])
    first, following = 1, served.agent.buffer.next
    root = served.root("/sample")
    assert sequences(root) == list(range(first, first + 100))
    assert header(root)["nextSequence"] == "101"
    root = served.root("/sample?from=200&count=10")
    assert sequences(root) == list(range(200, 210))
    assert header(root)["nextSequence"] == "210"
    root = served.root(f"/sample?from={following}")
    assert sequences(root) == []
    assert header(root)["nextSequence"] == str(following)
    assert sequences(served.root("/sample?count=-10")) == list(range(following - 10, following))
    assert sequences(served.root("/sample?from=100&count=-10")) == list(range(91, 101))
    assert sequences(served.root("/sample?from=50&to=57")) == list(range(50, 58))
    at, seen = 1, []
    while at < following:
        root = served.root(f"/sample?from={at}&count=50")
        seen += sequences(root)
        at = int(header(root)["nextSequence"])
    assert seen == list(range(1, following))


def test_a_path_counts_what_it_finds(serve: Serve) -> None:
    served = serve()
    for n in range(20):
        served.add("vmc15_line", [n])
        served.add("vmc15_xpos", [float(n)])
    first = served.agent.buffer.next - 40
    query = {"path": '//DataItem[@name="line"]', "from": str(first), "count": "5"}
    root = etree.fromstring(httpx.get(served.url + "/sample", params=query).content)
    assert [local(each) for each in observations(root)] == ["LineNumber"] * 5
    assert sequences(root) == [first + 2 * n for n in range(5)]
    assert header(root)["nextSequence"] == str(first + 9)


def test_current_at_a_sequence_is_what_held_then(serve: Serve) -> None:
    served = serve()
    served.add("vmc15_zpos", [1.25])
    for n in range(10):
        served.add("vmc15_line", [n])
        served.add("vmc15_xpos", [10.0 * n])
    at = served.agent.buffer.next - 11
    found = {
        each.get("dataItemId"): each.text
        for each in observations(served.root(f"/current?at={at}"))
    }
    assert (found["vmc15_line"], found["vmc15_xpos"]) == ("4", "40")
    assert found["vmc15_zpos"] == "1.25"


def test_a_full_buffer_forgets_the_oldest_and_keeps_what_holds(serve: Serve) -> None:
    served = serve(size=2000)
    served.add("vmc15_zpos", [1.25])
    for _ in range(10):
        served.add("vmc15_xpos", [float(n) for n in range(777)])
    words = header(served.root("/current"))
    assert int(words["firstSequence"]) == int(words["lastSequence"]) - 1999
    assert error_codes(served.root("/sample?from=1", status=400)) == ["OutOfRange"]
    assert error_codes(served.root("/current?at=1", status=400)) == ["OutOfRange"]
    for at in (words["firstSequence"], words["lastSequence"]):
        found = {
            each.get("dataItemId"): each.text
            for each in observations(served.root(f"/current?at={at}"))
        }
        assert found["vmc15_zpos"] == "1.25"
    first = int(words["firstSequence"])
    (seen,) = observations(served.root(f"/sample?from={first}&count=1"))
    held = {
        each.get("dataItemId"): each
        for each in observations(served.root(f"/current?at={first}"))
    }
    assert held["vmc15_xpos"].text == seen.text


def test_conditions_are_active_by_their_code(serve: Serve) -> None:
    served = serve()

    def levels() -> list[tuple[str, str | None]]:
        return [
            (local(each), each.get("nativeCode"))
            for each in observations(served.root("/current"))
            if each.get("dataItemId") == "vmc15_cload_cond"
        ]

    served.add("vmc15_cload_cond", [ConditionValue(level="NORMAL")])
    assert levels() == [("Normal", None)]
    served.add("vmc15_cload_cond", [
        ConditionValue(level="WARNING", native_code="1"),
        ConditionValue(level="FAULT", native_code="2"),
    ])  # fmt: skip
    assert levels() == [("Warning", "1"), ("Fault", "2")]
    served.add("vmc15_cload_cond", [ConditionValue(level="NORMAL", native_code="1")])
    assert levels() == [("Fault", "2")]
    served.add("vmc15_cload_cond", [ConditionValue(level="NORMAL")])
    assert levels() == [("Normal", None)]


class PartReader:
    """Parts of a stream as a client reads them: by the length that each states."""

    def __init__(self, answer: httpx.Response) -> None:
        kind = answer.headers["content-type"]
        assert kind.startswith("multipart/mixed;boundary=")
        self.boundary = kind.partition("=")[2].encode()
        self.chunks = answer.iter_raw()
        self.data = b""

    def until(self, end: bytes) -> bytes:
        while end not in self.data:
            self.data += next(self.chunks)
        found, _, self.data = self.data.partition(end)
        return found

    def part(self) -> Any:
        head = self.until(b"\r\n\r\n").strip().split(b"\r\n")
        assert head[0] == b"--" + self.boundary
        words = dict(line.lower().split(b": ") for line in head[1:])
        assert words[b"content-type"] == b"text/xml"
        length = int(words[b"content-length"])
        while len(self.data) < length + 2:
            self.data += next(self.chunks)
        body, self.data = self.data[:length], self.data[length + 2 :]
        return etree.fromstring(body)


def test_a_stream_tells_what_is_new_and_beats(serve: Serve) -> None:
    served = serve()
    at = served.agent.buffer.next
    url = f"{served.url}/sample?interval=50&heartbeat=300&from={at}"
    with httpx.stream("GET", url, timeout=120.0) as answer:
        reader = PartReader(answer)
        empty = reader.part()
        assert sequences(empty) == []
        assert header(empty)["nextSequence"] == str(at)
        served.add("vmc15_xpos", [1.0, 2.0])
        assert sequences(reader.part()) == [at, at + 1]
        served.add("vmc15_xpos", [3.0])
        seen = reader.part()
        while not sequences(seen):
            seen = reader.part()
        assert sequences(seen) == [at + 2]


def test_a_stream_catches_up_without_gaps(serve: Serve) -> None:
    served = serve()
    served.add("vmc15_xpos", [float(n) for n in range(500)])
    seen: list[int] = []
    url = f"{served.url}/sample?interval=50&from=1&count=20"
    with httpx.stream("GET", url, timeout=120.0) as answer:
        reader = PartReader(answer)
        while len(seen) < served.agent.buffer.last:
            found = sequences(reader.part())
            assert len(found) <= 20
            seen += found
    assert seen == list(range(1, served.agent.buffer.next))


def test_current_is_streamed_at_its_interval(serve: Serve) -> None:
    served = serve()
    with httpx.stream("GET", f"{served.url}/current?interval=50", timeout=120.0) as answer:
        reader = PartReader(answer)
        counts = [len(observations(reader.part())) for _ in range(3)]
    assert counts == [len(served.agent.model.items)] * 3


def test_a_stream_that_falls_behind_the_buffer_ends_with_an_error(serve: Serve) -> None:
    served = serve(size=1000)
    url = f"{served.url}/sample?interval=100&heartbeat=200&from={served.agent.buffer.next}"
    with httpx.stream("GET", url, timeout=120.0) as answer:
        reader = PartReader(answer)
        reader.part()
        served.add("vmc15_xpos", [float(n) for n in range(5000)])
        last = reader.part()
        while local(last) != "MTConnectError":
            last = reader.part()
        assert error_codes(last) == ["OutOfRange"]


@pytest.mark.parametrize(
    ("path", "code"),
    [
        ("/bad_path", "NoDevice"),
        ("/vmc15/current/blah", "InvalidURI"),
        ("/bad/path/", "NoDevice"),
        ("/probe/x", "InvalidURI"),
        ("/schemas/../../etc/passwd", "NoDevice"),
    ],
)
def test_an_address_that_is_none_is_told(serve: Serve, path: str, code: str) -> None:
    assert error_codes(serve().root(path, status=404)) == [code]


def test_json_is_the_same_in_lists(serve: Serve) -> None:
    served = serve()
    served.add("vmc15_xpos", [1.5])
    answer = served.get("/probe", accept="application/json")
    assert answer.headers["content-type"] == "application/json"
    devices = answer.json()["MTConnectDevices"]["Devices"]
    (device,) = devices["Device"]
    assert device["Components"]["Axes"][0]["Components"]["Linear"][0]["name"] == "X"
    streams = served.get("/vmc15/current?format=json").json()["MTConnectStreams"]
    (stream,) = streams["Streams"]["DeviceStream"]
    linear = next(each for each in stream["ComponentStream"] if each["name"] == "X")
    assert linear["Samples"]["Position"][0]["value"] == 1.5
    assert isinstance(streams["Header"]["nextSequence"], int)


def test_other_forms_fall_back_to_xml(serve: Serve) -> None:
    served = serve()
    answer = served.get("/current", accept="text/html, unknown")
    assert answer.headers["content-type"].startswith("text/xml")
    pretty = served.get("/current?pretty=true")
    assert pretty.text.count("\n") > 50
    plain = observations(etree.fromstring(answer.content))
    assert [each.attrib for each in plain] == [
        each.attrib for each in observations(etree.fromstring(pretty.content))
    ]


def test_nothing_can_be_written(serve: Serve) -> None:
    served = serve()
    before = served.agent.buffer.next
    for method in ("POST", "PUT", "DELETE"):
        answer = httpx.request(method, f"{served.url}/current", content=b"x=1")
        assert answer.status_code == 405
        assert error_codes(etree.fromstring(answer.content)) == ["Unsupported"]
    assert served.agent.buffer.next == before
    answer = httpx.options(f"{served.url}/probe")
    assert answer.status_code < 300
    assert "GET" in answer.headers["allow"]
    assert answer.headers["access-control-allow-origin"] == "*"


def test_one_connection_serves_many_requests_and_packs_them(serve: Serve) -> None:
    served = serve()
    with httpx.Client() as client:
        sizes = {len(client.get(f"{served.url}/probe").content) for _ in range(3)}
        answer = client.get(f"{served.url}/probe", headers={"accept-encoding": "gzip"})
    assert len(sizes) == 1
    assert answer.headers["content-encoding"] == "gzip"
    assert int(answer.headers["content-length"]) < len(answer.content) / 3


BROWSER = "text/html,application/xhtml+xml,application/xml;q=0.9,image/avif,*/*;q=0.8"


@pytest.mark.parametrize("path", ["/current", "/probe", "/sample?count=20", "/smell"])
def test_a_browser_is_given_a_page(serve: Serve, path: str) -> None:
    served = serve()
    page = served.get(path, accept=BROWSER)
    assert page.headers["content-type"] == "text/html; charset=utf-8"
    assert page.text.startswith("<!DOCTYPE html")
    # Of the same address, each client has what it asks for.
    for accept, kind in (
        ("text/html", "text/xml; charset=utf-8"),
        ("*/*", "text/xml; charset=utf-8"),
        ("application/json", "application/json"),
    ):
        assert served.get(path, accept=accept).headers["content-type"] == kind
    join = "&" if "?" in path else "?"
    xml = served.get(f"{path}{join}format=xml", accept=BROWSER)
    assert xml.headers["content-type"] == "text/xml; charset=utf-8"


def test_a_page_shows_what_a_document_holds(serve: Serve) -> None:
    served = serve()
    served.add("vmc15_program", ["<script>alert(1)</script>"])
    page = served.get("/current?format=html").text
    assert "vmc15_xpos" in page
    assert "UNAVAILABLE" in page
    assert "<script>" not in page
    assert "&lt;script&gt;" in page
    for word in ("probe", "current", "sample"):
        assert f'href="{word}"' in page


def asset(id: str, *, is_removed: bool = False) -> Asset:
    return Asset(
        id=id, type="CuttingTool", text=TOOL.format(id=id), device=1, is_removed=is_removed
    )


def test_assets_by_id_kind_and_age(serve: Serve) -> None:
    served = serve()
    for id in ("A1", "A2", "A3"):
        served.do(lambda id=id: served.agent.put(asset(id)))  # type: ignore[misc]

    def ids(path: str) -> list[str]:
        return [each.get("assetId") for each in served.root(path).iter() if each.get("assetId")]

    assert ids("/assets") == ["A3", "A2", "A1"]
    assert ids("/assets?type=CuttingTool&count=1") == ["A3"]
    assert ids("/assets?count=1048576") == ["A3", "A2", "A1"]
    assert ids("/asset/A1;NOPE") == ["A1"]
    assert error_codes(served.root("/asset/NOPE", status=404)) == ["AssetNotFound"]
    assert header(served.root("/assets"))["assetCount"] == "3"
    served.do(lambda: served.agent.put(asset("A1", is_removed=True)))
    assert ids("/assets") == ["A3", "A2"]
    assert ids("/assets?removed=true") == ["A1", "A3", "A2"]
    texts = {
        each.get("dataItemId"): each.text for each in observations(served.root("/current"))
    }
    assert texts["vmc15_asset_rem"] == "A1"
    assert texts["vmc15_asset_chg"] == "A3"


def test_the_requests_of_the_reference_agent_as_a_client(serve: Serve) -> None:
    served = serve()
    assert served.get("/assets?count=1048576").status_code == 200
    following = header(served.root("/vmc15/current"))["nextSequence"]
    url = f"{served.url}/vmc15/sample?count=1000&from={following}&heartbeat=10000&interval=100"
    with httpx.stream("GET", url, timeout=120.0) as answer:
        served.add("vmc15_xpos", [1.0])
        assert sequences(PartReader(answer).part()) == [int(following)]


def test_timestamps_are_as_sent_and_sequence_numbers_give_the_order(serve: Serve) -> None:
    served = serve()
    served.add("vmc15_xpos", [1.0], begin=BEGIN + 10_000_000)
    served.add("vmc15_xpos", [2.0], begin=BEGIN)
    later, earlier = observations(served.root("/sample"))[-2:]
    assert (later.text, earlier.text) == ("1", "2")
    assert later.get("timestamp", "") > earlier.get("timestamp", "")
    assert int(later.get("sequence", "")) < int(earlier.get("sequence", ""))


def test_texts_are_escaped_and_illegal_signs_replaced(serve: Serve) -> None:
    served = serve()
    served.add("vmc15_program", ["<O1> & 'x'\x07\ufffe"])
    (seen,) = observations(served.root("/sample?count=-1"))
    assert seen.text == "<O1> & 'x'��"


def test_series_are_told_with_their_rate(serve: Serve) -> None:
    served = serve(model_from(TYPES))
    served.add("series", [TimeSeriesValue(values=(1.0, 2.5), rate=100.0)])
    served.add("set", [{"a": "1", "b": "x y"}, {"a": None, "c": "3"}])
    root = require_valid(served.get("/current").content, "2.7")
    found = {each.get("dataItemId"): each for each in observations(root)}
    assert found["series"].text == "1 2.5"
    assert (found["series"].get("sampleCount"), found["series"].get("sampleRate")) == (
        "2",
        "100",
    )
    assert {each.get("key"): each.text for each in found["set"]} == {"b": "x y", "c": "3"}
    assert found["set"].get("count") == "2"
