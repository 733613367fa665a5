"""What every request goes through: names, origins, keys, bodies that are too large or slow."""

import asyncio
import socket
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from service.rest.app import BY_KIND, application
from service.rest.rights import is_protected
from service.rest.settings import Settings
from service.storage import keys
from service.storage.folder import open_data_folder
from tests.every_case import every_case
from tests.service.rest.conftest import Done
from tests.service.rest.server import Server, create_key, is_problem, made, over

WANTED = {
    "x-content-type-options": "nosniff",
    "cross-origin-resource-policy": "same-origin",
}
OF_PAGES = {
    "referrer-policy": "no-referrer",
    "x-frame-options": "DENY",
    "cross-origin-opener-policy": "same-origin",
}

ID = "0" * 26


@every_case(
    ("method", "path"),
    [
        ("GET", "/healthz"), ("GET", "/"), ("GET", "/dashboard/plan.html"), ("GET", "/metrics"),
        ("GET", "/dashboard/none"), ("GET", "/none"), ("PATCH", "/v1/jobs"),
        ("GET", f"/v1/jobs/{ID}"), ("GET", "/v1/jobs/x"), ("POST", "/v1/trials"),
        ("POST", "/v1/programs"), ("GET", "/v1/openapi.json"), ("DELETE", f"/v1/jobs/{ID}"),
        ("GET", f"/v1/trials/{ID}/events"), ("OPTIONS", "/v1/programs"), ("HEAD", "/healthz"),
    ],
)  # fmt: skip
def test_every_answer_protects_the_browser(
    client: httpx.Client, method: str, path: str
) -> None:
    answer = client.request(method, path, content=b"{" if method == "POST" else None)
    assert WANTED.items() <= dict(answer.headers).items()
    policy = answer.headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "unsafe-inline" not in policy.partition("style-src")[0]
    if answer.headers.get("content-type", "").startswith("text/html"):
        assert OF_PAGES.items() <= dict(answer.headers).items()
        assert "script-src 'self';" in policy
    else:
        assert "script-src" not in policy
    assert answer.headers["x-request-id"]
    assert "server" not in answer.headers
    assert "access-control-allow-origin" not in answer.headers


@pytest.mark.parametrize("path", ["/dashboard/plan.html", "/dashboard/app.js", "/v1/machines"])
def test_what_the_browser_has_already_keeps_its_policy(client: httpx.Client, path: str) -> None:
    """Headers of a 304 replace those that were kept: a page would lose its scripts."""
    first = client.get(path)
    again = client.get(path, headers={"if-none-match": first.headers["etag"]})
    assert again.status_code == 304
    policy = "content-security-policy"
    assert {**first.headers, **again.headers}[policy] == first.headers[policy]
    assert again.headers["x-request-id"]


def test_a_stream_protects_the_browser_too(client: httpx.Client, done: Done) -> None:
    with client.stream("GET", f"/v1/trials/{done.trial}/events") as answer:
        assert WANTED.items() <= dict(answer.headers).items()
        assert answer.headers["content-type"].startswith("text/event-stream")
        assert answer.headers["cache-control"] == "no-store"


def test_a_request_keeps_its_id_unless_it_is_none(client: httpx.Client) -> None:
    answer = client.get("/healthz", headers={"x-request-id": "a.B-9_z"})
    assert answer.headers["x-request-id"] == "a.B-9_z"
    found = is_problem(client.get("/v1/jobs/x", headers={"x-request-id": "mine"}), 422)
    assert found["instance"] == "mine"
    for bad in ("a b", "x" * 65, "<script>", '"'):
        assert client.get("/healthz", headers={"x-request-id": bad}).headers[
            "x-request-id"
        ] not in {bad, ""}
    ids = {client.get("/healthz").headers["x-request-id"] for _ in range(5)}
    assert len(ids) == 5


