"""``/v1/files``: logs, tool tables and required parts, checked before they are stored."""

import gzip
from collections.abc import Iterator

import httpx
import pytest

from service.rest.files import FileView
from tests.every_case import every_case
from tests.service.rest.server import Server, is_problem, made
from tests.service.waiting import rss_mib

MIB = 1 << 20
LOG = b"time_s,x_axis_position_actual,z_axis_position_actual\n0,1,2\n"
TOOLS = b'[[tool]]\nnumber = 4\nkind = "endmill"\ndiameter_mm = 10\n'
PART = b"solid a\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendsolid\n"


@pytest.mark.parametrize(
    ("kind", "name", "body"),
    [
        ("log", "../run 1.csv", LOG),
        ("tools", "measured.toml", TOOLS),
        ("required-part", "part.STL", PART),
        ("stock", "raw.stl", PART),
        ("stock", "raw.step", b"ISO-10303-21;\n"),
    ],
)
def test_a_file_comes_back_byte_for_byte(
    client: httpx.Client, kind: str, name: str, body: bytes
) -> None:
    answer = client.post("/v1/files", params={"kind": kind, "name": name}, content=body)
    id = made(answer, 201)
    assert answer.headers["location"] == f"/v1/files/{id}"
    shown = client.get(f"/v1/files/{id}").json()
    assert FileView.model_validate(shown).model_dump(mode="json") == answer.json() == shown
    assert (shown["name"], shown["kind"]) == (name.removeprefix("../"), kind)
    content = client.get(f"/v1/files/{id}/content")
    assert content.content == body
    assert "attachment" in content.headers["content-disposition"]
    assert id in {each["id"] for each in client.get(f"/v1/files?kind={kind}").json()["items"]}
    assert client.delete(f"/v1/files/{id}").status_code == 204
    for path in ("", "/content"):
        is_problem(client.get(f"/v1/files/{id}{path}"), 404, "not-found")
    is_problem(client.delete(f"/v1/files/{id}"), 404)


@every_case(
    ("kind", "name", "body", "refusal"),
    [
        ("log", "run.csv", b"", (400, "the body is empty")),
        ("log", "run.exe", LOG, (400, "ends in .csv")),
        ("log", "run.csv", b"a,b\n1,2\n", (422, "no column time_s")),
        ("log", "run.parquet", LOG, (422, "cannot be read")),
        ("log", "run.xml", b"<a/>", (422, "root element a")),
        ("log", "run.shdr", LOG, (422, "no line of SHDR")),
        ("tools", "tools.toml", b"[[tool]]\nnumber = 0\n", (422, "tools.toml")),
        ("tools", "tools.toml", b"#" * (1 << 21), (413, "larger than")),
        ("required-part", "part.stl", b"no part", (422, "no triangles")),
        ("stock", "raw.step", b"no part", (422, "STL or STEP")),
        ("stock", "raw.obj", PART, (400, "ends in .step")),
        ("picture", "a.png", b"x", (422, "kind")),
    ],
)
def test_what_is_no_such_file_is_refused_and_not_stored(
    service: Server,
    client: httpx.Client,
    kind: str,
    name: str,
    body: bytes,
    refusal: tuple[int, str],
) -> None:
    status, detail = refusal
    before = sorted((service.data / "files").iterdir())
    answer = client.post("/v1/files", params={"kind": kind, "name": name}, content=body)
    found = is_problem(answer, status)
    assert detail in found["detail"]
    assert str(service.data) not in answer.text
    assert sorted((service.data / "files").iterdir()) == before


def test_a_name_is_needed(client: httpx.Client) -> None:
    is_problem(client.post("/v1/files", content=LOG), 422)


def test_a_packed_file_is_unpacked_within_the_bound(
    service: Server, client: httpx.Client
) -> None:
    headers = {"content-encoding": "gzip"}
    path = "/v1/files?name=run.csv"
    id = made(client.post(path, content=gzip.compress(LOG), headers=headers), 201)
    assert client.get(f"/v1/files/{id}/content").content == LOG
    assert client.get(f"/v1/files/{id}").json()["size_bytes"] == len(LOG)
    broken = gzip.compress(LOG)[:-9]
    is_problem(client.post(path, content=broken, headers=headers), 400, "unreadable")
    before = rss_mib(service.pid)
    bomb = gzip.compress(LOG + b"\n" * (256 * MIB))
    found = is_problem(client.post(path, content=bomb, headers=headers), 413, "too-large")
    assert found["bound"] == 4 * MIB
    assert rss_mib(service.pid) < before + 60.0


def test_a_file_has_the_bound_of_programs_told_or_not(client: httpx.Client) -> None:
    large = LOG + b"1,1,1\n" * (MIB)

    def chunks() -> Iterator[bytes]:
        for begin in range(0, len(large), 65_536):
            yield large[begin : begin + 65_536]

    for content in (large, chunks()):
        is_problem(client.post("/v1/files?name=run.csv", content=content), 413, "too-large")


def test_an_upload_with_a_key_is_made_once(client: httpx.Client) -> None:
    headers = {"idempotency-key": "file-1"}
    path = "/v1/files?name=run.csv"
    ids = {made(client.post(path, content=LOG, headers=headers), 201) for _ in range(3)}
    assert len(ids) == 1
    other = client.post(path, content=LOG + b"1,2,3\n", headers=headers)
    is_problem(other, 409, "conflict")
    client.delete(f"/v1/files/{ids.pop()}")
    gone = is_problem(client.post(path, content=LOG, headers=headers), 409)
    assert "was deleted" in gone["detail"]


def test_pages_go_on_where_they_ended(client: httpx.Client) -> None:
    ids = [made(client.post("/v1/files?name=a.csv", content=LOG), 201) for _ in range(3)]
    page = client.get("/v1/files?limit=2&kind=log").json()
    assert [each["id"] for each in page["items"]] == ids[:0:-1]
    after = client.get(f"/v1/files?limit=1&kind=log&cursor={page['next_cursor']}").json()
    assert after["items"][0]["id"] == ids[0]
