"""Readings of tooth periods become revolutions."""

from itertools import pairwise
from math import isnan, nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller.signals.ports import Reading
from controller.signals.signal import Collector, Revolution, ToothJoiner
from tests.controller.shown import SPINDLE_SPEED, turn


def collected(readings: list[Reading]) -> list[Revolution | None]:
    collector = Collector()
    return [collector.add(reading) for reading in readings]


def one(readings: list[Reading]) -> Revolution:
    *before, last = collected(readings)
    assert before == [None] * (len(readings) - 1)
    assert last is not None
    return last


@given(
    seed=st.integers(0, 2**32 - 1),
    teeth=st.integers(1, 8),
    count=st.integers(1, 20),
    turns=st.integers(1, 3),
)
def test_figures_are_those_of_all_samples(
    seed: int, teeth: int, count: int, turns: int
) -> None:
    random = np.random.default_rng(seed)
    forces = random.normal(500.0, 100.0, (turns, teeth, count))
    first = int(random.integers(teeth))
    period = 1.0 / SPINDLE_SPEED
    readings = [
        each
        for row in range(turns)
        for each in turn(forces[row], start=row * period, first=first)
    ]
    found = [each for each in collected(readings) if each is not None]
    assert len(found) == turns
    for row, each in enumerate(found):
        assert each.force == pytest.approx(forces[row].mean())
        assert each.peak == forces[row].max()
        peaks = np.roll(forces[row].max(axis=1), first)
        means = np.roll(forces[row].mean(axis=1), first)
        np.testing.assert_array_equal(each.tooth_peaks, peaks)
        np.testing.assert_allclose(each.tooth_means, means)
        assert (each.samples, each.first) == (count, first)
        assert each.coverage == 1.0
        assert each.period == pytest.approx(period)
        lines = 2.0 / (teeth * count) * np.abs(np.fft.rfft(forces[row].ravel()))
        if 2 * teeth < teeth * count:
            assert each.tooth_passing == pytest.approx(lines[teeth])
    for before, after in pairwise(found):
        assert after.progress_before == before.progress


def test_means_are_taken_of_what_goes_with_the_force() -> None:
    first, second = turn(np.ones((2, 4)))
    found = one([
        first._replace(power=nan, feed=10.0, override=0.5, progress=0.105, time=3.01),
        second._replace(power=700.0, feed=20.0, override=1.0, progress=0.115, time=3.02),
    ])
    assert (found.power, found.feed, found.override) == (700.0, 15.0, 0.75)
    assert (found.time, found.progress, found.teeth) == (3.02, 0.115, 2)
    # Half of 0.01 s of the program was run in the first tooth period.
    assert found.progress_before == pytest.approx(0.1)


def test_power_that_never_arrived_is_not_known() -> None:
    assert isnan(one([each._replace(power=nan) for each in turn(np.ones((2, 4)))]).power)


@given(seed=st.integers(0, 2**32 - 1), lost=st.floats(0.0, 1.0))
def test_lost_samples_count_nothing(seed: int, lost: float) -> None:
    random = np.random.default_rng(seed)
    forces = random.normal(500.0, 100.0, (4, 8))
    forces[random.random((4, 8)) < lost] = nan
    found = one(turn(forces))
    seen = ~np.isnan(forces)
    assert found.coverage == pytest.approx(seen.mean())
    assert found.is_covered == (seen.sum() >= 16)
    assert isnan(found.force) != found.is_covered
    if seen.any():
        assert found.peak == np.nanmax(forces)
        for tooth in range(4):
            assert isnan(found.tooth_peaks[tooth]) != seen[tooth].any()
    else:
        assert isnan(found.peak)


def test_teeth_of_which_more_was_lost_count_the_same() -> None:
    forces = np.array([[100.0, nan, nan, 100.0], [300.0] * 4])
    assert one(turn(forces)).force == pytest.approx(200.0)


def test_spectrum_of_few_lost_samples_is_nearly_the_one_without() -> None:
    at = 2.0 * np.pi * np.arange(128) / 128
    whole = 500.0 + 200.0 * np.cos(4 * at) + 30.0 * np.cos(at)
    gappy = whole.copy()
    gappy[[0, 5, 40, 41, 90, 127]] = nan
    found = one(turn(gappy.reshape(4, 32)))
    assert found.tooth_passing == pytest.approx(200.0, rel=0.02)
    assert found.once_per_revolution == pytest.approx(30.0, rel=0.05)


def test_samples_lost_where_the_revolution_closes_are_filled_across_it() -> None:
    wave = 100.0 * np.sin(2.0 * np.pi * np.arange(32) / 32)
    wave[[29, 30, 31, 0, 1, 2]] = nan
    found = one(turn(wave.reshape(2, 16)))
    assert found.once_per_revolution == pytest.approx(100.0, rel=0.01)


