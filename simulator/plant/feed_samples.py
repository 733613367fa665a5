"""Samples of one reading at feed: the way of the axes, and the mean forces of the cutter.

The arrays stay in place while a machine runs, and kernels are bound to them: a dozen calls of
numpy for eight samples would take far longer than their arithmetic. Sums are added up as numpy
does. Units mm, s, N.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from simulator.kernels.kernel import entry, kernel
from simulator.motion.segments import Floats, Ints
from simulator.plant.course import NominalCourse, Singles

_BLOCK = 128  # values that numpy adds up in eight sums


def view(values: NDArray[Any]) -> "memoryview[Any]":
    """View of an array, whose items Python reads and writes in a third of the time."""
    return values.data


class FeedSamples:
    """Samples of readings with a given number of samples (mutable state).

    Parameters
    ----------
    count : int
        Number K of samples.
    lag : float, s
        Lag of the axes behind their override.
    """

    def __init__(self, course: NominalCourse, count: int, lag: float) -> None:
        self.ways, self.chips, self.land = np.empty(count), np.empty(count), np.empty(count)
        """Program time from the begin of the reading, s; mean forces of chips and of the wear
        land over a revolution, N; at each sample, (K,)."""
        self.force, self.shape = np.empty(count), np.empty(count)
        """Force at each sample, N, and its ratio to the mean of a revolution, (K,)."""
        self._lag, self._period = lag, 0.0
        self._steps, self._gone = (np.arange(count) + 1.0) / count, np.empty(count)
        self._overrides, self._powers = np.empty(count), np.empty(count)
        rows = np.empty(count, dtype=np.int64)
        asked, scales, sums = np.empty(5), np.empty(2), np.empty(2)
        factor = np.empty(1, dtype=course.force.dtype)
        self._way, self._row = view(self.ways), view(rows)
        self._asked, self._factor = view(asked), view(factor)
        self._scales, self._sums = view(scales), view(sums)
        self._go = _go.bound(
            asked,
            (self._steps, self._gone),
            np.ascontiguousarray(course.until),
            (self.ways, self._overrides, rows),
        )
        self._cut = _cut.bound(
            (factor, scales),
            (np.ascontiguousarray(course.force), np.ascontiguousarray(course.land_force)),
            (rows, self._powers, self.shape),
            (self.chips, self.land, self.force),
            sums,
        )

    @property
    def way(self) -> float:
        """Program time of the whole reading, s."""
        return float(self._way[-1])

    @property
    def row(self) -> int:
        """Cell of the last sample."""
        return int(self._row[-1])

    @property
    def peak(self) -> float:
        """Greatest force of a sample, N."""
        return float(self._sums[1])

    def go(
        self, progress: float, cell: int, *, override: float, aim: float, period: float
    ) -> None:
        """Find way, override and cell of each sample; the override lags its command.

        Parameters
        ----------
        progress : float, s
            Program time at the begin.
        cell : int
            Its cell.
        override : float
            Override that the axes run at the begin.
        aim : float
            Override towards which they go.
        period : float, s
            Duration of the reading.
        """
        if self._period != period:
            self._period = period
            self._gone[...] = 1.0 - np.exp(-period * self._steps / self._lag)
        asked = self._asked
        asked[0], asked[1], asked[2] = progress, aim * period, (override - aim) * self._lag
        asked[3], asked[4] = len(self._way) / period, cell
        self._go()

    def cut(self, exponent: float, *, factor: float, depth: float, flank_wear: float) -> float:
        """Compute the forces for the shape given; return their mean over the reading, N.

        Parameters
        ----------
        exponent : float
            Exponent of force over feed.
        factor, depth : float
            Factors on the force of the chips, and on the depth.
        flank_wear : float, mm
        """
        np.power(self._overrides, exponent, out=self._powers)
        self._factor[0] = factor
        self._scales[0], self._scales[1] = depth, flank_wear
        self._cut()
        return float(self._sums[0]) / len(self._way)


@entry
def _go(
    motion: Floats,
    lagged: tuple[Floats, Floats],
    until: Floats,
    samples: tuple[Floats, Floats, Ints],
) -> None:
    """Kernel of :meth:`FeedSamples.go`."""
    (steps, gone), (ways, overrides, rows) = lagged, samples
    last, row, before = until.shape[0] - 1, max(int(motion[4]) - 1, 0), 0.0
    for each in range(ways.shape[0]):
        ways[each] = motion[1] * steps[each] + motion[2] * gone[each]
        overrides[each] = (ways[each] - before) * motion[3]
        before = ways[each]
        # The axes only go on: the search goes on from the cell of the sample before.
        while row < last and until[row] < motion[0] + ways[each]:
            row += 1
        rows[each] = row


@entry
def _cut(
    scales: tuple[Singles, Floats],
    course: tuple[Singles, Singles],
    at: tuple[Ints, Floats, Floats],
    forces: tuple[Floats, Floats, Floats],
    sums: Floats,
) -> None:
    """Kernel of :meth:`FeedSamples.cut`; the force of the chips has the course's precision."""
    (factor, (depth, flank_wear)), (force, land_force) = scales, course
    (rows, powers, shape), (chips, land, shown) = at, forces
    for each in range(rows.shape[0]):
        row = rows[each]
        chips[each] = float(factor[0] * force[row]) * powers[each] * depth
        land[each] = depth * (flank_wear * float(land_force[row]))
        shown[each] = chips[each] + land[each]
    sums[0] = _added(shown)
    sums[1] = -np.inf
    for each in range(rows.shape[0]):
        shown[each] *= shape[each]
        sums[1] = max(sums[1], shown[each])


@kernel
def _added(values: Floats) -> float:
    """Sum of values, with the roundings of numpy for up to a block of them."""
    total = 0.0
    for begin in range(0, values.shape[0], _BLOCK):
        total += _block(values[begin : begin + _BLOCK])
    return total


@kernel
def _block(values: Floats) -> float:
    """Sum of a block of values: in order if there are few, else in eight sums."""
    count, total = values.shape[0], 0.0
    if count < 8:
        for each in range(count):
            total += values[each]
        return total
    one, two, three, four = values[0], values[1], values[2], values[3]
    five, six, seven, eight = values[4], values[5], values[6], values[7]
    whole = count - count % 8
    for each in range(8, whole, 8):
        one += values[each]
        two += values[each + 1]
        three += values[each + 2]
        four += values[each + 3]
        five += values[each + 4]
        six += values[each + 5]
        seven += values[each + 6]
        eight += values[each + 7]
    total = float(((one + two) + (three + four)) + ((five + six) + (seven + eight)))
    for each in range(whole, count):
        total += values[each]
    return total
