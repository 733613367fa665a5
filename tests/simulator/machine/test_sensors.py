"""Seeded noise: its distribution, and that chunks do not matter."""

from itertools import pairwise
from math import sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.machine.disturbance import EQUAL, FORCE, POWER, Noise, SeededSensor, shown

COUNT = 20_000
FEED = np.zeros(COUNT, dtype=np.bool_)
ALL = Noise(relative=0.03, absolute=2.0, feed_spread=0.1, rapid_spread=0.05, missing=0.1)


@settings(max_examples=20, deadline=None)
@given(cuts=st.lists(st.integers(0, 3000), max_size=5), seed=st.integers(0, 2**63))
def test_chunks_do_not_matter(cuts: list[int], seed: int) -> None:
    sensor = SeededSensor(column="cutting_force", noise=ALL, seed=seed)
    truth = np.linspace(0.0, 500.0, 3000)
    is_rapid = np.arange(3000) % 7 == 0
    whole = shown(sensor, truth, first=0, is_rapid=is_rapid)
    edges = [0, *sorted(cuts), 3000]
    parts = [
        shown(sensor, truth[a:b], first=a, is_rapid=is_rapid[a:b]) for a, b in pairwise(edges)
    ]
    assert np.concatenate(parts).tobytes() == whole.tobytes()


def test_force_errs_by_three_per_cent() -> None:
    force = shown(
        SeededSensor(column="f", noise=FORCE), np.full(COUNT, 800.0), first=0, is_rapid=FEED
    )
    assert force.mean() == pytest.approx(800.0, abs=4.0 * 24.0 / sqrt(COUNT))
    assert force.std() == pytest.approx(24.0, rel=0.02)
    within = np.abs(force - 800.0) < 24.0
    assert within.mean() == pytest.approx(0.6827, abs=0.015)


def test_power_errs_by_twenty_watts_also_at_rest() -> None:
    power = shown(
        SeededSensor(column="p", noise=POWER), np.zeros(COUNT), first=0, is_rapid=FEED
    )
    assert power.std() == pytest.approx(20.0, rel=0.02)


def test_equal_distribution_of_feed_and_rapid() -> None:
    truth = np.full(COUNT, 100.0)
    for is_rapid, spread in ((FEED, 10.0), (~FEED, 5.0)):
        power = shown(SeededSensor(column="p", noise=EQUAL), truth, first=0, is_rapid=is_rapid)
        assert np.abs(power - 100.0).max() <= spread
        assert power.std() == pytest.approx(spread / sqrt(3.0), rel=0.02)


def test_another_seed_or_column_is_another_noise() -> None:
    truth = np.zeros(COUNT)
    sensors = [
        SeededSensor(column="x", noise=POWER, seed=1),
        SeededSensor(column="x", noise=POWER, seed=2),
        SeededSensor(column="y", noise=POWER, seed=1),
    ]
    rows = np.array([shown(one, truth, first=0, is_rapid=FEED) for one in sensors])
    between = np.corrcoef(rows) - np.eye(3)
    assert np.abs(between).max() < 4.0 / sqrt(COUNT)


def test_one_sample_tells_nothing_of_the_next() -> None:
    power = shown(
        SeededSensor(column="p", noise=POWER), np.zeros(COUNT), first=0, is_rapid=FEED
    )
    for lag in (1, 2, 4):
        assert abs(np.corrcoef(power[lag:], power[:-lag])[0, 1]) < 4.0 / sqrt(COUNT)


def test_missing_samples_are_nan() -> None:
    sensor = SeededSensor(column="p", noise=Noise(missing=0.25))
    power = shown(sensor, np.ones(COUNT), first=5, is_rapid=FEED)
    assert np.isnan(power).mean() == pytest.approx(0.25, abs=0.015)
    assert (power[~np.isnan(power)] == 1.0).all()


def test_a_sensor_shows_whole_steps() -> None:
    sensor = SeededSensor(column="p", noise=Noise(step=0.25))
    power = shown(sensor, np.array([0.1, 0.2, 7.4]), first=0, is_rapid=FEED[:3])
    assert power.tolist() == [0.0, 0.25, 7.5]


def test_without_noise_the_truth_is_shown() -> None:
    truth = np.array([1.0, 2.0])
    power = shown(SeededSensor(column="p", noise=Noise()), truth, first=0, is_rapid=FEED[:2])
    assert power.tolist() == [1.0, 2.0]
    assert power is not truth


def test_figures_out_of_range_are_refused() -> None:
    with pytest.raises(ValueError, match="relative -1 must be at least 0"):
        Noise(relative=-1.0)
    with pytest.raises(ValueError, match=r"probability 1.5 must lie between 0 and 1"):
        Noise(missing=1.5)
    with pytest.raises(ValueError, match="seed -1"):
        SeededSensor(column="p", noise=POWER, seed=-1)
    with pytest.raises(ValueError, match="sample number -1"):
        shown(SeededSensor(column="p", noise=POWER), np.zeros(1), first=-1, is_rapid=FEED[:1])
