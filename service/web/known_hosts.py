"""Host names by which clients may reach a server: the guard against DNS rebinding.

A page of another site can let its own name lead to this computer. The browser then takes the
server for that site and lets the page's scripts read and write, but the Host header still names
the site. All servers of the project therefore answer only requests for a name that they know
[1]_, and take the host of an absolute request target for that header, as [2]_ demands.

References
----------
.. [1] C. Jackson et al., "Protecting browsers from DNS rebinding attacks", CCS 2007,
   DOI 10.1145/1315245.1315298.
.. [2] RFC 9112, "HTTP/1.1", 3.2.2 (absolute form); RFC 9110, 4.2.3 and 7.2 (Host).
"""

import re
from collections.abc import Awaitable, Callable, Iterable, Mapping
from dataclasses import dataclass
from ipaddress import AddressValueError, IPv6Address, ip_address
from typing import Any

from service.errors import Forbidden, ServiceError, Unreadable
from service.web.problem import problem_of

LOOPBACK = frozenset({"127.0.0.1", "::1", "localhost"})

MOST_PORT = 65_535

PLACE = re.compile(
    r"(?:\[(?P<six>[0-9a-f:.]+)\]|(?P<name>[^:@/?#\[\]\s]+))(?::(?P<port>[0-9]*))?"
)
"""Host and optional port, [2]_."""

Receive = Callable[[], Awaitable[Mapping[str, Any]]]
Send = Callable[[Mapping[str, Any]], Awaitable[None]]
Application = Callable[[Mapping[str, Any], Receive, Send], Awaitable[None]]


@dataclass(frozen=True, slots=True)
class KnownHosts:
    """Names of a server."""

    names: frozenset[str]

    def require(self, scope: Mapping[str, Any]) -> str:
        """Return the Host header of a request, in lower case, if it names this server.

        The address at which the client has reached the server needs no name: a page that was
        loaded from it is a page of this server.

        Parameters
        ----------
        scope : mapping
            Scope of an HTTP request (ASGI).

        Raises
        ------
        Unreadable
            When there are several: readers would disagree which one counts.
        Forbidden
            When it is none, or the name of another server.
        """
        found = [value for name, value in scope["headers"] if name.lower() == b"host"]
        if len(found) > 1:
            raise Unreadable("the header Host is given more than once")
        place = found[0].decode("latin-1").lower() if found else ""
        host = host_in(place)
        if not host or (host not in self.names and host != _reached(scope)):
            raise Forbidden(f"host '{place}' is not a name of this service; add it with --name")
        return place


def known_hosts(listens: str, names: Iterable[str] = ()) -> KnownHosts:
    """Names of a server that listens on an address, those of this computer among them.

    Parameters
    ----------
    listens : str
        Address; one that stands for all addresses is no name.
    names : iterable of str
        Further names.
    """
    own = {_plain(each) for each in (listens, *names)} | LOOPBACK
    return KnownHosts(frozenset(each for each in own if each and not _is_any(each)))


def host_in(place: str) -> str:
    """Return the host of a Host header without port; empty if it is not well formed.

    Examples
    --------
    >>> host_in("planner.shop:8000")
    'planner.shop'
    >>> host_in("[0:0:0:0:0:0:0:1]:80")
    '::1'
    >>> host_in("127.0.0.1:99999999")
    ''
    """
    found = PLACE.fullmatch(place)
    if found is None:
        return ""
    port = found["port"]
    if port and not (len(port) <= len(str(MOST_PORT)) and 0 < int(port) <= MOST_PORT):
        return ""
    if found["six"] is None:
        return found["name"]
    try:
        return IPv6Address(found["six"]).compressed
    except AddressValueError:
        return ""


def for_known_hosts(app: Application, hosts: KnownHosts) -> Application:
    """Application that answers only requests for a name of its server."""

    async def serve(scope: Mapping[str, Any], receive: Receive, send: Send) -> None:
        if scope["type"] == "http":
            try:
                hosts.require(scope)
            except ServiceError as error:
                await _refuse(error, send)
                return
        await app(scope, receive, send)

    return serve


async def _refuse(error: ServiceError, send: Send) -> None:
    """Answer in plain text; no page of another site may read it."""
    body = f"{error}\n".encode()
    headers = [
        (b"content-type", b"text/plain; charset=utf-8"),
        (b"content-length", str(len(body)).encode()),
        (b"x-content-type-options", b"nosniff"),
    ]
    status = problem_of(error)["status"]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})


def _reached(scope: Mapping[str, Any]) -> str:
    """Address at which a client has reached the server; empty if it is not known."""
    server = scope.get("server")
    return _plain(str(server[0])) if server and server[0] else ""


def _plain(name: str) -> str:
    """Name in lower case, or an address in its usual form: IPv4 also where IPv6 carries it."""
    text = name.strip().lower().removeprefix("[").removesuffix("]")
    try:
        address = ip_address(text)
    except ValueError:
        return text
    mapped = address.ipv4_mapped if isinstance(address, IPv6Address) else None
    return (mapped or address).compressed


def _is_any(name: str) -> bool:
    """True if a name stands for all addresses of the computer."""
    try:
        return ip_address(name).is_unspecified
    except ValueError:
        return False
