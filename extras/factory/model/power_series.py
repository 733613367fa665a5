"""Power of a whole shop over time, as energies in intervals of equal length. Running state.

Each state of a machine spreads its energy evenly over its time, machining too, so that the
energy is exact and intervals shorter than a part are smooth.
"""

from array import array
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

import numpy as np

from extras.factory.model.distribution import Floats

DEMAND = 900.0
"""Interval of the demand that electricity tariffs take, s."""

WAITING = 6_000
"""States that are added together."""

WaitingBatch: TypeAlias = tuple[float, Floats, tuple[float, float]]
"""Batch as :meth:`PowerSeries.add_batch` takes it."""

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
    _batches: list[WaitingBatch] = field(default_factory=list)
    """Batches that are yet to be added, as :meth:`add_batch` takes them."""
    _states: int = 0
    """States in these batches."""

    def __post_init__(self) -> None:
        span = self.end - self.begin
        self.step = FINE if span <= FINE * MOST else DEMAND
        self._energy = np.zeros(max(1, int(np.ceil(span / self.step - 1e-9))))

    def restart(self, begin: float) -> None:
        """Begin anew at a later time."""
        del self.waiting[:], self._batches[:]
        self._states = 0
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

    def add_batch(self, start: float, parts: Floats, powers: tuple[float, float]) -> None:
        """Add set-up, machining and ejection of the parts of a batch, which follow each other.

        Parameters
        ----------
        start : float, s
        parts : (N, 4 or more) array
            Times of set-up, ejection and machining, s, and energy of machining, J.
        powers : (float, float), W
            Of set-up and ejection.
        """
        self._batches.append((start, parts, powers))
        self._states += 3 * len(parts)

    def flush_many(self) -> None:
        """Add the states that wait if they are many."""
        if len(self.waiting) + 3 * self._states > 3 * WAITING:
            self.flush()

    def flush(self) -> None:
        """Add the states that wait."""
        if not self.waiting and not self._batches:
            return
        begin, end, energy = np.array(self.waiting).reshape(-1, 3).T
        power = energy / (end - begin)
        times, changes = [begin, end], [power, -power]
        if self._batches:
            of_batches = _changes_of(self._batches)
            times.append(of_batches.times)
            changes.append(of_batches.powers)
        del self.waiting[:], self._batches[:]
        self._states = 0
        self._add(Changes(np.concatenate(times), np.concatenate(changes)))

    def _add(self, changes: "Changes") -> None:
        """Add the energy that follows from changes of the power."""
        at, power = (changes.times - self.begin) / self.step, changes.powers
        row = np.minimum(at.astype(np.int64), len(self._energy) - 1)
        left = int(row.min())
        size = int(row.max()) + 1 - left
        # A change counts in all later intervals; its own interval has it from its time on.
        whole = np.cumsum(np.bincount(row - left, power, size))
        before = np.bincount(row - left, power * (at - row), size)
        self._energy[left : left + size] += self.step * (whole - before)


class Changes(NamedTuple):
    """Changes of the power of a shop."""

    times: Floats
    """(N,), s"""
    powers: Floats
    """Power afterwards less that before, (N,), W."""


def _changes_of(batches: list[WaitingBatch]) -> Changes:
    """Changes of the power by the parts of batches."""
    starts, found, powers = zip(*batches, strict=True)
    counts = np.array([len(each) for each in found])
    setup, ejection, machining, energy = np.concatenate([each[:, :4] for each in found]).T
    setup_power, ejection_power = np.repeat(powers, counts, axis=0).T
    power = np.divide(energy, machining, out=np.zeros_like(energy), where=machining > 0.0)
    end = np.cumsum(setup + machining + ejection)
    last = np.cumsum(counts) - 1
    begin = np.concatenate(([0.0], end[:-1]))
    begin += np.repeat(starts - begin[last - counts + 1], counts)
    cutting = begin + setup
    leaving = cutting + machining
    rest = np.concatenate(([0.0], ejection_power[:-1]))
    rest[last[:-1] + 1] = 0.0
    return Changes(
        np.concatenate((begin, cutting, leaving, leaving[last] + ejection[last])),
        np.concatenate((
            setup_power - rest, power - setup_power, ejection_power - power,
            -ejection_power[last],
        )),
    )  # fmt: skip
