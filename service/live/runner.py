"""Runner of a live session: it advances a run in wall-clock time and obeys change requests.

In each tick the runner carries out requested changes, advances the run, and writes rows, events
and status to files that others read. A run that waits for an order is ended when no order comes
for a long time. Running state.

Rows and events of a live session, and their conversion to columns of files.

Includes the "Power Limit Warning" of [1]_: on while the main drive draws more than the motor
can deliver. Running state. Units s, W.

Status snapshot of a live session, and its JSON with units in the names.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, "Optimal results" and Fig. 9.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from enum import Enum, StrEnum
from math import inf, isnan
from typing import Any, NamedTuple, Protocol

import numpy as np

from controller.monitoring.monitor import Monitor
from controller.orders import Criterion, EventKind, LoopEvent
from controller.record import EXCESS_RATIO
from service.live.journal import LiveFolder, append, read_on
from service.live.playback import TICK
from service.live.series import SeriesWriter
from simulator.motion.segments import Floats
from stepnc_model.errors import StepNcError
from stepnc_model.units import kw_from_watts, mm_min_from_speed


class Moment(NamedTuple):
    """Values of a run at one time; NaN where a value is unknown or does not exist."""

    time: float
    progress: float
    workingstep: str
    x: float
    y: float
    z: float
    feed_programmed: float
    feed_actual: float
    override_commanded: float
    override_actual: float
    set_point: float
    force_measured: float
    force_peak: float
    force_true: float
    force_expected: float
    force_ratio: float
    tooth_passing: float
    once_per_revolution: float
    spindle_power: float
    spindle_power_true: float
    removal_rate: float
    axial_depth: float
    flank_wear: float
    level: str
    holding: str
    event: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RunUpdate:
    """Rows and events since the last call, ascending in time."""

    moments: tuple[Moment, ...] = ()
    """Rows, one for each revolution or quarter of a second."""
    events: tuple[LoopEvent, ...] = ()

    @property
    def rows(self) -> Floats:
        """Rows in the units of the columns, (M, C)."""
        return rows_of(self.moments)


LIT = 1.0
"""Shortest time for which the power warning stays on, in s, so that it can be seen."""

CM3_MIN = 0.06
"""Removal rate of 1 mm³/s, in cm³/min."""


class LiveRows:
    """Collects rows and events, as the sink of a trace. Running state.

    Parameters
    ----------
    motor_power : callable
        Function that returns the power that the motor can deliver now, in W.
    """

    def __init__(self, motor_power: Callable[[], float]) -> None:
        self.last: Moment | None = None
        """Latest row."""
        self._motor_power = motor_power
        self._moments: list[Moment] = []
        self._events: list[LoopEvent] = []
        self._lit_until = -inf
        self._is_lit = False

    def __call__(self, moment: Moment) -> None:
        """Add a row, and an event when the power warning changes."""
        self._moments.append(moment)
        self.last = moment
        power, motor = moment.spindle_power_true, self._motor_power()
        if power > EXCESS_RATIO * motor:
            self._lit_until = moment.time + LIT
        if self.is_overloaded(moment.time) is not self._is_lit:
            self._is_lit = not self._is_lit
            self.note(_change(moment.time, power, motor, is_lit=self._is_lit))

    def note(self, event: LoopEvent) -> None:
        """Add an event."""
        self._events.append(event)

    def is_overloaded(self, time: float) -> bool:
        """True if the drive exceeds the motor power, or did within the last second."""
        return time < self._lit_until

    def taken(self) -> RunUpdate:
        """Return rows and events since the last call, and clear them."""
        taken = RunUpdate(moments=tuple(self._moments), events=tuple(self._events))
        self._moments.clear()
        self._events.clear()
        return taken


def _change(time: float, power: float, motor: float, *, is_lit: bool) -> LoopEvent:
    """Return the event for a change of the power warning."""
    draws, has = f"{kw_from_watts(power):.3g} kW", f"{kw_from_watts(motor):.3g} kW"
    if is_lit:
        text = f"power limit: the drive draws {draws}, the motor delivers {has}"
        return LoopEvent(time=time, kind=EventKind.OVER, text=text)
    text = f"power limit: for {LIT:g} s at most {EXCESS_RATIO - 1.0:.0%} above {has}"
    return LoopEvent(time=time, kind=EventKind.SAFE, text=text)


def known(value: float) -> float | None:
    """Return a number of a row, or None where it is NaN."""
    return None if isnan(value) else value


FEED, RATE = mm_min_from_speed(1.0), 0.001 * mm_min_from_speed(1.0)
"""Feed of 1 mm/s in mm/min, and removal rate of 1 mm³/s in cm³/min."""

PER_CENT = 100.0

COLUMNS: Mapping[str, tuple[str, float]] = {
    "time_s": ("time", 1.0),
    "progress_s": ("progress", 1.0),
    "x_mm": ("x", 1.0),
    "y_mm": ("y", 1.0),
    "z_mm": ("z", 1.0),
    "feed_programmed_mm_min": ("feed_programmed", FEED),
    "feed_actual_mm_min": ("feed_actual", FEED),
    "override_commanded_percent": ("override_commanded", PER_CENT),
    "override_actual_percent": ("override_actual", PER_CENT),
    "force_set_point_n": ("set_point", 1.0),
    "force_measured_n": ("force_measured", 1.0),
    "force_expected_n": ("force_expected", 1.0),
    "force_true_n": ("force_true", 1.0),
    "force_ratio": ("force_ratio", 1.0),
    "spindle_power_w": ("spindle_power", 1.0),
    "spindle_power_true_w": ("spindle_power_true", 1.0),
    "removal_rate_cm3_min": ("removal_rate", RATE),
    "axial_depth_mm": ("axial_depth", 1.0),
    "flank_wear_mm": ("flank_wear", 1.0),
}
"""Columns in files: attribute of :class:`Moment` and factor from internal units."""

_PLACES = [Moment._fields.index(name) for name, _ in COLUMNS.values()]
_SCALES = np.array([scale for _, scale in COLUMNS.values()])


def rows_of(moments: Sequence[Moment]) -> Floats:
    """Return moments as an array of rows, (M, C), in the units of the columns."""
    rows = [[moment[place] for place in _PLACES] for moment in moments]
    values: Floats = np.array(rows, dtype=np.float64).reshape(-1, len(_PLACES)) * _SCALES
    return values


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
        """True if the run waits for an order."""
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
        """True if the run waits for an order that may still come."""
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


UNITS = {
    "time": "time_s",
    "force_predicted": "force_predicted_n",
    "force_measured": "force_measured_n",
    "force_expected": "force_expected_n",
    "set_point": "force_set_point_n",
    "specific_cutting_force": "specific_cutting_force_n_mm2",
    "progress": "progress_share",
}
"""JSON names, with units, of attributes that are in canonical units."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionStatus:
    """Status values that controlled runs and trial cuts have in common."""

    time: float
    """Machine time, in s."""
    feed_programmed_mm_min: float
    feed_advised_mm_min: float
    """Feed advised by the force loop, in mm/min."""
    feed_actual_mm_min: float
    override_percent: float
    """Commanded override, in per cent."""
    force_measured: float | None
    """Mean force of the last revolution, in N; None if there was none."""
    set_point: float | None
    """Force set point, in N; None if the force is not bounded, or not known yet."""
    power_kw: float
    """True power that the main drive draws, in kW."""
    motor_power_kw: float | None
    """Power available from the motor, in kW, as limited by the operator; None at standstill."""
    removal_rate_cm3_min: float
    """True material removal rate, in cm³/min."""
    is_overloaded: bool
    """Power warning: the drive draws more than the motor delivers, or did a second ago."""
    over_set_point_percent: float | None
    """Mean force over its set point, in per cent, while it is above it; else None."""
    over_set_point_s: float
    """Time for which the force has been above its set point without a break, in s."""
    is_override_followed: bool
    """Whether the axes run the commanded override."""
    holding: str
    """What limits the feed now."""
    level: str
    """Level of the force, as the loop sees it."""
    criterion: Criterion
    is_on: bool
    is_stopped: bool
    """Whether the loop has stopped the run, or lost the machine."""

    def as_json(self) -> dict[str, Any]:
        """Return the values by names that carry their units."""
        return {UNITS.get(name, name): _plain(value) for name, value in asdict(self).items()}


def _plain(value: Any) -> Any:
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, dict):
        return {name: _plain(each) for name, each in value.items()}
    return value


def over_percent(monitor: Monitor) -> float | None:
    """Return the mean force over its set point, in per cent; None if it is not above it."""
    return 100.0 * monitor.share if monitor.over.is_lasting else None


def over_seconds(monitor: Monitor) -> float:
    """Return for how long the force has been above its set point, in s."""
    return monitor.over.seconds if monitor.over.is_lasting else 0.0
