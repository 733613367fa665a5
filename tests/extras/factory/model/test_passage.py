"""Parts that pass in one event have the times and sums of parts that pass one by one."""

from pathlib import Path

import numpy as np
import pytest

from extras.factory.model.floor import Floor
from extras.factory.model.machining import MachiningPlan, PartSource
from extras.factory.model.passage import HandlingPowers, PreparedParts
from extras.factory.model.records import Listeners
from extras.factory.model.shop import Shop
from extras.factory.model.shop_figures import measures_of
from extras.factory.model.store import Batch
from extras.factory.model.streams import Blocks, Streams
from simulator.errors import Deadlock
from tests.extras.factory.model.random_shops import random_shop
from tests.extras.factory.model.shops import shop_of

SIZE = 7
"""Numbers in a block."""


def columns(seed: int, rows: int) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    return np.random.default_rng(seed).uniform(1.0, 9.0, (rows, 60 * SIZE))


def in_blocks(numbers: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> Blocks:
    return Blocks(
        numbers[..., begin : begin + SIZE] for begin in range(0, numbers.shape[-1], SIZE)
    )


@pytest.mark.parametrize("ahead", [0, 20])
def test_batches_have_the_sums_of_their_parts(ahead: int) -> None:
    setups, ejections = columns(1, 1)[0], columns(2, 1)[0]
    time, energy, peak = machining = columns(3, 3)
    source = PartSource(
        blocks=(machining[:, begin : begin + SIZE] for begin in range(0, 60 * SIZE, SIZE))
    )
    prepared = PreparedParts(
        in_blocks(setups),
        source,
        in_blocks(ejections),
        powers=HandlingPowers(500.0, 250.0),
        ahead=ahead,
    )
    first = 0
    for count in (1, 10, 10, 10, 2, 33, 5, 64):
        batch = Batch(number=0, product=0, released=0.0, parts=list(range(count)))
        passage = prepared.take(batch)
        rows = slice(first, first + count)
        totals = passage.totals
        assert totals.setup == pytest.approx(setups[rows].sum())
        assert totals.machining == pytest.approx(time[rows].sum())
        assert totals.ejection == pytest.approx(ejections[rows].sum())
        assert totals.energy == pytest.approx(energy[rows].sum())
        assert totals.peak == peak[rows].max()
        passage.begin(100.0)
        whole = setups[rows] + time[rows] + ejections[rows]
        assert passage.end == pytest.approx(100.0 + whole.sum())
        drawn = list(passage.drawn())
        assert [part[0] for part in drawn] == setups[rows].tolist()
        assert [part[1].time for part in drawn] == time[rows].tolist()
        assert [part[1].peak_power for part in drawn] == peak[rows].tolist()
        first += count


def figures_of(shop: Shop, seed: int, listeners: Listeners) -> tuple[list[object], list[float]]:
    """Counts of a run that is looked at now and then, and its times, energies and figures."""
    floor = Floor(shop, MachiningPlan(), Streams(seed=seed), listeners)
    try:
        for look in range(1, 6):
            floor.run(shop.duration * look / 5.0)
            floor.close()
    except Deadlock:
        floor.close()
    machines, stations = floor.tally.machines, floor.stations
    processes = [each for machine in machines for each in machine.processes.values()]
    counts = [(each.parts, each.good) for each in processes]
    released = [each.released for each in floor.raw]
    sums = [value for each in processes for value in (each.time, each.energy, each.peak)]
    for machine in machines:
        sums += [*machine.seconds.values(), *machine.joules.values()]
    sums += [floor.env.now, *(each.machined for each in stations)]
    sums += [each.value for each in measures_of(floor)]
    return [counts, released, floor.in_shop, floor.is_finished], sums


@pytest.mark.parametrize("group", range(20))
def test_random_shops_are_the_same_part_by_part(tmp_path: Path, group: int) -> None:
    for seed in range(5 * group, 5 * group + 5):
        shop = shop_of(random_shop(seed, is_plain=True), tmp_path)
        counts, sums = figures_of(shop, seed, Listeners())
        others, expected = figures_of(shop, seed, Listeners(part=(lambda _: None,)))
        assert counts == others
        # What is left of states without time is rounding of the clock.
        assert sums == pytest.approx(expected, rel=1e-12, abs=1e-7, nan_ok=True)
