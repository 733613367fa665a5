"""Interpolated cycles of the pocket of paper 003, held against 64 direct runs."""

from math import pi
from pathlib import Path
from time import process_time

import numpy as np
import pytest
from scipy.stats import qmc

from extras.factory.cycles import PartCycles
from extras.factory.model.interpolation import CycleTable, SettingRange, SettingsDesign
from service.programs.machine_choice import material_for
from simulator.library import load_machine
from stepnc_model.editing.cut_settings import CutSettings
from stepnc_model.programs.program import Program

PARTS = Path(__file__).parents[3] / "examples" / "parts"
POCKET = Program.load(PARTS / "paper003_pocket.stpnc")
MACHINE = load_machine("paper003")
LOW, HIGH = (30.0, 75.4 / (2.0 * pi), 2.5), (90.0, 226.2 / (2.0 * pi), 3.5)
"""mm/s, rev/s and mm of §4.2"""
DESIGN = SettingsDesign(
    feed=SettingRange(low=LOW[0], high=HIGH[0]),
    spindle_speed=SettingRange(low=LOW[1], high=HIGH[1]),
    depth=SettingRange(low=LOW[2], high=HIGH[2]),
)
RUNS = 64
"""Points of a Sobol sequence: the gaps between them are those of 200 drawn at random."""


@pytest.fixture(scope="module")
def cycles() -> PartCycles:
    return PartCycles()


@pytest.fixture(scope="module")
def table(cycles: PartCycles) -> CycleTable:
    return cycles.table(POCKET, MACHINE, material_for("", POCKET), DESIGN)


def test_time_and_energy_are_within_a_per_cent_of_direct_runs(
    cycles: PartCycles, table: CycleTable
) -> None:
    rows = qmc.scale(qmc.Sobol(3, seed=42).random(RUNS), LOW, HIGH)
    found = table.values(*rows.T)
    material = material_for("", POCKET)
    direct = [
        cycles.cycle(
            POCKET,
            MACHINE,
            material,
            CutSettings(feed=feed, spindle_speed=-speed, depth=depth),
        )
        for feed, speed, depth in rows.tolist()
    ]
    assert found.time == pytest.approx([each.time for each in direct], rel=0.01)
    assert found.energy == pytest.approx([each.energy for each in direct], rel=0.01)
    # Within a table every movement has its own polynomial.
    for (feed, speed, depth), run in zip(rows[:20].tolist(), direct, strict=False):
        one = table.cycle(CutSettings(feed=feed, spindle_speed=-speed, depth=depth))
        moved = run.feed_energies.sum()
        assert one.feed_energies.sum() == pytest.approx(moved, rel=0.02)
        assert np.abs(one.profile - run.profile).max() < 0.03


def test_a_shop_asks_for_many_parts(table: CycleTable) -> None:
    """2 µs a part is what is wanted; ten times that is a slip, on any machine."""
    rows = np.random.default_rng(1).uniform(LOW, HIGH, (100_000, 3))
    began = process_time()
    table.values(*rows.T)
    assert (process_time() - began) / len(rows) < 20e-6


def test_layers_of_a_slot_change_at_a_third_of_its_depth(cycles: PartCycles) -> None:
    program = Program.load(PARTS / "paper003_case1.stpnc")
    design = SettingsDesign(depth=SettingRange(low=2.5, high=3.5))
    table = cycles.table(program, MACHINE, material_for("", program), design)
    assert table.bounds == pytest.approx([3.0], abs=1e-5)
    nothing = np.full(2, np.nan)
    times = table.values(nothing, nothing, np.array([2.9, 3.1])).time
    runs = [
        cycles.cycle(program, MACHINE, material_for("", program), CutSettings(depth=depth)).time
        for depth in (2.9, 3.1)
    ]
    assert times == pytest.approx(runs, rel=1e-9)
