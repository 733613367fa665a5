"""Collector of a run's totals, samples and plot signals on the virtual machine.

Signals of a simulated run for plots, in bounded memory. Units mm, s, N, W, rev/s.

The samples of a simulated run as a Parquet or CSV file, in bounded memory.
"""

from collections.abc import Callable, Mapping, Sequence
from enum import IntEnum
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from service.outputs.run_file import ColumnKind, RunColumn, RunFile, Values, Words
from service.plots.buckets import BucketedRun, Buckets
from simulator.errors import ProgramFault, SimulationError
from simulator.machine.disturbance import Disturbance, Disturbed
from simulator.machine.samples import Episode, Execution, Samples, joined
from simulator.machine.sensing import Sampler
from simulator.machine.timeline import COLUMNS, DataItem
from simulator.machine.totals import Total, added
from simulator.machine.virtual import VirtualMachine
from simulator.motion.segments import Floats


class SimulationSignal(IntEnum):
    """Signals of a run that are kept for plots; the value is the column index."""

    X_POWER = 0
    Y_POWER = 1
    Z_POWER = 2
    SPINDLE_POWER = 3
    COOLANT_POWER = 4
    BASE_POWER = 5
    TOTAL_POWER = 6
    FEED_PROGRAMMED = 7
    FEED_ACTUAL = 8
    SPINDLE_SPEED = 9
    FORCE = 10
    REMOVAL_RATE = 11
    OVERLOAD = 12
    """Overload, a :class:`simulator.machine.samples.Condition`."""


class TraceKeeper:
    """Collects the signals of a run for plots while it is simulated. Running state."""

    def __init__(self) -> None:
        self._buckets = Buckets(len(SimulationSignal))

    def add(self, samples: Samples) -> None:
        """Add samples, later than all before; NaN is a missing value."""
        self._buckets.add(samples.time, _values(samples))

    def trace(self) -> BucketedRun:
        """Return the signals collected so far."""
        return self._buckets.trace()


def _values(samples: Samples) -> Floats:
    """Return the signals as an array, (M, S), in the order of their numbers."""
    return np.column_stack((
        samples.axis_power,
        samples.spindle_power,
        samples.coolant_power,
        samples.base_power,
        samples.total_power,
        samples.feed_programmed,
        samples.path_speed,
        samples.spindle_speed,
        samples.cutting_force,
        samples.removal_rate,
        samples.overload,
    ))


ROWS = 32_768
"""in one group of the file"""

MOST_PARTS = 512
"""that wait in memory, each with an overhead of its own"""

EXACT = frozenset({"time", "position"})
"""columns that keep 64 bits; sensors do not have the digits of the others"""

WHOLE = frozenset({"line", "tool"})
"""columns of numbers that count"""


class TimelineFile:
    """Samples on their way to a file. Running state; use it with ``with``.

    Parameters
    ----------
    path : Path
        Ends with ``.parquet`` or ``.csv``.
    workingsteps : sequence of str
        Ids by their number, from 1; may grow while samples come.
    program : str
        Its name.

    Raises
    ------
    WriteError
        When the ending is another, or the disk refuses.
    """

    def __init__(self, path: Path, workingsteps: Sequence[str], *, program: str = "") -> None:
        self._run = RunFile(path, timeline_columns())
        self._workingsteps = workingsteps
        self._program = program
        self._waiting: list[Samples] = []
        self._count = 0

    @property
    def rows(self) -> int:
        """Number of rows written."""
        return self._run.rows

    @property
    def place(self) -> Path | None:
        """Name of the file once it is closed."""
        return self._run.place

    @property
    def partial(self) -> Path:
        """Name of the file that an interrupted run leaves."""
        return self._run.partial

    def __enter__(self) -> "TimelineFile":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with self._run.closing(is_whole=kind is None):
            self._flush()

    def add(self, samples: Samples) -> None:
        """More samples, later than those before."""
        self._waiting.append(samples)
        self._count += len(samples)
        if self._count >= ROWS:
            self._flush()
        elif len(self._waiting) >= MOST_PARTS:
            self._waiting = [joined(self._waiting)]

    def _flush(self) -> None:
        if not self._count:
            return
        samples, self._waiting, self._count = joined(self._waiting), [], 0
        names = {"program": (self._program,), "workingstep": ("", *self._workingsteps)}
        self._run.write([_values_of(column, samples, names) for column in COLUMNS])


