"""Interpolated cycles, held against cycles whose values are known in closed form."""

from collections.abc import Callable
from math import ceil

import numpy as np
import pytest

from extras.factory.model.cycle import PARTS, PartCycle, drawn_energies
from extras.factory.model.interpolation import (
    CycleTable,
    SettingRange,
    SettingsDesign,
    cycle_table,
)
from simulator.errors import SimulationError
from simulator.spec import PowerDeviation
from stepnc_model.editing.cut_settings import CutSettings

DESIGN = SettingsDesign(
    feed=SettingRange(low=30.0, high=90.0),
    spindle_speed=SettingRange(low=12.0, high=36.0),
    depth=SettingRange(low=0.9, high=2.6),
)
TOTAL = 5.0
"""Depth of the pocket, mm."""


def count(depth: float) -> int:
    return ceil(TOTAL / depth - 1e-9)


def cycle(settings: CutSettings) -> PartCycle:
    """A pocket of equal layers of 1 m each; k_c as in Kienzle's law."""
    feed, speed, depth = settings.feed, settings.spindle_speed, settings.depth
    assert feed is not None
    assert speed is not None
    assert depth is not None
    assert speed < 0.0
    layers = count(depth)
    seconds = 1000.0 / feed + feed / 3000.0
    cut = 2e4 * (feed / abs(speed)) ** -0.25 + 30.0 * abs(speed) * seconds
    feeds = np.repeat([cut / layers, 50.0], layers)
    traverse = np.full(layers + 1, 60.0)
    time = 2.0 + 0.2 * abs(speed) + layers * (seconds + 0.5)
    return PartCycle(
        time=time,
        energy=650.0 * time + feeds.sum() + traverse.sum(),
        peak_power=400.0 + 10.0 * abs(speed),
        traverse_energies=traverse,
        feed_energies=feeds,
        profile=np.linspace(0.0, 1.0, PARTS + 1),
    )


@pytest.fixture(scope="module")
def table() -> CycleTable:
    return cycle_table(DESIGN, cycle, count)


Drawn = tuple[np.ndarray, np.ndarray, np.ndarray]


def drawn(number: int, seed: int = 1) -> Drawn:
    rng = np.random.default_rng(seed)
    low, high = (30.0, 12.0, 0.9), (90.0, 36.0, 2.6)
    feed, speed, depth = rng.uniform(low, high, (number, 3)).T
    return feed, speed, depth


def settings_of(feed: float, speed: float, depth: float) -> CutSettings:
    return CutSettings(feed=feed, spindle_speed=-speed, depth=depth)


def test_layers_change_where_their_number_does(table: CycleTable) -> None:
    assert table.bounds == pytest.approx([1.0, 1.25, 5.0 / 3.0, 2.5], abs=2e-6)
    assert len(table.tables) == 5
    # The depth does not matter as long as the layers stay the same.
    assert {each.orders[2] for each in table.tables} == {0}


def test_values_are_those_of_runs(table: CycleTable) -> None:
    feed, speed, depth = drawn(500)
    found = table.values(feed, speed, depth)
    runs = [cycle(settings_of(*row)) for row in zip(feed, speed, depth, strict=True)]
    assert found.time == pytest.approx([each.time for each in runs], rel=5e-3)
    assert found.energy == pytest.approx([each.energy for each in runs], rel=5e-3)
    assert found.peak_power == pytest.approx([each.peak_power for each in runs], rel=1e-9)
    assert table.time_error <= 5e-3
    assert table.energy_error <= 5e-3


def test_a_bound_belongs_to_the_deeper_side(table: CycleTable) -> None:
    feed, speed = np.full(2, 50.0), np.full(2, 20.0)
    shallow, deep = table.values(feed, speed, np.array([2.4999, 2.5])).time.tolist()
    assert shallow == pytest.approx(cycle(settings_of(50.0, 20.0, 2.4999)).time, rel=5e-3)
    assert deep == pytest.approx(cycle(settings_of(50.0, 20.0, 2.5)).time, rel=5e-3)
    assert shallow > 1.3 * deep


def test_the_sign_of_the_spindle_speed_does_not_count(table: CycleTable) -> None:
    feed, speed, depth = drawn(5)
    one, other = (table.values(feed, each, depth) for each in (speed, -speed))
    assert np.array_equal(one.energy, other.energy)


def test_a_cycle_has_movements_that_sum_to_its_energy(table: CycleTable) -> None:
    settings = settings_of(44.0, 17.0, 1.1)
    found, run = table.cycle(settings), cycle(settings)
    assert found.feed_energies == pytest.approx(run.feed_energies, rel=2e-2)
    assert found.traverse_energies == pytest.approx(run.traverse_energies)
    moved = found.feed_energies.sum() + found.traverse_energies.sum()
    assert found.energy == pytest.approx(650.0 * found.time + moved, rel=1e-9)
    assert found.profile == pytest.approx(run.profile, abs=1e-9)


def test_energies_with_deviation_are_distributed_as_those_of_the_cycle(
    table: CycleTable,
) -> None:
    deviation = PowerDeviation(feed=0.1, traverse=0.05)
    number, settings = 4000, settings_of(44.0, 17.0, 1.1)
    columns = [np.full(number, value) for value in (44.0, 17.0, 1.1)]
    rng = np.random.default_rng(3)
    found = table.drawn_energies(*columns, deviation=deviation, rng=rng)
    direct = drawn_energies(cycle(settings), deviation, np.random.default_rng(4), number)
    assert found.mean() == pytest.approx(direct.mean(), rel=5e-3)
    assert found.std() == pytest.approx(direct.std(), rel=0.06)
    one = table.cycle(settings)
    most = 0.1 * one.feed_energies.sum() + 0.05 * one.traverse_energies.sum()
    assert np.abs(found - one.energy).max() <= most