def test_reading_without_samples_is_a_tooth_that_was_lost() -> None:
    readings = turn(np.full((4, 8), 100.0))
    readings[2] = readings[2]._replace(force=np.empty(0))
    found = one(readings)
    assert (found.force, found.coverage) == (100.0, 0.75)
    assert isnan(found.tooth_means[2])
    assert isnan(found.tooth_passing)
    nothing = one([each._replace(force=np.empty(0)) for each in readings])
    assert nothing.coverage == 0.0
    assert isnan(nothing.force)


def test_unlike_numbers_of_samples_are_all_there() -> None:
    """A sampling rate that the tooth period is no multiple of."""
    readings = turn(np.ones((3, 1)))
    rows = [np.array([1.0, 2.0]), np.array([3.0]), np.array([4.0, 6.0])]
    readings = [each._replace(force=row) for each, row in zip(readings, rows, strict=True)]
    found = one(readings)
    assert found.coverage == 1.0
    np.testing.assert_array_equal(found.tooth_means, [1.5, 3.0, 5.0])
    assert found.peak == 6.0


FOUR = turn(np.arange(32.0).reshape(4, 8))
NEXT = turn(np.arange(32.0).reshape(4, 8), start=0.02)


@pytest.mark.parametrize(
    "change",
    [
        {"spindle_speed": 1.05 * SPINDLE_SPEED},
        {"workingstep": 2},
        {"tooth": 2},
        {"time": NEXT[1].time + 0.02},
    ],
    ids=str,
)
def test_revolution_begins_anew_at_a_change(change: dict[str, float]) -> None:
    """After the first tooth of the second revolution; four more complete the next one."""
    odd = NEXT[1]._replace(**change)  # type: ignore[arg-type]
    later = [
        odd._replace(
            tooth=(odd.tooth + row) % 4,
            time=odd.time + row * odd.period,
            progress=odd.progress + row * odd.period,
        )
        for row in range(4)
    ]
    found = collected([*FOUR, NEXT[0], *later])
    assert [each is not None for each in found] == [False] * 3 + [True] + [False] * 4 + [True]
    last = found[-1]
    assert last is not None
    assert last.progress_before == pytest.approx(odd.progress - odd.period)


@pytest.mark.parametrize(
    "change",
    [
        {"can_override": False},
        {"spindle_speed": 0.0},
    ],
    ids=str,
)
def test_what_is_no_cut_belongs_to_no_revolution(change: dict[str, float]) -> None:
    odd = NEXT[0]._replace(**change)  # type: ignore[arg-type]
    assert not any(collected([*FOUR[:3], odd._replace(tooth=3), *NEXT[:3]]))
    assert collected([*FOUR[:3], odd, *FOUR])[-1] is not None


def test_other_number_of_teeth_begins_anew() -> None:
    found = collected([*FOUR[:2], *turn(np.ones((2, 8)), start=0.01)])
    assert [each is not None for each in found] == [False, False, False, True]
    last = found[-1]
    assert last is not None
    assert last.force == 1.0


def cut(reading: Reading, period: float, count: int) -> list[Reading]:
    """Readings of another period in place of the teeth; each with the mean of its time."""
    speed, teeth = reading.spindle_speed, reading.teeth
    return [
        reading._replace(
            time=(row + 1) * period,
            progress=(row + 1) * period,
            period=period,
            tooth=int((row + 1) * period * speed * teeth) % teeth,
            force=np.array([100.0 + row]),
        )
        for row in range(count)
    ]


@pytest.mark.parametrize("periods", [1.2, 1.92, 3.0, 4.0, 7.7, 40.0])
def test_readings_of_any_period_are_averaged_over_a_turn_at_least(periods: float) -> None:
    """In tooth periods of a cutter of four."""
    period = periods * FOUR[0].period
    readings = cut(FOUR[0], period, 24)
    found = [each for each in collected(readings) if each is not None]
    assert len(found) >= 24 * min(periods / 4.0, 1.0) * 0.6
    for each in found:
        assert not each.by_teeth
        assert 0.999 <= each.turns <= 1.0 + periods / 4.0
        assert each.samples == 1
        assert np.isnan(each.tooth_means).all()
        assert each.is_covered
    forces = [each.force * each.period for each in found]
    whole = sum(each.period for each in found)
    mean = np.mean([each.force[0] for each in readings if each.time <= found[-1].time + 1e-9])
    assert sum(forces) / whole == pytest.approx(mean)


def test_pieces_of_a_tooth_period_become_one() -> None:
    pieces = ToothJoiner()
    halves = cut(FOUR[0], 0.4 * FOUR[0].period, 6)
    joined = [pieces.add(each) for each in halves]
    assert [each is None for each in joined] == [True, True, False] * 2
    first = joined[2]
    assert first is not None
    assert first.period == pytest.approx(1.2 * FOUR[0].period)
    assert first.force == pytest.approx([101.0])
    assert pieces.add(FOUR[0]) is FOUR[0]
