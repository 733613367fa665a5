"""Server-sent events: everybody gets the same, nobody waits for somebody else."""

import asyncio
import json
import socket
from collections.abc import AsyncGenerator
from contextlib import aclosing, suppress
from functools import partial
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from service.errors import TooMany
from service.live.journal import LiveFolder, append
from service.live.series import SeriesWriter
from service.rest import streams
from service.rest.streams import (
    END_OF_STREAM,
    ROWS,
    WAITING,
    RunReader,
    StreamClient,
    StreamHub,
    event,
)
from service.storage import jobs
from service.storage.folder import DataFolder, open_data_folder
from service.storage.jobs import Job, JobKind, JobRequest, JobState
from tests.service.rest.conftest import Done
from tests.service.rest.server import Server, made, over
from tests.service.waiting import rss_mib, until


def parsed(text: str) -> list[tuple[str, Any]]:
    """Events of a stream, comments aside."""
    found = []
    for block in text.split("\n\n"):
        lines = dict(line.split(": ", 1) for line in block.splitlines() if ": " in line)
        if "event" in lines:
            found.append((lines["event"], json.loads(lines["data"])))
    return found


@pytest.fixture
def data_folder(tmp_path: Path) -> DataFolder:
    return open_data_folder(tmp_path, knowledge="none.db")


@pytest.fixture
def job(data_folder: DataFolder) -> Job:
    """A trial that runs, as far as the database knows."""
    jobs.add(data_folder, JobRequest(kind=JobKind.TRIAL, request={}, owner="anna"))
    found = jobs.claim(data_folder, kinds=[JobKind.TRIAL])
    assert found is not None
    data_folder.job_folder(found.id).mkdir()
    return found


async def heard(hub: StreamHub, id: str, *, at_least: str) -> list[bytes]:
    """Messages until one of a kind has come."""
    found: list[bytes] = []
    watching = hub.watch(id)
    assert isinstance(watching, AsyncGenerator)
    async with asyncio.timeout(10.0), aclosing(watching):
        async for message in watching:
            found.append(message)
            if message.startswith(f"event: {at_least}\n".encode()):
                break
    return found


def test_rows_events_and_the_end_are_told(data_folder: DataFolder, job: Job) -> None:
    folder = LiveFolder(path=data_folder.job_folder(job.id))

    async def watch() -> list[bytes]:
        hub = StreamHub(data_folder)
        found = [message async for message in hub.watch(job.id)]
        assert hub._clients == 0
        await hub.close()
        return found

    async def work() -> list[bytes]:
        watching = asyncio.create_task(watch())
        await asyncio.sleep(0)
        with SeriesWriter(folder.series, ["time_s", "a"]) as series:
            folder.write_status({"time_s": 1.0})
            await asyncio.to_thread(until, lambda: True)
            series.add(np.array([[0.0, np.nan], [1.0, 2.0]]))
            append(folder.events, {"kind": "order", "text": "x"})
        jobs.finish(data_folder, job, JobState.SUCCEEDED)
        async with asyncio.timeout(10.0):
            return await watching

    told = parsed(b"".join(asyncio.run(work())).decode())
    kinds = [kind for kind, _ in told]
    assert kinds[-1] == "job"
    assert told[-1][1]["state"] == "succeeded"
    rows = [content["columns"] for kind, content in told if kind == "rows"]
    assert [time for each in rows for time in each["time_s"]] == [0.0, 1.0]
    assert [value for each in rows for value in each["a"]] == [None, 2.0]
    assert ("event", {"kind": "order", "text": "x"}) in told
    assert ("status", {"time_s": 1.0}) in told


