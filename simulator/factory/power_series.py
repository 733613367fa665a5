"""Power of a whole shop over time, as energies in intervals of equal length. Running state.

Each state of a machine spreads its energy evenly over its time, machining too, so that the
energy is exact and intervals shorter than a part are smooth.
"""

from array import array
from dataclasses import dataclass, field

import numpy as np

from simulator.factory.distribution import Floats

DEMAND = 900.0
"""Interval of the demand that electricity tariffs take, s."""

FINE, MOST = 60.0, 300_000
"""Usual interval, s, and the most intervals of that length."""


@dataclass(slots=True, eq=False)
class PowerSeries:
    """Energies in intervals of equal length from a time on."""

    begin: float
    """s"""
    end: float
    """s"""
    step: float = field(init=False)
    """Length of an interval, s."""
    _energy: Floats = field(init=False)
    """Energy in each interval, (N,), J."""
    waiting: "array[float]" = field(default_factory=lambda: array("d"))
    """Begin, end and energy, in s and J, of each state that is yet to be added."""

    def __post_init__(self) -> None:
        span = self.end - self.begin
        self.step = FINE if span <= FINE * MOST else DEMAND
        self._energy = np.zeros(max(1, int(np.ceil(span / self.step - 1e-9))))

    def restart(self, begin: float) -> None:
        """Begin anew at a later time."""
        del self.waiting[:]
        self.begin = begin
        self.__post_init__()

    def energies(self) -> Floats:
        """Energy in each interval, (N,), J."""
        self.flush()
        return self._energy

    def demand(self, now: float) -> float:
        """Greatest mean power over a whole quarter of an hour until now, W.

        Of a shorter time it is the mean.
        """
        return self._greatest(now, max(1, round(DEMAND / self.step)))

    def peak(self, now: float) -> float:
        """Greatest mean power over a whole interval until now, or a shorter time, W."""
        return self._greatest(now, 1)

    def _greatest(self, now: float, group: int) -> float:
        """Greatest mean power over a number of intervals, W."""
        energies, length = self.energies(), group * self.step
        count = int((now - self.begin) / length + 1e-9) * group
        if count == 0:
            return float(energies.sum() / (now - self.begin)) if now > self.begin else 0.0
        return float(energies[:count].reshape(-1, group).sum(axis=1).max() / length)

    def flush(self) -> None:
        """Add the states that wait."""
        if not self.waiting:
            return
        rows = np.array(self.waiting)
        del self.waiting[:]
        begin, end, energy = rows.reshape(-1, 3).T
        first, last = (begin - self.begin) / self.step, (end - self.begin) / self.step
        power = energy / (end - begin)
        most = len(self._energy) - 1
        low = np.clip(first.astype(np.int64), 0, most)
        high = np.clip(last.astype(np.int64), 0, most)
        left, size = int(low.min()), int(high.max()) - int(low.min()) + 2
        # Whole intervals by differences, then what the first and the last lack.
        steps = np.bincount(low - left, power, size)
        steps -= np.bincount(high + 1 - left, power, size)
        lacking = np.bincount(low - left, power * (first - low), size)
        lacking += np.bincount(high - left, power * (high + 1 - last), size)
        energies = self.step * (np.cumsum(steps) - lacking)
        self._energy[left : left + size - 1] += energies[:-1]
