"""Replications of a shop: independent runs, the first one with outputs, others on processes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf

from extras.factory.model.floor import Floor
from extras.factory.model.machining import MachiningPlan
from extras.factory.model.measures import Measure
from extras.factory.model.records import Listeners
from extras.factory.model.shop import Shop
from extras.factory.model.shop_figures import measures_of
from extras.factory.model.streams import Streams
from extras.factory.model.tally import Tally
from service.execution.executors import Pools, results
from service.progress import Tell, Ticker
from stepnc_model.errors import StepNcError

SLICES = 500
"""Parts of a run between which its progress is told."""

MOST_AT_ONCE = 20_000
"""Most parts that one run may make at one time."""

ProgressShare = Callable[[float], None]
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

    def count(self, count: int, time: float) -> None:
        """Count parts that left a machine at a time in s.

        Raises
        ------
        StepNcError
            When there are too many, or too many at one time.
        """
        self._count += count
        self._at_once = self._at_once + count if time == self._at else 0
        self._at = time
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
    progress: ProgressShare = lambda _: None,
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
            progress(part / SLICES)
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
    """Replications that run on executors."""

    pools: Pools
    seed: int
    tell: Tell
    most_parts: float = inf
    """Most parts of a run."""

    def measures(
        self, cases: Sequence[tuple[Shop, MachiningPlan, Sequence[int]]]
    ) -> list[list[tuple[Measure, ...]]]:
        """Measures of the replications of given numbers of each shop, in order.

        Raises
        ------
        Deadlock
            If machines of one of them wait for each other.
        StepNcError
            If executors are lost again and again.
        """
        ticker = Ticker(self.tell)
        tasks = [
            (shop, plan, Streams(seed=self.seed, replication=number), self.most_parts)
            for shop, plan, numbers in cases
            for number in numbers
        ]
        found: dict[int, tuple[Measure, ...]] = {}
        if not tasks:
            return [[] for _ in cases]
        work = results(self.pools, _measures, tasks, tell=self.tell, what="replications")
        for index, measures in work:
            found[index] = measures
            ticker(lambda: f"{len(found)} of {len(tasks)} replications")
        rows = iter(range(len(tasks)))
        return [[found[next(rows)] for _ in numbers] for _, _, numbers in cases]


def _measures(
    shop: Shop, plan: MachiningPlan, streams: Streams, most_parts: float
) -> tuple[Measure, ...]:
    bound = PartBound(most_parts)
    listeners = Listeners(count=(bound.count,)) if most_parts < inf else Listeners()
    return run_shop(shop, plan, streams, listeners=listeners).measures
