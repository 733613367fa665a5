"""Recorded runs as machines of the loop."""

from dataclasses import fields, replace
from itertools import pairwise

import numpy as np
import pytest

from simulator.errors import CalibrationError
from simulator.motion.segments import Floats
from simulator.plant.course import NominalCourse
from simulator.plant.hidden_behaviour import HiddenChange, HiddenQuantity
from simulator.plant.recorded_machine import RecordedMachine, RecordedSignals, program_times
from simulator.reading import Reading
from tests.simulator.plant.courses import FEED, course, levels


def shuttling() -> NominalCourse:
    """1 s of air and 2 s of a cut to the right, a rapid back, and the same again."""
    there = np.concatenate((levels(0.0, 200.0, 200.0), levels(0.0, cells=20)))
    force = np.tile(there, 2)
    is_feed = np.tile(np.arange(len(there)) < 300, 2)
    plain = course(force, can_override=is_feed)
    middle = plain.until - 0.005
    x = np.interp(middle, [0.0, 3.0, 3.2, 6.2, 6.4], [0.0, 3.0 * FEED, 0.0, 3.0 * FEED, 0.0])
    position = np.zeros((len(force), 3), np.float32)
    position[:, 0] = x
    return replace(plain, position=position)


def run(
    whole: NominalCourse, times: Floats, program: Floats, *, rate: float
) -> RecordedSignals:
    """Samples of a run that has got so far in the program at some times."""
    time = np.arange(0.0, times[-1] + 0.5 / rate, 1.0 / rate)
    done = np.interp(time, times, program)
    middle = whole.until - 0.005
    position = np.column_stack([np.interp(done, middle, axis) for axis in whole.position.T])
    rows = np.minimum(whole.until.searchsorted(done), len(whole) - 1)
    return RecordedSignals(
        time=time,
        position=position,
        feed=np.gradient(position[:, 0], time),
        force=1.3 * np.asarray(whole.force, dtype=np.float64)[rows],
        power=np.full(len(time), 500.0),
    )


SLOWER = np.array([0.0, 4.0, 6.0, 6.2, 8.7, 8.9]), np.array([0.0, 2.0, 3.0, 3.2, 6.2, 6.4])
"""Half the feed first, then held for a moment, later 1.2 times the feed."""


def readings(machine: RecordedMachine) -> list[Reading]:
    found = []
    while (reading := machine.read()) is not None:
        found.append(reading)
    return found


@pytest.mark.parametrize("rate", [10.0, 50.0, 1000.0])
def test_the_program_time_is_found_at_any_feed(rate: float) -> None:
    whole = shuttling()
    signals = run(whole, *SLOWER, rate=rate)
    found = program_times(signals, whole)
    assert (np.diff(found) >= 0.0).all()
    assert np.abs(found - np.interp(signals.time, *SLOWER)).max() < 0.05


@pytest.mark.parametrize("offset", [(0.0, 0.0, 0.0), (-312.5, 40.0, 7.0)])
def test_another_zero_point_is_no_other_path(offset: tuple[float, ...]) -> None:
    whole = shuttling()
    signals = run(whole, *SLOWER, rate=50.0)
    moved = replace(signals, position=signals.position + np.array(offset))
    found = program_times(moved, whole)
    assert np.abs(found - np.interp(signals.time, *SLOWER)).max() < 0.1


def test_a_recording_that_ends_early_has_no_offset() -> None:
    """The way of the whole program is longer, so that all samples seem to lag."""
    whole = shuttling()
    signals = run(whole, *SLOWER, rate=50.0)
    rows = slice(0, int(signals.time.searchsorted(5.5)))
    early = RecordedSignals(**{
        each.name: getattr(signals, each.name)[rows] for each in fields(RecordedSignals)
    })
    found = program_times(early, whole)
    assert np.abs(found - np.interp(early.time, *SLOWER)).max() < 0.05


def test_positions_in_steps_tell_no_override_that_wavers() -> None:
    whole = shuttling()
    signals = run(whole, *SLOWER, rate=29.0)
    steps = 0.04 * np.round(signals.position / 0.04)
    found = readings(RecordedMachine(whole, replace(signals, position=steps)))
    for low, high, expected in ((2.5, 3.8, 0.5), (7.5, 8.5, 1.2)):
        values = [each.override for each in found if low < each.time < high]
        assert values == pytest.approx([expected] * len(values), rel=1e-3)


