"""Replications of a shop: independent runs, the first one with outputs, others on processes."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from os import cpu_count
from signal import SIG_IGN, SIGINT, signal

from service.progress import Ticker
from service.reading import Tell
from simulator.factory.floor import Floor
from simulator.factory.machining import MachiningPlan
from simulator.factory.measured import measures_of
from simulator.factory.measures import Measure
from simulator.factory.records import Listeners
from simulator.factory.shop import Shop
from simulator.factory.streams import Streams
from simulator.factory.tally import Tally

SLICES = 500
"""Parts of a run between which its progress is told."""

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
            self.pool.submit(_measures, shop, plan, Streams(seed=self.seed, replication=number))
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
    """Leave Ctrl-C to the main process."""
    signal(SIGINT, SIG_IGN)


def _measures(shop: Shop, plan: MachiningPlan, streams: Streams) -> tuple[Measure, ...]:
    return run_shop(shop, plan, streams, listeners=Listeners()).measures
