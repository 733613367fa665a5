"""Log of requests, in the lines of the service's log."""

import asyncio
import sys
from datetime import UTC, datetime

import orjson

WAIT = 0.05
"""Time for which request lines are buffered, in s."""


class RequestLog:
    """Log of requests, which writes several lines at once. Running state.

    Lines are buffered for 0.05 s: writing each alone would make a look-up a tenth slower.
    """

    def __init__(self) -> None:
        self._lines: list[bytes] = []

    def add(self, entry: dict[str, object]) -> None:
        """Add a line for a request; must be called within a running event loop."""
        if not self._lines:
            asyncio.get_running_loop().call_later(WAIT, self.write)
        stamp = datetime.now(UTC).isoformat(timespec="milliseconds")
        line = {"event": "request", "level": "info", "timestamp": stamp, **entry}
        self._lines.append(orjson.dumps(line))

    def write(self) -> None:
        """Write all buffered lines."""
        if self._lines:
            text = b"\n".join(self._lines).decode()
            self._lines.clear()
            sys.stderr.write(f"{text}\n")
            sys.stderr.flush()