def test_a_feed_in_other_units_is_not_believed() -> None:
    whole = shuttling()
    signals = run(whole, *SLOWER, rate=50.0)
    machine = RecordedMachine(whole, replace(signals, feed=60.0 * signals.feed))
    slow = [each.override for each in readings(machine) if 2.5 < each.time < 3.8]
    assert slow == pytest.approx([0.5] * len(slow), abs=0.02)


def test_readings_tell_times_forces_and_overrides() -> None:
    whole = shuttling()
    machine = RecordedMachine(whole, run(whole, *SLOWER, rate=50.0))
    found = readings(machine)
    assert found[-1].time == pytest.approx(8.9, abs=0.03)
    assert machine.share == pytest.approx(1.0, abs=0.01)
    for before, after in pairwise(found):
        assert after.time - after.period == pytest.approx(before.time)
        assert after.progress >= before.progress
    # Readings end where feed and rapids do.
    turns = [before.progress for before, after in pairwise(found)
             if before.can_override != after.can_override]  # fmt: skip
    assert turns == pytest.approx([3.0, 3.2, 6.2])
    slow = [each for each in found if 2.5 < each.time < 3.8]
    assert all(each.override == pytest.approx(0.5, abs=0.02) for each in slow)
    assert all(each.force[0] == pytest.approx(260.0) for each in slow)
    fast = [each for each in found if 7.5 < each.time < 8.5]
    assert all(each.override == pytest.approx(1.2, abs=0.02) for each in fast)
    assert {each.can_override for each in found} == {True, False}


def test_a_feed_hold_is_an_override_of_nothing() -> None:
    whole = shuttling()
    times, program = np.array([0.0, 2.0, 5.0, 9.4]), np.array([0.0, 2.0, 2.0, 6.4])
    machine = RecordedMachine(whole, run(whole, times, program, rate=50.0))
    found = readings(machine)
    held = [each for each in found if 2.3 < each.time < 4.7]
    assert all(abs(each.override) < 0.02 for each in held)
    assert sum(each.period for each in found) == pytest.approx(9.4, abs=0.05)


@pytest.mark.parametrize(("rate", "around"), [(50.0, 0.05), (10.0, 0.15)])
def test_where_the_force_changes_places_are_not_steady(rate: float, around: float) -> None:
    """A force between two samples knows of the time from one to the other."""
    whole = shuttling()
    machine = RecordedMachine(whole, run(whole, *SLOWER, rate=rate))
    steady = {}
    while (reading := machine.read()) is not None:
        steady[round(reading.progress, 2)] = reading.is_placed
    assert not any(value for time, value in steady.items() if abs(time - 1.0) < around)
    assert all(value for time, value in steady.items() if 1.25 < time < 2.75)


def test_a_run_that_is_over_cannot_be_changed() -> None:
    whole = shuttling()
    machine = RecordedMachine(whole, run(whole, *SLOWER, rate=50.0))
    machine.set(0.5)
    assert machine.commanded == 1.0
    with pytest.raises(ValueError, match="cannot be changed"):
        machine.change(HiddenChange(time=0.0, what=HiddenQuantity.DEPTH, value=2.0))


def test_axes_that_are_not_recorded_do_not_count() -> None:
    whole = shuttling()
    signals = run(whole, *SLOWER, rate=50.0)
    position = signals.position.copy()
    position[:, 2] = np.nan
    found = program_times(replace(signals, position=position), whole)
    assert np.abs(found - np.interp(signals.time, *SLOWER)).max() < 0.05


def test_a_run_of_something_else_is_refused() -> None:
    whole = shuttling()
    signals = run(whole, *SLOWER, rate=50.0)
    circle = 100.0 * np.column_stack([
        np.cos(signals.time), np.sin(signals.time), np.zeros(len(signals.time))
    ])  # fmt: skip
    for position, message in (
        (circle, "more than 5 mm off the path: is it a run of this program"),
        (np.zeros_like(circle), "the recorded positions do not change"),
        (np.full_like(circle, np.nan), "no positions of the axes are recorded"),
    ):
        with pytest.raises(CalibrationError, match=message):
            program_times(replace(signals, position=position), whole)
    two = RecordedSignals(
        time=signals.time[:2],
        position=signals.position[:2],
        feed=signals.feed[:2],
        force=signals.force[:2],
        power=signals.power[:2],
    )
    with pytest.raises(CalibrationError, match="2 samples; at least 3 are needed"):
        program_times(two, whole)
