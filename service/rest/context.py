"""Dependencies of the routes: data folder, settings, pages, idempotency keys."""

import hashlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from threading import BoundedSemaphore
from typing import Annotated, Any

from fastapi import Depends, Header, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from optimiser.source import why_elsewhere
from service.errors import Unavailable, Unreadable
from service.monitor.monitor import MonitorSet
from service.program_kind import ProgramKind
from service.reading import read_given, selected
from service.requests.fields import loaded
from service.requests.given import GIVEN, ProgramRequest
from service.rest.replies import json_reply
from service.rest.settings import Settings
from service.rest.streams import StreamHub
from service.rest.views import ProblemDetails, job_view
from service.storage import jobs, library, programs
from service.storage.folder import DataFolder
from service.storage.idempotency import IdempotencyKey, made_before
from service.storage.jobs import Job, JobRequest
from service.storage.keys import Key
from service.storage.pages import MOST, USUAL, Page, PageCursor
from simulator.library import load_machine
from stepnc_model.errors import StepNcError

LONGEST_KEY = 128

PROBLEMS: dict[int | str, dict[str, Any]] = {
    status: {
        "model": ProblemDetails,
        "description": what,
        "content": {"application/problem+json": {}},
    }
    for status, what in (
        (400, "The request is malformed"),
        (401, "A valid API key is required"),
        (403, "The key, or the site of the page, does not allow this request"),
        (404, "The resource does not exist"),
        (409, "The state of the resource does not allow this request"),
        (412, "The resource has changed since (If-Match)"),
        (413, "The body is too large"),
        (415, "The route does not accept the media type of the body"),
        (422, "The request cannot be carried out; the detail states value, bound and unit"),
        (429, "Too many requests; Retry-After says when to try again"),
        (503, "Something that the service depends on does not answer; Retry-After as for 429"),
        (507, "The disk is full"),
    )
}
"""Problem responses that any route may return."""


def data_folder_of(request: Request) -> DataFolder:
    """Return the data folder of the service."""
    found: DataFolder = request.app.state.data_folder
    return found


def settings_of(request: Request) -> Settings:
    """Return the settings of the service."""
    found: Settings = request.app.state.settings
    return found


def hub_of(request: Request) -> StreamHub:
    """Return the hub of the event streams."""
    found: StreamHub = request.app.state.hub
    return found


def monitors_of(request: Request) -> MonitorSet:
    """Return the monitors of real machines."""
    found: MonitorSet = request.app.state.monitors
    return found


def key_of(request: Request) -> Key:
    """Return the API key of the client, with its roles."""
    found: Key = request.state.key
    return found


def owner_of(request: Request) -> str:
    """Return the name of the client's key, which owns what the request creates."""
    return key_of(request).name


def cursor_of(
    limit: Annotated[int, Query(ge=1, le=MOST, description="entries per page")] = USUAL,
    cursor: Annotated[str | None, Query(description="next_cursor of the previous page")] = None,
) -> PageCursor:
    """Return the page cursor of a list request."""
    return PageCursor(limit=limit, cursor=cursor)


InDataFolder = Annotated[DataFolder, Depends(data_folder_of)]
OnPage = Annotated[PageCursor, Depends(cursor_of)]
ByOwner = Annotated[str, Depends(owner_of)]
IdempotencyHeader = Annotated[
    str | None,
    Header(
        alias="Idempotency-Key",
        description="repeating the key with the same request within a day has no effect",
        max_length=LONGEST_KEY,
    ),
]


def idempotency_of(request: Request, key: str | None, body: bytes) -> IdempotencyKey | None:
    """Return the idempotency key of a request; None if it has none.

    Raises
    ------
    Unreadable
        When the key is empty.
    """
    if key is None:
        return None
    if not key.strip():
        raise Unreadable("Idempotency-Key is empty")
    text = f"{request.method} {request.url.path}?{request.url.query}\n".encode()
    digest = hashlib.sha256(text + body).hexdigest()
    found = key_of(request)
    return IdempotencyKey(owner=found.id or found.name, key=key, fingerprint=digest)


