"""Dependencies of the routes: data folder, settings, pages, idempotency keys."""

import hashlib
from pathlib import Path
from typing import Annotated, Any

from fastapi import Depends, Header, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from service.errors import Unreadable
from service.monitor.monitor import MonitorSet
from service.rest.replies import json_reply
from service.rest.settings import Settings
from service.rest.streams import StreamHub
from service.rest.views import ProblemDetails
from service.storage.folder import DataFolder
from service.storage.idempotency import IdempotencyKey
from service.storage.keys import Key
from service.storage.pages import MOST, USUAL, Page, PageCursor

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


def page_reply(request: Request, page: Page[Any], items: list[Any]) -> Response:
    """Reply with a page of a list."""
    return json_reply(request, {"items": items, "next_cursor": page.cursor})
