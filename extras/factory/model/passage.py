"""Batches that pass a machine in one event, as nothing can happen to them.

Nobody listens, so a batch is looked at only at the end of the warm-up and of the run. Parts are
drawn for many batches at once, and all batches of one size among them are added up together.
Units s, J, W.
"""

from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

import numpy as np

from extras.factory.model.distribution import Floats
from extras.factory.model.machining import Machining, PartSource
from extras.factory.model.shop import ShopMachine
from extras.factory.model.states import MachineState
from extras.factory.model.store import Batch
from extras.factory.model.streams import Blocks, Streams

AHEAD = 256
"""Parts that are prepared at once."""

Step: TypeAlias = tuple[int, int]
"""Indices of product and step."""

DrawnPart: TypeAlias = tuple[float, Machining, float]
"""Time of set-up, s, machining, and time of ejection, s, of a part."""


def drawn_parts(
    spec: ShopMachine, machining: Mapping[Step, PartSource], streams: Streams
) -> dict[Step, Iterator[DrawnPart]]:
    """Parts of each step at a machine, one after another, without end."""
    setups, ejections = (
        streams.numbers(spec.handling[state].time, spec.name, state)
        for state in (MachineState.PART_SETUP, MachineState.PART_EJECTION)
    )
    return {
        step: zip(setups, source.parts(), ejections, strict=False)
        for step, source in machining.items()
    }


class PassageTotals(NamedTuple):
    """Sums over the parts of a batch, and the greatest power of their machining."""

    setup: float
    """s"""
    ejection: float
    """s"""
    machining: float
    """s"""
    energy: float
    """Energy of machining, J."""
    peak: float
    """W"""


class PartTimes(NamedTuple):
    """Begin of set-up, machining and ejection of a part, and its end, s."""

    setup: float
    machining: float
    ejection: float
    end: float


@dataclass(slots=True, eq=False)
class WatchedParts:
    """Parts of a batch that is looked at on its way. Running state."""

    ahead: deque[tuple[int, PartTimes, Machining]]
    """Parts that have not left the machine, with their numbers."""
    is_begun: bool = False
    """Whether the first of these is on the machine."""
    good: list[int] = field(default_factory=list)
    """Numbers of the good parts that have left."""


class HandlingPowers(NamedTuple):
    """Powers of set-up and ejection of a part, W."""

    setup: float
    ejection: float


@dataclass(slots=True, eq=False)
class Passage:
    """Batch that passes. Running state."""

    batch: Batch
    source: PartSource
    parts: Floats
    """Times of set-up and ejection of each part, then its machining as the source gave it,
    (N, 5 or more)."""
    powers: HandlingPowers
    totals: PassageTotals
    start: float = 0.0
    """Time at which the first part is set up, s."""
    end: float = 0.0
    """Time at which the last part leaves, s."""
    watched: WatchedParts | None = None
    """Its parts one by one, once somebody has looked at it on its way."""

    @property
    def step(self) -> Step:
        """Step that is done."""
        return self.batch.product, self.batch.step

    def begin(self, time: float) -> None:
        """Let the first part be set up at a time in s."""
        setup, ejection, machining, _, _ = self.totals
        self.start, self.end = time, time + (setup + machining + ejection)

    def watch(self) -> WatchedParts:
        """Look at its parts one by one from now on."""
        if self.watched is None:
            setup, ejection, machining = self.parts[:, :3].T
            end = self.start + np.cumsum(setup + machining + ejection)
            begin = np.concatenate(([self.start], end[:-1]))
            times = np.column_stack((begin, begin + setup, end - ejection, end))
            work = (work for _, work, _ in self.drawn())
            parts = zip(
                self.batch.parts, map(PartTimes._make, times.tolist()), work, strict=True
            )
            self.watched = WatchedParts(deque(parts))
        return self.watched

    def drawn(self) -> Iterator[DrawnPart]:
        """All parts, to be machined one by one."""
        setup, ejection = self.parts[:, :2].T.tolist()
        return zip(setup, self.source.machined(self.parts[:, 2:].T), ejection, strict=True)


class PreparedParts:
    """Parts of one step at one machine, prepared to pass. Running state.

    Parameters
    ----------
    setups, ejections : Blocks
        Times of set-up and ejection, s.
    ahead : int
        Parts that are drawn before they are needed; 0 where other steps take from the same
        numbers.
    """

    def __init__(
        self,
        setups: Blocks,
        source: PartSource,
        ejections: Blocks,
        *,
        powers: HandlingPowers,
        ahead: int,
    ) -> None:
        self._numbers = setups, ejections, Blocks(source.blocks)
        self._source, self._powers, self._ahead = source, powers, ahead
        self._parts, self._at = np.empty((0, 0)), 0
        self._totals: list[PassageTotals] = []
        self._count = 0

    def take(self, batch: Batch) -> Passage:
        """Next parts, for a batch."""
        count = len(batch.parts)
        if not self._totals or count != self._count:
            self._add_up(count)
        first = self._at
        self._at = last = first + count
        return Passage(
            batch, self._source, self._parts[first:last], self._powers, self._totals.pop()
        )

    def _add_up(self, count: int) -> None:
        """Add up the parts of the next batches of a size, drawing them where they lack."""
        left = len(self._parts) - self._at
        if count > left:
            self._draw(max(self._ahead, count - left))
            left = len(self._parts)
        # One batch alone after one of another size: with scrap, sizes change again and again.
        batches = left // count if count == self._count else 1
        self._count = count
        parts = self._parts[self._at : self._at + batches * count]
        each = parts.reshape(batches, count, -1)
        sums = np.column_stack((each[..., :4].sum(axis=1), each[..., 4].max(axis=1)))
        self._totals = [PassageTotals._make(row) for row in sums[::-1].tolist()]

    def _draw(self, more: int) -> None:
        """Draw parts behind those that are left."""
        drawn = np.vstack([each.take(more) for each in self._numbers]).T
        left = self._parts[self._at :]
        self._parts = np.concatenate((left, drawn)) if len(left) else np.array(drawn, order="C")
        self._at = 0


def prepared_parts(
    spec: ShopMachine, machining: Mapping[Step, PartSource], streams: Streams
) -> dict[Step, PreparedParts]:
    """Parts of each step at a machine, prepared to pass; the same as the drawn ones."""
    setup, ejection = MachineState.PART_SETUP, MachineState.PART_EJECTION
    setups, ejections = (
        Blocks(streams.blocks(spec.handling[state].time, spec.name, state))
        for state in (setup, ejection)
    )
    powers = HandlingPowers(spec.handling[setup].power, spec.handling[ejection].power)
    ahead = AHEAD if len(machining) == 1 else 0
    return {
        step: PreparedParts(setups, source, ejections, powers=powers, ahead=ahead)
        for step, source in machining.items()
    }
