"""Rows of a run in a growing file, and windows of them that fit a screen.

The file starts with a JSON line of the column names, which carry their units; rows of 64-bit
numbers follow, ascending in the first column, the time. The file is read while it grows;
incomplete rows are ignored. A window keeps minimum, mean and maximum of the rows that it
merges, so that no peak is lost.
"""

import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from io import BufferedReader
from pathlib import Path
from types import TracebackType

import numpy as np

from service.errors import NotFound
from service.live.journal import storing, write_whole
from simulator.motion.segments import Floats, Ints

BLOCK = 16 << 20
"""Most bytes of rows in memory at once; calculations take several times as much."""

TIME = "time_s"

MOST_POINTS = 5000
"""Default number of points in a window, more than a screen shows."""

BYTES = 8

MOST_BYTES = 512 << 20
"""Largest size of a file, in bytes: some million rows, which are read in seconds."""


class SeriesWriter:
    """Writer of rows to a file, a context manager. Running state.

    Parameters
    ----------
    columns : sequence of str
        Names of the columns; the first must be the time.

    Raises
    ------
    StorageFull, Unavailable
        When the file cannot be written.
    """

    def __init__(self, file: Path, columns: Sequence[str]) -> None:
        self.rows = 0
        """Number of rows in the file."""
        self.is_full = False
        """Whether rows were omitted because the file has reached its largest size."""
        self._name = file.name
        self._most = MOST_BYTES // (BYTES * len(columns))
        with storing(self._name):
            # Not truncated in place: readers of an earlier attempt keep their mapped rows.
            file.unlink(missing_ok=True)
            self._file = file.open("wb", buffering=0)
            write_whole(self._file.fileno(), json.dumps(list(columns)).encode() + b"\n")

    def __enter__(self) -> "SeriesWriter":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._file.close()

    def add(self, rows: Floats) -> None:
        """Write rows (M, C), later than all before; NaN is a missing value.

        When the file reaches its largest size, further rows are omitted and ``is_full`` is set.

        Raises
        ------
        StorageFull, Unavailable
            When the rows cannot be written.
        """
        taken = rows[: self._most - self.rows]
        self.is_full = self.is_full or len(taken) < len(rows)
        with storing(self._name):
            write_whole(self._file.fileno(), np.ascontiguousarray(taken, dtype="<f8").tobytes())
        self.rows += len(taken)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Series:
    """Rows that a file holds at the time of opening."""

    columns: tuple[str, ...]
    values: Floats
    """Values, (N, C), read from the file on demand."""

    def __len__(self) -> int:
        return len(self.values)

    def places(self, names: Sequence[str]) -> list[int]:
        """Return the indices of columns by their names.

        Raises
        ------
        NotFound
            When a column does not exist.
        """
        for name in names:
            if name not in self.columns:
                raise NotFound("signal", name)
        return [self.columns.index(name) for name in names]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Window:
    """Rows of a time range, merged into at most B points."""

    names: tuple[str, ...]
    time: Floats
    """Time of the first row of each point, (B,), s."""
    end: Floats
    """Time of the last row of each point, (B,), s."""
    low: Floats
    """Minimum of each signal at each point, (B, S)."""
    mean: Floats
    """Mean of each signal at each point, (B, S)."""
    high: Floats
    """Maximum of each signal at each point, (B, S)."""
    rows: int
    """Number of rows in the time range."""

    @property
    def is_reduced(self) -> bool:
        """True if rows were merged."""
        return self.rows > len(self.time)


def open_series(file: Path) -> Series | None:
    """Open the rows of a file; None before the file and its header exist."""
    try:
        # An open file stays readable, even when it is deleted.
        with file.open("rb") as opened:
            return _series_in(opened)
    except FileNotFoundError:
        return None


def _series_in(opened: BufferedReader) -> Series | None:
    head = opened.readline()
    if not head.endswith(b"\n"):
        return None
    columns = tuple(json.loads(head))
    count = (os.fstat(opened.fileno()).st_size - len(head)) // (BYTES * len(columns))
    shape = (count, len(columns))
    if count == 0:
        return Series(columns=columns, values=np.empty(shape))
    values = np.memmap(opened, dtype="<f8", mode="r", offset=len(head), shape=shape)
    return Series(columns=columns, values=values)


def window(
    series: Series,
    names: Sequence[str],
    *,
    begin: float = -np.inf,
    end: float = np.inf,
    points: int = MOST_POINTS,
) -> Window:
    """Return the signals of a time range, merged into at most a number of points.

    Parameters
    ----------
    begin, end : float, s
    points : int

    Raises
    ------
    NotFound
        When a signal does not exist.
    """
    places = series.places(names)
    first = first_at(series, begin)
    last = first_at(series, float(np.nextafter(end, np.inf)))
    count = max(last - first, 0)
    shown = min(count, max(points, 1))
    starts = first + np.arange(shown) * count // max(shown, 1)
    ends = np.append(starts[1:], last)[:shown] - 1
    time = series.values[:, 0]
    if shown == count:
        low = mean = high = np.asarray(series.values[first:last, places], dtype=np.float64)
    else:
        low, mean, high = _reduced(series, places, starts, end=last)
    return Window(
        names=tuple(names), time=np.asarray(time[starts]), end=np.asarray(time[ends]),
        low=low, mean=mean, high=high, rows=count,
    )  # fmt: skip


def _reduced(
    series: Series, places: Sequence[int], starts: Ints, *, end: int
) -> tuple[Floats, Floats, Floats]:
    """Minimum, mean and maximum of the rows from each start to the next, each (B, S)."""
    shape = (len(starts), len(places))
    low, high = np.full(shape, np.nan), np.full(shape, np.nan)
    sums, counts = np.zeros(shape), np.zeros(shape)
    for begin, stop in blocks(int(starts[0]), end, width=len(places)):
        values = np.asarray(series.values[begin:stop, places], dtype=np.float64)
        known = ~np.isnan(values)
        # The first point may have begun in the previous block.
        at = slice(
            int(np.searchsorted(starts, begin, side="right")) - 1,
            int(np.searchsorted(starts, stop)),
        )
        cuts = np.maximum(starts[at], begin) - begin
        low[at] = np.fmin(low[at], np.fmin.reduceat(values, cuts, axis=0))
        high[at] = np.fmax(high[at], np.fmax.reduceat(values, cuts, axis=0))
        counts[at] += np.add.reduceat(known, cuts, axis=0, dtype=np.float64)
        values[~known] = 0.0
        sums[at] += np.add.reduceat(values, cuts, axis=0)
    mean = np.divide(sums, counts, out=np.full(shape, np.nan), where=counts > 0.0)
    return low, mean, high


def blocks(begin: int, end: int, *, width: int) -> Iterator[tuple[int, int]]:
    """Yield ranges of rows that are small enough to be held in memory."""
    step = max(BLOCK // (BYTES * max(width, 1)), 1)
    for first in range(begin, end, step):
        yield first, min(first + step, end)


def first_at(series: Series, time: float) -> int:
    """Index of the first row at or after a time, by bisection."""
    low, high = 0, len(series)
    while low < high:
        middle = (low + high) // 2
        if series.values[middle, 0] < time:
            low = middle + 1
        else:
            high = middle
    return low
