"""The kernels of a reading give what the same formulas give in numpy, to the last digit."""

import numpy as np
import pytest

from simulator.motion.segments import Floats
from simulator.plant.course import NominalCourse
from simulator.plant.feed_samples import FeedSamples, _added
from tests.simulator.plant.courses import EXPONENT, course

LAG = 0.06
FORCES = np.random.default_rng(1).uniform(50.0, 800.0, 40)


def differences(values: Floats) -> Floats:
    return np.diff(values, prepend=0.0)


@pytest.mark.parametrize("count", [8, 24])
@pytest.mark.parametrize(("override", "aim"), [(1.0, 1.0), (0.7, 1.3), (1.1, 0.0)])
def test_ways_and_forces_are_those_of_numpy(count: int, override: float, aim: float) -> None:
    on: NominalCourse = course(FORCES, cell=0.003)
    samples, progress, period = FeedSamples(on, count, LAG), 0.0101, 0.0085
    samples.go(progress, 3, override=override, aim=aim, period=period)
    steps = (np.arange(count) + 1.0) / count
    gone = 1.0 - np.exp(-period * steps / LAG)
    ways = aim * period * steps + (override - aim) * LAG * gone
    rows = on.until.searchsorted(progress + ways, side="left")
    assert samples.ways.tolist() == ways.tolist()
    assert (samples.way, samples.row) == (ways[-1], rows[-1])

    samples.shape[...] = np.linspace(0.5, 1.5, count)
    mean = samples.cut(EXPONENT, factor=1.2, depth=1.5, flank_wear=0.1)
    overrides = differences(ways) * (count / period)
    chips = 1.2 * on.force[rows] * overrides**EXPONENT * 1.5
    land = 1.5 * (0.1 * on.land_force[rows].astype(np.float64))
    assert samples.chips.tolist() == chips.tolist()
    assert samples.land.tolist() == land.tolist()
    assert mean == np.add.reduce(chips + land) / count
    force = (chips + land) * np.linspace(0.5, 1.5, count)
    assert samples.force.tolist() == force.tolist()
    assert samples.peak == force.max()


def test_beyond_the_end_of_the_course_its_last_cell_counts() -> None:
    samples = FeedSamples(course(FORCES), 8, LAG)
    samples.go(0.395, len(FORCES) - 1, override=1.0, aim=1.0, period=0.02)
    assert samples.row == len(FORCES) - 1


@pytest.mark.parametrize("count", [1, 3, 7, 8, 9, 24, 127, 128])
def test_sums_are_rounded_as_by_numpy(count: int) -> None:
    values = np.random.default_rng(count).normal(size=count) * 1e3
    assert _added(values) == np.add.reduce(values)


def test_long_sums_are_sums_too() -> None:
    values = np.random.default_rng(3).normal(size=1000)
    assert _added(values) == pytest.approx(np.add.reduce(values), rel=1e-12)
