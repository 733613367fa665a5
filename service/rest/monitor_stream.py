"""Server-sent events of a monitored machine: new rows, and the status every second."""

import asyncio
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from service.monitor.monitor import COLUMNS, MachineMonitor, MonitorStatus
from service.rest.monitor_views import status_view
from service.rest.streams import ROWS, TICK, StreamClient, event

APART = 1.0
"""Time between two status messages without a change, in s."""


class MonitorReader:
    """Reads one monitor for all its subscribers. Running state."""

    def __init__(
        self, monitor: MachineMonitor, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.clients: set[StreamClient] = set()
        self.is_finished = False
        self._monitor, self._clock = monitor, clock
        self._row = monitor.count
        self._known: tuple[Any, ...] = ()
        self._told_at = -APART

    async def run(self) -> None:
        """Poll and send until no subscriber is left."""
        try:
            while self.clients:
                for message in self._news():
                    for client in self.clients:
                        client.give(message)
                await asyncio.sleep(TICK)
        finally:
            self.is_finished = True
            for client in self.clients:
                client.end()

    def first(self) -> list[bytes]:
        """Return the first message for a new subscriber: the status."""
        return [event("status", status_view(self._monitor.status()))]

    def _news(self) -> list[bytes]:
        """Return messages about everything that has changed since the last poll."""
        rows, status = self._rows(), self._monitor.status()
        news = [] if rows is None else [rows]
        now, known = self._clock(), _changes(status)
        if known != self._known or now - self._told_at >= APART:
            self._known, self._told_at = known, now
            news.insert(0, event("status", status_view(status)))
        return news

    def _rows(self) -> bytes | None:
        values, self._row = self._monitor.rows_since(self._row)
        if not len(values):
            return None
        count = len(values)
        at = np.unique(np.linspace(0, count - 1, min(count, ROWS)).astype(int))
        columns = dict(zip(COLUMNS, np.ascontiguousarray(values[at].T), strict=True))
        return event("rows", {"columns": columns, "is_reduced": count > ROWS})


def _changes(status: MonitorStatus) -> tuple[Any, ...]:
    """Return what subscribers are told at once when it changes."""
    return (
        status.state, status.freshness, status.availability, status.execution,
        status.program, status.workingstep, status.origin,
    )  # fmt: skip
