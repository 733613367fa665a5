"""HTTP of the agent: an ASGI application, read-only unless the agent allows puts.

One event loop serves all clients and takes the observations, so that no locks are needed. A
client that does not read is dropped; the machine never waits for one.
"""

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from typing import Any, NamedTuple
from urllib.parse import parse_qsl, unquote
from uuid import uuid4

from extras.agent.model.agent import (
    Agent,
    RequestRefused,
    StreamQuery,
    current_query,
    sample_query,
)
from extras.agent.model.documents import (
    RequestFault,
    as_json,
    as_page,
    has_observations,
    indented,
    packed,
)
from extras.agent.model.schemas import PLACE
from extras.agent.model.shdr import (
    MOST_BODY,
    put_asset,
    put_observations,
    remove_all_assets,
    remove_assets,
)

LONGEST_URI = 8192
"""bytes of a path with its query"""

MOST_PARAMETERS = 40

PATIENCE = 15.0
"""s for which a client may leave what was sent unread"""

LEAST_PACKED = 1024
"""bytes of a document that is worth compressing"""

BROWSER = frozenset({"text/html", "application/xhtml+xml"})
"""kinds that every browser accepts, and no client that reads MTConnect"""

READS = ("GET", "HEAD", "OPTIONS")
ASSET_WRITES = ("PUT", "POST", "DELETE")
VALUE_WRITES = ("PUT", "POST")

SUCCESS = b"<success/>"
"""answer to values that were put, as the reference agent gives it"""

Receive = Callable[[], Awaitable[Mapping[str, Any]]]
Send = Callable[[Mapping[str, Any]], Awaitable[None]]

COMMON = [
    (b"access-control-allow-origin", b"*"),
    (b"cache-control", b"no-store"),
    (b"x-content-type-options", b"nosniff"),
]

VERBS = frozenset({"probe", "current", "sample", "asset", "assets"})

KINDS = {
    "probe": "MTConnectDevices",
    "current": "MTConnectStreams",
    "sample": "MTConnectStreams",
}


class HttpRequest(NamedTuple):
    """An HTTP request; a tuple, as making it is a good part of an answer."""

    method: str
    path: str
    uri: str
    values: Mapping[str, str]
    is_json: bool
    is_page: bool
    """from a browser's address line"""
    takes_gzip: bool
    origin: str
    """of the page whose script asks; empty: none"""
    host: str

    @property
    def is_pretty(self) -> bool:
        """True if documents are to be indented."""
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
    headers = dict(scope["headers"])
    query = scope.get("query_string", b"").decode("latin-1")
    raw = scope.get("raw_path") or scope["path"].encode()
    values = _values(query) if query else {}
    uri = raw.decode("latin-1") + (f"?{query}" if query else "")
    accept = headers.get(b"accept", b"").decode("latin-1").lower()
    wanted = values.get("format", "").lower()
    return HttpRequest(
        method=scope["method"],
        path=scope["path"],
        uri=uri[:LONGEST_URI],
        values=values,
        is_json=wanted == "json" or ("application/json" in accept and wanted != "xml"),
        is_page=wanted == "html"
        or ("html" in accept and _kinds(accept) >= BROWSER and not wanted),
        takes_gzip=b"gzip" in headers.get(b"accept-encoding", b""),
        origin=headers.get(b"origin", b"").decode("latin-1"),
        host=headers.get(b"host", b"").decode("latin-1"),
    )


def _values(query: str) -> dict[str, str]:
    """Parameters of a query, each as it stands first; none if there are too many."""
    try:
        pairs = parse_qsl(query, keep_blank_values=True, max_num_fields=MOST_PARAMETERS)
    except ValueError:
        return {}
    values: dict[str, str] = {}
    for key, value in pairs:
        values.setdefault(key, value)
    return values


def _kinds(accept: str) -> set[str]:
    return {each.partition(";")[0].strip() for each in accept.split(",")}


async def _answer(agent: Agent, request: HttpRequest, receive: Receive, send: Send) -> None:
    if len(request.uri) >= LONGEST_URI:
        raise _bad_uri(f"the address is longer than {LONGEST_URI} bytes", status=414)
    if request.method == "OPTIONS":
        # Scripts of other pages may read; they never write.
        head = [*COMMON, (b"allow", _allowed(agent, request.path))]
        head.append((b"access-control-allow-methods", b"GET, HEAD, OPTIONS"))
        head.append((b"access-control-allow-headers", b"*"))
        await _send(send, 204, head, b"")
        return
    parts = _parts_of(request.path)
    if request.method not in {"GET", "HEAD"}:
        await _write(agent, request, parts, receive, send)
        return
    if (text := _file(agent, request.path)) is not None:
        body = b"" if request.method == "HEAD" else text
        await _send(send, 200, [*COMMON, (b"content-type", b"text/xml")], body)
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


def _file(agent: Agent, path: str) -> bytes | None:
    """Schema at an address; None: there is none."""
    if not path.startswith(PLACE):
        return None
    return agent.writer.schemas.files.get(path.removeprefix(PLACE))


def _parts_of(path: str) -> list[str]:
    # Few addresses have anything quoted.
    plain = unquote if "%" in path else str
    return [plain(part) for part in path.split("/") if part]


def _writes(agent: Agent, parts: list[str]) -> tuple[str, ...]:
    """Methods by which a client may write at an address."""
    if not agent.allows_put:
        return ()
    if any(verb in parts[:2] for verb in ("asset", "assets")):
        return ASSET_WRITES
    is_device = len(parts) == 1 and parts[0] not in VERBS
    return VALUE_WRITES if is_device else ()


