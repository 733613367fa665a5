"""HTTP of the agent: an ASGI application, read-only.

One event loop serves all clients and takes the observations, so that no locks are needed. A
client that does not read is dropped; the machine never waits for one.
"""

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl, unquote
from uuid import uuid4

from simulator.agent.agent import Agent
from simulator.agent.documents import RequestFault, as_json, indented, packed
from simulator.agent.requests import (
    RequestRefused,
    StreamQuery,
    current_query,
    sample_query,
)

STYLESHEET = Path(__file__).with_name("mtconnect.xsl").read_bytes()
"""makes documents readable in a browser"""

LONGEST_URI = 8192
"""bytes of a path with its query"""

MOST_PARAMETERS = 40

PATIENCE = 15.0
"""s for which a client may leave what was sent unread"""

LEAST_PACKED = 1024
"""bytes of a document that is worth compressing"""

Receive = Callable[[], Awaitable[Mapping[str, Any]]]
Send = Callable[[Mapping[str, Any]], Awaitable[None]]

COMMON = [
    (b"access-control-allow-origin", b"*"),
    (b"cache-control", b"no-store"),
    (b"x-content-type-options", b"nosniff"),
]

KINDS = {
    "probe": "MTConnectDevices",
    "current": "MTConnectStreams",
    "sample": "MTConnectStreams",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class HttpRequest:
    """What a request says of itself."""

    method: str
    path: str
    uri: str
    values: Mapping[str, str]
    is_json: bool
    takes_gzip: bool

    @property
    def is_pretty(self) -> bool:
        """Whether documents are to be indented."""
        return self.values.get("pretty", "").lower() in {"true", "1", "yes"}


def application(agent: Agent) -> Callable[[Mapping[str, Any], Receive, Send], Awaitable[None]]:
    """ASGI application that serves an agent."""

    async def serve(scope: Mapping[str, Any], receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            return
        request = _request(scope)
        try:
            await _answer(agent, request, receive, send)
        except RequestRefused as refused:
            await _refuse(agent, request, refused, send)

    return serve


def _request(scope: Mapping[str, Any]) -> HttpRequest:
    headers = {
        key.decode("latin-1"): value.decode("latin-1") for key, value in scope["headers"]
    }
    query = scope.get("query_string", b"").decode("latin-1")
    raw = scope.get("raw_path") or scope["path"].encode()
    try:
        pairs = parse_qsl(query, keep_blank_values=True, max_num_fields=MOST_PARAMETERS)
    except ValueError:
        pairs = []
    values: dict[str, str] = {}
    for key, value in pairs:
        values.setdefault(key, value)
    uri = raw.decode("latin-1") + (f"?{query}" if query else "")
    accept = headers.get("accept", "").lower()
    wanted = values.get("format", "").lower()
    return HttpRequest(
        method=scope["method"],
        path=scope["path"],
        uri=uri[:LONGEST_URI],
        values=values,
        is_json=wanted == "json" or ("application/json" in accept and wanted != "xml"),
        takes_gzip="gzip" in headers.get("accept-encoding", ""),
    )


async def _answer(agent: Agent, request: HttpRequest, receive: Receive, send: Send) -> None:
    if len(request.uri) >= LONGEST_URI:
        raise _bad_uri(f"the address is longer than {LONGEST_URI} bytes", status=414)
    if request.method == "OPTIONS":
        head = [*COMMON, (b"allow", b"GET, HEAD, OPTIONS")]
        head.append((b"access-control-allow-methods", b"GET, HEAD, OPTIONS"))
        head.append((b"access-control-allow-headers", b"*"))
        await _send(send, 204, head, b"")
        return
    if request.method not in {"GET", "HEAD"}:
        fault = RequestFault(
            code="UNSUPPORTED", message=f"{request.method} is not supported: read only"
        )
        raise RequestRefused(405, fault)
    parts = [unquote(part) for part in request.path.split("/") if part]
    if request.path == "/styles/mtconnect.xsl":
        await _send(send, 200, [*COMMON, (b"content-type", b"text/xsl")], STYLESHEET)
        return
    device, verb, rest = _place(agent, parts)
    match verb:
        case "probe":
            await _document(request, send, agent.probe(device))
        case "current":
            query = current_query(request.values, agent.model, agent.buffer, device=device)
            if query.interval is None:
                await _document(request, send, agent.current(query))
            else:
                await _stream(agent, request, query, receive, send, is_current=True)
        case "sample":
            query = sample_query(request.values, agent.model, agent.buffer, device=device)
            if query.interval is None:
                await _document(request, send, agent.sample(query)[0])
            else:
                await _stream(agent, request, query, receive, send, is_current=False)
        case _:
            await _document(request, send, _assets(agent, request, device, rest))


def _place(agent: Agent, parts: list[str]) -> tuple[int | None, str, str]:
    """Device, verb and the rest of a path."""
    verbs = {"probe", "current", "sample", "asset", "assets"}
    if not parts:
        return None, "probe", ""
    device: int | None = None
    if parts[0] not in verbs:
        device = agent.model.device_of(parts[0])
        if device is None:
            fault = RequestFault(code="NO_DEVICE", message=f"no device '{parts[0][:200]}'")
            raise RequestRefused(404, fault)
        parts = parts[1:]
    verb = parts[0] if parts else "probe"
    rest = parts[1:]
    is_asset = verb in {"asset", "assets"}
    if verb not in verbs or len(rest) > int(is_asset):
        raise _bad_uri(f"no such address: /{'/'.join(parts)[:200]}")
    return device, verb, rest[0] if rest else ""


def _bad_uri(message: str, *, status: int = 404) -> RequestRefused:
    return RequestRefused(status, RequestFault(code="INVALID_URI", message=message))


def _assets(agent: Agent, request: HttpRequest, device: int | None, ids: str) -> bytes:
    if ids:
        return agent.assets_by_id([id for id in ids.split(";") if id])
    text = request.values.get("count", "100")
    if not text.isdecimal() or not 0 < int(text) <= 1 << 31:
        fault = RequestFault(
            code="INVALID_PARAMETER_VALUE",
            message="'count' must be a positive integer",
            parameter="count",
            value=text[:200],
            type="integer",
            format="int32",
        )
        raise RequestRefused(400, fault)
    return agent.assets_of(
        kind=request.values.get("type", ""),
        count=int(text),
        is_removed=request.values.get("removed", "").lower() == "true",
        device=device,
    )


async def _document(
    request: HttpRequest, send: Send, document: bytes, status: int = 200
) -> None:
    """Send a document in the form that the client asks for."""
    kind = b"text/xml; charset=utf-8"
    if request.is_json:
        kind, document = b"application/json", as_json(document, is_pretty=request.is_pretty)
    elif request.is_pretty:
        document = indented(document)
    head = [*COMMON, (b"content-type", kind), (b"vary", b"accept, accept-encoding")]
    if request.takes_gzip and len(document) >= LEAST_PACKED:
        document = packed(document)
        head.append((b"content-encoding", b"gzip"))
    await _send(send, status, head, b"" if request.method == "HEAD" else document)


async def _send(send: Send, status: int, head: list[tuple[bytes, bytes]], body: bytes) -> None:
    sized = [*head, (b"content-length", str(len(body)).encode())]
    await send({"type": "http.response.start", "status": status, "headers": sized})
    await send({"type": "http.response.body", "body": body})


async def _refuse(
    agent: Agent, request: HttpRequest, refused: RequestRefused, send: Send
) -> None:
    words = [part for part in request.path.split("/") if part]
    verb = words[-1] if words else "probe"
    document = agent.writer.errors(
        refused.faults,
        size=agent.size,
        request=KINDS.get(verb, "MTConnectAssets" if "asset" in verb else "MTConnectDevices"),
        uri=request.uri,
    )
    await _document(request, send, document, refused.status)


async def _stream(
    agent: Agent,
    request: HttpRequest,
    query: StreamQuery,
    receive: Receive,
    send: Send,
    *,
    is_current: bool,
) -> None:
    """Documents as parts of one answer, until the client goes."""
    boundary = uuid4().hex
    kind = f"multipart/mixed;boundary={boundary}".encode()
    await send({
        "type": "http.response.start",
        "status": 200,
        "headers": [*COMMON, (b"content-type", kind)],
    })
    gone = asyncio.create_task(_until_gone(receive))
    parts = asyncio.create_task(_parts(agent, request, query, send, boundary, is_current))
    try:
        await asyncio.wait({gone, parts}, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in (gone, parts):
            task.cancel()
        await asyncio.gather(gone, parts, return_exceptions=True)


async def _until_gone(receive: Receive) -> None:
    while (await receive())["type"] != "http.disconnect":
        pass


async def _parts(
    agent: Agent,
    request: HttpRequest,
    query: StreamQuery,
    send: Send,
    boundary: str,
    is_current: bool,
) -> None:
    interval = (query.interval or 0) / 1000.0
    loop = asyncio.get_running_loop()
    if is_current:
        while True:
            begin = loop.time()
            await _part(request, send, boundary, agent.current(query))
            await asyncio.sleep(max(0.001, begin + interval - loop.time()))
    following = agent.buffer.first if query.start is None else query.start
    silent_since = loop.time()
    while True:
        begin = loop.time()
        if following < agent.buffer.first:
            message = f"observation {following} is no longer in the buffer"
            fault = RequestFault(
                code="OUT_OF_RANGE", message=message, parameter="from", value=str(following)
            )
            document = agent.writer.errors(
                [fault], size=agent.size, request="MTConnectStreams", uri=request.uri
            )
            await _part(request, send, boundary, document)
            return
        before = following
        document, following = agent.sample(
            StreamQuery(chosen=query.chosen, start=following, count=query.count)
        )
        heartbeat = query.heartbeat / 1000.0
        if following > before and _has_observations(document):
            await _part(request, send, boundary, document)
            silent_since = begin
            if following < agent.buffer.next:
                await asyncio.sleep(0)
                continue
        elif begin - silent_since >= heartbeat:
            await _part(request, send, boundary, document)
            silent_since = begin
        left = silent_since + heartbeat - loop.time()
        if await agent.wait(following, max(0.001, left)):
            # What comes within the interval goes into one document.
            await asyncio.sleep(max(0.0, begin + interval - loop.time()))


def _has_observations(document: bytes) -> bool:
    return b"<DeviceStream " in document


async def _part(request: HttpRequest, send: Send, boundary: str, document: bytes) -> None:
    kind = "text/xml"
    if request.is_json:
        kind, document = "application/json", as_json(document)
    head = f"--{boundary}\r\nContent-type: {kind}\r\nContent-length: {len(document)}\r\n\r\n"
    body = head.encode() + document + b"\r\n"
    message = {"type": "http.response.body", "body": body, "more_body": True}
    # A client that reads nothing fills its buffers; then it is dropped.
    await asyncio.wait_for(send(message), PATIENCE)