@every_case(
    "host",
    [
        "evil.example",
        "[::1]evil",
        "localhost:80:80",
        "localhost/",
        "127.0.0.1.evil.example",
        "",
        "[::2]:80",
        "a@127.0.0.1",
        "0.0.0.0",
        "127.0.0.1:99999999",
        "localhost:0",
        "[127.0.0.1]",
    ],
)
def test_a_name_that_is_not_ours_is_refused(client: httpx.Client, host: str) -> None:
    for method in ("GET", "POST"):
        answer = client.request(method, "/v1/programs", headers={"host": host})
        assert answer.status_code in {400, 403}
        assert WANTED.items() <= dict(answer.headers).items() or answer.status_code == 400


@pytest.mark.parametrize("host", ["localhost", "LOCALHOST:99", "127.0.0.1:1", "[::1]:80"])
def test_names_of_this_computer_are_ours(client: httpx.Client, host: str) -> None:
    assert client.get("/v1/programs", headers={"host": host}).status_code == 200


@every_case(
    "headers",
    [
        {"origin": "https://evil.example"},
        {"origin": "null"},
        {"origin": "http://localhost.evil.example"},
        {"origin": "http://127.0.0.1:1"},
        {"sec-fetch-site": "cross-site"},
        {"sec-fetch-site": "same-site"},
        {"sec-fetch-site": "cross-site", "origin": "http://127.0.0.1"},
    ],
)
def test_a_page_of_another_site_changes_nothing(
    client: httpx.Client, headers: dict[str, str]
) -> None:
    for method, path in (
        ("POST", "/v1/trials"), ("DELETE", f"/v1/jobs/{ID}"), ("PUT", "/v1/machines/x"),
    ):  # fmt: skip
        found = is_problem(client.request(method, path, headers=headers), 403, "forbidden")
        assert "page of" in found["detail"]


def test_a_page_of_ours_may(client: httpx.Client, service: Server) -> None:
    headers = {"origin": service.url, "sec-fetch-site": "same-origin"}
    is_problem(client.delete(f"/v1/jobs/{ID}", headers=headers), 404)


def test_what_may_be_read_may_be_asked_about(client: httpx.Client) -> None:
    for path in ("/v1/machines", "/healthz", "/dashboard/plan.html", "/v1/openapi.json"):
        whole, head = client.get(path), client.head(path)
        assert (head.status_code, head.content) == (200, b"")
        for name in ("content-type", "content-length"):
            assert head.headers[name] == whole.headers[name]
    assert client.head("/v1/jobs/x").status_code == 422


def test_who_leaves_before_the_end_is_no_fault(service: Server, client: httpx.Client) -> None:
    for head in (
        b"PUT /v1/machines/gone HTTP/1.1\r\nContent-Type: application/toml\r\n",
        b"POST /v1/programs HTTP/1.1\r\n",
        b"POST /v1/trials HTTP/1.1\r\nContent-Type: application/json\r\n",
    ):
        with socket.create_connection(("127.0.0.1", service.port), timeout=120.0) as line:
            line.sendall(head + b"Host: localhost\r\nContent-Length: 100\r\n\r\nhello")
    assert client.get("/healthz").status_code == 200
    assert service.faults() == ""
    assert 'status="500"' not in client.get("/metrics").text


def test_a_body_of_json_has_a_bound_told_or_not(client: httpx.Client) -> None:
    large = b'{"pace": 1.0' + b" " * (1 << 20) + b"}"

    def chunks() -> Iterator[bytes]:
        for begin in range(0, len(large), 65_536):
            yield large[begin : begin + 65_536]

    headers = {"content-type": "application/json"}
    for content in (large, chunks()):
        found = is_problem(client.post("/v1/trials", content=content, headers=headers), 413)
        assert found["bound"] == 1 << 20


def test_a_length_that_is_a_lie_or_none_harms_nobody(
    service: Server, client: httpx.Client
) -> None:
    for length in ("-1", "x", "9" * 30, "+5"):
        with socket.create_connection(("127.0.0.1", service.port), timeout=120.0) as line:
            line.sendall(
                b"POST /v1/trials HTTP/1.1\r\nHost: localhost\r\n"
                b"Content-Length: " + length.encode() + b"\r\n\r\n{}"
            )
            assert line.recv(65_536).split(b" ", 2)[1] in {b"400", b"413"}
    assert client.get("/healthz").status_code == 200


