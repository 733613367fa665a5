"""Access middleware: authentication, roles, limits, and timing of every request.

It is one middleware in plain ASGI, so that a look-up adds little to the framework's own time.
"""

import asyncio
import re
import secrets
import time
from collections.abc import Iterable
from itertools import count as count_up
from typing import Any

import orjson
import structlog
from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.errors import Forbidden, TooLarge, Unauthorised, Unreadable
from service.rest.logs import RequestLog
from service.rest.metrics import count
from service.rest.rate import RateLimit, SharedRateLimit
from service.rest.rights import LOOKING, is_protected, require, role_for
from service.rest.settings import Settings
from service.rest.storage_queries import answered
from service.storage import keys
from service.storage.folder import DataFolder
from service.storage.keys import Key, Role
from service.web.known_hosts import known_hosts
from service.web.problem import plain_problem, problem_of, retry_after
from stepnc_model.errors import StepNcError

LOG = structlog.get_logger("rest")

BODY_BYTES = 1 << 20
"""Largest request body other than an upload, in bytes."""

UPLOADS = frozenset({"/v1/programs", "/v1/files"})
"""Paths that accept uploads; their routes count the unpacked bytes."""

PATIENT = 5.0
"""Time for which a valid key is not looked up again, in s."""

GONE = 499
"""Status in metrics and log when the client disconnected before the answer."""

REQUEST_ID = re.compile(rb"^[A-Za-z0-9._-]{1,64}$")

HEADERS = (
    (b"x-content-type-options", b"nosniff"),
    (b"cross-origin-resource-policy", b"same-origin"),
)
"""Security headers of all answers."""

OF_PAGES = (
    (b"referrer-policy", b"no-referrer"),
    (b"x-frame-options", b"DENY"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (
        b"permissions-policy",
        b"camera=(), microphone=(), geolocation=(), payment=(), usb=()",
    ),
)

# plotly.js adds inline styles to the page; scripts come from files only.
POLICY = (
    b"content-security-policy",
    b"default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
    b"img-src 'self' data: blob:; connect-src 'self'; font-src 'self'; base-uri 'none'; "
    b"form-action 'none'; frame-ancestors 'none'",
)

# A report is a self-contained page with inline scripts, and makes no requests.
REPORT_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
    "sandbox allow-scripts allow-downloads"
)

ANYBODY = Key(id="", name="local", roles=frozenset(Role), created=0.0, revoked=None)
"""Key assumed for every client where no keys are required."""

NOBODY = Key(id="", name="nobody", roles=frozenset(), created=0.0, revoked=None)
"""Key of a client that has shown none on a path that needs none."""


NOTHING = (b"content-security-policy", b"default-src 'none'; frame-ancestors 'none'")
"""Policy for answers that are not pages: a browser that renders one can run nothing."""


def _with_common(status: int, own: list[tuple[bytes, bytes]]) -> list[tuple[bytes, bytes]]:
    """Add the common security headers to the headers of an answer.

    A 304 answer gets none, because its headers would replace those that the browser has stored.
    """
    if status == 304:
        return own
    is_page = False
    for name, value in own:
        if name == POLICY[0]:
            return [*own, *HEADERS, *OF_PAGES]
        is_page = is_page or (name == b"content-type" and value.startswith(b"text/html"))
    return [*own, *HEADERS, *OF_PAGES, POLICY] if is_page else [*own, *HEADERS, NOTHING]


class _Revoked(Exception):
    """Internal signal: the key was revoked while its answer was being sent."""


