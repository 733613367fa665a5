"""What plots need of a run, in bounded memory: least, mean and greatest by time.

Samples fall into buckets of one width. When the run outgrows them, neighbours are merged and
the width doubles, so that a run of a second and one of a hundred hours take the same room and
no peak is lost. Widths are powers of two: the border of a bucket stays one when widths double,
and the trace is the same however the samples were cut in chunks. Units mm, s, N, W, rev/s.
"""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from simulator.machine.samples import Samples
from simulator.motion.segments import Floats

MOST = 4096
"""buckets; an even number"""

FINEST = 2.0**-14
"""s, width of the first buckets: below the interval of the fastest sampling"""


class Signal(IntEnum):
    """What is kept of the samples; the number is its column."""

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
    """:class:`simulator.machine.samples.Condition`"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Curve:
    """One signal in each bucket; NaN where all its samples are missing."""

    low: Floats
    """(B,)"""
    mean: Floats
    """(B,)"""
    high: Floats
    """(B,)"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trace:
    """A run in B buckets that hold samples, ascending in time."""

    width: float
    """s"""
    begin: Floats
    """(B,) s, first sample of each bucket"""
    end: Floats
    """(B,) s, last one"""
    curves: tuple[Curve, ...]
    """by the number of the signal"""

    def curve(self, signal: Signal) -> Curve:
        """One signal."""
        return self.curves[signal]


class TraceKeeper:
    """Keeps the trace of a run while its samples pass by. Running state."""

    def __init__(self) -> None:
        self._width = FINEST
        self._begin, self._end = np.full(MOST, np.inf), np.full(MOST, -np.inf)
        shape = (MOST, len(Signal))
        self._count, self._sum = np.zeros(shape), np.zeros(shape)
        self._low, self._high = np.full(shape, np.inf), np.full(shape, -np.inf)

    def add(self, samples: Samples) -> None:
        """More samples, later than those before; NaN is a missing value."""
        time, values = samples.time, _values(samples)
        while len(time):
            fits = int(np.searchsorted(time, MOST * self._width))
            self._put(time[:fits], values[:fits])
            time, values = time[fits:], values[fits:]
            if len(time):
                self._widen()

    def trace(self) -> Trace:
        """The run so far."""
        held = np.isfinite(self._begin)
        is_known = self._count[held] > 0.0
        counts = np.where(is_known, self._count[held], np.nan)
        low = np.where(is_known, self._low[held], np.nan)
        mean = self._sum[held] / counts
        high = np.where(is_known, self._high[held], np.nan)
        return Trace(
            width=self._width,
            begin=self._begin[held],
            end=self._end[held],
            curves=tuple(
                Curve(low=low[:, row], mean=mean[:, row], high=high[:, row]) for row in Signal
            ),
        )

    def _put(self, time: Floats, values: Floats) -> None:
        """Samples that fit."""
        rows = (time / self._width).astype(np.int64)
        np.minimum.at(self._begin, rows, time)
        np.maximum.at(self._end, rows, time)
        # One sample after another, so that sums do not depend on how samples are cut in chunks.
        cells = (rows[:, None] * len(Signal) + np.arange(len(Signal))).ravel()
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


def _values(samples: Samples) -> Floats:
    """(M, S) signals in the order of their numbers."""
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
