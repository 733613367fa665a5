"""``/v1/programs``: bytes as they came, within their bounds, however they are packed."""

import asyncio
import gzip
import hashlib
import json
import zlib
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from service.rest.app import application
from service.rest.settings import Settings
from service.storage import programs
from service.verbs.check.request import CheckFiles, CheckRequest
from service.verbs.check.run import run as check
from service.verbs.result import Result
from tests.every_case import every_case
from tests.service.rest.conftest import Done
from tests.service.rest.samples import SAMPLE
from tests.service.rest.server import Server, is_problem, made
from tests.service.waiting import rss_mib

DATA = SAMPLE.read_bytes()
MIB = 1 << 20


def test_a_program_comes_back_byte_for_byte(client: httpx.Client) -> None:
    answer = client.post("/v1/programs", params={"name": "../a b/ü\r\n.stp"}, content=DATA)
    id = made(answer, 201)
    assert answer.headers["location"] == f"/v1/programs/{id}"
    assert answer.json()["name"] == "ü.stp"
    assert client.get(f"/v1/programs/{id}").json() == answer.json()
    file = client.get(f"/v1/programs/{id}/file")
    assert (file.content, file.headers["content-type"]) == (DATA, "application/step")
    assert "filename*=UTF-8''%C3%BC.stp" in file.headers["content-disposition"]
    findings = client.get(f"/v1/programs/{id}/findings").json()
    assert findings["is_usable"]
    assert [step["id"] for step in findings["workingsteps"]] == ["ROUGH THE FACE"]
    assert client.delete(f"/v1/programs/{id}").status_code == 204
    is_problem(client.get(f"/v1/programs/{id}"), 404, "not-found")
    is_problem(client.get(f"/v1/programs/{id}/file"), 404)
    is_problem(client.get(f"/v1/programs/{id}/findings"), 404)
    is_problem(client.get(f"/v1/programs/{id}/advice"), 404)
    is_problem(client.delete(f"/v1/programs/{id}"), 404)


def test_findings_of_a_program_without_an_instance_are_no_error_of_the_server(
    client: httpx.Client,
) -> None:
    for id in (b"#50", b"#13", b"#10"):
        damaged = DATA.replace(id + b"=", b"#999=")
        program = made(client.post("/v1/programs", content=damaged), 201)
        answer = client.get(f"/v1/programs/{program}/findings")
        assert answer.status_code in {200, 422}, answer.text
        assert f"{id.decode()} does not exist in this file" in answer.text


def test_a_sample_needs_no_body(client: httpx.Client) -> None:
    answer = client.post("/v1/programs?example=shaft")
    assert answer.status_code == 201
    assert answer.json()["name"] == "shaft.stpnc"
    for name in ("../parts/shaft", "/etc/passwd", "none", "shaft.stpnc", "shaft\0"):
        is_problem(client.post("/v1/programs", params={"example": name}), 400)


@pytest.mark.parametrize(
    ("body", "status", "kind"),
    [
        (b"", 400, "unreadable"),
        (b"\0" * 1000, 422, "part21-error"),
        (b"%PDF-1.7", 422, "part21-error"),
        (b"ISO-10303-21;\nHEADER;", 422, "part21-error"),
    ],
)
def test_what_is_no_program_is_refused(
    client: httpx.Client, body: bytes, status: int, kind: str
) -> None:
    found = is_problem(client.post("/v1/programs", content=body), status, kind)
    if status == 422:
        assert found["line"] >= 1
        assert found["column"] >= 1


def test_a_packed_program_is_unpacked(client: httpx.Client) -> None:
    packed = gzip.compress(DATA)
    answer = client.post("/v1/programs", content=packed, headers={"content-encoding": "gzip"})
    id = made(answer, 201)
    assert client.get(f"/v1/programs/{id}/file").content == DATA


@every_case(
    ("encoding", "body"),
    [
        ("gzip", DATA),
        ("gzip", gzip.compress(DATA)[:-20]),
        ("gzip", gzip.compress(DATA)[:5]),
        ("gzip", gzip.compress(DATA) + b"more behind its end"),
        ("gzip", gzip.compress(DATA) + gzip.compress(DATA)),
        ("gzip", zlib.compress(DATA)),
        ("deflate", zlib.compress(DATA)),
        ("br", DATA),
        ("gzip, gzip", gzip.compress(gzip.compress(DATA))),
    ],
)
def test_what_is_packed_otherwise_is_refused(
    client: httpx.Client, encoding: str, body: bytes
) -> None:
    headers = {"content-encoding": encoding}
    is_problem(client.post("/v1/programs", content=body, headers=headers), 400, "unreadable")


