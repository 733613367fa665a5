"""Places of batches while a shop runs: buffers, and the sources of raw stock.

Running state. A buffer keeps batches in the order of arrival; those beyond its capacity are
still on the machines that offer them. So a buffer of capacity 0 hands over from machine to
machine.
"""

from collections import deque
from collections.abc import Callable, Collection, Generator, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import count
from math import inf
from typing import Any, TypeAlias

from simpy import Environment, Event

from extras.factory.model.shop import Product


@dataclass(slots=True, eq=False)
class Batch:
    """Batch on its way. Running state."""

    number: int
    product: int
    """Index of the product."""
    released: float
    """Time at which it entered the shop, s."""
    parts: list[int]
    """Numbers of the parts that are good so far."""
    step: int = 0
    """Index of the next step."""
    arrived: float = 0.0
    """Time at which it arrived at its buffer, s."""
    offered: Event | None = None
    """Event for the machine on which it waits for room; None once it is in the buffer."""


Course: TypeAlias = Generator[Event, Any, None]
"""Course of a SimPy process."""

Wake = Callable[["BatchBuffer"], None]
"""Function that wakes a machine which waits for a buffer."""


@dataclass(slots=True, eq=False)
class BatchBuffer:
    """Buffer with its batches. Running state."""

    env: Environment
    name: str
    capacity: float
    wake: Wake
    """Called when a batch can be taken and a machine sleeps that might take it."""
    area: float = 0.0
    """Level times time so far, batches·s."""
    since: float = 0.0
    """Time of the last change, s."""
    items: deque[Batch] = field(default_factory=deque)
    """Batches in the order of arrival; those beyond the capacity are offered."""
    sleepers: int = 0
    """Machines that sleep and would take from it."""

    @property
    def level(self) -> int:
        """Batches in the buffer."""
        return int(min(len(self.items), self.capacity))

    def close(self) -> None:
        """Count the level so far."""
        self._close(self.env.now)

    def _close(self, now: float) -> None:
        if now > self.since:
            self.area += self.level * (now - self.since)
            self.since = now

    def put(self, batch: Batch) -> Event | None:
        """Put a batch; the event comes when there is room for it, None: at once."""
        now = self.env.now
        self._close(now)
        batch.arrived = now
        offered = None if len(self.items) < self.capacity else self.env.event()
        batch.offered = offered
        self.items.append(batch)
        if self.sleepers:
            self.wake(self)
        return offered

    def first(self, steps: Collection[tuple[int, int]]) -> Batch | None:
        """First batch for one of several steps, by index of product and step."""
        for batch in self.items:
            if (batch.product, batch.step) in steps:
                return batch
        return None

    def take(self, batch: Batch) -> None:
        """Take a batch; what waited for room moves in."""
        self.close()
        if self.items[0] is batch:
            self.items.popleft()
        else:
            self.items.remove(batch)
        if batch.offered is not None:
            batch.offered.succeed()
            batch.offered = None
        if self.capacity and len(self.items) >= self.capacity:
            entering = self.items[int(self.capacity) - 1]
            if entering.offered is not None:
                entering.offered.succeed()
                entering.offered = None


@dataclass(slots=True, eq=False)
class RawStock:
    """Raw stock of a product. Running state."""

    buffer: BatchBuffer
    product: Product
    index: int
    numbers: "count[int]"
    """Numbers of batches, shared by all products."""
    entered: Callable[[Batch], None]
    """Called with each batch that arrives."""
    released: int = 0

    @property
    def is_endless(self) -> bool:
        """True if batches come as machines ask for them."""
        return self.product.arrival is None

    @property
    def left(self) -> float:
        """Batches that have not been released."""
        return inf if self.product.batches is None else self.product.batches - self.released

    def release(self) -> None:
        """Release the next batch."""
        batch = self.cut()
        if not self.is_endless:
            self.entered(batch)
        self.buffer.put(batch)

    def cut(self) -> Batch:
        """Make the next batch, which goes to a machine at once or into the buffer."""
        self.released += 1
        now = self.buffer.env.now
        parts = list(range(self.product.batch))
        return Batch(next(self.numbers), self.index, now, parts, 0, now)

    def arrivals(self, intervals: Iterator[float]) -> Course:
        """SimPy process of arrivals."""
        while self.left > 0:
            yield self.buffer.env.timeout(next(intervals))
            self.release()


Supply: TypeAlias = tuple[BatchBuffer, Collection[tuple[int, int]]]
"""Buffer, and steps of its batches that a machine can do."""


def next_batch(
    raw: Sequence[RawStock], supplies: Sequence[Supply], products: Sequence[Product]
) -> Batch | None:
    """Take the batch of the highest priority that has waited longest; None: there is none.

    Parameters
    ----------
    raw : sequence of RawStock
        Raw stocks among the supplies whose batches come as machines ask for them.
    products : sequence of Product
        All products of the shop.
    """
    for stock in raw:
        if not stock.buffer.items and stock.left > 0:
            if len(supplies) == 1:
                # It need not wait: a machine that sleeps has no raw stock that is left.
                return stock.cut()
            stock.release()
    found = _oldest(supplies, products)
    if found is None:
        return None
    buffer, batch = found
    buffer.take(batch)
    return batch


def _oldest(
    supplies: Sequence[Supply], products: Sequence[Product]
) -> tuple[BatchBuffer, Batch] | None:
    """Batch of the highest priority that has waited longest, with its buffer."""
    best: tuple[BatchBuffer, Batch] | None = None
    rank = (inf, inf)
    for buffer, steps in supplies:
        found = buffer.first(steps)
        if found is not None:
            own = (-products[found.product].priority, found.arrived)
            if own < rank:
                best, rank = (buffer, found), own
    return best