def _allowed(agent: Agent, path: str) -> bytes:
    return ", ".join((*READS, *_writes(agent, _parts_of(path)))).encode()


async def _write(
    agent: Agent, request: HttpRequest, parts: list[str], receive: Receive, send: Send
) -> None:
    """Store what a client puts, or refuse it."""
    if request.method not in _writes(agent, parts):
        where = "" if agent.allows_put else ": read only"
        message = f"{request.method} is not supported{where}"
        raise RequestRefused(405, RequestFault(code="UNSUPPORTED", message=message))
    if request.origin and request.origin.partition("://")[2] != request.host:
        message = "pages of other servers may not write"
        raise RequestRefused(403, RequestFault(code="UNAUTHORIZED", message=message))
    device, verb, rest = _place(agent, parts)
    if verb == "probe" and device is not None:
        put_observations(agent, request.values, device=device)
        await _send(send, 200, [*COMMON, (b"content-type", b"text/xml")], SUCCESS)
        return
    device = _device_named(agent, request) if device is None else device
    kind = request.values.get("type", "")
    if request.method == "DELETE":
        if rest or verb == "asset":
            document = remove_assets(agent, _ids(rest))
        else:
            document = remove_all_assets(agent, kind=kind, device=device)
    else:
        at = _usual_device(agent) if device is None else device
        body = await _body(receive)
        document = put_asset(agent, body, id=rest, kind=kind, device=at)
    await _document(request, send, document)


def _device_named(agent: Agent, request: HttpRequest) -> int | None:
    """Device of a request by its parameter."""
    name = request.values.get("device")
    return None if name is None else _device(agent, name)


def _usual_device(agent: Agent) -> int:
    """The first device that is not the agent itself."""
    devices = agent.model.devices
    return next((at for at, each in enumerate(devices) if not each.is_agent), 0)


async def _body(receive: Receive) -> bytes:
    """Body of a request.

    Raises
    ------
    RequestRefused
        When it is too large, or takes too long.
    """
    body, is_open = b"", True
    try:
        async with asyncio.timeout(PATIENCE):
            while is_open:
                message = await receive()
                body += message.get("body", b"")
                is_open = message.get("more_body", False)
                if len(body) > MOST_BODY:
                    fault = f"the body is larger than {MOST_BODY} bytes"
                    raise RequestRefused(
                        413, RequestFault(code="INVALID_REQUEST", message=fault)
                    )
    except TimeoutError:
        fault = f"the body did not come within {PATIENCE:g} s"
        raise RequestRefused(408, RequestFault(code="INVALID_REQUEST", message=fault)) from None
    return body


def _device(agent: Agent, name: str) -> int:
    device = agent.model.device_of(name)
    if device is None:
        fault = RequestFault(code="NO_DEVICE", message=f"no device '{name[:200]}'")
        raise RequestRefused(404, fault)
    return device


def _place(agent: Agent, parts: list[str]) -> tuple[int | None, str, str]:
    """Device, verb and the rest of a path."""
    if not parts:
        return None, "probe", ""
    device: int | None = None
    if parts[0] not in VERBS:
        device = _device(agent, parts[0])
        parts = parts[1:]
    verb = parts[0] if parts else "probe"
    rest = parts[1:]
    is_asset = verb in {"asset", "assets"}
    if verb not in VERBS or len(rest) > int(is_asset):
        raise _bad_uri(f"no such address: /{'/'.join(parts)[:200]}")
    return device, verb, rest[0] if rest else ""


def _bad_uri(message: str, *, status: int = 404) -> RequestRefused:
    return RequestRefused(status, RequestFault(code="INVALID_URI", message=message))


def _assets(agent: Agent, request: HttpRequest, device: int | None, ids: str) -> bytes:
    if ids:
        return agent.assets_by_id(_ids(ids))
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


def _ids(text: str) -> list[str]:
    found = [id for id in text.split(";") if id]
    if not found:
        raise RequestRefused(
            400, RequestFault(code="INVALID_REQUEST", message="no asset named")
        )
    return found


async def _document(
    request: HttpRequest,
    send: Send,
    document: bytes,
    status: int = 200,
    more: tuple[tuple[bytes, bytes], ...] = (),
) -> None:
    """Send a document in the form that the client asks for."""
    kind = b"text/xml; charset=utf-8"
    if request.is_json:
        kind, document = b"application/json", as_json(document, is_pretty=request.is_pretty)
    elif request.is_page:
        kind, document = b"text/html; charset=utf-8", as_page(document)
    elif request.is_pretty:
        document = indented(document)
    head = [*COMMON, *more, (b"content-type", kind), (b"vary", b"accept, accept-encoding")]
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
    is_asset = any(word in {"asset", "assets"} for word in words[:2])
    verb = words[-1] if words else "probe"
    document = agent.writer.errors(
        refused.faults,
        size=agent.size,
        request="MTConnectAssets" if is_asset else KINDS.get(verb, "MTConnectDevices"),
        uri=request.uri,
    )
    allow = (b"allow", _allowed(agent, request.path))
    more = (allow,) if refused.status == 405 else ()
    await _document(request, send, document, refused.status, more)


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
        if following > before and has_observations(document):
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


async def _part(request: HttpRequest, send: Send, boundary: str, document: bytes) -> None:
    kind = "text/xml"
    if request.is_json:
        kind, document = "application/json", as_json(document)
    head = f"--{boundary}\r\nContent-type: {kind}\r\nContent-length: {len(document)}\r\n\r\n"
    body = head.encode() + document + b"\r\n"
    message = {"type": "http.response.body", "body": body, "more_body": True}
    # A client that reads nothing fills its buffers; then it is dropped.
    async with asyncio.timeout(PATIENCE):
        await send(message)
