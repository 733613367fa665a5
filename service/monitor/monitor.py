"""Monitor of a machine: a thread that reads its agent and keeps its recent rows.

The client survives lost connections and restarts of the agent. After a restart the device model
is read again; after lost observations, the state. Times are those of the machine's timestamps,
from the first row; when they jump back, the rows begin anew.
"""

import threading
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, field
from enum import StrEnum
from math import nan

import structlog

from service.live.series import TIME, Series
from service.monitor.freshness import ArrivalTimes, Freshness
from service.monitor.observed_run import AT_REST, ObservedMoment, ObservedRun, RunTracker
from service.monitor.ring import RowRing
from service.monitor.signals import READ, SIGNALS, signals_of
from service.monitor.source import MonitorSource
from simulator.client.columns import TIME as ROW_TIME
from simulator.client.columns import Cell, RowMaker, columns_of
from simulator.client.connection import (
    PAUSES,
    UNAVAILABLE,
    AgentClient,
    ClientItem,
    ClientObservation,
)
from simulator.errors import AgentError
from simulator.motion.segments import Floats
from stepnc_model.errors import StepNcError

LOG = structlog.get_logger("monitor")

STEP = "workingstep"

COLUMNS = (TIME, *SIGNALS, STEP)
"""Columns of the rows; the workingstep is its number, from 1; 0: none."""

POWER = "total_power_w"

WORDS = ("execution", "program", STEP)
AVAILABILITY = "availability"

USED = READ.union(WORDS)
"""Columns of an agent that are used."""

MOST_NAMES = 1000
"""Workingsteps that get a number; further ones count as none."""

LONGEST = 200
"""Characters of a name that are kept."""

JUMP = 1.0
"""Step of the timestamps back in time, in s, after which the rows begin anew."""

FAREWELL = 2.0
"""Time for the thread to end, in s; it may still be connecting."""


class ConnectionState(StrEnum):
    """Connection to an agent."""

    NEVER = "never"
    """There has been no connection yet."""
    CONNECTED = "connected"
    LOST = "lost"


@dataclass(frozen=True, slots=True, kw_only=True)
class MonitorStatus:
    """Snapshot of a monitor."""

    source: MonitorSource
    state: ConnectionState
    problem: str
    """Why there is no connection; empty if there is one."""
    freshness: Freshness
    age: float | None
    """Time since the last observation arrived, in s."""
    stale_after: float
    """Age from which data are old, in s."""
    availability: str | None
    """Availability that the machine reports; None: not told."""
    execution: str | None
    program: str | None
    workingstep: str | None
    origin: float | None
    """Timestamp at which the time axis of the rows begins, in s since 1970."""
    rows: int
    """Number of rows that are kept."""
    workingsteps: tuple[str, ...]
    """Ids of workingsteps, in the order of their numbers in the rows."""
    latest: Mapping[str, float]
    """Latest row; empty if there is none."""
    run: ObservedRun | None


@dataclass(kw_only=True)
class _Told:
    """Latest words of a machine. Running state."""

    names: Mapping[str, str] = field(default_factory=dict)
    """What each data item tells."""
    values: dict[str, str | None] = field(default_factory=dict)

    def take(self, observations: Iterable[ClientObservation]) -> bool:
        """Keep the latest value of each; whether there was one."""
        is_told = False
        for each in observations:
            if each.id in self.names:
                name = self.names[each.id]
                is_missing = each.value is None and name == AVAILABILITY
                text = UNAVAILABLE if is_missing else each.value
                self.values[name] = None if text is None else text[:LONGEST]
                is_told = True
        return is_told


class _Stopped(Exception):
    """The monitor is to end."""


