"""Curves of a run for plots, in bounded memory: least, mean and greatest by time.

Values fall into buckets of one width. When the run outgrows them, neighbours are merged and
the width doubles, so that a run of a second and one of a hundred hours take the same room and
no peak is lost. Widths are powers of two: the border of a bucket stays one when widths double,
and the trace is the same however the values were cut in chunks. Time in s.
"""

from dataclasses import dataclass

import numpy as np

from simulator.motion.segments import Floats

MOST = 4096
"""buckets; an even number"""

FINEST = 2.0**-14
"""s, width of the first buckets: below the interval of the fastest sampling"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BucketCurve:
    """One signal in each bucket; NaN where all its samples are missing."""

    low: Floats
    """Low, (B,)"""
    mean: Floats
    """Mean, (B,)"""
    high: Floats
    """High, (B,)"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BucketedRun:
    """A run in B buckets that hold samples, ascending in time."""

    width: float
    """Width, s"""
    begin: Floats
    """Begin, (B,) s, first sample of each bucket"""
    end: Floats
    """End, (B,) s, last one"""
    curves: tuple[BucketCurve, ...]
    """by the number of the signal"""

    def curve(self, signal: int) -> BucketCurve:
        """One signal."""
        return self.curves[signal]


class Buckets:
    """Keeps the trace of a run while its values pass by. Running state.

    Parameters
    ----------
    signals : int
        How many values there are at each time.
    """

    def __init__(self, signals: int) -> None:
        self._signals = signals
        self._width = FINEST
        self._begin, self._end = np.full(MOST, np.inf), np.full(MOST, -np.inf)
        shape = (MOST, signals)
        self._count, self._sum = np.zeros(shape), np.zeros(shape)
        self._low, self._high = np.full(shape, np.inf), np.full(shape, -np.inf)

    def add(self, time: Floats, values: Floats) -> None:
        """More values, later than those before.

        Parameters
        ----------
        time : (M,) array, s
            Ascending.
        values : (M, S) array
            NaN is a missing value.
        """
        while len(time):
            fits = int(np.searchsorted(time, MOST * self._width))
            self._put(time[:fits], values[:fits])
            time, values = time[fits:], values[fits:]
            if len(time):
                self._widen()

    def trace(self) -> BucketedRun:
        """The run so far."""
        held = np.isfinite(self._begin)
        is_known = self._count[held] > 0.0
        counts = np.where(is_known, self._count[held], np.nan)
        low = np.where(is_known, self._low[held], np.nan)
        mean = self._sum[held] / counts
        high = np.where(is_known, self._high[held], np.nan)
        return BucketedRun(
            width=self._width,
            begin=self._begin[held],
            end=self._end[held],
            curves=tuple(
                BucketCurve(low=low[:, row], mean=mean[:, row], high=high[:, row])
                for row in range(self._signals)
            ),
        )

    def _put(self, time: Floats, values: Floats) -> None:
        """Values that fit."""
        rows = (time / self._width).astype(np.int64)
        np.minimum.at(self._begin, rows, time)
        np.maximum.at(self._end, rows, time)
        # One value after another, so that sums do not depend on how they are cut in chunks.
        cells = (rows[:, None] * self._signals + np.arange(self._signals)).ravel()
        flat = values.ravel()
        is_known = ~np.isnan(flat)
        np.add.at(self._count.reshape(-1), cells, is_known.astype(np.float64))
        np.add.at(self._sum.reshape(-1), cells, np.where(is_known, flat, 0.0))
        np.minimum.at(self._low.reshape(-1), cells, np.where(is_known, flat, np.inf))
        np.maximum.at(self._high.reshape(-1), cells, np.where(is_known, flat, -np.inf))

    def _widen(self) -> None:
        """Make one bucket of two."""
        self._width *= 2.0
        self._begin = _merged(self._begin, np.minimum, np.inf)
        self._end = _merged(self._end, np.maximum, -np.inf)
        self._count = _merged(self._count, np.add, 0.0)
        self._sum = _merged(self._sum, np.add, 0.0)
        self._low = _merged(self._low, np.minimum, np.inf)
        self._high = _merged(self._high, np.maximum, -np.inf)


def _merged(cells: Floats, join: np.ufunc, empty: float) -> Floats:
    """Neighbours joined in the first half, the second half empty."""
    pairs = join(cells[0::2], cells[1::2])
    return np.concatenate((pairs, np.full_like(pairs, empty)))
