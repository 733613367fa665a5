"""Power of a whole shop over time, as energies in intervals of equal length. Running state.

Each state of a machine spreads its energy evenly over its time, machining too, so that the
energy is exact and intervals shorter than a part are smooth.
"""

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
    energy: Floats = field(init=False)
    """Energy in each interval, (N,), J."""

    def __post_init__(self) -> None:
        span = self.end - self.begin
        self.step = FINE if span <= FINE * MOST else DEMAND
        self.energy = np.zeros(max(1, int(np.ceil(span / self.step - 1e-9))))

    def add(self, begin: Floats, end: Floats, energy: Floats) -> None:
        """Add energies in J that are spent evenly from begin to end, (N,) each."""
        first, last = (begin - self.begin) / self.step, (end - self.begin) / self.step
        power = energy / (end - begin)
        low = np.clip(first.astype(np.int64), 0, len(self.energy) - 1)
        high = np.clip(last.astype(np.int64), 0, len(self.energy) - 1)
        # Whole intervals by differences, then what the first and the last lack.
        steps = np.zeros(len(self.energy) + 1)
        np.add.at(steps, low, power)
        np.add.at(steps, high + 1, -power)
        self.energy += self.step * np.cumsum(steps)[:-1]
        np.add.at(self.energy, low, -power * self.step * (first - low))
        np.add.at(self.energy, high, -power * self.step * (high + 1 - last))

    def power(self) -> Floats:
        """Mean power of each interval, (N,), W; the last one may be shorter."""
        length = np.full(len(self.energy), self.step)
        length[-1] = self.end - self.begin - self.step * (len(length) - 1)
        power: Floats = self.energy / length
        return power

    def demand(self) -> float:
        """Greatest mean power over a quarter of an hour, W."""
        group = max(1, round(DEMAND / self.step))
        if len(self.energy) < group:
            return float(self.energy.sum() / (self.end - self.begin))
        whole = self.energy[: len(self.energy) // group * group]
        return float(whole.reshape(-1, group).sum(axis=1).max() / (group * self.step))
