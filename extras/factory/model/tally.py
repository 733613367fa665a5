"""Counts of a running shop, from its warm-up on. Running state.

Machines count their own times, energies and parts as they go; memory does not grow with them.
"""

from dataclasses import dataclass, field

from extras.factory.model.power_series import PowerSeries
from extras.factory.model.shop import Shop
from extras.factory.model.states import MachineState
from extras.factory.model.store import Batch


@dataclass(slots=True, eq=False)
class ProcessTally:
    """Counts of the machining of one step on one machine."""

    parts: int = 0
    good: int = 0
    time: float = 0.0
    """s"""
    energy: float = 0.0
    """J"""
    peak: float = 0.0
    """W"""

    def add(self, parts: int, good: int, time: float, energy: float, peak: float) -> None:
        """Count parts, with the sums and the greatest power of their machining, in s, J, W."""
        self.parts += parts
        self.good += good
        self.time += time
        self.energy += energy
        self.peak = max(self.peak, peak)

    def reset(self) -> None:
        """Begin anew."""
        self.parts = self.good = 0
        self.time = self.energy = self.peak = 0.0


@dataclass(slots=True, eq=False)
class MachineTally:
    """Times, energies and parts of one machine."""

    seconds: dict[MachineState, float] = field(default_factory=dict)
    joules: dict[MachineState, float] = field(default_factory=dict)
    processes: dict[tuple[int, int], ProcessTally] = field(default_factory=dict)
    """Machining by the indices of product and step."""

    def __post_init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Begin anew."""
        for state in MachineState:
            self.seconds[state] = self.joules[state] = 0.0
        for process in self.processes.values():
            process.reset()


@dataclass(slots=True, eq=False)
class ProductTally:
    """Counts of one product."""

    good: int = 0
    lead: float = 0.0
    """Lead times of batches times their good parts, s."""


@dataclass(slots=True, eq=False)
class Tally:
    """Counts of a shop."""

    shop: Shop
    machines: list[MachineTally] = field(default_factory=list)
    products: list[ProductTally] = field(default_factory=list)
    power: PowerSeries = field(init=False)
    inside: int = 0
    """Parts in the shop."""
    area: float = 0.0
    """Parts in the shop times time, s."""
    since: float = 0.0
    """Time of the last change of the parts in the shop, s."""

    def __post_init__(self) -> None:
        self.machines += [MachineTally() for _ in self.shop.machines]
        self.products += [ProductTally() for _ in self.shop.products]
        self.power = PowerSeries(0.0, self.shop.duration)

    def entered(self, batch: Batch) -> None:
        """Count the parts of a batch in the shop."""
        self.close(batch.released)
        self.inside += self.shop.products[batch.product].batch

    def left(self, batch: Batch, time: float) -> None:
        """Count the good parts of a batch."""
        self.close(time)
        self.inside -= self.shop.products[batch.product].batch
        product = self.products[batch.product]
        product.good += len(batch.parts)
        product.lead += len(batch.parts) * (time - batch.released)

    def close(self, now: float) -> None:
        """Count the parts in the shop so far."""
        self.area += self.inside * (now - self.since)
        self.since = now

    def reset(self, now: float) -> None:
        """Begin anew after the warm-up."""
        for machine in self.machines:
            machine.reset()
        self.products[:] = [ProductTally() for _ in self.products]
        self.area, self.since = 0.0, now
        self.power.restart(now)
