"""The rows of a run in a file that grows, and a window of them that fits a screen.

The file is a line of JSON with the names of the columns, which carry their units, and then rows
of 64-bit numbers, ascending in the first column, which is the time. It is read while it grows:
what is not a whole row yet is not there yet. A window keeps least, mean and greatest of rows
that it brings together, so that no peak is lost.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

import numpy as np

from service.errors import NotFound
from simulator.motion.segments import Floats

TIME = "time_s"

MOST_POINTS = 5000
"""of a window: more than a screen has"""

BYTES = 8


class SeriesWriter:
    """Rows on their way to a file. Running state; use it with ``with``.

    Parameters
    ----------
    file : Path
    columns : sequence of str
        The first is the time.
    """

    def __init__(self, file: Path, columns: Sequence[str]) -> None:
        self.rows = 0
        # Not cut short in place: whoever has mapped the rows of an earlier attempt keeps them.
        file.unlink(missing_ok=True)
        self._file = file.open("wb")
        self._file.write(json.dumps(list(columns)).encode() + b"\n")
        self._file.flush()

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
        """More rows (M, C), later than those before; NaN is a missing value."""
        self._file.write(np.ascontiguousarray(rows, dtype="<f8").tobytes())
        self._file.flush()
        self.rows += len(rows)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Series:
    """The rows that a file holds now."""

    columns: tuple[str, ...]
    values: Floats
    """(N, C), read from the file as they are needed"""

    def __len__(self) -> int:
        return len(self.values)

    def places(self, names: Sequence[str]) -> list[int]:
        """Where columns stand.

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
    """(B,) s, of the first row of each"""
    end: Floats
    """(B,) s, of the last one"""
    low: Floats
    """(B, S)"""
    mean: Floats
    """(B, S)"""
    high: Floats
    """(B, S)"""
    rows: int
    """that the range holds"""

    @property
    def is_reduced(self) -> bool:
        """Whether rows were brought together."""
        return self.rows > len(self.time)


def open_series(file: Path) -> Series | None:
    """What a file holds now; None: there is no file, or not even its head."""
    try:
        with file.open("rb") as opened:
            head = opened.readline()
        size = file.stat().st_size
    except FileNotFoundError:
        return None
    if not head.endswith(b"\n"):
        return None
    columns = tuple(json.loads(head))
    count = (size - len(head)) // (BYTES * len(columns))
    if count == 0:
        return Series(columns=columns, values=np.empty((0, len(columns))))
    values = np.memmap(
        file, dtype="<f8", mode="r", offset=len(head), shape=(count, len(columns))
    )
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
    rows = np.asarray(series.values[first:last, [0, *places]], dtype=np.float64)
    count = len(rows)
    shown = min(count, max(points, 1))
    starts = np.arange(shown) * count // max(shown, 1)
    ends = np.append(starts[1:], count)[:shown] - 1
    time, values = rows[:, 0], rows[:, 1:]
    if shown == count:
        low = mean = high = values
    else:
        low = np.fmin.reduceat(values, starts, axis=0)
        high = np.fmax.reduceat(values, starts, axis=0)
        known = ~np.isnan(values)
        sums = np.add.reduceat(np.where(known, values, 0.0), starts, axis=0)
        counts = np.add.reduceat(known.astype(np.float64), starts, axis=0)
        mean = np.divide(sums, counts, out=np.full_like(sums, np.nan), where=counts > 0.0)
    return Window(
        names=tuple(names), time=time[starts], end=time[ends], low=low, mean=mean, high=high,
        rows=count,
    )  # fmt: skip


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
