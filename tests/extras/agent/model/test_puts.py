"""Writes of clients over real HTTP: assets and observations, and what is refused."""

import asyncio
import subprocess
from collections.abc import Callable
from pathlib import Path

import httpx
import pytest
from lxml import etree

from tests.docs.pages import DOCS, blocks
from tests.every_case import every_case
from tests.extras.agent.model.conftest import (
    BEGIN,
    ServedAgent,
    error_codes,
    header,
    local,
    observations,
    require_valid,
)
from tests.extras.agent.model.test_model import TYPES, model_from

Serve = Callable[..., ServedAgent]
UUID = "bb09c3d6-7115-51a2-909e-c83cb05478bf"
TOOL = (
    '<CuttingTool serialNumber="a assetId=b" toolId="T2" assetId="other">'
    "<CuttingToolLifeCycle><CutterStatus><Status>NEW</Status></CutterStatus>"
    "</CuttingToolLifeCycle></CuttingTool>"
)
PUT = "/asset/A2?device=vmc15&type=CuttingTool"


@pytest.fixture
def writable(serve: Serve) -> ServedAgent:
    """An agent that may be written to."""
    return serve(allows_put=True)


def write(
    served: ServedAgent, method: str, path: str, body: str | bytes = b"", **headers: str
) -> httpx.Response:
    return httpx.request(
        method, served.url + path, content=body, headers=headers, timeout=120.0
    )


def ids(served: ServedAgent, path: str) -> list[str]:
    return [each.get("assetId") for each in served.root(path).iter() if each.get("assetId")]


def told(served: ServedAgent) -> dict[str, str]:
    return {each.get("dataItemId"): each.text for each in observations(served.root("/current"))}


@pytest.mark.parametrize("method", ["PUT", "POST"])
@pytest.mark.parametrize(
    "path", [PUT, f"/asset/A2?device={UUID}", "/vmc15/asset/A2", "/asset/A2", "/assets/A2"]
)
def test_an_asset_that_is_put_is_kept_and_told(serve: Serve, method: str, path: str) -> None:
    served = serve(allows_put=True)
    answer = write(served, method, path, TOOL)
    assert answer.status_code == 200
    require_valid(answer.content, "2.7")
    (found,) = require_valid(served.get("/asset/A2").content, "2.7")[1]
    assert (local(found), found.get("assetId")) == ("CuttingTool", "A2")
    assert (found.get("deviceUuid"), found.get("serialNumber")) == (UUID, "a assetId=b")
    assert found.get("timestamp").startswith("2025-10-09T")
    assert told(served)["vmc15_asset_chg"] == "A2"
    require_valid(served.get("/current").content, "2.7")


def test_the_type_of_an_asset_is_told_with_its_id(serve: Serve) -> None:
    served = serve(allows_put=True)
    text = '<File xmlns="urn:mtconnect.org:MTConnectAssets:2.7" assetId="F1" name="O1"/>'
    assert write(served, "PUT", "/asset", text).status_code == 200
    (seen,) = observations(served.root("/sample?count=-1"))
    assert (seen.text, seen.get("assetType")) == ("F1", "File")
    assert ids(served, "/assets?type=File") == ["F1"]
    assert ids(served, "/assets?type=CuttingTool") == []


def test_an_asset_is_removed_and_comes_back(serve: Serve) -> None:
    served = serve(allows_put=True)
    for id in ("A1", "A2"):
        write(served, "PUT", f"/asset/{id}", TOOL)
    answer = write(served, "DELETE", "/asset/A1;NOPE")
    assert answer.status_code == 200
    assert ids(served, "/assets") == ["A2"]
    root = require_valid(served.get("/assets?removed=true").content, "2.7")
    removed = {each.get("assetId"): each.get("removed") for each in root[1]}
    assert removed == {"A1": "true", "A2": None}
    assert told(served)["vmc15_asset_rem"] == "A1"
    before = served.agent.buffer.next
    write(served, "DELETE", "/asset/A1")
    assert served.agent.buffer.next == before
    assert told(served)["vmc15_asset_chg"] == "A2"
    write(served, "DELETE", "/asset/A2")
    assert told(served)["vmc15_asset_chg"] == "UNAVAILABLE"
    write(served, "PUT", "/asset/A1", TOOL)
    assert ids(served, "/assets") == ["A1"]
    answer = write(served, "DELETE", "/asset/NOPE")
    assert answer.status_code == 404
    assert error_codes(require_valid(answer.content, "2.7")) == ["AssetNotFound"]


def test_all_assets_of_a_type_are_removed(serve: Serve) -> None:
    served = serve(allows_put=True)
    write(served, "PUT", "/asset/F1", "<File/>")
    for id in ("A1", "A2"):
        write(served, "PUT", f"/asset/{id}", TOOL)
    assert write(served, "DELETE", "/assets?type=CuttingTool").status_code == 200
    assert ids(served, "/assets") == ["F1"]
    answer = write(served, "DELETE", "/assets?type=CuttingTool")
    assert len(require_valid(answer.content, "2.7")[1]) == 0
    for path in ("/asset", "/asset/;"):
        answer = write(served, "DELETE", path)
        assert answer.status_code == 400
        assert error_codes(require_valid(answer.content, "2.7")) == ["InvalidRequest"]
    assert ids(served, "/assets") == ["F1"]


