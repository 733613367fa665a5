"""A run under control, revolution by revolution: for a file, and for plots.

A row is a revolution of the spindle; where there is none (rapid, a dwell, a spindle at rest)
rows are a quarter of a second apart. What is true is the mean over the row, what is measured
that of the revolution. Running state. Units mm, s, N, W.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from math import inf, isfinite, nan
from types import TracebackType

import numpy as np

from controller.cycle import LoopCycle
from controller.orders import LoopEvent
from service.control.holding import HoldTallies
from service.live.runner import Moment
from service.outputs.run_file import ColumnKind, RunColumn, RunFile, Values, words_of
from service.plots.buckets import BucketedRun, Buckets
from simulator.plant.controlled_machine import TrueState
from simulator.plant.course import NominalCourse

ROWS = 8192
"""in one group of the file"""

APART = 0.25
"""s between rows without a revolution, at least"""

COLUMNS = (
    RunColumn(name="time_s", unit="s", kind=ColumnKind.EXACT),
    RunColumn(name="progress_s", unit="s", kind=ColumnKind.EXACT),
    RunColumn(name="workingstep", kind=ColumnKind.WORDS),
    RunColumn(name="x_axis_position_actual", unit="mm"),
    RunColumn(name="y_axis_position_actual", unit="mm"),
    RunColumn(name="z_axis_position_actual", unit="mm"),
    RunColumn(name="path_feedrate_programmed", unit="mm/s"),
    RunColumn(name="path_feedrate_actual", unit="mm/s"),
    RunColumn(name="override_commanded", unit="1"),
    RunColumn(name="override_actual", unit="1"),
    RunColumn(name="force_set_point", unit="N"),
    RunColumn(name="force_measured", unit="N"),
    RunColumn(name="force_peak", unit="N"),
    RunColumn(name="force_true", unit="N"),
    RunColumn(name="force_expected", unit="N"),
    RunColumn(name="force_ratio", unit="1"),
    RunColumn(name="force_tooth_passing", unit="N"),
    RunColumn(name="force_once_per_revolution", unit="N"),
    RunColumn(name="spindle_power", unit="W"),
    RunColumn(name="spindle_power_true", unit="W"),
    RunColumn(name="removal_rate", unit="mm³/s"),
    RunColumn(name="axial_depth", unit="mm"),
    RunColumn(name="flank_wear", unit="mm"),
    RunColumn(name="level", kind=ColumnKind.WORDS),
    RunColumn(name="holding", kind=ColumnKind.WORDS),
    RunColumn(name="event", kind=ColumnKind.WORDS),
)
"""in the order of :class:`Moment`"""


class ControlSignal(IntEnum):
    """Signals of a row that plots need; the number is its column in the trace."""

    FEED_PROGRAMMED = 0
    FEED_ACTUAL = 1
    OVERRIDE_COMMANDED = 2
    OVERRIDE_ACTUAL = 3
    SET_POINT = 4
    FORCE_MEASURED = 5
    FORCE_EXPECTED = 6
    FORCE_RATIO = 7
    TOOTH_PASSING = 8
    ONCE_PER_REVOLUTION = 9
    SPINDLE_POWER_TRUE = 10
    REMOVAL_RATE = 11
    FLANK_WEAR = 12


_PLACES = [Moment._fields.index(signal.name.lower()) for signal in ControlSignal]


@dataclass(slots=True)
class _Sums:
    """Sums since the last row. Running state."""

    period: float = 0.0
    feed: float = 0.0
    override: float = 0.0
    force: float = 0.0
    power: float = 0.0
    removal: float = 0.0

    def add(self, cycle: LoopCycle, truth: TrueState) -> None:
        reading = cycle.reading
        period = reading.period
        self.period += period
        self.feed += period * reading.feed
        self.override += period * reading.override
        self.force += period * truth.force
        self.power += period * truth.power
        self.removal += period * truth.removal_rate


class ControlTrace:
    """Looks at each cycle, and hands rows on in bulk. Running state; use it with ``with``.

    Parameters
    ----------
    holdings : HoldTallies
        Which has seen each cycle before.
    workingsteps : sequence of str
        Ids by their number, from 1.
    file : RunFile, optional
        With the columns of :data:`COLUMNS`; it is closed at the end.
    has_trace : bool
        Whether there will be plots.
    sink : callable, optional
        Is given each row at once, whatever the file waits for.
    """

    def __init__(
        self,
        course: NominalCourse,
        holdings: HoldTallies,
        *,
        workingsteps: Sequence[str],
        file: RunFile | None = None,
        has_trace: bool = False,
        sink: Callable[[Moment], None] | None = None,
    ) -> None:
        self.file = file
        self._sink = sink
        self._course, self._holdings = course, holdings
        self._names = ("", *workingsteps)
        self._buckets = Buckets(len(ControlSignal)) if has_trace else None
        self._moments: list[Moment] = []
        self._sums = _Sums()
        self._events: list[str] = []
        self._last: tuple[LoopCycle, TrueState] | None = None
        self._written = -inf

    def __enter__(self) -> "ControlTrace":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close(is_whole=kind is None)

    def close(self, *, is_whole: bool) -> None:
        """The last rows; then the file gets its name, or is left as partial."""
        if self.file is None:
            self.end()
            return
        with self.file.closing(is_whole=is_whole):
            self.end()

    @property
    def rows(self) -> int:
        """Number of rows written."""
        return 0 if self.file is None else self.file.rows

    def __call__(self, cycle: LoopCycle, truth: TrueState) -> None:
        """One more cycle, and what really was."""
        self._sums.add(cycle, truth)
        for event in cycle.events:
            self.note(event)
        self._last = cycle, truth
        is_due = cycle.revolution is not None or cycle.reading.time - self._written >= APART
        if is_due:
            self._add(cycle, truth)

    def note(self, event: LoopEvent) -> None:
        """Something that happened, for the row that is to come."""
        self._events.append(f"{event.kind.value}: {event.text}")

    def trace(self) -> BucketedRun | None:
        """The run for plots; None when none was asked for."""
        return None if self._buckets is None else self._buckets.trace()

    def end(self) -> None:
        """The row that was not due yet, and all that wait."""
        if self._last is not None:
            self._add(*self._last)
        self._flush()

    def _add(self, cycle: LoopCycle, truth: TrueState) -> None:
        """One more row."""
        moment = self._moment(cycle, truth)
        self._moments.append(moment)
        if self._sink is not None:
            self._sink(moment)
        self._written = cycle.reading.time
        self._sums, self._last = _Sums(), None
        self._events.clear()
        if len(self._moments) >= ROWS:
            self._flush()

    def _moment(self, cycle: LoopCycle, truth: TrueState) -> Moment:
        reading, sums, turn, course = cycle.reading, self._sums, cycle.revolution, self._course
        x, y, z = course.position[truth.cell].tolist()
        period, weight = sums.period, cycle.weight
        return Moment(
            time=reading.time,
            progress=reading.progress,
            workingstep=self._names[reading.workingstep],
            x=x,
            y=y,
            z=z,
            feed_programmed=float(course.programmed[truth.cell]),
            feed_actual=sums.feed / period,
            override_commanded=cycle.allowed.override,
            override_actual=sums.override / period if reading.can_override else nan,
            set_point=cycle.bound if isfinite(cycle.bound) else nan,
            force_measured=nan if turn is None else turn.force / weight,
            force_peak=nan if turn is None else turn.peak / weight,
            force_true=sums.force / period,
            force_expected=nan if turn is None else cycle.expected / weight,
            force_ratio=nan if cycle.ratio is None else float(np.exp(cycle.ratio)),
            tooth_passing=nan if turn is None else turn.tooth_passing / weight,
            once_per_revolution=nan if turn is None else turn.once_per_revolution / weight,
            spindle_power=reading.power if turn is None else turn.power,
            spindle_power_true=sums.power / period,
            removal_rate=sums.removal / period,
            axial_depth=truth.axial_depth,
            flank_wear=truth.flank_wear,
            level=self._holdings.level.value,
            holding=self._holdings.words,
            event="; ".join(self._events) or None,
        )

    def _flush(self) -> None:
        if not self._moments:
            return
        columns = list(zip(*self._moments, strict=True))
        self._moments.clear()
        if self._buckets is not None:
            values = np.column_stack([np.array(columns[place]) for place in _PLACES])
            self._buckets.add(np.array(columns[0]), values)
        if self.file is not None:
            self.file.write([
                _values(column, values) for column, values in zip(COLUMNS, columns, strict=True)
            ])


def _values(column: RunColumn, values: Sequence[object]) -> Values:
    """One column of the file."""
    if column.kind is ColumnKind.WORDS:
        return words_of(values)
    return np.array(values, np.float64 if column.kind is ColumnKind.EXACT else np.float32)
