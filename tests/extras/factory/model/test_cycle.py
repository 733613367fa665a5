"""Cycle of a part: the energies of runs of the virtual machine, also with deviation."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from extras.factory.model import cycle as module
from extras.factory.model.cycle import PARTS, PartCycle, cycle_of, drawn_energies
from simulator.library import load_machine
from simulator.machine.cutting import CuttingEdge
from simulator.machine.deviation import SeededDeviation, movement_factors
from simulator.machine.interpreter import interpret
from simulator.machine.samples import Episode, joined
from simulator.machine.sensing import Sampler
from simulator.machine.totals import Total, added
from simulator.machine.virtual import LoadedTool, MachineSetup, VirtualMachine
from simulator.motion.control import control_model
from simulator.motion.model_name import ControlModelName
from simulator.motion.segments import axis_limits
from simulator.removal.cutter import Cutter
from simulator.removal.engage import MillingStock
from simulator.spec import Kienzle, PowerDeviation
from stepnc_model.post import blocks as nc
from stepnc_model.programs.program import Stock

MACHINE = load_machine("vmc15")
DEVIATION = PowerDeviation(feed=0.1, traverse=0.05)
EDGE = CuttingEdge(teeth=2, kienzle=Kienzle(k_c11=1500.0, m_c=0.25))
STOCK = Stock(low=(0.0, 0.0, -10.0), high=(30.0, 20.0, 0.0))
FEED = nc.Rate(value=15.0)
IS_RAPID = np.array([True, False, False, False, True, True, False, True])
"""Of the movements of the blocks below; the first rapid is where the machine starts."""
BLOCKS: tuple[nc.Block, ...] = (
    nc.ToolChange(number=1),
    nc.SpindleOn(speed=80.0),
    nc.Coolant(kinds=frozenset({nc.CoolantKind.FLOOD})),
    nc.Rapid(end=(-8.0, 10.0, 20.0)),
    nc.Rapid(end=(-8.0, 10.0, -2.0)),
    nc.Linear(end=(12.0, 10.0, -2.0), rate=FEED),
    nc.Linear(end=(12.0, 16.0, -2.0), rate=FEED),
    nc.Linear(end=(40.0, 16.0, -2.0), rate=FEED),
    nc.Rapid(end=(40.0, 16.0, 20.0)),
    nc.Rapid(end=(-8.0, 5.0, 20.0)),
    nc.Linear(end=(-8.0, 5.0, 0.0), rate=FEED),
    nc.Rapid(end=(-8.0, 5.0, 40.0)),
    nc.ProgramEnd(),
)


def episodes(seeded: SeededDeviation | None = None) -> list[Episode]:
    stock = MillingStock(STOCK, cell=0.5)
    setup = MachineSetup(
        machine=MACHINE,
        control=control_model(ControlModelName.FIR, axis_limits(MACHINE)),
        tools={1: LoadedTool(number=1, id="T1", shape=Cutter(diameter=8.0), edge=EDGE)},
        stock=lambda _: stock,
        deviation=seeded,
    )
    return list(VirtualMachine(setup).run(interpret(enumerate(BLOCKS, 1), MACHINE)))


def total_of(ran: list[Episode]) -> Total:
    total = Total()
    for episode in ran:
        total = added(total, episode, MACHINE)
    return total


@pytest.fixture(scope="module")
def cycle() -> PartCycle:
    return cycle_of(episodes(), MACHINE)


def test_time_and_energy_are_those_of_the_totals(cycle: PartCycle) -> None:
    total = total_of(episodes())
    assert cycle.time == pytest.approx(total.duration, rel=1e-12)
    assert cycle.energy == pytest.approx(total.energy.total, rel=1e-12)
    assert len(cycle.traverse_energies) == IS_RAPID.sum()
    assert len(cycle.feed_energies) == (~IS_RAPID).sum()


def test_movements_and_constant_loads_make_the_energy(cycle: PartCycle) -> None:
    """What is not drawn in movements: base, coolant, and the spindle while the axes rest."""
    ran = episodes()
    energy = total_of(ran).energy
    at_rest = total_of([each for each in ran if each.course is None]).energy.spindle
    moved = cycle.traverse_energies.sum() + cycle.feed_energies.sum()
    assert cycle.energy == pytest.approx(energy.base + energy.coolant + at_rest + moved)


def test_the_profile_is_that_of_the_samples(cycle: PartCycle) -> None:
    sampler = Sampler(MACHINE, rate=1000.0)
    samples = joined([part for each in episodes() for part in sampler.samples(each)])
    used = np.concatenate((
        [0.0],
        np.cumsum(0.5 * np.diff(samples.time) * (
            samples.total_power[1:] + samples.total_power[:-1]
        )),
    ))  # fmt: skip
    at = np.interp(np.linspace(0.0, cycle.time, PARTS + 1), samples.time, used)
    assert cycle.profile == pytest.approx(at / used[-1], abs=3e-3)
    assert (cycle.profile[0], cycle.profile[-1]) == (0.0, 1.0)
    assert all(low <= high for low, high in pairwise(cycle.profile.tolist()))
    assert cycle.peak_power == pytest.approx(samples.total_power.max(), rel=0.02)


@pytest.mark.parametrize("seed", range(5))
def test_a_run_with_deviation_is_the_sum_over_its_movements(
    cycle: PartCycle, seed: int
) -> None:
    seeded = SeededDeviation(deviation=DEVIATION, seed=seed)
    factors = movement_factors(seeded, IS_RAPID, first=0) - 1.0
    expected = (
        cycle.energy
        + factors[IS_RAPID] @ cycle.traverse_energies
        + factors[~IS_RAPID] @ cycle.feed_energies
    )
    assert total_of(episodes(seeded)).energy.total == pytest.approx(expected, rel=1e-10)


def test_drawn_energies_are_distributed_as_those_of_runs(cycle: PartCycle) -> None:
    count = 4000
    drawn = drawn_energies(cycle, DEVIATION, np.random.default_rng(1), count)
    widths = np.concatenate((0.05 * cycle.traverse_energies, 0.1 * cycle.feed_energies))
    spread = float(np.sqrt((widths**2).sum() / 3.0))
    assert drawn.shape == (count,)
    assert drawn.mean() == pytest.approx(cycle.energy, abs=4.0 * spread / np.sqrt(count))
    assert drawn.std() == pytest.approx(spread, rel=0.05)
    assert np.abs(drawn - cycle.energy).max() <= np.abs(widths).sum()
    runs = np.array([
        total_of(episodes(SeededDeviation(deviation=DEVIATION, seed=seed))).energy.total
        for seed in range(120)
    ])
    assert runs.mean() == pytest.approx(drawn.mean(), abs=4.0 * spread / np.sqrt(120.0))
    assert runs.std() == pytest.approx(spread, rel=0.25)


def test_chunks_draw_the_same_numbers(
    cycle: PartCycle, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = drawn_energies(cycle, DEVIATION, np.random.default_rng(7), 50)
    monkeypatch.setattr(module, "MOST_DRAWN", 30)
    parts = drawn_energies(cycle, DEVIATION, np.random.default_rng(7), 50)
    assert parts == pytest.approx(whole, rel=1e-14)


def test_without_deviation_all_parts_are_alike(cycle: PartCycle) -> None:
    none = PowerDeviation(feed=0.0, traverse=0.0)
    drawn = drawn_energies(cycle, none, np.random.default_rng(1), 3)
    assert drawn.tolist() == [cycle.energy] * 3


def test_a_machine_that_draws_nothing_has_the_profile_of_time() -> None:
    still = [each for each in episodes() if each.course is None and each.end > each.begin][:1]
    silent = replace(
        MACHINE,
        base_power=0.0,
        coolant_power=0.0,
        spindle=replace(MACHINE.spindle, idle_power=0.0, idle_power_per_speed=0.0, inertia=0.0),
    )
    cycle = cycle_of(still, silent)
    assert cycle.energy == 0.0
    assert cycle.profile == pytest.approx(np.linspace(0.0, 1.0, PARTS + 1))