LAUGHS = (
    '<!DOCTYPE a [<!ENTITY x "lol"><!ENTITY y "&x;&x;&x;&x;">]><CuttingTool>&y;</CuttingTool>'
)
FILE = '<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]><CuttingTool>&x;</CuttingTool>'
DEEP = "<CuttingTool>" + "<a>" * 60 + "</a>" * 60 + "</CuttingTool>"


@every_case(
    ("path", "body", "status"),
    [
        (PUT, LAUGHS, 400),
        (PUT, FILE, 400),
        (PUT, '<!DOCTYPE a SYSTEM "http://127.0.0.1:9/x.dtd"><CuttingTool/>', 400),
        (PUT, DEEP, 400),
        (PUT, "<CuttingTool>", 400),
        (PUT, "", 400),
        (PUT, b"\xff\xfe\x00", 400),
        (PUT, "<File/>", 400),
        (PUT, '<x:Tool xmlns:x="urn:other"/>', 400),
        ("/asset", "<CuttingTool/>", 400),
        ("/asset/" + "A" * 300, "<CuttingTool/>", 400),
        ("/asset/A;B", "<CuttingTool/>", 400),
        ("/asset/A2?device=nope", "<CuttingTool/>", 404),
        ("/nope/asset/A2", "<CuttingTool/>", 404),
        (PUT, f"<CuttingTool><!--{'x' * (1 << 20)}--></CuttingTool>", 413),
    ],
)
def test_an_asset_that_cannot_be_kept_is_refused(
    writable: ServedAgent, path: str, body: str | bytes, status: int
) -> None:
    before = writable.agent.buffer.next
    answer = write(writable, "PUT", path, body)
    assert answer.status_code == status
    root = require_valid(answer.content, "2.7")
    assert error_codes(root) == ["NoDevice" if status == 404 else "InvalidRequest"]
    assert "root:" not in answer.text
    assert ids(writable, "/assets") == []
    assert writable.agent.buffer.next == before


def test_json_has_no_numbers_that_json_does_not_know(serve: Serve) -> None:
    served = serve(allows_put=True)
    text = '<File count="1e999" sequence="nan"><Entry key="a">inf</Entry></File>'
    write(served, "PUT", "/asset/F1", text)
    assert "Infinity" not in served.get("/assets?format=json").text
    (file,) = served.get("/assets?format=json").json()["MTConnectAssets"]["Assets"]["File"]
    assert (file["count"], file["sequence"], file["value"]) == ("1e999", "nan", {"a": "inf"})


def test_assets_together_are_bounded(serve: Serve) -> None:
    served = serve(allows_put=True)
    body = f"<File><!--{'x' * 1_000_000}--></File>"
    for number in range(70):
        assert write(served, "PUT", f"/asset/F{number}", body).status_code == 200
    kept = list(served.agent.assets)
    assert 60 <= len(kept) < 70
    assert kept[-1] == "F69"


def test_values_are_put_as_adapters_tell_them(serve: Serve) -> None:
    served = serve(model_from(TYPES), allows_put=True)
    query = "avail=AVAILABLE&feed=60&cond=FAULT%7C7%7C2%7CHIGH%7Chot&set=a%3D1&s=2%7C%7C1 2"
    answer = write(served, "PUT", f"/D?{query}&msg=now&time=2025-01-02T03:04:05Z")
    assert (answer.status_code, answer.text) == (200, "<success/>")
    root = require_valid(served.get("/current").content, "2.7")
    seen = {each.get("dataItemId"): each for each in observations(root)}
    assert seen["feed"].text == "25.4"
    assert (local(seen["cond"]), seen["cond"].text) == ("Fault", "hot")
    assert seen["series"].text == "1 2"
    assert seen["msg"].text == "now"
    assert [each.text for each in seen["set"]] == ["1"]
    assert write(served, "POST", "/u?avail=UNAVAILABLE").status_code == 200
    assert told(served)["avail"] == "UNAVAILABLE"


def test_a_line_number_is_put(serve: Serve) -> None:
    served = serve(allows_put=True)
    assert write(served, "PUT", "/vmc15?line=77").status_code == 200
    (seen,) = observations(served.root("/sample?count=-1"))
    assert (local(seen), seen.text) == ("LineNumber", "77")
    assert write(served, "PUT", f"/{UUID}?vmc15_line=78").status_code == 200
    assert told(served)["vmc15_line"] == "78"


def test_a_time_in_the_future_is_now(serve: Serve) -> None:
    served = serve(allows_put=True)
    write(served, "PUT", "/vmc15?line=1&time=2999-01-01T00:00:00Z")
    assert served.agent.buffer.last_time == BEGIN


