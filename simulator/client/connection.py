"""A connection to an MTConnect agent that somebody else runs.

It survives what real shops have: an agent that restarts, a network that breaks, a buffer that
ran over. What is lost is reported, never hidden.
"""

import http.client
import socket
import time
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any
from urllib.parse import urlencode, urlsplit

from lxml import etree

from simulator.client.xml_text import parsed, without_namespaces
from simulator.errors import AgentError

TIMEOUT = 15.0
"""s for an answer, and for the next part of a stream"""

HEARTBEAT = 5000
"""ms after which an agent without news says so"""

INTERVAL = 100
"""ms between parts of a stream"""

COUNT = 1000
"""observations of a part"""

MOST_BYTES = 1 << 22
"""of a document"""

PAUSES = (0.5, 1.0, 2.0, 5.0)
"""s before another attempt after the first, second, … failure in a row"""

UNAVAILABLE = "UNAVAILABLE"


@dataclass(frozen=True, slots=True, kw_only=True)
class ClientItem:
    """A data item of an agent's device model."""

    id: str
    name: str
    category: str
    type: str
    sub_type: str
    units: str
    component: str
    """element of its component: ``Linear``"""
    component_name: str
    device: str


@dataclass(frozen=True, slots=True)
class ClientObservation:
    """An observation as an agent tells it."""

    id: str
    sequence: int
    time: float
    """s since 1970"""
    value: str | None
    """None: unavailable; of conditions the level"""


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamPart:
    """Observations in the order of their sequence, or what interrupted them."""

    observations: tuple[ClientObservation, ...] = ()
    lost: int = 0
    """observations that the agent had dropped before they were read"""
    is_restarted: bool = False
    """the agent has begun anew: its device model may be another"""
    fault: str = ""
    """why there is no connection at present"""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Page:
    """A document of streams."""

    instance: str
    first: int
    last: int
    following: int
    observations: tuple[ClientObservation, ...]


