"""Names by which clients may reach a server; another one comes from a page of another site."""

import asyncio
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from extras.agent import run
from extras.agent.requests import AgentRequest
from extras.agent.run import AgentFiles, serve_agent
from extras.factory import serve
from extras.factory.requests import LiveFactoryRequest
from service.errors import Forbidden, Unreadable
from service.simulation.run import RunFiles
from service.web.known_hosts import Application, host_in, known_hosts
from tests.every_case import every_case
from tests.extras.agent.model.test_model import TYPES
from tests.extras.factory.shops import TIMED


def scope(*hosts: str, server: tuple[str, int] | None = None, **more: Any) -> dict[str, Any]:
    """A request with these Host headers, which has come to an address of this computer."""
    headers = [(b"host", host.encode("latin-1")) for host in hosts]
    return {
        "type": "http", "method": "GET", "path": "/current", "query_string": b"",
        "headers": headers, "server": server, **more,
    }  # fmt: skip


@every_case(
    ("place", "host"),
    [
        ("localhost", "localhost"), ("planner.shop:8000", "planner.shop"), ("a:", "a"),
        ("127.0.0.1:65535", "127.0.0.1"), ("[::1]:80", "::1"), ("[0:0:0:0:0:0:0:1]", "::1"),
        ("", ""), (":80", ""), ("a:65536", ""), ("a:99999999", ""), ("a:0", ""), ("a:-1", ""),
        ("a:8o", ""), ("a:80:80", ""), ("a:" + "9" * 5000, ""), ("[127.0.0.1]", ""),
        ("[::1", ""), ("::1", ""), ("[::1]evil", ""), ("[::1%25lo]", ""), ("b@a", ""),
        ("a/b", ""), ("a b", ""), ("a?b", ""), ("a#b", ""), ("a:\u0661", ""),
    ],
)  # fmt: skip
def test_a_host_has_the_form_of_one(place: str, host: str) -> None:
    assert host_in(place) == host


@every_case(
    ("listens", "host", "is_known"),
    [
        ("127.0.0.1", "localhost:5000", True), ("127.0.0.1", "LOCALHOST", True),
        ("127.0.0.1", "[::1]:5000", True), ("127.0.0.1", "Planner.Shop", True),
        ("127.0.0.1", "evil.example", False), ("127.0.0.1", "127.0.0.1.evil.example", False),
        ("192.168.0.7", "192.168.0.7:5000", True), ("fd00:0::7", "[fd00::7]", True),
        # What stands for all addresses is no name: browsers lead pages there, too.
        ("0.0.0.0", "0.0.0.0:5000", False), ("::", "[::]:5000", False),
        # The address at which the client has reached us.
        ("0.0.0.0", "10.0.0.9:5000", True), ("0.0.0.0", "10.0.0.8:5000", False),
    ],
)  # fmt: skip
def test_names_and_reached_addresses_are_known(listens: str, host: str, is_known: bool) -> None:
    hosts = known_hosts(listens, ["planner.shop"])
    for server in (("10.0.0.9", 5000), ("::ffff:10.0.0.9", 5000)):
        if is_known:
            assert hosts.require(scope(host, server=server)) == host.lower()
        else:
            with pytest.raises(Forbidden, match="--name"):
                hosts.require(scope(host, server=server))


def test_one_host_is_named_exactly() -> None:
    hosts = known_hosts("127.0.0.1")
    with pytest.raises(Unreadable):
        hosts.require(scope("localhost", "localhost"))
    with pytest.raises(Forbidden):
        hosts.require(scope())


def answer(app: Application, asked: Mapping[str, Any]) -> int:
    """Status of the answer of an application."""
    told: list[Mapping[str, Any]] = []

    async def receive() -> Mapping[str, Any]:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Mapping[str, Any]) -> None:
        told.append(message)

    asyncio.run(app(asked, receive, send))  # type: ignore[arg-type]
    return int(told[0]["status"])


def require_guarded(app: Application) -> None:
    """Every method and path of an application asks for a known host."""
    for path in ("/current", "/probe", "/runs", "/runs/x/current", "/d?x=1", "/asset/A"):
        for method in ("GET", "HEAD", "PUT", "POST", "DELETE", "OPTIONS"):
            asked: dict[str, Any] = {"method": method, "path": path}
            assert answer(app, scope("evil.example:5000", **asked)) == 403
            assert answer(app, scope("planner.shop:99999", **asked)) == 403
            assert answer(app, scope("[127.0.0.1]", **asked)) == 403
            assert answer(app, scope("planner.shop:5000", **asked)) != 403


def test_the_agent_answers_for_its_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    device = tmp_path / "model.xml"
    device.write_text(
        '<MTConnectDevices xmlns="urn:mtconnect.org:MTConnectDevices:2.7">'
        f"{TYPES}</MTConnectDevices>",
        encoding="utf-8",
    )
    served: list[Application] = []
    monkeypatch.setattr(run, "run_server", lambda _, app, *__, **___: served.append(app))
    request = AgentRequest(
        port=0, adapters=("127.0.0.1:7878",), allows_put=True, host_names=("planner.shop",)
    )
    files = AgentFiles(run=RunFiles(), device=device, runs=tmp_path / "runs")
    serve_agent(request, files)
    require_guarded(served[0])


def test_the_agent_of_a_live_shop_answers_for_its_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shop = tmp_path / "shop.toml"
    shop.write_text(TIMED.format(hours=1), encoding="utf-8")
    served: list[Application] = []
    monkeypatch.setattr(serve, "run_server", lambda _, app, *__, **___: served.append(app))
    live = LiveFactoryRequest(port=0, host_names=("planner.shop",))
    serve.serve_shop(shop, live)
    require_guarded(served[0])