@every_case(
    ("query", "faults"),
    [
        ("nope=1", 1),
        ("nope=1&line=5", 1),
        ("nope=1&neither=2", 2),
        ("", 1),
        ("time=2026-01-01T00:00:00Z", 1),
        ("line=5&time=yesterday", 1),
        ("xpos=abc", 1),
        ("xpos=nan", 1),
        ("cload_cond=HOT", 1),
        ("line=1%7C2", 1),
        ("cmode=SPINDLE", 1),
        ("&".join(f"a{number}=1" for number in range(100)), 1),
    ],
)
def test_values_that_cannot_be_are_refused_together(
    writable: ServedAgent, query: str, faults: int
) -> None:
    before = writable.agent.buffer.next
    answer = write(writable, "PUT", f"/vmc15?{query}")
    assert answer.status_code == 400
    assert error_codes(require_valid(answer.content, "2.7")) == ["InvalidRequest"] * faults
    assert writable.agent.buffer.next == before


@pytest.mark.parametrize("path", ["/asset/A2", "/assets", "/vmc15?line=7", "/current"])
def test_nothing_is_written_unless_it_is_allowed(serve: Serve, path: str) -> None:
    served = serve()
    for method in ("PUT", "POST", "DELETE"):
        answer = write(served, method, path, TOOL)
        assert answer.status_code == 405
        assert error_codes(require_valid(answer.content, "2.7")) == ["Unsupported"]
        assert answer.headers["allow"] == "GET, HEAD, OPTIONS"
    assert httpx.options(served.url + path).headers["allow"] == "GET, HEAD, OPTIONS"
    assert ids(served, "/assets?removed=true") == []


@every_case(
    ("path", "methods"),
    [
        ("/asset/A1", {"PUT", "POST", "DELETE"}),
        ("/vmc15/assets", {"PUT", "POST", "DELETE"}),
        ("/vmc15", {"PUT", "POST"}),
        ("/vmc15/probe", set()),
        ("/current", set()),
        ("/", set()),
    ],
)
def test_what_may_be_written_where_is_told(
    writable: ServedAgent, path: str, methods: set[str]
) -> None:
    allowed = set(httpx.options(writable.url + path).headers["allow"].split(", "))
    assert allowed == {"GET", "HEAD", "OPTIONS"} | methods
    for method in {"PUT", "POST", "DELETE", "PATCH"} - methods:
        assert write(writable, method, path).status_code == 405


def test_pages_of_other_servers_may_not_write(serve: Serve) -> None:
    served = serve(allows_put=True)
    answer = write(served, "POST", "/vmc15?line=7", origin="http://evil.example")
    assert answer.status_code == 403
    assert error_codes(require_valid(answer.content, "2.7")) == ["Unauthorized"]
    methods = httpx.options(f"{served.url}/vmc15").headers["access-control-allow-methods"]
    assert methods == "GET, HEAD, OPTIONS"
    assert write(served, "POST", "/vmc15?line=7", origin=served.url).status_code == 200


def test_a_body_that_does_not_come_is_given_up(
    serve: Serve, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("extras.agent.model.http.PATIENCE", 0.2)
    served = serve(allows_put=True)

    async def slow() -> bytes:
        host, _, port = served.url.removeprefix("http://").partition(":")
        reader, writer = await asyncio.open_connection(host, int(port))
        writer.write(b"PUT /asset/A1 HTTP/1.1\r\nHost: x\r\nContent-Length: 100\r\n\r\n<Cut")
        async with asyncio.timeout(20.0):
            head = await reader.readuntil(b"\r\n")
        writer.close()
        return head

    assert b" 408 " in asyncio.run(slow())


def test_in_a_scaled_run_values_take_the_time_of_the_newest_observation(serve: Serve) -> None:
    served = serve(allows_put=True, is_scaled=True, begin=BEGIN - 60_000_000)
    write(served, "PUT", "/vmc15?line=7")
    write(served, "PUT", "/asset/A1", TOOL)
    assert served.agent.buffer.last_time == BEGIN - 60_000_000
    assert header(served.root("/assets"))["assetCount"] == "1"


def test_an_asset_may_be_put_as_removed_in_the_oldest_version(serve: Serve) -> None:
    served = serve(model_from(TYPES, "1.3"), allows_put=True)
    write(served, "PUT", "/asset/A1", TOOL.replace(" toolId", ' removed="true" toolId'))
    assert ids(served, "/assets") == []
    root = etree.fromstring(served.get("/assets?removed=true").content)
    assert root[1][0].get("removed") == "true"


def test_the_commands_of_the_page_write(serve: Serve, tmp_path: Path) -> None:
    served = serve(allows_put=True)
    (tmp_path / "tool.xml").write_text(TOOL, encoding="utf-8")
    page = (DOCS / "mtconnect.md").read_text(encoding="utf-8")
    (block,) = (each for each in blocks(page) if each.language == "sh" and "curl" in each.text)
    script = block.text.replace("http://127.0.0.1:5000", served.url)
    script = script.replace("curl ", "curl --fail -sS -m 60 ")
    subprocess.run(["bash", "-euc", script], cwd=tmp_path, check=True, capture_output=True)
    assert ids(served, "/assets?removed=true") == ["T7"]
    assert told(served)["vmc15_line"] == "77"