class AgentClient:
    """Reads one agent. Running state: where it is in the agent's buffer.

    Parameters
    ----------
    url : str
        Address of the agent, with a device after a slash if need be.
    wait : callable
        Waits for some seconds.

    Raises
    ------
    AgentError
        When the address is none.
    """

    def __init__(self, url: str, *, wait: Callable[[float], None] = time.sleep) -> None:
        parts = urlsplit(url if "//" in url else f"http://{url}")
        try:
            port = parts.port
        except ValueError as error:
            raise AgentError(f"{url}: {error}") from error
        if parts.scheme not in {"http", "https"} or not parts.hostname:
            raise AgentError(f"{url}: expected http://HOST:PORT or http://HOST:PORT/DEVICE")
        self.url = url
        self._is_secure = parts.scheme == "https"
        self._host, self._port = parts.hostname, port
        self._path = parts.path.rstrip("/")
        self._wait = wait
        self._instance = ""
        self._next: int | None = None
        self._socket: socket.socket | None = None

    def interrupt(self) -> None:
        """End the request that another thread waits for; a stream yields a fault."""
        waiting = self._socket
        if waiting is not None:
            with suppress(OSError):
                waiting.shutdown(socket.SHUT_RDWR)

    def items(self) -> tuple[ClientItem, ...]:
        """Data items of the device model.

        Raises
        ------
        AgentError
            When there is no answer, or it is no document of devices.
        """
        root = without_namespaces(self._document("/probe", {}))
        devices = root.find("Devices")
        return () if devices is None else tuple(items_of(devices))

    def state(self) -> tuple[ClientObservation, ...]:
        """Current state; the stream goes on from there.

        Raises
        ------
        AgentError
            When there is no answer, or it is no document of streams.
        """
        page = _page(self._document("/current", {}))
        self._instance, self._next = page.instance, page.following
        return page.observations

    def oldest_state(self) -> tuple[ClientObservation, ...]:
        """State at the oldest observation that the agent keeps; the stream goes on there.

        Raises
        ------
        AgentError
            As :meth:`state`, and when the agent drops that observation meanwhile.
        """
        oldest = _page(self._document("/sample", {"count": "1"})).first
        page = _page(self._document("/current", {"at": str(oldest)}))
        self._instance, self._next = page.instance, oldest + 1
        return page.observations

    def rewind(self) -> None:
        """Let the stream begin with the oldest observation that the agent keeps."""
        page = _page(self._document("/sample", {"count": "1"}))
        self._instance, self._next = page.instance, page.first

    def kept(self) -> Iterator[StreamPart]:
        """Observations since :meth:`oldest_state` or :meth:`rewind` that the agent keeps now.

        Ends with what was the newest observation when it began. Observations that the agent
        drops meanwhile are told as lost.

        Raises
        ------
        AgentError
            When there is no answer, it is no document of streams, or the agent begins anew.
        """
        last = self._looked().last
        while self._next is not None and self._next <= last:
            query = {"from": str(self._next), "count": str(COUNT)}
            try:
                page = _page(self._document("/sample", query))
            except AgentError:
                first = self._looked().first
                if first <= self._next:
                    raise
                yield StreamPart(lost=first - self._next)
                self._next = first
                continue
            self._require_same(page)
            if page.following <= self._next:
                raise AgentError(f"{self.url}: no observation after {self._next}")
            self._next = page.following
            yield StreamPart(observations=page.observations)

    def _looked(self) -> _Page:
        """Page of one observation, for what the agent keeps."""
        page = _page(self._document("/sample", {"count": "1"}))
        self._require_same(page)
        return page

    def _require_same(self, page: _Page) -> None:
        if page.instance != self._instance:
            raise AgentError(f"{self.url}: the agent has begun anew while it was read")

    def stream(self) -> Generator[StreamPart, None, None]:
        """Observations since :meth:`state` or :meth:`rewind`, as they come, without end.

        Every interruption is a part of its own; after it the stream goes on where it was, or
        with the oldest observation that is left.
        """
        failures = 0
        while True:
            try:
                for document in self._parts():
                    failures = 0
                    part = self._taken(document)
                    yield part
                    if part.is_restarted or part.lost:
                        break
            except (AgentError, OSError, http.client.HTTPException) as error:
                yield StreamPart(fault=_reason(error))
            self._wait(PAUSES[min(failures, len(PAUSES) - 1)])
            failures += 1
            yield from self._resumed()

    def _resumed(self) -> Iterator[StreamPart]:
        """News of an agent that began anew, or whose buffer no longer reaches back."""
        try:
            page = _page(self._document("/sample", {"count": "1"}))
        except (AgentError, OSError, http.client.HTTPException):
            return
        if page.instance != self._instance:
            self._instance, self._next = page.instance, page.first
            yield StreamPart(is_restarted=True)
        elif self._next is not None and page.first > self._next:
            lost, self._next = page.first - self._next, page.first
            yield StreamPart(lost=lost)

    def _taken(self, document: bytes) -> StreamPart:
        page = _page(parsed(document, what=self.url))
        if self._instance and page.instance != self._instance:
            self._instance, self._next = page.instance, page.first
            return StreamPart(is_restarted=True)
        self._instance, self._next = page.instance, page.following
        return StreamPart(observations=page.observations)

    def _parts(self) -> Iterator[bytes]:
        """Documents of one answer, by the length that each states."""
        query = {"interval": INTERVAL, "heartbeat": HEARTBEAT, "count": COUNT}
        if self._next is not None:
            query["from"] = self._next
        connection = self._connected()
        try:
            self._open(connection)
            connection.request("GET", f"{self._path}/sample?{urlencode(query)}")
            answer = connection.getresponse()
            if answer.status != http.client.OK:
                text = answer.read(2000).decode("utf-8", "replace")
                raise AgentError(f"{self.url}: status {answer.status}: {_message(text)}")
            while True:
                length = _part_length(answer)
                if length > MOST_BYTES:
                    raise AgentError(f"{self.url}: a part of {length} bytes")
                body = answer.read(length)
                if len(body) < length:
                    raise AgentError(f"{self.url}: the stream has ended")
                yield body
        finally:
            self._socket = None
            connection.close()

    def _document(self, path: str, query: Mapping[str, str]) -> Any:
        """Root of one document."""
        connection = self._connected()
        words = f"?{urlencode(query)}" if query else ""
        try:
            self._open(connection)
            connection.request("GET", f"{self._path}{path}{words}")
            answer = connection.getresponse()
            data = answer.read(MOST_BYTES + 1)
        except (OSError, http.client.HTTPException) as error:
            raise AgentError(f"{self.url}: {_reason(error)}") from error
        finally:
            self._socket = None
            connection.close()
        if answer.status != http.client.OK:
            text = data[:2000].decode("utf-8", "replace")
            raise AgentError(f"{self.url}{path}: status {answer.status}: {_message(text)}")
        return parsed(data, what=f"{self.url}{path}")

    def _connected(self) -> http.client.HTTPConnection:
        kind = http.client.HTTPSConnection if self._is_secure else http.client.HTTPConnection
        return kind(self._host, self._port, timeout=TIMEOUT)

    def _open(self, connection: http.client.HTTPConnection) -> None:
        """Connect, so that the connection can be interrupted."""
        connection.connect()
        self._socket = connection.sock


