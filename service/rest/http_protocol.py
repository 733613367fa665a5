"""HTTP with bounds on what comes before a request is one: time and size of its head.

The server underneath bounds neither: a client that begins and never ends would be waited for,
and kept in memory, without end. Bodies are bounded by the gate.
"""

import asyncio
from typing import Any

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

HEAD_S = 10.0
"""s within which a head arrives"""

HEAD_BYTES = 1 << 16
"""that a head may have beyond those that its first part brings"""


class BoundedHttpProtocol(HttpToolsProtocol):
    """A connection whose client must come to the point. Running state."""

    def __init__(self, *arguments: Any, **words: Any) -> None:
        super().__init__(*arguments, **words)
        self._begin: float | None = None
        """since when a whole head is waited for"""
        self._is_head = False
        """whether a part of it has come"""
        self._size = 0
        self._look_again: asyncio.TimerHandle | None = None

    # The class underneath narrows what asyncio may hand it, and so must this one.
    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """See asyncio."""
        super().connection_made(transport)
        self._expect()
        self._look()

    def connection_lost(self, exc: Exception | None) -> None:
        """See asyncio."""
        super().connection_lost(exc)
        if self._look_again is not None:
            self._look_again.cancel()

    def data_received(self, data: bytes) -> None:
        """See asyncio."""
        was_head, self._size = self._is_head, self._size + len(data)
        super().data_received(data)
        if was_head and self._is_head and self._size > HEAD_BYTES:
            self.send_400_response("The head is too large.")
        elif self._begin is None and self.cycle is not None and self.cycle.response_complete:
            # Not a head, or the rest of a body that was refused.
            self._expect()

    def on_message_begin(self) -> None:
        """See httptools."""
        super().on_message_begin()
        self._is_head, self._size = True, 0
        self._expect()

    def on_headers_complete(self) -> None:
        """See httptools."""
        self._begin, self._is_head = None, False
        super().on_headers_complete()

    def _expect(self) -> None:
        self._begin = self.loop.time()

    def _look(self) -> None:
        """One look in a while for each connection costs less than a timer for each request."""
        if self._begin is not None and self.loop.time() - self._begin >= HEAD_S:
            self.transport.close()
            return
        self._look_again = self.loop.call_later(HEAD_S, self._look)
