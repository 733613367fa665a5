"""Observations of a live shop."""

from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from extras.agent.model.buffer import Value
from extras.factory.cycles import PartCycles
from extras.factory.devices import shop_devices
from extras.factory.live import LiveShop
from extras.factory.model.machining import MachiningPlan, Place
from extras.factory.model.shop import Shop
from extras.factory.model.shop_file import read_shop
from extras.factory.plan import machining_plan
from extras.factory.shop_observations import PartTimeline, ShopPublisher, part_timelines
from service.progress import silent
from tests.extras.factory.shops import program_file, timed_shop

Told = list[tuple[float, str, Value]]


def told(
    shop: Shop,
    plan: MachiningPlan,
    timelines: Mapping[Place, PartTimeline],
    *,
    failing: Mapping[float, str] | None = None,
) -> Told:
    """All observations of a shop that is run in steps of 20 s; machines fail at times."""
    devices = shop_devices(shop)
    publisher = ShopPublisher(shop, plan, devices, timelines)
    live = LiveShop(shop, plan, seed=1, programs={}, listeners=publisher.listeners)
    publisher.watch(live.view)
    found: Told = []
    orders = dict(failing or {})
    goes_on = True
    while goes_on:
        goes_on = live.advance(live.time + 20.0)
        if live.time in orders:
            live.obey({"machine": orders.pop(live.time), "repair_min": 2.0})
        feed = publisher.taken(live.time)
        assert np.all(np.diff(feed.times) >= 0.0)
        assert not len(feed.times) or feed.times[-1] <= live.time
        found += [
            (time, devices.model.items[item].id, value)
            for time, item, value in zip(
                feed.times.tolist(), feed.items.tolist(), feed.values, strict=True
            )
        ]
    assert not orders
    return found


def of(found: Told, id: str) -> Iterator[tuple[float, Value]]:
    return ((time, value) for time, each, value in found if each == id)


def integral(found: Told, id: str, end: float) -> float:
    """Sum of values times the time for which they hold."""
    rows = [*of(found, id), (end, 0.0)]
    total = 0.0
    for (at, value), (after, _) in pairwise(rows):
        assert isinstance(value, int | float)
        total += value * (after - at)
    return total


def test_states_batches_and_counts_are_told(tmp_path: Path) -> None:
    shop = timed_shop(tmp_path, hours=0.5)
    found = told(shop, MachiningPlan(), {})
    words = [value for _, value in of(found, "saw_1_exec")]
    assert words[:4] == ["READY", "WAIT", "ACTIVE", "WAIT"]
    parts = [value for _, value in of(found, "saw_1_part")]
    assert parts[:6] == [None, "0-0", "0-1", None, "1-0", "1-1"]
    counts = [value for _, value in of(found, "saw_1_parts")]
    assert counts == list(range(len(counts)))
    assert len(counts) > 3


def test_power_held_until_the_next_adds_up_to_the_energy(tmp_path: Path) -> None:
    shop = timed_shop(tmp_path, hours=0.5)
    found = told(shop, MachiningPlan(), {})
    for name in ("saw_1", "mill-1", "mill-2"):
        *_, (end, energy) = of(found, f"{name}_energy")
        assert integral([row for row in found if row[0] < end], f"{name}_watt", end) == (
            pytest.approx(energy, rel=1e-6)
        )


def test_a_failure_is_a_fault_until_it_is_repaired(tmp_path: Path) -> None:
    shop = timed_shop(tmp_path, hours=0.5)
    found = told(shop, MachiningPlan(), {}, failing={40.0: "saw 1"})
    rows = list(of(found, "saw_1_exec"))
    at = next(row for row, (time, _) in enumerate(rows) if time == 40.0)
    assert rows[at] == (40.0, "INTERRUPTED")
    assert rows[at + 1] == (160.0, "ACTIVE")
    levels = [(time, value.level) for time, value in of(found, "saw_1_system")]  # type: ignore[union-attr]
    assert levels == [(0.0, "NORMAL"), (40.0, "FAULT"), (40.0, "FAULT"), (160.0, "NORMAL")]


@pytest.fixture(scope="module")
def milled(tmp_path_factory: pytest.TempPathFactory) -> tuple[Shop, MachiningPlan, Told]:
    """A shop with a program: a mill fails in its first part."""
    shop = read_shop(program_file(tmp_path_factory.mktemp("shop"), hours=1.0))
    plan = machining_plan(shop, PartCycles(), place="program.toml")
    timelines = part_timelines(shop, plan, rate=1.0, tell=silent)
    return shop, plan, told(shop, plan, timelines, failing={300.0: "mill-1"})


def test_axes_follow_the_virtual_machine(milled: tuple[Shop, MachiningPlan, Told]) -> None:
    _, plan, found = milled
    cycle = next(iter(plan.cycles.values()))
    assert len([1 for _ in of(found, "mill-1_xpos")]) > 50
    assert max(float(value) for _, value in of(found, "mill-1_speed") if value) > 0.0  # type: ignore[arg-type]
    # mill-2 takes the second batch and is not disturbed: its first part has the cycle's energy.
    begin = next(t for t, value in of(found, "mill-2_exec") if value == "ACTIVE")
    end = begin + cycle.cycle.time
    part = [row for row in found if begin <= row[0] < end]
    assert integral(part, "mill-2_watt", end) == pytest.approx(cycle.cycle.energy, rel=0.02)
    steps = {value for _, value in of(found, "mill-2_workingstep")}
    assert len(steps - {None}) >= 1


def test_a_failure_interrupts_the_program_where_it_is(
    milled: tuple[Shop, MachiningPlan, Told],
) -> None:
    _, _, found = milled
    execution = list(of(found, "mill-1_exec"))
    assert (300.0, "INTERRUPTED") in execution
    at = execution.index((300.0, "INTERRUPTED"))
    assert execution[at + 1] == (420.0, "ACTIVE")
    assert not [1 for time, value in of(found, "mill-1_xpos") if 300.0 < time < 420.0]
    assert (300.0, 0) in list(of(found, "mill-1_speed"))
    # The rest of the part comes after the repair: no line of the program comes twice.
    end = next(t for t, value in execution[at + 2 :])
    lines = [
        value
        for time, value in of(found, "mill-1_line")
        if execution[at - 1][0] <= time < end and isinstance(value, int)
    ]
    assert lines == sorted(lines)
    assert len(lines) > 5
