"""Two hosts whose files are in a bucket that is reached over a network, which goes away."""

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from tests.postgres import ServerMaker, new_server
from tests.service.object_store import BUCKET, Gate, object_store
from tests.service.rest.samples import SAMPLE
from tests.service.rest.server import Server, is_problem, made, over
from tests.service.waiting import until

__all__ = ["new_server"]

DATA = SAMPLE.read_bytes()
REVIEWS = 6


@pytest.fixture
def gate(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Gate]:
    with object_store(tmp_path) as found:
        monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://127.0.0.1:{found.port}")
        monkeypatch.setenv("AWS_ACCESS_KEY_ID", "test")
        monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "test")
        monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
        yield found


def succeeded(client: httpx.Client, id: str) -> str:
    job = over(client, id)
    assert job["state"] == "succeeded", job
    return str(job["result"])


def test_nothing_is_lost_when_a_host_is_killed_or_the_bucket_goes_away(
    new_server: ServerMaker, gate: Gate, tmp_path: Path
) -> None:
    words = ("--database", new_server().url, "--files", f"s3://{BUCKET}/stepnc")
    first, second = Server(tmp_path / "a", *words), Server(tmp_path / "b", *words)
    with first, second, first.client() as one, second.client() as other:
        program = made(one.post("/v1/programs", content=DATA), 201)
        assert other.get(f"/v1/programs/{program}/file").content == DATA
        advice = made(other.post(f"/v1/programs/{program}/advice", json={}))
        result = one.get(succeeded(one, advice)).content
        assert other.get(f"/v1/advice/{advice}").content == result

        # A host is killed while it uploads and runs jobs.
        reviews = [made(one.post("/v1/reviews", json={})) for _ in range(REVIEWS)]
        gate.passed.clear()
        until(gate.passed.is_set)
        first.kill()
        first.start()
        for id in reviews:
            succeeded(other, id)

        # The bucket is cut off from both, while jobs wait for it.
        reviews = [made(one.post("/v1/reviews", json={})) for _ in range(REVIEWS)]
        gate.close()
        once = {"idempotency-key": "once"}
        for client in (one, other):
            refused = client.post("/v1/programs", content=DATA, headers=once)
            found = is_problem(refused, 503, "unavailable")
            assert int(refused.headers["retry-after"]) > 0
            assert BUCKET not in str(found)
            assert client.get("/healthz").status_code == 200
            assert client.get(f"/v1/programs/{program}").status_code == 200
        gate.open()
        again = made(one.post("/v1/programs", content=DATA, headers=once), 201)
        assert made(other.post("/v1/programs", content=DATA, headers=once), 201) == again
        for id in reviews:
            path = succeeded(one, id)
            assert one.get(path).json() == other.get(path).json()
        assert one.get(f"/v1/programs/{again}/file").content == DATA
        listed = [each["id"] for each in one.get("/v1/programs").json()["items"]]
        assert listed == [again, program]
        assert first.faults() + second.faults() == ""
