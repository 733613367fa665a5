"""Failures and maintenance of a machine while its shop runs. Running state.

Failures by machining time come when the machine has cut for so long; failures by the clock
interrupt it. After a maintenance failures by machining time count anew.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from math import inf
from typing import NamedTuple

from simpy import Environment, Interrupt

from extras.factory.model.shop import Counting, ShopMachine
from extras.factory.model.store import Course
from extras.factory.model.streams import Streams


class Breakdown(NamedTuple):
    """Failure that interrupts a machine."""

    repair: float
    """s"""
    spoils: bool
    """Whether a part that is being machined is scrapped."""


@dataclass(slots=True, eq=False)
class PendingFailure:
    """Way in which a machine fails, with its random numbers."""

    scrap: float
    """Share of failures that spoil the part."""
    between: Iterator[float]
    """Times between failures, s."""
    repairs: Iterator[float]
    """s"""
    chances: Iterator[float]
    """Uniform numbers."""
    at: float = inf
    """Machining time of the machine at which the next one comes, s."""

    def breakdown(self) -> Breakdown:
        """Failure that comes now."""
        spoils = self.scrap > 0.0 and next(self.chances) < self.scrap
        return Breakdown(next(self.repairs), spoils)


@dataclass(slots=True, eq=False)
class DueMaintenance:
    """Maintenance with the time at which it is due."""

    counts: Counting
    every: float
    """s"""
    durations: Iterator[float]
    """s"""
    at: float
    """Machining time, or time, at which it is due, s."""

    def is_due(self, machined: float, now: float) -> bool:
        """True if it is due, by the machining time and the time in s."""
        return self.at <= (machined if self.counts is Counting.MACHINING else now)


@dataclass(slots=True, eq=False)
class Upkeep:
    """Failures and maintenance of one machine."""

    by_machining: list[PendingFailure] = field(default_factory=list)
    by_clock: list[PendingFailure] = field(default_factory=list)
    maintenance: list[DueMaintenance] = field(default_factory=list)
    failure_at: float = inf
    """Machining time at which the next failure comes, s."""

    def renew(self, machined: float) -> None:
        """Let failures by machining time count anew."""
        for each in self.by_machining:
            each.at = machined + next(each.between)
        self._set_next()

    def breakdown(self, machined: float) -> Breakdown:
        """Failure that comes at a machining time."""
        first = min(self.by_machining, key=lambda each: each.at)
        first.at = machined + next(first.between)
        self._set_next()
        return first.breakdown()

    def due(self, machined: float, now: float) -> DueMaintenance | None:
        """Maintenance that is due."""
        return next((each for each in self.maintenance if each.is_due(machined, now)), None)

    def maintained(self, due: DueMaintenance, machined: float, now: float) -> None:
        """Count anew after a maintenance."""
        due.at = due.every + (machined if due.counts is Counting.MACHINING else now)
        self.renew(machined)

    def _set_next(self) -> None:
        self.failure_at = min((each.at for each in self.by_machining), default=inf)


def upkeep_of(spec: ShopMachine, streams: Streams) -> Upkeep:
    """Failures and maintenance of a machine at the beginning of a run."""
    upkeep, name = Upkeep(), spec.name
    for row, failure in enumerate(spec.failures):
        purpose = f"failure {row}"
        pending = PendingFailure(
            scrap=failure.scrap,
            between=streams.numbers(failure.between, name, purpose),
            repairs=streams.numbers(failure.repair, name, f"{purpose} repair"),
            chances=iter(streams.generator(name, f"{purpose} scrap").random, None),
        )
        is_machining = failure.counts is Counting.MACHINING
        (upkeep.by_machining if is_machining else upkeep.by_clock).append(pending)
    for row, each in enumerate(spec.maintenance):
        durations = streams.numbers(each.duration, name, f"maintenance {row}")
        upkeep.maintenance.append(
            DueMaintenance(
                counts=each.counts, every=each.every, durations=durations, at=each.every
            )
        )
    upkeep.renew(0.0)
    return upkeep


def breakdown_of(interrupt: Interrupt) -> Breakdown:
    """Failure of an interrupt.

    Raises
    ------
    TypeError
        If the interrupt has another cause.
    """
    cause = interrupt.cause
    if not isinstance(cause, Breakdown):
        raise TypeError(f"an interrupt of a machine by {cause!r}")
    return cause


def wakes_when_due(env: Environment, due: DueMaintenance, wake: Callable[[], bool]) -> Course:
    """SimPy process that wakes a machine without work for its maintenance."""
    while True:
        yield env.timeout(max(due.at - env.now, 0.0) or due.every)
        wake()