async def fetched(data_folder: DataFolder, path: Path) -> Path:
    """Return a path below the folder of files; a file in a store is copied there first."""
    if data_folder.store is None:
        return path
    return await run_in_threadpool(data_folder.fetched, path)


READING = BoundedSemaphore(2)
"""Limits how many programs are read at once to check requests; each is held in memory."""

READING_WAIT = 30.0
"""Longest time to wait for one of them, in s: readers that hang must not hold all threads."""

Require = Callable[[DataFolder, JobRequest], None]
"""Check that refuses a request which cannot be carried out."""


def nothing(_data_folder: DataFolder, _asked: JobRequest) -> None:
    """Accept every request without a check."""


def runnable(data_folder: DataFolder, asked: JobRequest) -> None:
    """Check that program, machine and material exist, and that the program is STEP-NC.

    Raises
    ------
    NotFound
        When the program or its file was deleted.
    StepNcError
        When the program is NC code.
    UnknownMachine, UnknownMaterial, Unreadable, LibraryError
        When the job would raise the same error.
    """
    programs.require_kind(data_folder, asked.program, ProgramKind.STEP_NC)
    if not asked.source:
        programs.require_file(data_folder, asked.program)
    words = asked.request
    library.require(data_folder, machine=words["machine"], material=words["material"])
    if not asked.source and (words["machine"] or words.get("workingsteps")):
        _require_possible(data_folder, asked)


def _require_possible(data_folder: DataFolder, asked: JobRequest) -> None:
    """Refuse an unknown workingstep, and a machine that can run none of the workingsteps."""
    words = asked.request
    with reading_in_turn():
        file = data_folder.fetched(data_folder.program_file(asked.program))
        given = loaded(ProgramRequest, {name: words[name] for name in GIVEN if name in words})
        program = read_given(file, given).program
        steps = selected(program, tuple(words.get("workingsteps", ())))
        if not words["machine"]:
            return
        machine = load_machine(library.machine_word(data_folder, words["machine"]))
        reasons = [why_elsewhere(step, machine) for step in steps]
    if reasons and all(reasons):
        raise StepNcError(f"no workingstep can be run on this machine: {reasons[0]}")


@contextmanager
def reading_in_turn() -> Iterator[None]:
    """Block in which a program is read, while few others are.

    Raises
    ------
    Unavailable
        When no other reading ends in time.
    """
    if not READING.acquire(timeout=READING_WAIT):
        raise Unavailable(
            f"other programs are still being read after {READING_WAIT:g} s; try again"
        )
    try:
        yield
    finally:
        READING.release()


def page_reply(request: Request, page: Page[Any], items: list[Any]) -> Response:
    """Reply with a page of a list."""
    return json_reply(request, {"items": items, "next_cursor": page.cursor})


async def queued(
    request: Request, asked: JobRequest, key: str | None, *, require: Require = nothing
) -> Response:
    """Queue a job and reply 202 with its location.

    Raises
    ------
    StepNcError
        When the job could not start; a repeated idempotency key returns the existing job.
    """
    asked = replace(asked, key=key_of(request).id)
    data_folder, idempotency = (
        data_folder_of(request),
        idempotency_of(request, key, _words(asked)),
    )

    def add() -> Job:
        with data_folder.database.reading() as connection:
            is_new = made_before(connection, idempotency) is None
        if is_new:
            require(data_folder, asked)
        return jobs.add(data_folder, asked, idempotency=idempotency)

    job = await run_in_threadpool(add)
    headers = {"location": f"/v1/jobs/{job.id}", "retry-after": "1"}
    return json_reply(request, job_view(job), status=202, headers=headers)


def _words(asked: JobRequest) -> bytes:
    """Return a stable text of a request for its fingerprint."""
    return repr(sorted(asked.request.items())).encode()
