"""Replies that all kinds of jobs share: result, rows of the run, and events."""

from collections.abc import AsyncIterator, Callable
from functools import partial
from math import inf
from pathlib import Path
from typing import Annotated, Any, ParamSpec, TypeVar

import numpy as np
from anyio import CapacityLimiter, to_thread
from fastapi import Query, Request, Response
from fastapi.responses import StreamingResponse
from starlette.concurrency import run_in_threadpool

from service.errors import Conflict, NotFound, Unreadable
from service.live.journal import LiveFolder, read_on
from service.live.series import TIME, Series, Window, open_series, window
from service.rest.context import data_folder_of, hub_of, page_reply
from service.rest.replies import json_reply, tag_of, tagged
from service.rest.storage_queries import answered
from service.rest.views import job_view
from service.storage import jobs
from service.storage.folder import DataFolder
from service.storage.jobs import Job, JobKind, JobState
from service.storage.pages import PageCursor
from service.storage.results import RESULT

SERIES_POINTS = 1000

SHOWN_EVENTS = 500
"""Most past events that are listed."""

EVENTS: dict[int | str, dict[str, Any]] = {
    200: {"content": {"text/event-stream": {}}, "description": "server-sent events"}
}
"""Response of a stream in the OpenAPI document."""

Begin = Annotated[float | None, Query(description="start time, s", allow_inf_nan=False)]
End = Annotated[float | None, Query(description="end time, s", allow_inf_nan=False)]
Points = Annotated[int, Query(ge=1, le=5000, description="most points in each signal")]
Signals = Annotated[
    str, Query(max_length=1000, description="comma-separated names; empty: all signals")
]


READERS = CapacityLimiter(2)
"""Limit of threads that read whole runs at once: each takes a processor and some 100 MB."""

P = ParamSpec("P")
T = TypeVar("T")


async def read_in_turn(read: Callable[P, T], *args: P.args, **words: P.kwargs) -> T:
    """Read rows in a thread, while few other threads do: memory and processors are shared."""
    return await to_thread.run_sync(partial(read, *args, **words), limiter=READERS)


async def result_reply(request: Request, id: str, kind: JobKind) -> Response:
    """Reply with the result of a job.

    Raises
    ------
    NotFound, Conflict
        When the job does not exist, or has no result (yet).
    """
    data_folder = data_folder_of(request)
    job = await answered(jobs.get, data_folder, id, kind)
    body = await run_in_threadpool(result_of, data_folder, job)
    return tagged(request, body, tag_of(body))


def result_of(data_folder: DataFolder, job: Job) -> bytes:
    """Return the result of a job as JSON.

    Raises
    ------
    Conflict, NotFound
        When the job has not succeeded, or has lost its result.
    """
    require_done(job)
    return file_of(data_folder, job, RESULT, thing="result of job").read_bytes()


async def jobs_reply(
    request: Request,
    data_folder: DataFolder,
    cursor: PageCursor,
    *,
    kind: JobKind | None = None,
    state: JobState | None = None,
    program: str = "",
) -> Response:
    """Reply with a page of jobs, newest first."""
    page = await answered(
        jobs.listed, data_folder, cursor, kind=kind, state=state, program=program
    )
    return page_reply(request, page, [job_view(job) for job in page.items])


def require_done(job: Job) -> None:
    """Refuse a request that needs the job to have succeeded.

    Raises
    ------
    Conflict
        When the job has not succeeded.
    """
    if job.state is not JobState.SUCCEEDED:
        where = f"see /v1/jobs/{job.id}"
        raise Conflict(f"{job.kind.value} '{job.id}' is {job.state.value}: {where}")


async def series_reply(
    request: Request,
    job: Job,
    *,
    signals: str,
    begin: float | None,
    end: float | None,
    points: int,
) -> Response:
    """Reply with signals over a time range, thinned to as many points as a screen shows."""
    data_folder = data_folder_of(request)
    series = await run_in_threadpool(lambda: open_series(live_folder(data_folder, job).series))
    if series is None:
        raise Conflict(f"{job.kind.value} '{job.id}' is {job.state.value}: it has no rows yet")
    is_growing = not job.state.is_finished
    return await window_reply(
        request, series, signals=signals, begin=begin, end=end, points=points,
        is_growing=is_growing,
    )  # fmt: skip


