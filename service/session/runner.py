"""A run that goes on in wall time, tells how it is, and does what it is asked. Running state.

Each tick: what was asked of it is done, it goes on as far as it is time for, what came of it is
written where others read it. A run that stands, and of which nobody asks anything for long, has
been forgotten: it ends.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any, Protocol

from service.live.folder import LiveFolder
from service.live.journal import append, read_on
from service.live.playback import TICK
from service.live.series import SeriesWriter
from service.session.rows import COLUMNS, RunUpdate, rows_of
from simulator.motion.segments import Floats
from stepnc_model.errors import StepNcError

AT_ONCE = 2.0
"""simulated seconds of a tick when the clock does not matter"""

FORGOTTEN_AFTER = 3600.0
"""wall-clock seconds for which a stopped run waits for an order"""

MOST_ROWS = 20_000_000
"""that come of a run: what is kept of them then takes some gigabytes"""

REFUSED = "refused"
"""kind of the event that tells of an order that could not be done"""

FORGOTTEN = "forgotten"
"""kind of the event for the end of a run that got no order"""

FULL = "full"
"""kind of the event that tells that no more rows are kept to be looked at"""


class LiveSession(Protocol):
    """A run that goes on when it is told to, may be watched, and obeys orders."""

    @property
    def time(self) -> float:
        """Machine time, in seconds."""
        ...

    @property
    def is_waiting(self) -> bool:
        """Whether the run waits for an order."""
        ...

    def advance(self, until: float) -> bool:
        """Go on until a time, s; False: it does not go on any more."""
        ...

    def taken(self) -> RunUpdate:
        """Rows and events since it was asked last."""
        ...

    def obey(self, order: Mapping[str, Any]) -> None:
        """Do what is asked.

        Raises
        ------
        StepNcError
            When it cannot be; nothing has changed then.
        """
        ...

    def snapshot(self) -> dict[str, Any]:
        """Status snapshot as JSON."""
        ...


@dataclass(kw_only=True)
class LiveRunner:
    """Steers one run. Running state."""

    run: LiveSession
    folder: LiveFolder
    pace: float
    """simulated seconds per wall-clock second; 0: as fast as possible"""
    now: Callable[[], float] = time.monotonic
    wait: Callable[[float], None] = time.sleep
    clock: Callable[[], datetime] = lambda: datetime.now(UTC)
    """of the moment that each status carries: who watches knows a run that hangs from one that
    stands"""
    tell: Callable[[dict[str, Any]], None] = lambda _: None
    """hears the status of each tick"""
    patience: float = FORGOTTEN_AFTER
    _offset: int = 0
    _touched_at: float = 0.0
    """wall-clock time of the last progress or order, s"""
    _rows: int = 0

    def go(self) -> None:
        """Run to the end.

        Raises
        ------
        StepNcError
            When more comes of it than can be kept.
        StorageFull, Unavailable
            When what came of it cannot be written.
        """
        self._touched_at = self.now()
        with SeriesWriter(self.folder.series, list(COLUMNS)) as series:
            goes_on, due = True, self.run.time
            while goes_on:
                begin = self.now()
                self._obey()
                # A cycle passes the time that is due: what it was too early waits in the next.
                if self.run.is_waiting or not self.pace:
                    due = self.run.time
                due += TICK * self.pace or AT_ONCE
                goes_on = self.run.advance(due) or self._is_awaited()
                self._publish(series)
                if self.pace or self.run.is_waiting:
                    self.wait(max(TICK - (self.now() - begin), 0.0))

    def _is_awaited(self) -> bool:
        """Whether the run stands, and an order may still come."""
        if not self.run.is_waiting:
            return False
        if self.now() - self._touched_at < self.patience:
            return True
        self._say(FORGOTTEN, f"ended: no order for {self.patience:g} s while it stood")
        return False

    def _obey(self) -> None:
        """All that was asked since the last tick."""
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
        if taken.moments:
            self._keep(series, rows_of(taken.moments))
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
            self._say(
                FULL, "the series has as many rows as it may have: later ones are not shown"
            )
        self._rows += len(rows)
        if self._rows > MOST_ROWS:
            raise StepNcError(f"the run has more than {MOST_ROWS} rows, which is the most")

    def _say(self, kind: str, text: str, *, at: float | None = None) -> None:
        moment = self.run.time if at is None else at
        append(self.folder.events, {"time_s": moment, "kind": kind, "text": text})
