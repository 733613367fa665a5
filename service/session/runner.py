"""Runner of a live session: it advances a run in wall-clock time and obeys change requests.

In each tick the runner carries out requested changes, advances the run, and writes rows, events
and status to files that others read. A run that waits for an order is ended when no order comes
for a long time. Running state.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from enum import StrEnum
from typing import Any, Protocol

from service.live.folder import LiveFolder
from service.live.journal import append, read_on
from service.live.playback import TICK
from service.live.series import SeriesWriter
from service.session.rows import COLUMNS
from simulator.motion.segments import Floats
from stepnc_model.errors import StepNcError

AT_ONCE = 2.0
"""Simulated time of a tick when the run is not paced, in s."""

FORGOTTEN_AFTER = 3600.0
"""Wall-clock time for which a waiting run waits for an order, in s."""

MOST_ROWS = 20_000_000
"""Largest number of rows of a run, some gigabytes in files."""

REFUSED = "refused"
"""Kind of event that reports an order which could not be carried out."""

FORGOTTEN = "forgotten"
"""Kind of event that reports the end of a run which received no order."""

FULL = "full"
"""Kind of event that reports that no more rows are kept for display."""


class SessionEvent(Protocol):
    """Event of a run."""

    @property
    def time(self) -> float:
        """Machine time, in seconds."""
        ...

    @property
    def kind(self) -> StrEnum:
        """Kind of the event."""
        ...

    @property
    def text(self) -> str:
        """Description for people."""
        ...


class SessionUpdate(Protocol):
    """Rows and events of a run since the last call."""

    @property
    def rows(self) -> Floats:
        """Rows in the units of the columns, (M, C)."""
        ...

    @property
    def events(self) -> Sequence[SessionEvent]:
        """Events, ascending in time."""
        ...


class LiveSession(Protocol):
    """Run that can be advanced, watched and changed."""

    @property
    def time(self) -> float:
        """Machine time, in seconds."""
        ...

    @property
    def is_waiting(self) -> bool:
        """Whether the run waits for an order."""
        ...

    def advance(self, until: float) -> bool:
        """Advance to a time, in s; return False when the run has ended."""
        ...

    def taken(self) -> SessionUpdate:
        """Return rows and events since the last call."""
        ...

    def obey(self, order: Mapping[str, Any]) -> None:
        """Carry out a change request.

        Raises
        ------
        StepNcError
            When the request cannot be carried out; nothing has changed then.
        """
        ...

    def snapshot(self) -> dict[str, Any]:
        """Return the status snapshot as JSON."""
        ...


@dataclass(kw_only=True)
class LiveRunner:
    """Advances and publishes one live session. Running state."""

    run: LiveSession
    folder: LiveFolder
    columns: Sequence[str] = tuple(COLUMNS)
    """Columns of the rows; the first is the time."""
    pace: float
    """Simulated seconds per wall-clock second; 0: as fast as possible."""
    now: Callable[[], float] = time.monotonic
    wait: Callable[[float], None] = time.sleep
    clock: Callable[[], datetime] = lambda: datetime.now(UTC)
    """Clock for the time stamp of each status, by which watchers notice a run that hangs."""
    tell: Callable[[dict[str, Any]], None] = lambda _: None
    """Callback that receives the status of each tick."""
    patience: float = FORGOTTEN_AFTER
    _offset: int = 0
    _touched_at: float = 0.0
    """Wall-clock time of the last progress or order, s."""
    _rows: int = 0

    def go(self) -> None:
        """Run to the end.

        Raises
        ------
        StepNcError
            When the run has more rows than can be kept.
        StorageFull, Unavailable
            When results cannot be written.
        """
        self._touched_at = self.now()
        with SeriesWriter(self.folder.series, self.columns) as series:
            goes_on, due = True, self.run.time
            while goes_on:
                begin = self.now()
                self._obey()
                # A control cycle may pass the due time; the next tick makes up for it.
                if self.run.is_waiting or not self.pace:
                    due = self.run.time
                due += TICK * self.pace or AT_ONCE
                goes_on = self.run.advance(due) or self._is_awaited()
                self._publish(series)
                if self.pace or self.run.is_waiting:
                    self.wait(max(TICK - (self.now() - begin), 0.0))

    def _is_awaited(self) -> bool:
        """Whether the run waits for an order that may still come."""
        if not self.run.is_waiting:
            return False
        if self.now() - self._touched_at < self.patience:
            return True
        self._say(FORGOTTEN, f"ended: no order for {self.patience:g} s while the run waited")
        return False

    def _obey(self) -> None:
        """Carry out all orders received since the last tick."""
        read = read_on(self.folder.orders, self._offset)
        if read.lines or not self.run.is_waiting:
            self._touched_at = self.now()
        self._offset = read.offset
        for order in read.lines:
            try:
                if "pace" in order:
                    self.pace = float(order["pace"])
                self.run.obey({name: order[name] for name in order if name != "pace"})
            except StepNcError as error:
                self._say(REFUSED, str(error))

    def _publish(self, series: SeriesWriter) -> None:
        taken = self.run.taken()
        rows = taken.rows
        if len(rows):
            self._keep(series, rows)
        for event in taken.events:
            self._say(event.kind.value, event.text, at=event.time)
        told_at = self.clock().isoformat(timespec="milliseconds")
        status = {
            **self.run.snapshot(),
            "pace": self.pace,
            "told_at": told_at,
            "is_series_full": series.is_full,
        }
        self.folder.write_status(status)
        self.tell(status)

    def _keep(self, series: SeriesWriter, rows: Floats) -> None:
        was_full = series.is_full
        series.add(rows)
        if series.is_full and not was_full:
            self._say(FULL, "the series is full: later rows are not shown")
        self._rows += len(rows)
        if self._rows > MOST_ROWS:
            raise StepNcError(f"the run exceeds {MOST_ROWS} rows, the largest number allowed")

    def _say(self, kind: str, text: str, *, at: float | None = None) -> None:
        moment = self.run.time if at is None else at
        append(self.folder.events, {"time_s": moment, "kind": kind, "text": text})