class MachineMonitor:
    """Reads the agent of one machine. Running state.

    Parameters
    ----------
    clock : callable
        Time of this computer, in s, which never goes back.
    """

    def __init__(
        self, source: MonitorSource, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.source = source
        self._clock = clock
        self._lock = threading.Lock()
        self._stopping = threading.Event()
        self._client = AgentClient(source.url, wait=self._pause)
        self._thread = threading.Thread(
            target=self._run, name=f"monitor {source.name}", daemon=True
        )
        self._state, self._problem = ConnectionState.NEVER, ""
        self._maker = RowMaker(columns=(), begin=0.0)
        self._told = _Told()
        self._ring = RowRing(len(COLUMNS))
        self._origin: float | None = None
        self._arrivals, self._tracker = ArrivalTimes(), RunTracker()
        self._power = nan
        self._numbers: dict[str, int] = {}

    def start(self) -> None:
        """Start to read the agent."""
        self._thread.start()

    def stop(self) -> None:
        """End the thread and its connection."""
        self._stopping.set()
        self._client.interrupt()
        if self._thread.is_alive():
            self._thread.join(FAREWELL)

    def status(self) -> MonitorStatus:
        """Return the current status."""
        with self._lock:
            now = self._clock()
            is_connected = self._state is ConnectionState.CONNECTED
            told, last = self._told.values, self._ring.rows(self._ring.count - 1)
            execution, availability = told.get("execution"), told.get(AVAILABILITY)
            is_at_rest = execution in AT_REST or availability == UNAVAILABLE
            return MonitorStatus(
                source=self.source,
                state=self._state,
                problem=self._problem,
                freshness=self._arrivals.freshness(
                    now, is_connected=is_connected, is_at_rest=is_at_rest
                ),
                age=self._arrivals.age(now),
                stale_after=self._arrivals.stale_after,
                availability=availability,
                execution=execution,
                program=told.get("program"),
                workingstep=told.get(STEP),
                origin=self._origin,
                rows=len(self._ring),
                workingsteps=tuple(self._numbers),
                latest=dict(zip(COLUMNS, map(float, last[-1]), strict=True))
                if len(last)
                else {},
                run=self._tracker.run,
            )

    def rows_since(self, count: int) -> tuple[Floats, int]:
        """Return the rows after the first ``count`` ones, and the number of all so far."""
        with self._lock:
            return self._ring.rows(count), self._ring.count

    @property
    def count(self) -> int:
        """Number of rows so far."""
        return self._ring.count

    def series(self) -> Series:
        """Return the kept rows."""
        with self._lock:
            return Series(columns=COLUMNS, values=self._ring.rows())

    # -- the thread ----------------------------------------------------------------------------

    def _pause(self, seconds: float) -> None:
        if self._stopping.wait(seconds):
            raise _Stopped

    def _run(self) -> None:
        failures = 0
        with suppress(_Stopped):
            while not self._stopping.is_set():
                try:
                    self._begin(self._client.items())
                    self._hold(self._present())
                    failures = 0
                    self._follow()
                except StepNcError as error:
                    self._fail(str(error))
                except (ArithmeticError, ValueError) as error:
                    # A document of another shape than any known; the next may be better.
                    LOG.exception("monitoring failed", machine=self.source.name)
                    self._fail(f"the answer cannot be read: {error}")
                except Exception:
                    # A mistake of this program; the other machines are monitored on.
                    LOG.exception("monitoring failed", machine=self.source.name)
                    self._fail("internal error, see the log")
                self._pause(PAUSES[min(failures, len(PAUSES) - 1)])
                failures += 1

    def _present(self) -> tuple[ClientObservation, ...]:
        """State from which the stream goes on: at first, all that the agent still keeps."""
        if self._state is ConnectionState.NEVER:
            with suppress(AgentError):
                return self._client.oldest_state()
        return self._client.state()

    def _follow(self) -> None:
        """Take parts of the stream until observations are lost."""
        with closing(self._client.stream()) as parts:
            for part in parts:
                if self._stopping.is_set():
                    return
                if part.fault:
                    self._fail(part.fault)
                elif part.is_restarted:
                    self._begin(self._client.items())
                elif part.lost:
                    return
                else:
                    self._take(part.observations)

    def _fail(self, problem: str) -> None:
        with self._lock:
            if self._state is ConnectionState.CONNECTED:
                self._state = ConnectionState.LOST
            self._problem = problem
            self._arrivals.interrupt()

    def _begin(self, items: Sequence[ClientItem]) -> None:
        """Begin with a device model, of which nothing is told yet."""
        columns = [each for each in columns_of(items) if each.name in USED]
        if all(each.is_text for each in columns):
            raise AgentError(f"{self.source.url}: the device model has none of the signals")
        names = {each.id: each.name for each in columns if each.name in WORDS}
        for item in items:
            if item.type == "AVAILABILITY" and item.component == "Device":
                names.setdefault(item.id, AVAILABILITY)
        with self._lock:
            self._maker = RowMaker(columns=tuple(columns), begin=0.0)
            self._told = _Told(names=names)
            self._tracker.interrupt()

    def _hold(self, observations: Sequence[ClientObservation]) -> None:
        """Take a state: one row, whatever the ages of its values."""
        with self._lock:
            self._arrived(observations)
            self._maker.rows(observations)
            self._told.take(observations)
            for row in self._maker.last():
                self._add(row)

    def _take(self, observations: Sequence[ClientObservation]) -> None:
        """Take new observations; no observation says that the agent is alive."""
        with self._lock:
            self._arrived(observations)
            for each in observations:
                for row in self._maker.rows([each]):
                    self._add(row)
                if self._told.take([each]):
                    self._track(each.time)
            for row in self._maker.last():
                self._add(row)

    def _arrived(self, observations: Sequence[ClientObservation]) -> None:
        self._state, self._problem = ConnectionState.CONNECTED, ""
        if observations:
            self._arrivals.add(self._clock())

    def _add(self, row: Mapping[str, Cell]) -> None:
        """Keep a row."""
        moment = float(row[ROW_TIME] or 0.0)
        if self._origin is not None and self._last - moment > JUMP:
            self._ring.clear()
            self._origin, self._tracker = None, RunTracker()
        if self._origin is None:
            self._origin = moment
        elif moment < self._last:
            return
        since, signals = round(moment - self._origin, 6), signals_of(row)
        step = self._number_of(self._told.values.get(STEP))
        self._ring.add([since, *signals.values(), step])
        self._power = signals[POWER]
        self._track(moment)

    @property
    def _last(self) -> float:
        """Timestamp of the latest row, in s since 1970."""
        return (self._origin or 0.0) + (self._ring.last_time or 0.0)

    def _track(self, moment: float) -> None:
        """Tell the tracker what holds from a timestamp on."""
        told, last = self._told.values, self._tracker.last
        if self._origin is None:
            if told.get("execution") is None:
                return
            self._origin = moment
        since = round(moment - self._origin, 6)
        self._tracker.advance(
            ObservedMoment(
                time=since if last is None else max(since, last.time),
                execution=told.get("execution"),
                program=told.get("program"),
                workingstep=told.get(STEP),
                power=self._power,
            )
        )

    def _number_of(self, step: str | None) -> int:
        if not step:
            return 0
        if step not in self._numbers and len(self._numbers) < MOST_NAMES:
            self._numbers[step] = len(self._numbers) + 1
        return self._numbers.get(step, 0)


class MonitorSet:
    """Monitors of all sources, by name. Running state."""

    def __init__(self, sources: Iterable[MonitorSource]) -> None:
        self.by_name = {source.name: MachineMonitor(source) for source in sources}

    def start(self) -> None:
        """Start all monitors."""
        for monitor in self.by_name.values():
            monitor.start()

    def stop(self) -> None:
        """End all monitors."""
        for monitor in self.by_name.values():
            monitor.stop()
