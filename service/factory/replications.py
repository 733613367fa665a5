"""Replications of a shop: independent runs, the first one with outputs, others on processes."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from math import inf
from multiprocessing import get_context
from os import cpu_count
from signal import SIG_IGN, SIGINT, signal

from service.lifeline import end_with_parent
from service.progress import Ticker
from service.reading import Tell
from simulator.factory.floor import Floor
from simulator.factory.machining import MachiningPlan
from simulator.factory.measured import measures_of
from simulator.factory.measures import Measure
from simulator.factory.records import Listeners, PartMade
from simulator.factory.shop import Shop
from simulator.factory.streams import Streams
from simulator.factory.tally import Tally
from stepnc_model.errors import StepNcError

SLICES = 500
"""Parts of a run between which its progress is told."""

MOST_AT_ONCE = 20_000
"""Most parts that one run may make at one time."""

Told = Callable[[float], None]
"""Function that is told the share of a run that is done."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ShopRun:
    """One run of a shop that has ended."""

    measures: tuple[Measure, ...]
    tally: Tally
    ended: float
    """s"""
    is_finished: bool
    """Whether all orders were finished before the time was over."""


class PartBound:
    """Ends a run that makes too many parts, also one in which no time passes. Running state."""

    def __init__(self, most: float) -> None:
        self._most, self._count = most, 0
        self._at, self._at_once = -1.0, 0

    def part(self, part: PartMade) -> None:
        """Count a part.

        Raises
        ------
        StepNcError
            When there are too many, or too many at one time.
        """
        self._count += 1
        self._at_once = self._at_once + 1 if part.end == self._at else 0
        self._at = part.end
        if self._at_once > MOST_AT_ONCE:
            raise StepNcError(f"no time passes: {MOST_AT_ONCE} parts are made at once")
        if self._count > self._most:
            raise StepNcError(f"a run makes more than {self._most:g} parts")


def run_shop(
    shop: Shop,
    plan: MachiningPlan,
    streams: Streams,
    *,
    listeners: Listeners,
    told: Told = lambda _: None,
) -> ShopRun:
    """Run a shop once.

    Raises
    ------
    Deadlock
        If machines wait for each other.
    """
    floor = Floor(shop, plan, streams, listeners)
    try:
        for part in range(1, SLICES + 1):
            floor.run(shop.duration * part / SLICES)
            told(part / SLICES)
            if floor.is_finished:
                break
    finally:
        floor.close()
    return ShopRun(
        measures=measures_of(floor),
        tally=floor.tally,
        ended=floor.env.now,
        is_finished=floor.is_finished,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Replications:
    """Replications that run on an executor."""

    pool: Executor
    seed: int
    tell: Tell
    most_parts: float = inf
    """Most parts of a run."""

    def measures(
        self, shop: Shop, plan: MachiningPlan, numbers: Sequence[int]
    ) -> list[tuple[Measure, ...]]:
        """Measures of the replications of given numbers, in order.

        Raises
        ------
        Deadlock
            If machines of one of them wait for each other.
        """
        ticker = Ticker(self.tell)
        waiting = [
            self.pool.submit(
                _measures,
                shop,
                plan,
                Streams(seed=self.seed, replication=number),
                self.most_parts,
            )
            for number in numbers
        ]
        for count, _ in enumerate(as_completed(waiting), start=1):
            ticker(lambda done=count: f"{done} of {len(waiting)} replications")  # type: ignore[misc]
        return [each.result() for each in waiting]


@contextmanager
def processes(count: int) -> Iterator[Executor]:
    """Executor with a process for each processor, at most a given number."""
    workers = max(1, min(count, cpu_count() or 1))
    context = get_context("forkserver")
    with ProcessPoolExecutor(workers, mp_context=context, initializer=_deaf) as pool:
        try:
            yield pool
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _deaf() -> None:
    """Leave Ctrl-C to the main process, and end with it."""
    end_with_parent()
    signal(SIGINT, SIG_IGN)


def _measures(
    shop: Shop, plan: MachiningPlan, streams: Streams, most_parts: float
) -> tuple[Measure, ...]:
    bound = PartBound(most_parts)
    listeners = Listeners(part=(bound.part,)) if most_parts < inf else Listeners()
    return run_shop(shop, plan, streams, listeners=listeners).measures