def test_who_comes_late_is_told_how_it_is(data_folder: DataFolder, job: Job) -> None:
    folder = LiveFolder(path=data_folder.job_folder(job.id))
    folder.write_status({"time_s": 7.0})

    async def work() -> tuple[list[bytes], list[bytes], int]:
        hub = StreamHub(data_folder)
        first = asyncio.create_task(heard(hub, job.id, at_least="gone"))
        await heard(hub, job.id, at_least="job")
        early = len(hub._readers)
        late = await heard(hub, job.id, at_least="status")
        jobs.finish(data_folder, job, JobState.CANCELLED)
        return await first, late, early

    first, late, readers = asyncio.run(work())
    assert readers == 1
    assert event("status", {"time_s": 7.0}) in late
    assert b'"state":"cancelled"' in first[-1]


def test_a_job_that_is_deleted_ends_its_streams(data_folder: DataFolder, job: Job) -> None:
    async def work() -> None:
        hub = StreamHub(data_folder)
        watching = asyncio.create_task(heard(hub, job.id, at_least="gone"))
        await heard(hub, job.id, at_least="job")
        jobs.finish(data_folder, job, JobState.CANCELLED)
        jobs.remove(data_folder, job.id)
        await watching
        assert not hub._readers

    asyncio.run(work())


def test_a_fault_ends_the_streams_rather_than_let_all_wait(
    data_folder: DataFolder, job: Job
) -> None:
    async def work() -> None:
        hub = StreamHub(data_folder)
        watching = asyncio.create_task(heard(hub, job.id, at_least="gone"))
        await heard(hub, job.id, at_least="job")
        with data_folder.database.writing() as connection:
            connection.execute("DROP TABLE jobs")
        await watching
        assert hub._clients == 0

    asyncio.run(work())


def test_nobody_joins_a_reader_that_has_ended(data_folder: DataFolder, job: Job) -> None:
    async def work() -> None:
        hub = StreamHub(data_folder)
        await heard(hub, job.id, at_least="job")
        [reader] = [hub._readers[job.id]]
        reader.is_finished = True
        other = hub._joined(job.id, StreamClient(), partial(RunReader, data_folder, job.id))
        assert other is not reader
        await hub.close()

    asyncio.run(work())


def test_rows_of_another_attempt_are_told_from_its_beginning(
    data_folder: DataFolder, job: Job
) -> None:
    file = LiveFolder(path=data_folder.job_folder(job.id)).series
    reader = streams.RunReader(data_folder, job.id)
    with SeriesWriter(file, ["time_s"]) as series:
        series.add(np.arange(50.0).reshape(-1, 1))
    assert reader._rows() is not None
    assert reader._rows() is None
    with SeriesWriter(file, ["time_s"]) as series:
        series.add(np.arange(3.0).reshape(-1, 1))
    message = reader._rows()
    assert message is not None
    [(_, content)] = parsed(message.decode())
    assert content["columns"]["time_s"] == [0.0, 1.0, 2.0]


def test_many_rows_are_thinned_and_it_is_said(data_folder: DataFolder, job: Job) -> None:
    reader = streams.RunReader(data_folder, job.id)
    with SeriesWriter(
        LiveFolder(path=data_folder.job_folder(job.id)).series, ["time_s"]
    ) as series:
        series.add(np.arange(1000.0).reshape(-1, 1))
    message = reader._rows()
    assert message is not None
    [(_, content)] = parsed(message.decode())
    assert content["is_reduced"]
    assert len(content["columns"]["time_s"]) <= ROWS
    assert content["columns"]["time_s"][0] == 0.0
    assert content["columns"]["time_s"][-1] == 999.0


def queued(client: StreamClient) -> list[bytes]:
    found = []
    while not client.queue.empty():
        found.append(client.queue.get_nowait())
    return found


def test_who_cannot_follow_loses_messages_and_is_told_so() -> None:
    client = StreamClient()
    for number in range(3 * WAITING):
        client.give(b"%d" % number)
    assert client.queue.qsize() == WAITING
    first = [client.queue.get_nowait() for _ in range(WAITING)]
    assert first == [b"%d" % number for number in range(WAITING)]
    client.give(b"late")
    assert queued(client) == [event("gap", {}), b"late"]