def test_a_bomb_is_refused_in_little_memory(service: Server, client: httpx.Client) -> None:
    packer = zlib.compressobj(9, wbits=31)
    chunk = b"\0" * MIB
    bomb = b"".join(packer.compress(chunk) for _ in range(1024)) + packer.flush()
    assert len(bomb) < 2 * MIB
    before = rss_mib(service.pid)
    headers = {"content-encoding": "gzip"}
    for _ in range(5):
        is_problem(client.post("/v1/programs", content=bomb, headers=headers), 413)
    assert rss_mib(service.pid) < before + 60.0


@pytest.mark.parametrize("unit", [b"#1=", b"/*", b"/", b"#1=A(/*"])
def test_packed_faults_without_end_are_refused_in_little_memory(
    service: Server, client: httpx.Client, unit: bytes
) -> None:
    text = b"ISO-10303-21;\nDATA;\n" + unit * (3 * MIB // len(unit))
    before = rss_mib(service.pid)
    headers = {"content-encoding": "gzip"}
    answer = client.post("/v1/programs", content=gzip.compress(text), headers=headers)
    if unit == b"/":
        assert answer.status_code == 201
    else:
        assert is_problem(answer, 422, "part21-error")["line"] == 3
    assert rss_mib(service.pid) < before + 100.0


def test_a_program_has_a_bound_told_or_not(client: httpx.Client) -> None:
    large = DATA + b" " * (4 * MIB)

    def chunks() -> Iterator[bytes]:
        for begin in range(0, len(large), 65_536):
            yield large[begin : begin + 65_536]

    for content in (large, chunks()):
        found = is_problem(client.post("/v1/programs", content=content), 413, "too-large")
        assert found["bound"] == 4 * MIB
    assert client.get("/healthz").status_code == 200


def test_findings_are_tagged_by_what_the_program_is(client: httpx.Client, done: Done) -> None:
    path = f"/v1/programs/{done.program}/findings"
    tag = client.get(path).headers["etag"]
    again = client.get(path, headers={"if-none-match": tag})
    assert (again.status_code, again.content) == (304, b"")
    other = client.get(f"{path}?units=part21")
    assert other.status_code in {200, 422}
    assert other.headers.get("etag") != tag


def test_the_bytes_are_tagged_by_what_they_are(client: httpx.Client, done: Done) -> None:
    path = f"/v1/programs/{done.program}/file"
    tag = client.get(path).headers["etag"]
    assert tag == f'"{hashlib.sha256(DATA).hexdigest()}"'
    again = client.get(path, headers={"if-none-match": tag})
    assert (again.status_code, again.content) == (304, b"")


def test_who_has_the_findings_needs_no_check(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    checks: list[str] = []

    def counted(request: CheckRequest, files: CheckFiles) -> Result:
        checks.append(request.units)
        return check(request, files)

    monkeypatch.setattr("service.rest.programs.check", counted)
    app = application(Settings(data=str(tmp_path)))
    id = programs.add(app.state.data_folder, DATA, name="a", owner="a").id
    path = f"/v1/programs/{id}/findings"

    async def asked() -> None:
        transport = httpx.ASGITransport(app)
        async with httpx.AsyncClient(
            transport=transport, base_url="http://127.0.0.1"
        ) as client:
            tag = f'"{hashlib.sha256(DATA).hexdigest()[:24]}-iso"'
            known = await client.get(path, headers={"if-none-match": tag})
            assert (known.status_code, known.headers["etag"], checks) == (304, tag, [])
            answers = await asyncio.gather(*(client.get(path) for _ in range(3)))
            assert {each.content for each in answers} == {(await client.get(path)).content}
            assert len(checks) <= 2
            before = len(checks)
            await client.get(path)
            await client.get(f"{path}?units=rpm-mmin")
            assert checks[before:] == ["rpm-mmin"]

    asyncio.run(asked())


def test_a_program_whose_bytes_are_gone_is_not_found_anywhere(
    service: Server, client: httpx.Client
) -> None:
    id = made(client.post("/v1/programs", content=DATA), 201)
    assert client.get(f"/v1/programs/{id}/findings").status_code == 200
    (service.data / "programs" / f"{id}.stpnc").unlink()
    run = {"program_id": id}
    details = {
        is_problem(answer, 404, "not-found")["detail"]
        for answer in (
            client.get(f"/v1/programs/{id}/file"),
            client.get(f"/v1/programs/{id}/findings"),
            client.post(f"/v1/programs/{id}/advice", json={}),
            client.post("/v1/simulations", json=run),
            client.post("/v1/control-runs", json=run),
        )
    }
    assert details == {f"there is no file of program '{id}'"}
    assert client.delete(f"/v1/programs/{id}").status_code == 204


def test_an_upload_whose_program_was_deleted_is_not_made_again(client: httpx.Client) -> None:
    headers = {"idempotency-key": "upload-2"}
    id = made(client.post("/v1/programs", content=DATA, headers=headers), 201)
    client.delete(f"/v1/programs/{id}")
    answer = client.post("/v1/programs", content=DATA, headers=headers)
    assert "was deleted" in is_problem(answer, 409, "conflict")["detail"]


def test_pages_show_each_program_once(client: httpx.Client) -> None:
    ids = [made(client.post("/v1/programs", content=DATA), 201) for _ in range(5)]
    seen: list[str] = []
    cursor = ""
    while True:
        query = {"limit": "2", **({"cursor": cursor} if cursor else {})}
        page = client.get("/v1/programs", params=query).json()
        seen += [each["id"] for each in page["items"]]
        made(client.post("/v1/programs", content=DATA), 201)
        cursor = page["next_cursor"]
        if not cursor or set(ids) <= set(seen):
            break
    assert set(ids) <= set(seen)
    assert len(seen) == len(set(seen))
    assert seen == sorted(seen, reverse=True)
    is_problem(client.get("/v1/programs?cursor=../x"), 400)
    for limit in ("0", "-1", "501", "x", "1e3"):
        is_problem(client.get(f"/v1/programs?limit={limit}"), 422)


def test_an_upload_with_a_key_is_made_once(client: httpx.Client) -> None:
    headers = {"idempotency-key": "upload-1"}
    ids = {
        made(client.post("/v1/programs?name=a", content=DATA, headers=headers), 201)
        for _ in range(3)
    }
    assert len(ids) == 1
    is_problem(
        client.post("/v1/programs?name=a", content=DATA + b"\n", headers=headers),
        409,
        "conflict",
    )
    is_problem(client.post("/v1/programs?name=b", content=DATA, headers=headers), 409)
    for bad in ("", "x" * 129):
        answer = client.post("/v1/programs", content=DATA, headers={"idempotency-key": bad})
        assert answer.status_code in {400, 422}


def test_advice_is_asked_for_once_by_key(client: httpx.Client, done: Done) -> None:
    path, headers = f"/v1/programs/{done.program}/advice", {"idempotency-key": "advice-1"}
    ids = {made(client.post(path, json={"mode": "QC"}, headers=headers)) for _ in range(2)}
    assert len(ids) == 1
    is_problem(client.post(path, json={"mode": "TC"}, headers=headers), 409)
    listed = client.get(path).json()["items"]
    assert ids | {done.advice} <= {job["id"] for job in listed}
    is_problem(client.delete(f"/v1/programs/{done.program}"), 409)
    client.post(f"/v1/jobs/{ids.pop()}/cancel")


@pytest.mark.parametrize(
    ("body", "detail"),
    [
        ({"workingsteps": ["NOPE"]}, "no workingstep 'NOPE'; known: 'ROUGH THE FACE'"),
        ({"machine": "lathe22"}, "needs a mill, and 'lathe22' is a lathe"),
    ],
)
def test_what_no_job_could_do_is_refused_before_there_is_one(
    client: httpx.Client, done: Done, body: dict[str, object], detail: str
) -> None:
    path = f"/v1/programs/{done.program}/advice"
    # Jobs of other tests may end meanwhile.
    before = [each["id"] for each in client.get(path).json()["items"]]
    found = is_problem(client.post(path, json=body), 422)
    assert detail in found["detail"]
    assert [each["id"] for each in client.get(path).json()["items"]] == before
    if "machine" in body:
        asked = {"program_id": done.program, **body}
        for path in ("/v1/simulations", "/v1/control-runs"):
            found = is_problem(client.post(path, json=asked), 422)
            assert detail in found["detail"]


def test_numbers_beyond_json_are_refused(client: httpx.Client, done: Done) -> None:
    path = f"/v1/programs/{done.program}/advice"
    headers = {"content-type": "application/json"}
    for text in (
        '{"roughness_um": NaN}', '{"roughness_um": 1e999}', '{"safety": -Infinity}',
        '{"tool_change_s": ' + "9" * 5000 + "}", "[" * 100_000, '{"mode": "TC"', "null", "[]",
        '{"\\ud800": 1}', '{"machine": "\\ud800"}', "{'mode': 'TC'}",
    ):  # fmt: skip
        answer = client.post(path, content=text.encode(), headers=headers)
        assert answer.status_code in {400, 422}, text[:40]
        is_problem(answer, answer.status_code)
    answer = client.post(path, content=b'\xff\xfe{"mode": "TC"}', headers=headers)
    is_problem(answer, answer.status_code)
    assert json.loads(answer.content)["status"] in {400, 422}
