"""HTTP protocol with bounds on a request head, one host, and an end for streams.

The server underneath bounds neither time nor size of a head: it would wait without end for a
client that never completes it, and keep it in memory. Bodies are bounded by the access
middleware. Nor does it end a stream when it stops: it would wait for the client, then cancel
and log a fault.
"""

import asyncio
import re
from types import FrameType
from typing import Any

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol
from uvicorn.server import Server

HEAD_S = 10.0
"""Time within which a request head must arrive, in s."""

END_OF_HOST = re.compile(rb"[/?#]")
"""What follows the host of an absolute request target."""

HEAD_BYTES = 1 << 16
"""Largest size of a request head beyond its first chunk, in bytes."""


class BoundedHttpProtocol(HttpToolsProtocol):
    """HTTP connection with bounds on a request head and an end for streams. Running state."""

    def __init__(self, *arguments: Any, **words: Any) -> None:
        super().__init__(*arguments, **words)
        self._begin: float | None = None
        """Time since when a complete head is awaited, in s; None while a request is served."""
        self._is_head = False
        """Whether a part of the head has arrived."""
        self._size = 0
        self._look_again: asyncio.TimerHandle | None = None

    # The base class narrows the type of transport, and so must this class.
    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Start waiting for a request head (see asyncio)."""
        super().connection_made(transport)
        self._expect()
        self._look()

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop the timer of a closed connection (see asyncio)."""
        super().connection_lost(exc)
        if self._look_again is not None:
            self._look_again.cancel()

    def data_received(self, data: bytes) -> None:
        """Process received bytes and refuse a head that is too large (see asyncio)."""
        was_head, self._size = self._is_head, self._size + len(data)
        super().data_received(data)
        if was_head and self._is_head and self._size > HEAD_BYTES:
            self.send_400_response("The request head is too large.")
        elif self._begin is None and self.cycle is not None and self.cycle.response_complete:
            # Not a head, or the rest of a body that was refused.
            self._expect()

    def shutdown(self) -> None:
        """Finish the current answer; a stream has no end, so leave its client at once."""
        super().shutdown()
        cycle = self.cycle
        if cycle is None or cycle.response_complete or not cycle.chunked_encoding:
            return
        if self.transport.get_write_buffer_size():
            # The client does not read what it gets.
            self.transport.abort()
        else:
            self.transport.close()

    def on_message_begin(self) -> None:
        """Note that a request head has begun (see httptools)."""
        super().on_message_begin()
        self._is_head, self._size = True, 0
        self._expect()

    def on_headers_complete(self) -> None:
        """Note that a request head is complete (see httptools)."""
        self._begin, self._is_head = None, False
        self._take_host_of_target()
        super().on_headers_complete()

    def _take_host_of_target(self) -> None:
        """Let the host of an absolute request target replace the Host header.

        RFC 9112 §3.2.2 demands it: who checks the header would be told one host and asked for
        another. The base class drops the host of the target.
        """
        _, mark, rest = self.url.partition(b"://")
        if self.url.startswith(b"/") or not mark:
            return
        host = END_OF_HOST.split(rest, maxsplit=1)[0]
        # In place: the scope has the same list. A second header stays one too many.
        names = [name for name, _ in self.headers]
        if b"host" not in names:
            self.headers.append((b"host", host))
        for number, name in enumerate(names):
            if name == b"host":
                self.headers[number] = (name, host)

    def _expect(self) -> None:
        self._begin = self.loop.time()

    def _look(self) -> None:
        """Close overdue connections; a periodic look costs less than a timer per request."""
        if self._begin is not None and self.loop.time() - self._begin >= HEAD_S:
            self.transport.close()
            return
        self._look_again = self.loop.call_later(HEAD_S, self._look)


class WebServer(Server):
    """Server of uvicorn that ignores all signals but the first. Running state.

    Launchers pass on what the terminal has sent to all, and uvicorn would break off its
    application at a second SIGINT, whose traceback it logs.
    """

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Begin to end."""
        if not self.should_exit:
            super().handle_exit(sig, frame)
