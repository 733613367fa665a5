"""Answers: JSON with an ETag, files, problems."""

import hashlib
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from urllib.parse import quote

import orjson
from fastapi import Request
from fastapi.responses import FileResponse, Response

from service.errors import NotFound
from service.rest.gate import REPORT_POLICY

JSON = "application/json"
PROBLEM = "application/problem+json"


def json_reply(
    request: Request,
    content: Any,
    *,
    status: int = 200,
    headers: Mapping[str, str] | None = None,
) -> Response:
    """JSON; 304 when the client has it already."""
    option = orjson.OPT_SERIALIZE_NUMPY
    body = content if isinstance(content, bytes) else orjson.dumps(content, option=option)
    if status != 200:
        return Response(body, status, headers, JSON)
    return tagged(request, body, tag_of(body), headers=headers)


def tagged(
    request: Request, body: bytes, tag: str, *, headers: Mapping[str, str] | None = None
) -> Response:
    """JSON whose tag is known."""
    told = {"etag": tag, "cache-control": "no-cache", **(headers or {})}
    if matches(request.headers.get("if-none-match"), tag):
        return Response(status_code=304, headers=told)
    return Response(body, 200, told, JSON)


class Prepared(Response):
    """A body whose headers were made before: what is asked again and again is sent as it is."""

    def __init__(self, status: int, body: bytes, headers: list[tuple[bytes, bytes]]) -> None:
        self.status_code, self.body, self.raw_headers = status, body, headers
        self.background = None


def tag_of(body: bytes) -> str:
    """What changes with every byte."""
    return f'"{hashlib.blake2b(body, digest_size=12).hexdigest()}"'


def matches(condition: str | None, tag: str) -> bool:
    """Whether a tag is among those of a condition, RFC 9110 §13.1.2."""
    if condition is None:
        return False
    tags = {each.strip().removeprefix("W/") for each in condition.split(",")}
    return tag in tags or "*" in tags


def problem_reply(problem: Mapping[str, Any]) -> Response:
    """A problem body."""
    return Response(orjson.dumps(problem), problem["status"], None, PROBLEM)


def file_reply(file: Path, *, name: str, kind: str, thing: str) -> Response:
    """A file to save, under a name of the user's.

    Raises
    ------
    NotFound
        When it does not exist.
    """
    if not file.is_file():
        raise NotFound(thing, name)
    plain = "".join(each if (each.isascii() and each.isalnum()) or each in "._- " else "_"
                    for each in name)  # fmt: skip
    disposition = f"attachment; filename=\"{plain}\"; filename*=UTF-8''{quote(name, safe='')}"
    headers = {"content-disposition": disposition, "cache-control": "no-cache"}
    return FileResponse(file, media_type=kind, headers=headers)


def report_reply(file: Path, *, id: str) -> Response:
    """A page that stands for itself, and may reach nothing.

    Raises
    ------
    NotFound
        When it does not exist.
    """
    if not file.is_file():
        raise NotFound("report", id)
    headers = {"content-security-policy": REPORT_POLICY, "cache-control": "no-cache"}
    return FileResponse(file, media_type="text/html; charset=utf-8", headers=headers)


def moment(seconds: float | None) -> str | None:
    """A time as in RFC 3339."""
    if seconds is None:
        return None
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="milliseconds")