def test_without_deviation_they_are_the_values(table: CycleTable) -> None:
    columns = drawn(50)
    none = PowerDeviation(feed=0.0, traverse=0.0)
    found = table.drawn_energies(*columns, deviation=none, rng=np.random.default_rng(1))
    assert found == pytest.approx(table.values(*columns).energy, rel=1e-12)


def test_settings_that_the_design_leaves_out_are_those_of_the_program() -> None:
    asked: list[CutSettings] = []

    def run(settings: CutSettings) -> PartCycle:
        asked.append(settings)
        return cycle(CutSettings(feed=settings.feed, spindle_speed=-20.0, depth=1.5))

    design = SettingsDesign(feed=SettingRange(low=30.0, high=90.0))
    table = cycle_table(design, run, count)
    assert all(each.spindle_speed is None and each.depth is None for each in asked)
    feed = np.array([31.0, 88.0])
    nothing = np.full(2, np.nan)
    found = table.values(feed, nothing, nothing).time
    runs = [cycle(settings_of(each, 20.0, 1.5)).time for each in feed]
    assert found == pytest.approx(runs, rel=5e-3)
    assert table.cycle(CutSettings(feed=31.0)).time == pytest.approx(runs[0], rel=5e-3)


def test_a_depth_that_matters_within_its_layers_is_interpolated() -> None:
    def run(settings: CutSettings) -> PartCycle:
        plain = cycle(settings)
        assert settings.depth is not None
        return PartCycle(
            time=plain.time + 3.0 * settings.depth,
            energy=plain.energy,
            peak_power=plain.peak_power,
            traverse_energies=plain.traverse_energies,
            feed_energies=plain.feed_energies,
            profile=plain.profile,
        )

    table = cycle_table(DESIGN, run, count)
    columns = drawn(200)
    runs = [run(settings_of(*row)).time for row in zip(*columns, strict=True)]
    assert table.values(*columns).time == pytest.approx(runs, rel=5e-3)
    assert {each.orders[2] for each in table.tables} == {2}


def edged(settings: CutSettings) -> PartCycle:
    """A machine that feeds no faster than 60 mm/s, and costs a second where it begins to."""
    assert settings.feed is not None
    plain = cycle(settings)
    slower = 200.0 if settings.feed > 60.0 else 0.0
    return PartCycle(
        time=plain.time + slower,
        energy=plain.energy,
        peak_power=plain.peak_power,
        traverse_energies=plain.traverse_energies,
        feed_energies=plain.feed_energies,
        profile=plain.profile,
    )


def test_what_cannot_be_interpolated_is_refused_with_the_error() -> None:
    with pytest.raises(SimulationError) as caught:
        cycle_table(DESIGN, edged, count)
    text = str(caught.value)
    assert text.startswith("cycles cannot be interpolated at depths of 0.9 to 1 mm: 12 points")
    assert "at most 0.5 % are allowed; narrow the ranges" in text


def test_a_sharper_dependence_needs_a_higher_order() -> None:
    def run(settings: CutSettings) -> PartCycle:
        plain = cycle(settings)
        assert settings.spindle_speed is not None
        share = 1.0 + 0.2 * np.sin(settings.spindle_speed / 6.0)
        return PartCycle(
            time=plain.time * share,
            energy=plain.energy,
            peak_power=plain.peak_power,
            traverse_energies=plain.traverse_energies,
            feed_energies=plain.feed_energies,
            profile=plain.profile,
        )

    table = cycle_table(DESIGN, run, count)
    assert min(each.orders[1] for each in table.tables) > 2
    columns = drawn(200)
    runs = [run(settings_of(*row)).time for row in zip(*columns, strict=True)]
    assert table.values(*columns).time == pytest.approx(runs, rel=1e-2)


def test_movements_that_differ_within_the_same_layers_are_told() -> None:
    with pytest.raises(SimulationError, match=r"runs with the same layers have .* movements"):
        cycle_table(DESIGN, cycle, lambda _: 1)


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ((29.0, 20.0, 1.0), "feed 29 is outside 30 to 90"),
        ((30.0, 40.0, 1.0), "spindle speed 40 is outside 12 to 36"),
        ((30.0, 20.0, 3.0), "depth 3 is outside 0.9 to 2.6"),
    ],
)
def test_settings_outside_the_design_are_refused(
    table: CycleTable, row: tuple[float, float, float], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        table.values(*(np.array([value]) for value in row))


@pytest.mark.parametrize("ends", [(0.0, 1.0), (2.0, 1.0), (1.0, float("inf"))])
def test_a_range_is_positive_and_rises(ends: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="must be positive and rise"):
        SettingRange(low=ends[0], high=ends[1])


def test_a_range_of_one_value_is_a_table_of_one_row() -> None:
    single: Callable[[float], SettingRange] = lambda value: SettingRange(low=value, high=value)  # noqa: E731
    design = SettingsDesign(feed=single(50.0), spindle_speed=single(20.0), depth=single(1.0))
    table = cycle_table(design, cycle, count)
    found = table.values(np.array([50.0]), np.array([20.0]), np.array([1.0]))
    assert found.time[0] == pytest.approx(cycle(settings_of(50.0, 20.0, 1.0)).time, rel=1e-12)
    assert table.runs <= 2