class AccessMiddleware:
    """ASGI middleware that checks and counts every request. Running state."""

    def __init__(self, app: ASGIApp, *, settings: Settings, data_folder: DataFolder) -> None:
        self._app, self._settings, self._data_folder = app, settings, data_folder
        self._rate = RateLimit(settings.rate, burst=settings.burst)
        self._shared_rate: SharedRateLimit | None = None
        if settings.rate and data_folder.database.is_shared:
            self._shared_rate = SharedRateLimit(
                data_folder.database, settings.rate, burst=settings.burst
            )
        self._hosts = known_hosts(settings.host, settings.names)
        self._log = RequestLog() if settings.has_request_log else None
        # Request ids: a random prefix for the process, then a counter.
        self._prefix, self._count_of = secrets.token_hex(6), count_up(1)
        self._good: dict[str, tuple[float, Key]] = {}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Check, bound, answer and count a request, as an ASGI application."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        begin = time.perf_counter()
        headers: dict[bytes, bytes] = dict(scope["headers"])
        asked = headers.get(b"x-request-id", b"")
        id = (
            asked
            if REQUEST_ID.match(asked)
            else f"{self._prefix}{next(self._count_of):x}".encode()
        )
        status = 0

        async def answer(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                own = _with_common(status, message["headers"])
                message["headers"] = [*own, (b"x-request-id", id)]
            elif message.get("more_body"):
                await self._require_still_known(key, headers)
            await send(message)

        key = NOBODY
        # HEAD is answered as GET; the server leaves out the body.
        asked_as = {**scope, "method": "GET"} if scope["method"] == "HEAD" else scope
        try:
            _require_once(scope["headers"])
            self._require_known_host(scope, headers)
            key = await self._key(scope, headers)
            asked_as["state"] = {**scope.get("state", {}), "key": key, "id": id.decode()}
            await self._app(asked_as, self._bounded(scope, receive, headers), answer)
        except ClientDisconnect:
            status = status or GONE
        except _Revoked:
            await send({"type": "http.response.body", "body": b""})
        except StepNcError as error:
            if status:
                raise
            await _refuse(answer, problem_of(error), error)
        except Exception:
            LOG.exception("fault", request=id.decode(), path=scope["path"])
            if status:
                raise
            problem = plain_problem(500, "Fault", "internal error; see the log of the service")
            await _refuse(answer, {**problem, "instance": id.decode()}, None)
        finally:
            self._count(asked_as, status, time.perf_counter() - begin, id=id, who=key.name)

    def _require_known_host(self, scope: Scope, headers: dict[bytes, bytes]) -> None:
        """Refuse unknown host names and changes requested by pages of other sites."""
        place = self._hosts.require(scope)
        if scope["method"] in LOOKING:
            return
        site = headers.get(b"sec-fetch-site", b"same-origin")
        origin = headers.get(b"origin", b"").decode("latin-1")
        is_own = not origin or origin.partition("://")[2].lower() == place
        if site not in {b"same-origin", b"none"} or not is_own:
            raise Forbidden(f"a page of '{origin or 'another site'}' may not change anything")

    async def _key(self, scope: Scope, headers: dict[bytes, bytes]) -> Key:
        client = (scope.get("client") or ("?",))[0]
        if not self._settings.needs_keys:
            await self._take(client)
            return ANYBODY
        path = scope["path"]
        if not is_protected(path):
            await self._take(client)
            return NOBODY
        try:
            key = await self._known(headers)
        except StepNcError:
            await self._take(client)
            raise
        # Clients without a key share a bucket by address, so that guessing keys is slow.
        await self._take(client if key is None else key.id)
        if key is None:
            raise Unauthorised("API key needed: Authorization: Bearer stepnc_…; `stepnc keys`")
        require(key, role_for(scope["method"], path))
        return key

    async def _take(self, client: str) -> None:
        """Take a token for a request of a client; with a server, out of all hosts' bucket."""
        if self._shared_rate is None:
            self._rate.take(client)
        else:
            await self._shared_rate.take(client)

    async def _require_still_known(self, key: Key, headers: dict[bytes, bytes]) -> None:
        """End a long answer if its key has been revoked meanwhile."""
        if key.id and await self._known(headers) is None:
            raise _Revoked

    async def _known(self, headers: dict[bytes, bytes]) -> Key | None:
        scheme, _, word = headers.get(b"authorization", b"").decode("latin-1").partition(" ")
        if scheme.lower() != "bearer":
            return None
        word = word.strip()
        now = time.monotonic()
        at, key = self._good.get(word, (0.0, None))
        if key is not None and now - at < PATIENT:
            return key
        found = await answered(keys.known, self._data_folder, word)
        if found is None:
            self._good.pop(word, None)
            return None
        self._good[word] = now, found
        return found

    def _bound(self, path: str, length: bytes) -> int:
        """Return the largest accepted body for a path, in bytes; refuse larger ones."""
        bound = self._settings.upload_bytes if path in UPLOADS else BODY_BYTES
        if not length.isdigit():
            raise Unreadable("Content-Length is not a number")
        if int(length) > bound:
            raise TooLarge("the body", bound=bound)
        return bound

    def _bounded(self, scope: Scope, receive: Receive, headers: dict[bytes, bytes]) -> Receive:
        """Wrap ``receive`` so that the body must arrive in time and within its size limit."""
        length = headers.get(b"content-length")
        if length is None and b"transfer-encoding" not in headers:
            return receive
        bound = self._bound(scope["path"], length or b"0")
        taken = 0
        is_whole = False
        until = time.monotonic() + self._settings.body_s

        async def bounded() -> Message:
            nonlocal taken, is_whole
            if is_whole:
                return await receive()
            try:
                async with asyncio.timeout(max(until - time.monotonic(), 0.0)):
                    message = await receive()
            except TimeoutError as error:
                limit = self._settings.body_s
                raise Unreadable(f"the body did not arrive within {limit:g} s") from error
            taken += len(message.get("body", b""))
            is_whole = not message.get("more_body", False)
            if taken > bound:
                raise TooLarge("the body", bound=bound)
            return message

        return bounded

    def _count(self, scope: Scope, status: int, seconds: float, *, id: bytes, who: str) -> None:
        """Record a request in the metrics and in the request log."""
        count(scope["method"], getattr(scope.get("route"), "path", "unknown"), status, seconds)
        if self._log is not None:
            self._log.add({
                "request": id.decode(), "method": scope["method"], "path": scope["path"],
                "status": status, "seconds": round(seconds, 6), "who": who,
            })  # fmt: skip


def _require_once(headers: Iterable[tuple[bytes, bytes]]) -> None:
    """Refuse a second Authorization header: readers would disagree which one counts."""
    if [name.lower() for name, _ in headers].count(b"authorization") > 1:
        raise Unreadable("the header Authorization is given more than once")


async def _refuse(send: Send, problem: dict[str, Any], error: StepNcError | None) -> None:
    headers = [(b"content-type", b"application/problem+json")]
    if isinstance(error, Unauthorised):
        headers.append((b"www-authenticate", b"Bearer"))
    wait = None if error is None else retry_after(error)
    if wait is not None:
        headers.append((b"retry-after", str(wait).encode()))
    await send({"type": "http.response.start", "status": problem["status"], "headers": headers})
    await send({"type": "http.response.body", "body": orjson.dumps(problem)})