@pytest.mark.parametrize("count", [0, 1, WAITING - 2, WAITING - 1, WAITING, 2 * WAITING])
def test_the_end_comes_to_everybody_and_a_loss_is_told_before_it(count: int) -> None:
    client = StreamClient()
    for number in range(count):
        client.give(b"%d" % number)
    client.end()
    found = queued(client)
    assert found[-1] == END_OF_STREAM
    told = [message for message in found if message not in {END_OF_STREAM, event("gap", {})}]
    assert (len(told) < count) == (event("gap", {}) in found) or count == WAITING


def test_one_client_more_than_can_watch_is_refused_before_anything_is_answered(
    data_folder: DataFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(streams, "MOST_CLIENTS", 0)
    hub = StreamHub(data_folder)
    with pytest.raises(TooMany):
        hub.require_room()


def test_a_trial_is_watched_to_its_end(client: httpx.Client) -> None:
    id = made(client.post("/v1/trials", json={"pace": 20.0}))
    is_ended = False
    with client.stream("GET", f"/v1/trials/{id}/events") as answer:
        text = ""
        for chunk in answer.iter_text():
            text += chunk
            told = parsed(text.rpartition("\n\n")[0])
            if not is_ended and sum(kind == "rows" for kind, _ in told) >= 3:
                ended = client.post(f"/v1/trials/{id}/changes", json={"end": True})
                is_ended = ended.status_code == 202
                assert is_ended
    told = parsed(text)
    assert text.startswith("retry: ")
    assert {"status", "rows", "job"} <= {kind for kind, _ in told}
    assert told[-1][0] == "job"
    assert told[-1][1]["state"] == "succeeded"
    times = [time for kind, content in told if kind == "rows"
             for time in content["columns"]["time_s"]]  # fmt: skip
    assert times == sorted(times)


def test_a_job_that_is_over_is_told_at_once(client: httpx.Client, done: Done) -> None:
    for path in (f"trials/{done.trial}", f"jobs/{done.simulation}"):
        told = parsed(client.get(f"/v1/{path}/events").text)
        assert [content["state"] for kind, content in told if kind == "job"] == ["succeeded"]


def stream_of(service: Server, id: str) -> socket.socket:
    """A client that has asked, and has not read yet."""
    line = socket.create_connection(("127.0.0.1", service.port), timeout=120.0)
    line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    line.sendall(
        f"GET /v1/trials/{id}/events HTTP/1.1\r\nHost: localhost\r\n\r\n".encode("ascii")
    )
    return line


def test_two_hundred_clients_are_told_and_one_that_never_reads_harms_nobody(
    service: Server, client: httpx.Client
) -> None:
    id = made(client.post("/v1/trials", json={"pace": 20.0}))
    until(lambda: client.get(f"/v1/trials/{id}/status").json() is not None)
    deaf = [stream_of(service, id) for _ in range(5)]
    lines = [stream_of(service, id) for _ in range(200)]
    before = rss_mib(service.pid)
    heard_of = dict.fromkeys(range(len(lines)), b"")

    def look() -> bool:
        for number, line in enumerate(lines):
            line.setblocking(False)
            with suppress(BlockingIOError):
                heard_of[number] = heard_of[number] + line.recv(65_536)
        return all(text.count(b"event: rows") >= 3 for text in heard_of.values())

    until(look)
    assert client.get("/healthz").elapsed.total_seconds() < 30.0
    assert rss_mib(service.pid) < before + 80.0
    for line in (*lines, *deaf):
        line.close()
    assert client.post(f"/v1/trials/{id}/cancel").status_code == 200
    assert over(client, id)["state"] == "cancelled"

    def is_empty() -> bool:
        return "stepnc_streams 0.0" in client.get("/metrics").text

    until(is_empty)