def items_of(devices: Any) -> Iterator[ClientItem]:
    """Data items of a ``Devices`` element without namespaces."""
    for device in devices:
        if not isinstance(device.tag, str):
            continue
        for element in device.iter("DataItem"):
            owner = element.getparent().getparent()
            yield ClientItem(
                id=element.get("id", ""),
                name=element.get("name", ""),
                category=element.get("category", ""),
                type=element.get("type", ""),
                sub_type=element.get("subType", ""),
                units=element.get("units", ""),
                component=owner.tag,
                component_name=owner.get("name", ""),
                device=device.get("name", ""),
            )


def _page(root: Any) -> _Page:
    """A document of streams as it is needed here."""
    plain = etree.QName(root).localname
    if plain != "MTConnectStreams":
        text = " ".join("".join(root.itertext()).split())
        raise AgentError(f"{plain} instead of MTConnectStreams: {text[:200]}")
    header = next((each for each in root if etree.QName(each).localname == "Header"), None)
    if header is None:
        raise AgentError("a document of streams without a header")
    try:
        first, following = int(header.get("firstSequence")), int(header.get("nextSequence"))
        last = int(header.get("lastSequence", following - 1))
        found = [
            observation_of(each) for each in root.iter() if each.get("sequence") is not None
        ]
    except (TypeError, ValueError) as error:
        raise AgentError(
            f"a document of streams with a faulty number or time: {error}"
        ) from error
    found.sort(key=lambda each: each.sequence)
    return _Page(
        instance=header.get("instanceId", ""),
        first=first,
        last=last,
        following=following,
        observations=tuple(found),
    )


def observation_of(element: Any) -> ClientObservation:
    """Observation of an element of a document of streams.

    Raises
    ------
    TypeError, ValueError
        When its sequence or its time is missing or none.
    """
    name = etree.QName(element).localname
    text: str | None = (element.text or "").strip()
    if etree.QName(element.getparent()).localname == "Condition":
        text = name.upper()
    if text == UNAVAILABLE:
        text = None
    return ClientObservation(
        element.get("dataItemId", ""),
        int(element.get("sequence")),
        _seconds(element.get("timestamp", "")),
        text,
    )


def _seconds(text: str) -> float:
    """Seconds since 1970 of a timestamp; ValueError where it is none."""
    moment = datetime.fromisoformat(text.replace("Z", "+00:00"))
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()


def _part_length(answer: http.client.HTTPResponse) -> int:
    """Length of the next part of a stream, by its head."""
    length = -1
    for _ in range(20):
        read = answer.readline(1000)
        if not read:
            raise AgentError("the stream has ended")
        line = read.strip().lower()
        if line.startswith(b"content-length:"):
            number = line.partition(b":")[2].strip()
            if not number.isdigit():
                break
            length = int(number)
        elif not line and length >= 0:
            return length
    raise AgentError("a part of a stream without its length")


def _reason(error: Exception) -> str:
    """Reason why there is no answer, without the number of the error."""
    return getattr(error, "strerror", None) or str(error) or type(error).__name__


def _message(text: str) -> str:
    """Text of an error document, or the first words of what else came."""
    try:
        words = "".join(parsed(text.encode(), what="answer").itertext())
    except AgentError:
        words = text
    return " ".join(words.split())[:200]