def asked(
    app: Any, *, path: str, chunks: list[bytes], method: str = "POST"
) -> tuple[int, bytes]:
    """An answer of an application to a body of which nothing more comes."""
    left = list(chunks)
    told: list[dict[str, Any]] = []

    async def receive() -> dict[str, Any]:
        if left:
            return {"type": "http.request", "body": left.pop(0), "more_body": True}
        await asyncio.Event().wait()
        raise AssertionError

    async def send(message: dict[str, Any]) -> None:
        told.append(message)

    scope = {
        "type": "http", "asgi": {"version": "3.0"}, "http_version": "1.1", "method": method,
        "path": path, "raw_path": path.encode(), "query_string": b"", "scheme": "http",
        "headers": [(b"host", b"localhost"), (b"content-type", b"application/json"),
                    (b"transfer-encoding", b"chunked")],
        "client": ("127.0.0.1", 1), "server": ("127.0.0.1", 80), "root_path": "",
    }  # fmt: skip
    asyncio.run(asyncio.wait_for(app(scope, receive, send), 20.0))
    body = b"".join(each.get("body", b"") for each in told[1:])
    return int(told[0]["status"]), body


def test_a_body_that_does_not_arrive_is_not_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("STEPNC_KB", raising=False)
    app = application(Settings(data=str(tmp_path), body_s=0.2))
    for path in ("/v1/programs", "/v1/trials"):
        status, body = asked(app, path=path, chunks=[b"ISO", b"-10303"])
        assert status in {400, 408}
        assert b"did not arrive within 0.2 s" in body


