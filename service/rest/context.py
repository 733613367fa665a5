"""What the routes share: the data folder, pages, keys that make a request once."""

import hashlib
from collections.abc import Callable
from typing import Annotated, Any

from fastapi import Depends, Header, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from service.depot import jobs, library, programs
from service.depot.folder import Depot
from service.depot.jobs import Job, Order
from service.depot.keys import Key
from service.depot.once import Once, made_before
from service.depot.pages import MOST, USUAL, Page, Place
from service.errors import Unreadable
from service.rest.replies import json_reply
from service.rest.settings import Settings
from service.rest.streams import Hub
from service.rest.views import Problem, job_view

LONGEST_KEY = 128

PROBLEMS: dict[int | str, dict[str, Any]] = {
    status: {
        "model": Problem,
        "description": what,
        "content": {"application/problem+json": {}},
    }
    for status, what in (
        (400, "The request cannot be read"),
        (401, "A key is needed"),
        (403, "The key, or the page it comes from, does not open this"),
        (404, "There is none"),
        (409, "It is not in the state for that"),
        (412, "It is not any more what If-Match names"),
        (413, "The body is too large"),
        (422, "What is asked is not possible; the detail names value, bound and unit"),
        (429, "Too many requests; Retry-After says when"),
        (503, "Something the service stands on does not answer"),
        (507, "The disk has no room"),
    )
}
"""that any route may answer with"""


def depot_of(request: Request) -> Depot:
    """The data folder."""
    found: Depot = request.app.state.depot
    return found


def settings_of(request: Request) -> Settings:
    """What the service was told."""
    found: Settings = request.app.state.settings
    return found


def hub_of(request: Request) -> Hub:
    """Who tells clients of runs."""
    found: Hub = request.app.state.hub
    return found


def key_of(request: Request) -> Key:
    """What the client has shown."""
    found: Key = request.state.key
    return found


def owner_of(request: Request) -> str:
    """Who asks."""
    return key_of(request).name


def place_of(
    limit: Annotated[int, Query(ge=1, le=MOST, description="entries of a page")] = USUAL,
    cursor: Annotated[str | None, Query(description="next_cursor of the page before")] = None,
) -> Place:
    """Which page of a list."""
    return Place(limit=limit, cursor=cursor)


InDepot = Annotated[Depot, Depends(depot_of)]
AtPlace = Annotated[Place, Depends(place_of)]
ByOwner = Annotated[str, Depends(owner_of)]
OnceKey = Annotated[
    str | None,
    Header(
        alias="Idempotency-Key",
        description="the same key with the same request makes nothing twice, for a day",
        max_length=LONGEST_KEY,
    ),
]


def once_of(request: Request, key: str | None, body: bytes) -> Once | None:
    """What tells a request from others; None: it may be repeated.

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
    return Once(owner=owner_of(request), key=key, fingerprint=digest)


Require = Callable[[Depot, Order], None]
"""refuses an order that could not be done"""


def nothing(_depot: Depot, _order: Order) -> None:
    """Whatever is asked can be done."""


def runnable(depot: Depot, order: Order) -> None:
    """What it works on is there, and so are machine and material.

    Raises
    ------
    NotFound
        When the program or its file was deleted.
    UnknownMachine, UnknownMaterial, Unreadable, LibraryError
        As the job would.
    """
    if not order.source:
        programs.require_file(depot, order.program)
    words = order.request
    library.require(depot, machine=words["machine"], material=words["material"])


def page_reply(request: Request, page: Page[Any], items: list[Any]) -> Response:
    """A page of a list."""
    return json_reply(request, {"items": items, "next_cursor": page.cursor})


async def queued(
    request: Request, order: Order, key: str | None, *, require: Require = nothing
) -> Response:
    """Queue a job: 202, and where to look.

    Raises
    ------
    StepNcError
        When the job could not begin; one that was asked for before is told as it is.
    """
    depot, once = depot_of(request), once_of(request, key, _words(order))

    def add() -> Job:
        with depot.database.reading() as connection:
            is_new = made_before(connection, once) is None
        if is_new:
            require(depot, order)
        return jobs.add(depot, order, once=once)

    job = await run_in_threadpool(add)
    headers = {"location": f"/v1/jobs/{job.id}", "retry-after": "1"}
    return json_reply(request, job_view(job), status=202, headers=headers)


def _words(order: Order) -> bytes:
    """What tells an order from others."""
    return repr(sorted(order.request.items())).encode()
