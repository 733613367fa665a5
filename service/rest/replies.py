"""Building of HTTP replies: JSON with an ETag, files, problems."""

import hashlib
import os
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, BinaryIO
from urllib.parse import quote

import orjson
from fastapi import Request
from fastapi.responses import Response
from starlette.concurrency import run_in_threadpool
from starlette.types import Receive, Scope, Send

from service.errors import NotFound
from service.rest.access import REPORT_POLICY

JSON = "application/json"
PROBLEM = "application/problem+json"

PART = 1 << 18
"""Size of the parts in which a file is read and sent, in bytes."""


def json_reply(
    request: Request,
    content: Any,
    *,
    status: int = 200,
    headers: Mapping[str, str] | None = None,
) -> Response:
    """Reply with JSON, or with 304 when the client has it already."""
    option = orjson.OPT_SERIALIZE_NUMPY
    body = content if isinstance(content, bytes) else orjson.dumps(content, option=option)
    if status != 200:
        return Response(body, status, headers, JSON)
    return tagged(request, body, tag_of(body), headers=headers)


def tagged(
    request: Request, body: bytes, tag: str, *, headers: Mapping[str, str] | None = None
) -> Response:
    """Reply with JSON whose entity tag is known, or with 304."""
    told = {"etag": tag, "cache-control": "no-cache", **(headers or {})}
    if matches(request.headers.get("if-none-match"), tag):
        return Response(status_code=304, headers=told)
    return Response(body, 200, told, JSON)


class PreparedResponse(Response):
    """Response with prepared headers, for content that is requested again and again."""

    def __init__(self, status: int, body: bytes, headers: list[tuple[bytes, bytes]]) -> None:
        self.status_code, self.body, self.raw_headers = status, body, headers
        self.background = None


def tag_of(body: bytes) -> str:
    """Return the entity tag of a content."""
    return f'"{hashlib.blake2b(body, digest_size=12).hexdigest()}"'


def matches(condition: str | None, tag: str) -> bool:
    """True if a tag is among those of an If-None-Match header, RFC 9110 §13.1.2."""
    if condition is None:
        return False
    tags = {each.strip().removeprefix("W/") for each in condition.split(",")}
    return tag in tags or "*" in tags


def problem_reply(problem: Mapping[str, Any]) -> Response:
    """Reply with a problem body."""
    return Response(orjson.dumps(problem), problem["status"], None, PROBLEM)


class FileReply(Response):
    """Response with an open file, which may be deleted meanwhile; always closed at the end.

    Parameters
    ----------
    size : int
        Size of the file, in bytes.
    kind : str
        Media type.
    """

    def __init__(
        self, file: BinaryIO, *, size: int, kind: str, headers: Mapping[str, str]
    ) -> None:
        super().__init__(None, 200, {**headers, "content-length": str(size)}, kind)
        self.file = file
        self._left = size

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send the file in parts (see ASGI)."""
        start = {"status": self.status_code, "headers": self.raw_headers}
        try:
            await send({"type": "http.response.start", **start})
            while self._left:
                part = await run_in_threadpool(self.file.read, min(PART, self._left))
                if not part:
                    raise OSError(f"the file lost {self._left} bytes while it was sent")
                self._left -= len(part)
                await send({"type": "http.response.body", "body": part, "more_body": True})
            await send({"type": "http.response.body", "body": b""})
        finally:
            self.file.close()


def file_reply(
    request: Request, file: Path, *, name: str, kind: str, thing: str, tag: str = ""
) -> Response:
    """Reply with a file to download, under the name that its owner gave it.

    Parameters
    ----------
    name : str
        Name of the download.
    kind : str
        Media type.
    thing : str
        Name of the resource in the error when the file does not exist.
    tag : str
        Entity tag of the content; empty: derived from the time of writing.

    Raises
    ------
    NotFound
        When the file does not exist.
    """
    plain = "".join(each if (each.isascii() and each.isalnum()) or each in "._- " else "_"
                    for each in name)  # fmt: skip
    disposition = f"attachment; filename=\"{plain}\"; filename*=UTF-8''{quote(name, safe='')}"
    headers = {"content-disposition": disposition, **({"etag": tag} if tag else {})}
    return _opened(request, file, kind=kind, headers=headers, missing=NotFound(thing, name))


def report_reply(request: Request, file: Path, *, id: str) -> Response:
    """Reply with a self-contained page that may not load anything.

    Raises
    ------
    NotFound
        When the report does not exist.
    """
    headers = {"content-security-policy": REPORT_POLICY}
    kind, missing = "text/html; charset=utf-8", NotFound("report", id)
    return _opened(request, file, kind=kind, headers=headers, missing=missing)


def _opened(
    request: Request, file: Path, *, kind: str, headers: Mapping[str, str], missing: NotFound
) -> Response:
    """Reply with an opened file, or with 304 when the client has it already."""
    try:
        opened = file.open("rb")
    except (FileNotFoundError, NotADirectoryError, IsADirectoryError):
        raise missing from None
    found = os.fstat(opened.fileno())
    written = tag_of(f"{found.st_mtime_ns} {found.st_ino} {found.st_size}".encode())
    told = {"etag": written, "cache-control": "no-cache", **headers}
    if matches(request.headers.get("if-none-match"), told["etag"]):
        opened.close()
        return Response(status_code=304, headers=told)
    return FileReply(opened, size=found.st_size, kind=kind, headers=told)


def moment(seconds: float | None) -> str | None:
    """Return a time as RFC 3339 text."""
    if seconds is None:
        return None
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="milliseconds")
