"""Random deviation of motor powers, in samples and totals alike."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.machine.cutting import CuttingEdge
from simulator.machine.deviation import SeededDeviation, movement_factors, movement_of
from simulator.machine.interpreter import interpret
from simulator.machine.samples import Episode, Samples, joined
from simulator.machine.sensing import Sampler
from simulator.machine.totals import Energy, Total, added
from simulator.machine.virtual import LoadedTool, MachineSetup, StockMap, VirtualMachine
from simulator.motion.control import ExactStop
from simulator.motion.segments import lines
from simulator.removal.cutter import Cutter
from simulator.spec import Kienzle, Machine, PowerDeviation
from stepnc_model.post import blocks as nc

DEVIATION = PowerDeviation(feed=0.1, traverse=0.05)
EDGE = CuttingEdge(teeth=2, kienzle=Kienzle(k_c11=1500.0, m_c=0.25))
FEED = nc.Rate(value=10.0)
BLOCKS: tuple[nc.Block, ...] = (
    nc.ToolChange(number=1),
    nc.SpindleOn(speed=40.0),
    nc.Coolant(kinds=frozenset({nc.CoolantKind.FLOOD})),
    nc.Rapid(end=(0.0, 0.0, 0.0)),
    nc.Rapid(end=(5.0, 0.0, 0.0)),
    nc.Linear(end=(25.0, 0.0, 0.0), rate=FEED),
    nc.Linear(end=(25.0, 0.0, 8.0), rate=FEED),
    nc.Rapid(end=(0.0, 0.0, 20.0)),
    nc.Pause(seconds=1.0),
    nc.Linear(end=(0.0, 0.0, 0.0), rate=FEED),
    nc.Rapid(end=(40.0, 0.0, 20.0)),
    nc.ProgramEnd(),
)
RAPIDS = np.array([True, False, False, True, False, True])
"""Of the movements of these blocks; the machine begins where the first rapid ends."""

Stocks = Callable[[], StockMap]


def episodes(
    machine: Machine, stock: StockMap, seeded: SeededDeviation | None
) -> list[Episode]:
    tool = LoadedTool(number=1, id="T1", shape=Cutter(diameter=10.0), edge=EDGE)
    setup = MachineSetup(
        machine=machine,
        control=ExactStop(),
        tools={1: tool},
        stock=lambda _: stock,
        deviation=seeded,
    )
    return list(VirtualMachine(setup).run(interpret(enumerate(BLOCKS, 1), machine)))


def total_of(ran: list[Episode], machine: Machine) -> Total:
    total = Total()
    for episode in ran:
        total = added(total, episode, machine)
    return total


def samples_of(ran: list[Episode], machine: Machine, rate: float) -> Samples:
    sampler = Sampler(machine, rate=rate)
    return joined([part for episode in ran for part in sampler.samples(episode)])


def motors(energy: Energy) -> float:
    return energy.x_axis + energy.y_axis + energy.z_axis + energy.spindle


def test_a_movement_is_a_block_and_a_kind_of_motion() -> None:
    path = lines([(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0), (4, 0, 0), (5, 0, 0)], speed=5.0)
    path = replace(
        path,
        block=np.array([7, 7, 8, 8, 9]),
        is_rapid=np.array([False, False, True, False, False]),
    )
    assert movement_of(path).tolist() == [0, 0, 1, 2, 3]


def test_factors_are_those_of_the_number_and_not_of_the_stretch() -> None:
    seeded = SeededDeviation(deviation=DEVIATION, seed=11)
    is_rapid = np.arange(3000) % 3 == 0
    whole = movement_factors(seeded, is_rapid, first=0)
    parts = [
        movement_factors(seeded, is_rapid[begin:end], first=begin)
        for begin, end in ((0, 1), (1, 1024), (1024, 1025), (1025, 3000))
    ]
    assert np.concatenate(parts).tolist() == whole.tolist()


def test_factors_are_stable_across_machines() -> None:
    """The words come from Philox and SeedSequence, whose streams NumPy keeps."""
    seeded = SeededDeviation(deviation=PowerDeviation(feed=1.0, traverse=1.0), seed=1)
    first = movement_factors(seeded, np.zeros(3, dtype=np.bool_), first=0)
    words = np.random.SeedSequence([1, *b"power of movements"]).generate_state(2, np.uint64)
    raw = np.random.Philox(key=words).random_raw(6)[::2]
    assert first == pytest.approx([2.0 * (int(word) / 2**64) for word in raw], abs=1e-12)


def test_factors_are_uniform_within_their_half_widths() -> None:
    seeded = SeededDeviation(deviation=DEVIATION, seed=3)
    for is_rapid, width in ((True, 0.05), (False, 0.1)):
        factors = movement_factors(seeded, np.full(20_000, is_rapid), first=0)
        assert np.abs(factors - 1.0).max() <= width
        assert factors.mean() == pytest.approx(1.0, abs=4.0 * width / np.sqrt(3.0 * 20_000))
        assert factors.var() == pytest.approx(width**2 / 3.0, rel=0.03)


def test_a_negative_seed_is_refused() -> None:
    with pytest.raises(ValueError, match="seed -1 must be at least 0"):
        SeededDeviation(deviation=DEVIATION, seed=-1)


def test_samples_integrate_to_the_totals(mill: Machine, even_stock: Stocks) -> None:
    ran = episodes(mill, even_stock(), SeededDeviation(deviation=DEVIATION, seed=5))
    total = total_of(ran, mill)
    samples = samples_of(ran, mill, 2000.0)
    energy = np.trapezoid(samples.total_power, samples.time)
    assert energy == pytest.approx(total.energy.total, rel=1e-4)
    axes = np.trapezoid(samples.axis_power, samples.time, axis=0)
    parts = (total.energy.x_axis, total.energy.y_axis, total.energy.z_axis)
    assert axes == pytest.approx(parts, rel=5e-3)


def test_each_movement_deviates_by_its_factor_and_nothing_else_does(
    mill: Machine, even_stock: Stocks
) -> None:
    seeded = SeededDeviation(deviation=DEVIATION, seed=9)
    plain = samples_of(episodes(mill, even_stock(), None), mill, 50.0)
    drawn = samples_of(episodes(mill, even_stock(), seeded), mill, 50.0)
    turning = plain.spindle_power > 0.0
    ratio = np.ones(len(plain))
    ratio[turning] = drawn.spindle_power[turning] / plain.spindle_power[turning]
    moving = plain.path_mode > 0
    shown = moving & turning
    found = [ratio[shown & (plain.line == line)] for line in (5, 6, 7, 8, 10, 11)]
    factors = movement_factors(seeded, RAPIDS, first=0)
    for shares, factor in zip(found, factors, strict=True):
        assert len(shares)
        assert shares == pytest.approx(factor)
    assert (ratio[~moving] == 1.0).all()
    same = ("time", "position", "cutting_force", "cutting_power", "base_power", "coolant_power")
    for name in same:
        assert np.array_equal(getattr(plain, name), getattr(drawn, name))


def test_the_peak_while_cutting_deviates_with_its_movement(
    mill: Machine, even_stock: Stocks
) -> None:
    seeded = SeededDeviation(deviation=DEVIATION, seed=9)
    plain = total_of(episodes(mill, even_stock(), None), mill)
    drawn = total_of(episodes(mill, even_stock(), seeded), mill)
    feeds = movement_factors(seeded, RAPIDS, first=0)[~RAPIDS]
    assert drawn.drive_power.value == pytest.approx(plain.drive_power.value * feeds.max())
    assert drawn.cutting_power == plain.cutting_power


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**31))
def test_the_energy_never_leaves_the_bounds(seed: int, mill: Machine) -> None:
    blocks: list[nc.Block] = [
        nc.SpindleOn(speed=40.0),
        nc.Rapid(end=(0.0, 0.0, 0.0)),
        *(nc.Linear(end=end, rate=FEED) for end in ((30.0, 0.0, 0.0), (30.0, 20.0, 0.0))),
        nc.Rapid(end=(0.0, 0.0, 0.0)),
    ]

    def energy(seeded: SeededDeviation | None) -> Energy:
        setup = MachineSetup(machine=mill, control=ExactStop(), deviation=seeded)
        ran = VirtualMachine(setup).run(interpret(enumerate(blocks, 1), mill))
        return total_of(list(ran), mill).energy

    plain = energy(None)
    drawn = energy(SeededDeviation(deviation=DEVIATION, seed=seed))
    again = energy(SeededDeviation(deviation=DEVIATION, seed=seed))
    assert drawn == again
    assert drawn.base == plain.base
    assert 0.9 <= motors(drawn) / motors(plain) <= 1.1


def test_the_mean_over_seeds_tends_to_the_undisturbed_energy(
    mill: Machine, even_stock: Stocks
) -> None:
    plain = total_of(episodes(mill, even_stock(), None), mill).energy.total
    drawn = np.array([
        total_of(
            episodes(mill, even_stock(), SeededDeviation(deviation=DEVIATION, seed=seed)), mill
        ).energy.total
        for seed in range(60)
    ])
    assert len(set(drawn.tolist())) == 60
    assert drawn.mean() == pytest.approx(plain, abs=4.0 * drawn.std() / np.sqrt(60.0))
    assert drawn.std() > 1e-3 * plain
