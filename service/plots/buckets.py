"""Minimum, mean and maximum of the signals of a run over time, in bounded memory, for plots.

Values fall into buckets of equal width. When a run outgrows them, neighbouring buckets are
merged and the width doubles, so that a run of a second and one of a hundred hours take the same
memory and no peak is lost. Widths are powers of two: bucket borders stay borders when the width
doubles, and the result does not depend on how the values were cut into chunks. Time in s.
"""

from dataclasses import dataclass

import numpy as np

from simulator.motion.segments import Floats

MOST = 4096
"""Largest number of buckets; must be even."""

FINEST = 2.0**-14
"""Initial width of a bucket, in s; shorter than the interval of the fastest sampling."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BucketCurve:
    """Minimum, mean and maximum of a signal in each bucket; NaN where no sample is known."""

    low: Floats
    """Minimum in each bucket, (B,)."""
    mean: Floats
    """Mean of each bucket, (B,)."""
    high: Floats
    """Maximum in each bucket, (B,)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BucketedRun:
    """Signals of a run in B non-empty buckets, ascending in time."""

    width: float
    """Width of a bucket, in s."""
    begin: Floats
    """Time of the first sample in each bucket, (B,), s."""
    end: Floats
    """Time of the last sample in each bucket, (B,), s."""
    curves: tuple[BucketCurve, ...]
    """Curves of the signals, indexed by signal number."""

    def curve(self, signal: int) -> BucketCurve:
        """Curve of a signal, by its number."""
        return self.curves[signal]


class Buckets:
    """Collect the samples of a run into time buckets as they arrive. Running state.

    Parameters
    ----------
    signals : int
        Number of signals sampled at each time.
    """

    def __init__(self, signals: int) -> None:
        self._signals = signals
        self._width = FINEST
        self._begin, self._end = np.full(MOST, np.inf), np.full(MOST, -np.inf)
        shape = (MOST, signals)
        self._count, self._sum = np.zeros(shape), np.zeros(shape)
        self._low, self._high = np.full(shape, np.inf), np.full(shape, -np.inf)

    def add(self, time: Floats, values: Floats) -> None:
        """Add samples that are later than all samples before.

        Parameters
        ----------
        time : (M,) array, s
            Ascending times of the samples.
        values : (M, S) array
            Values of the signals; NaN marks a missing value.
        """
        while len(time):
            fits = int(np.searchsorted(time, MOST * self._width))
            self._put(time[:fits], values[:fits])
            time, values = time[fits:], values[fits:]
            if len(time):
                self._widen()

    def trace(self) -> BucketedRun:
        """Return the buckets filled so far."""
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
        """Add samples that fit into the current time range."""
        rows = (time / self._width).astype(np.int64)
        np.minimum.at(self._begin, rows, time)
        np.maximum.at(self._end, rows, time)
        # Add values one by one, so that sums do not depend on how they are cut into chunks.
        cells = (rows[:, None] * self._signals + np.arange(self._signals)).ravel()
        flat = values.ravel()
        is_known = ~np.isnan(flat)
        np.add.at(self._count.reshape(-1), cells, is_known.astype(np.float64))
        np.add.at(self._sum.reshape(-1), cells, np.where(is_known, flat, 0.0))
        np.minimum.at(self._low.reshape(-1), cells, np.where(is_known, flat, np.inf))
        np.maximum.at(self._high.reshape(-1), cells, np.where(is_known, flat, -np.inf))

    def _widen(self) -> None:
        """Double the bucket width by merging each pair of neighbouring buckets."""
        self._width *= 2.0
        self._begin = _merged(self._begin, np.minimum, np.inf)
        self._end = _merged(self._end, np.maximum, -np.inf)
        self._count = _merged(self._count, np.add, 0.0)
        self._sum = _merged(self._sum, np.add, 0.0)
        self._low = _merged(self._low, np.minimum, np.inf)
        self._high = _merged(self._high, np.maximum, -np.inf)


def _merged(cells: Floats, join: np.ufunc, empty: float) -> Floats:
    """Merge neighbouring cells into the first half of the array and clear the second half."""
    pairs = join(cells[0::2], cells[1::2])
    return np.concatenate((pairs, np.full_like(pairs, empty)))
