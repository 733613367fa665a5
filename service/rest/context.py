"""Dependencies of the routes: data folder, pages, idempotency keys."""

import hashlib
from collections.abc import Callable
from threading import BoundedSemaphore
from typing import Annotated, Any

from fastapi import Depends, Header, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from optimiser.source import why_elsewhere
from service.errors import Unreadable
from service.reading import read_program, selected
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
        (400, "The request cannot be read"),
        (401, "A key is needed"),
        (403, "The key, or the page it comes from, does not open this"),
        (404, "There is none"),
        (409, "It is not in the state for that"),
        (412, "The resource has changed since (If-Match)"),
        (413, "The body is too large"),
        (415, "The body is not of the media type that the route takes"),
        (422, "What is asked is not possible; the detail names value, bound and unit"),
        (429, "Too many requests; Retry-After says when"),
        (503, "Something the service stands on does not answer"),
        (507, "The disk has no room"),
    )
}
"""that any route may answer with"""


def data_folder_of(request: Request) -> DataFolder:
    """The data folder."""
    found: DataFolder = request.app.state.data_folder
    return found


def settings_of(request: Request) -> Settings:
    """Settings of the service."""
    found: Settings = request.app.state.settings
    return found


def hub_of(request: Request) -> StreamHub:
    """Hub of the streams."""
    found: StreamHub = request.app.state.hub
    return found


def key_of(request: Request) -> Key:
    """Key of the client, with its role."""
    found: Key = request.state.key
    return found


def owner_of(request: Request) -> str:
    """Owner of the request."""
    return key_of(request).name


def cursor_of(
    limit: Annotated[int, Query(ge=1, le=MOST, description="entries of a page")] = USUAL,
    cursor: Annotated[str | None, Query(description="next_cursor of the page before")] = None,
) -> PageCursor:
    """Page of a list."""
    return PageCursor(limit=limit, cursor=cursor)


InDataFolder = Annotated[DataFolder, Depends(data_folder_of)]
OnPage = Annotated[PageCursor, Depends(cursor_of)]
ByOwner = Annotated[str, Depends(owner_of)]
IdempotencyHeader = Annotated[
    str | None,
    Header(
        alias="Idempotency-Key",
        description="the same key with the same request makes nothing twice, for a day",
        max_length=LONGEST_KEY,
    ),
]


def idempotency_of(request: Request, key: str | None, body: bytes) -> IdempotencyKey | None:
    """Idempotency key of a request; None: it has none.

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
    return IdempotencyKey(owner=owner_of(request), key=key, fingerprint=digest)


READING = BoundedSemaphore(2)
"""programs that are read at once to check a request: each is wholly in memory"""

Require = Callable[[DataFolder, JobRequest], None]
"""refuses a request that could not be done"""


def nothing(_data_folder: DataFolder, _asked: JobRequest) -> None:
    """Whatever is asked can be done."""


def runnable(data_folder: DataFolder, asked: JobRequest) -> None:
    """Check that program, machine and material exist.

    Raises
    ------
    NotFound
        When the program or its file was deleted.
    UnknownMachine, UnknownMaterial, Unreadable, LibraryError
        As the job would.
    """
    if not asked.source:
        programs.require_file(data_folder, asked.program)
    words = asked.request
    library.require(data_folder, machine=words["machine"], material=words["material"])
    if not asked.source and (words["machine"] or words.get("workingsteps")):
        _require_possible(data_folder, asked)


def _require_possible(data_folder: DataFolder, asked: JobRequest) -> None:
    """Refuse an unknown workingstep, and a machine that can run none of them."""
    words = asked.request
    with READING:
        file = data_folder.program_file(asked.program)
        program = read_program(file, units=words["units"])
        steps = selected(program, tuple(words.get("workingsteps", ())))
        if not words["machine"]:
            return
        machine = load_machine(library.machine_word(data_folder, words["machine"]))
        reasons = [why_elsewhere(step, machine) for step in steps]
    if reasons and all(reasons):
        raise StepNcError(f"no workingstep can be run: {reasons[0]}")


def page_reply(request: Request, page: Page[Any], items: list[Any]) -> Response:
    """A page of a list."""
    return json_reply(request, {"items": items, "next_cursor": page.cursor})


async def queued(
    request: Request, asked: JobRequest, key: str | None, *, require: Require = nothing
) -> Response:
    """Queue a job: 202, and where to look.

    Raises
    ------
    StepNcError
        When the job could not begin; one that was asked for before is told as it is.
    """
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
    """Fingerprint text of a request."""
    return repr(sorted(asked.request.items())).encode()