@pytest.fixture(scope="session")
def locked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server that asks for keys."""
    server = Server(tmp_path_factory.mktemp("locked"), "--keys")
    server.data.mkdir(parents=True)
    create_key(server, "Anna", "planner")
    with server:
        yield server
        assert server.faults() == ""


def test_every_route_needs_a_key_and_the_role_of_the_table(locked: Server) -> None:
    words = {role: create_key(locked, role, role) for role in ("viewer", "planner", "operator")}
    with locked.client() as nobody, locked.client(words["planner"]) as planner:
        assert nobody.get("/healthz").status_code == 200
        assert nobody.get("/readyz").status_code == 200
        assert nobody.get("/dashboard/plan.html").status_code == 200
        is_problem(nobody.get("/metrics"), 401)
        document = planner.get("/v1/openapi.json").json()
    routes = [
        (method.upper(), path, operation)
        for path, methods in document["paths"].items()
        for method, operation in methods.items()
        if is_protected(path)
    ]
    assert len(routes) > 50
    opened = {"viewer": {"viewer"}, "planner": {"viewer", "planner"},
              "operator": {"viewer", "operator"}}  # fmt: skip
    with locked.client() as client:
        for method, path, operation in routes:
            role = operation["x-role"]
            assert operation["security"] == [{"key": []}]
            filled = path.replace("{id}", ID).replace("{number}", "1")
            filled = filled.replace("{name}", "x").replace("{run}", "x")
            filled = filled.replace("{workingstep}", "x")
            refused = client.request(method, filled)
            is_problem(refused, 401, "unauthorised")
            assert refused.headers["www-authenticate"] == "Bearer"
            for who, key in words.items():
                answer = client.request(
                    method, filled, headers={"authorization": f"Bearer {key}"}
                )
                if role in {BY_KIND, *opened[who]}:
                    assert answer.status_code not in {401, 403}, (method, path, who)
                else:
                    found = is_problem(answer, 403, "forbidden")
                    assert role in found["detail"]


def test_a_run_with_people_is_ended_by_operators_alone(locked: Server) -> None:
    words = {role: create_key(locked, role, role) for role in ("planner", "operator")}
    with locked.client(words["planner"]) as planner, locked.client(words["operator"]) as other:
        trial = made(other.post("/v1/trials", json={}))
        table = made(planner.post("/v1/evaluations", json={}))
        for path in (f"/v1/jobs/{trial}/cancel", f"/v1/trials/{trial}/cancel"):
            is_problem(planner.post(path), 403, "forbidden")
        is_problem(other.post(f"/v1/jobs/{table}/cancel"), 403, "forbidden")
        is_problem(other.delete(f"/v1/jobs/{table}"), 403, "forbidden")
        assert other.post(f"/v1/jobs/{trial}/cancel").status_code == 200
        over(other, trial)
        is_problem(planner.delete(f"/v1/jobs/{trial}"), 403, "forbidden")
        assert other.delete(f"/v1/jobs/{trial}").status_code == 204


@every_case(
    "word", ["", "Bearer", "Bearer x", "Basic Zm9v", "Bearer stepnc_x_y", "Bearer ä" * 50]
)
def test_what_is_no_key_opens_nothing(locked: Server, word: str) -> None:
    with locked.client() as client:
        headers = [(b"authorization", word.encode("latin-1"))]
        is_problem(client.get("/v1/programs", headers=headers), 401)


def test_a_revoked_key_opens_nothing(locked: Server) -> None:
    word = create_key(locked, "Bert")
    keys.revoke(open_data_folder(locked.data), word.split("_")[1])
    with locked.client(word) as client:
        is_problem(client.get("/v1/programs"), 401)


def test_a_revoked_key_ends_what_it_watches(locked: Server) -> None:
    operator = create_key(locked, "Bert", "operator")
    viewer = create_key(locked, "Carl")
    with locked.client(operator) as client, locked.client(viewer) as watching:
        id = made(client.post("/v1/trials", json={}))
        with watching.stream("GET", f"/v1/trials/{id}/events") as answer:
            lines = answer.iter_lines()
            next(line for line in lines if line == "event: rows")
            keys.revoke(open_data_folder(locked.data), viewer.split("_")[1])
            until = time.monotonic() + 20.0
            for _ in lines:
                assert time.monotonic() < until
        assert client.post(f"/v1/trials/{id}/cancel").status_code == 200


def test_the_owner_is_who_has_the_key(locked: Server) -> None:
    with locked.client(create_key(locked, "Ümit", "planner")) as client:
        assert client.post("/v1/programs?example=paper002").json()["owner"] == "Ümit"
        assert client.get("/v1/about").json()["owner"] == "Ümit"
        assert client.get("/v1/about").json()["needs_keys"]


def test_a_second_authorization_is_refused(client: httpx.Client) -> None:
    words = [("authorization", "Bearer x"), ("authorization", "Bearer y")]
    answer = client.get("/v1/jobs", headers=words)
    assert answer.status_code == 400
    assert "Authorization is given more than once" in answer.json()["detail"]


def test_a_second_host_is_refused(client: httpx.Client) -> None:
    name = client.base_url.netloc.decode()
    with socket.create_connection((client.base_url.host, client.base_url.port or 80)) as line:
        line.sendall(f"GET /v1/jobs HTTP/1.1\r\nHost: {name}\r\nHost: {name}\r\n\r\n".encode())
        assert line.recv(100).startswith(b"HTTP/1.1 400")


def test_the_host_of_an_absolute_target_counts(client: httpx.Client) -> None:
    """RFC 9112, 3.2.2: who checks the header would be told a name that was not asked for."""
    own = client.base_url.netloc.decode()
    for target, host, status in (
        ("http://evil.example/v1/jobs", own, 403),
        (f"http://{own}/v1/jobs", own, 200),
        (f"http://{own}/v1/jobs", "evil.example", 200),
    ):
        with socket.create_connection((
            client.base_url.host,
            client.base_url.port or 80,
        )) as line:
            line.sendall(f"GET {target} HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())
            assert line.recv(100).startswith(f"HTTP/1.1 {status}".encode()), target