Names = Mapping[str, tuple[str, ...]]
"""words that only the run knows, by the attribute of the samples"""

OF_RUN: Names = {"program": (), "workingstep": ()}


def timeline_columns() -> list[RunColumn]:
    """Columns of the file, in their order."""

    def kind(column: DataItem) -> ColumnKind:
        if _words(column, OF_RUN) is not None:
            return ColumnKind.WORDS
        if column.source in WHOLE:
            return ColumnKind.COUNT
        return ColumnKind.EXACT if column.source in EXACT else ColumnKind.NUMBER

    return [
        RunColumn(name=column.name, kind=kind(column), unit=column.unit) for column in COLUMNS
    ]


def _words(column: DataItem, of_run: Names) -> tuple[str, ...] | None:
    """Words of the numbers of a column; None: it has numbers."""
    return of_run.get(column.source, column.words)


def _values_of(column: DataItem, samples: Samples, of_run: Names) -> Values:
    """One column of the file."""
    values: NDArray[Any] = getattr(samples, column.source)
    if column.axis is not None:
        values = values[:, column.axis]
    words = _words(column, of_run)
    if words is not None:
        return Words(codes=values.astype(np.int32), names=words)
    if column.source in WHOLE:
        return values.astype(np.int32)
    kind = np.float64 if column.source in EXACT else np.float32
    return (values * column.scale).astype(kind)


MOST_SECONDS = 1e7
"""Longest machining time, in s, about 100 days; more suggests a wrong feed or dwell."""


class SampleWatcher(Protocol):
    """Observer of the samples while the machine runs, e.g. a live view."""

    def begin(self, workingsteps: Sequence[str]) -> None:
        """Receive the list of workingstep ids, numbered from 1, which grows during the run."""

    def add(self, samples: Samples) -> None:
        """Receive samples, later than all before."""


class RunCollector:
    """Collected totals, samples and plot signals of a run."""

    def __init__(
        self,
        virtual: VirtualMachine,
        disturbance: Disturbance,
        *,
        rate: float,
        watchers: Sequence[SampleWatcher],
    ) -> None:
        self.totals = [Total()]
        self.file: TimelineFile | None = None
        self.trace: TraceKeeper | None = None
        self.block = 0.0
        """Number of the current block, plus the completed share of it."""
        self.share = 0.0
        """Completed share of the program that was reported last."""
        self._watchers = watchers
        for watcher in watchers:
            watcher.begin(virtual.workingsteps)
        self._machine = virtual.machine
        self._sampler = Sampler(virtual.machine, rate=rate)
        self._disturbed = Disturbed(
            disturbance=disturbance, rate=rate, efficiency=virtual.machine.spindle.efficiency
        )

    def add(self, episode: Episode, *, ticked: Callable[[], None]) -> None:
        """Add an episode of the run to totals and samples."""
        require_sense(episode)
        at = episode.state.workingstep
        self.totals += [Total() for _ in range(len(self.totals), at + 1)]
        self.totals[at] = added(self.totals[at], episode, self._machine)
        self.block = block_at(episode, episode.begin)
        ticked()
        takers = [
            taker for taker in (self.file, self.trace, *self._watchers) if taker is not None
        ]
        if not takers:
            return
        for samples in self._sampler.samples(episode):
            shown = self._disturbed.shown(samples)
            for taker in takers:
                taker.add(shown)
            self.block = block_at(episode, float(samples.time[-1]))
            ticked()


def block_at(episode: Episode, time: float) -> float:
    """Fractional block number at a time in s; blocks of a stretch count as equally long."""
    if episode.course is None:
        return float(episode.state.line)
    blocks = episode.course.segments.block
    share = (time - episode.begin) / (episode.end - episode.begin)
    return float(blocks[0] + share * (blocks[-1] - blocks[0]))


def require_sense(episode: Episode) -> None:
    """Refuse a program that takes no time or does not end."""
    if episode.state.execution is Execution.PROGRAM_COMPLETED and episode.end == 0.0:
        raise SimulationError("the program contains nothing that takes time")
    if episode.end > MOST_SECONDS:
        course = episode.course
        line = episode.state.line if course is None else int(course.segments.block[-1])
        text = f"{episode.end:.3g} s of machining: the limit is {MOST_SECONDS:g} s"
        raise ProgramFault(text, line)