async def window_reply(  # noqa: PLR0913 (each is a parameter of the request)
    request: Request,
    series: Series,
    *,
    signals: str,
    begin: float | None,
    end: float | None,
    points: int,
    is_growing: bool,
) -> Response:
    """Reply with a time range of rows.

    Raises
    ------
    Unreadable, NotFound
        When the range ends before it begins, or a signal does not exist.
    """
    first = -inf if begin is None else begin
    last = inf if end is None else end
    if first > last:
        raise Unreadable(f"begin_s {first:g} s is after end_s {last:g} s")
    names = [name for name in signals.split(",") if name] or list(series.columns[1:])
    found = await read_in_turn(window, series, names, begin=first, end=last, points=points)
    return json_reply(request, _window(found, series, is_growing=is_growing))


def _window(window: Window, series: Series, *, is_growing: bool) -> dict[str, Any]:
    return {
        "begin_s": window.time,
        "end_s": window.end,
        "signals": {
            name: {
                "low": np.ascontiguousarray(window.low[:, place]),
                "mean": np.ascontiguousarray(window.mean[:, place]),
                "high": np.ascontiguousarray(window.high[:, place]),
            }
            for place, name in enumerate(window.names)
        },
        "rows": window.rows,
        "is_reduced": window.is_reduced,
        "is_growing": is_growing,
        "columns": [name for name in series.columns if name != TIME],
    }


def live_folder(data_folder: DataFolder, job: Job, *more: str) -> LiveFolder:
    """Return the folder of a run, with its rows, events and status, and files named besides.

    Raises
    ------
    Conflict
        When the run goes on on another host, and the hosts share no folder but a store.
    """
    folder = LiveFolder(path=data_folder.run_folder(job.id, job.attempt))
    if data_folder.store is None:
        return folder
    if job.state.is_finished:
        names = (folder.series.name, folder.events.name, folder.status.name, *more)
        for name in names:
            data_folder.fetched(folder.path / name)
    elif job.state is JobState.RUNNING and not folder.path.is_dir():
        raise Conflict(
            f"{job.kind.value} '{job.id}' runs on another host: follow and change it there, "
            "or let the hosts share a folder with --files"
        )
    return folder


async def status_reply(request: Request, job: Job) -> Response:
    """Reply with the latest status snapshot of a run; null before the first one."""
    data_folder = data_folder_of(request)
    if data_folder.store is None:
        return json_reply(request, live_folder(data_folder, job).read_status())
    folder = await run_in_threadpool(live_folder, data_folder, job)
    return json_reply(request, folder.read_status())


async def stream_reply(request: Request, job: Job) -> Response:
    """Reply with the events of a run as a stream."""
    return messages_reply(request, hub_of(request).watch(job.id))


def messages_reply(request: Request, stream: AsyncIterator[bytes]) -> Response:
    """Reply with messages as a stream, if there is room for one more."""
    hub_of(request).require_room()

    async def messages() -> AsyncIterator[bytes]:
        yield b"retry: 2000\n\n"
        async for message in stream:
            yield message

    headers = {"cache-control": "no-store", "x-accel-buffering": "no"}
    return StreamingResponse(messages(), media_type="text/event-stream", headers=headers)


def past_events(data_folder: DataFolder, job: Job) -> list[dict[str, Any]]:
    """Return the last events of a run, oldest first."""
    folder = live_folder(data_folder, job)
    found: list[dict[str, Any]] = []
    offset = 0
    while (read := read_on(folder.events, offset)).lines:
        found, offset = [*found, *read.lines][-SHOWN_EVENTS:], read.offset
    return found


def file_of(data_folder: DataFolder, job: Job, name: str, *, thing: str) -> Path:
    """Return the path of a file written by a job.

    Raises
    ------
    NotFound
        When the job has written no such file.
    """
    file = data_folder.fetched(data_folder.run_folder(job.id, job.attempt) / name)
    if not file.is_file():
        raise NotFound(thing, job.id)
    return file
