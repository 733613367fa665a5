"""The rows of a run in a file that grows, and a window of them that fits a screen.

The file is a line of JSON with the names of the columns, which carry their units, and then rows
of 64-bit numbers, ascending in the first column, which is the time. It is read while it grows:
what is not a whole row yet is not there yet. A window keeps least, mean and greatest of rows
that it brings together, so that no peak is lost.
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
from service.live.storage import storing, write_whole
from simulator.motion.segments import Floats, Ints

BLOCK = 16 << 20
"""bytes of rows in memory at once; what is worked out of them takes some times as much"""

TIME = "time_s"

MOST_POINTS = 5000
"""of a window: more than a screen has"""

BYTES = 8

MOST_BYTES = 512 << 20
"""of a file: some million rows, which a window of them all reads in seconds"""


class SeriesWriter:
    """Rows on their way to a file. Running state; use it with ``with``.

    Parameters
    ----------
    file : Path
    columns : sequence of str
        The first is the time.

    Raises
    ------
    StorageFull, Unavailable
        When it cannot be written.
    """

    def __init__(self, file: Path, columns: Sequence[str]) -> None:
        self.rows = 0
        """that are in the file"""
        self.is_full = False
        """whether rows were left out, as the file has as many as it may have"""
        self._name = file.name
        self._most = MOST_BYTES // (BYTES * len(columns))
        with storing(self._name):
            # Not cut short in place: who has mapped the rows of an earlier attempt keeps them.
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
        """More rows (M, C), later than those before; NaN is a missing value.

        A file that has as many as it may have takes no more, and says so.

        Raises
        ------
        StorageFull, Unavailable
            When they cannot be written.
        """
        taken = rows[: self._most - self.rows]
        self.is_full = self.is_full or len(taken) < len(rows)
        with storing(self._name):
            write_whole(self._file.fileno(), np.ascontiguousarray(taken, dtype="<f8").tobytes())
        self.rows += len(taken)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Series:
    """The rows that a file holds now."""

    columns: tuple[str, ...]
    values: Floats
    """Values, (N, C), read from the file as they are needed"""

    def __len__(self) -> int:
        return len(self.values)

    def places(self, names: Sequence[str]) -> list[int]:
        """Indices of columns by their names.

        Raises
        ------
        NotFound
            When there is no such column.
        """
        for name in names:
            if name not in self.columns:
                raise NotFound("signal", name)
        return [self.columns.index(name) for name in names]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Window:
    """Rows of a range of time, B of them or fewer than there were."""

    names: tuple[str, ...]
    time: Floats
    """Time, (B,) s, of the first row of each"""
    end: Floats
    """End, (B,) s, of the last one"""
    low: Floats
    """Low, (B, S)"""
    mean: Floats
    """Mean, (B, S)"""
    high: Floats
    """High, (B, S)"""
    rows: int
    """that the range holds"""

    @property
    def is_reduced(self) -> bool:
        """Whether rows were merged."""
        return self.rows > len(self.time)


def open_series(file: Path) -> Series | None:
    """Rows of a file; None: there is no file yet, or not even its header."""
    try:
        # Once it is open it stays, whoever deletes it.
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
    """A range of time in a number of points at most.

    Parameters
    ----------
    series : Series
    names : sequence of str
    begin, end : float, s
    points : int

    Raises
    ------
    NotFound
        When there is no such signal.
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
    """Least, mean and greatest (B, S) of the rows from each start to the next."""
    shape = (len(starts), len(places))
    low, high = np.full(shape, np.nan), np.full(shape, np.nan)
    sums, counts = np.zeros(shape), np.zeros(shape)
    for begin, stop in blocks(int(starts[0]), end, width=len(places)):
        values = np.asarray(series.values[begin:stop, places], dtype=np.float64)
        known = ~np.isnan(values)
        # The first of them may have begun in the block before.
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
    """Pieces of a range of rows of so many numbers, each of which takes little memory."""
    step = max(BLOCK // (BYTES * max(width, 1)), 1)
    for first in range(begin, end, step):
        yield first, min(first + step, end)


def first_at(series: Series, time: float) -> int:
    """Number of the first row at or after a time: found by halving, few rows are read."""
    low, high = 0, len(series)
    while low < high:
        middle = (low + high) // 2
        if series.values[middle, 0] < time:
            low = middle + 1
        else:
            high = middle
    return low
