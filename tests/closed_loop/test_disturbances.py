"""What may happen to a loop with log-PI and a noisy dynamometer, and what it makes of it."""

from collections import Counter
from dataclasses import replace
from math import inf

import numpy as np
import pytest

from controller.guard import OverrideBand, OverrideReason
from controller.orders import EventKind
from controller.reference import Reference
from controller.signals.ports import Floats
from controller.states.loop_settings import LoopSettings
from simulator.plant.course import NominalCourse
from simulator.plant.dynamometer import DYNAMOMETER, Instrument
from simulator.plant.hidden_behaviour import HiddenChange, HiddenQuantity, HiddenTruth
from tests.closed_loop.rig import SET_POINT, Rig, rig, step
from tests.simulator.plant.courses import EXPONENT, course

AIR = np.zeros(20)
"""ten revolutions: the feed is that of the program when the cut begins"""

RISE = 2.0
"""s"""


def cut(force: float = SET_POINT, cells: int = 500) -> Floats:
    """Air, then a cut of two cells a revolution."""
    return np.concatenate([AIR, np.full(cells, force)])


def changed(what: HiddenQuantity, value: float, **more: float) -> HiddenTruth:
    return HiddenTruth(changes=(HiddenChange(time=RISE, what=what, value=value),), **more)


def forces(done: Rig, last: int) -> Floats:
    """Of the last revolutions, N."""
    seen = [each.revolution.force for each in done.cycles if each.revolution is not None]
    return np.array(seen[-last:])


def kinds(done: Rig) -> Counter[EventKind]:
    return Counter(event.kind for event in done.events)


def turned(path: NominalCourse, *, speed: float, teeth: int) -> NominalCourse:
    """The path at another spindle speed, in as many revolutions."""
    return replace(
        path,
        until=path.until * (50.0 / speed),
        teeth=np.full(len(path), teeth),
        spindle_speed=np.full(len(path), speed, dtype=np.float32),
    )


def test_a_quiet_cut_is_held_at_its_set_point_without_a_word() -> None:
    done = rig(course(cut())).run()
    assert forces(done, 100).mean() == pytest.approx(SET_POINT, rel=0.01)
    assert kinds(done) == {EventKind.WORKINGSTEP: 1}


@pytest.mark.parametrize("lag", [0.03, 0.06, 0.12])
@pytest.mark.parametrize("factor", [1.5, 2.0])
def test_a_deeper_cut_is_held_back_once_and_then_kept(factor: float, lag: float) -> None:
    """The loop takes the lag for 0.06 s: half and twice of it do not matter."""
    done = rig(course(cut()), changed(HiddenQuantity.DEPTH, factor, servo_lag=lag)).run()
    told = kinds(done)
    assert (told[EventKind.HOLD], told[EventKind.RESUME]) == (1, 1)
    assert told[EventKind.HARDNESS] == 1
    (hold,) = done.told(EventKind.HOLD)
    # Two tooth periods at most: the rise may come in the middle of the first.
    assert hold.time - RISE <= 0.02 + 1e-9
    assert forces(done, 50).mean() == pytest.approx(SET_POINT, rel=0.01)
    override = np.mean([each.reading.override for each in done.cycles[-100:]])
    assert override == pytest.approx(factor ** (-1.0 / EXPONENT), rel=0.03)


def test_harder_work_is_told_and_needs_no_hold() -> None:
    done = rig(course(cut()), changed(HiddenQuantity.HARDNESS, 1.3)).run()
    told = kinds(done)
    assert (told[EventKind.HARDNESS], told[EventKind.HOLD]) == (1, 0)
    assert "harder" in done.told(EventKind.HARDNESS)[0].text
    assert forces(done, 50).mean() == pytest.approx(SET_POINT, rel=0.01)


def test_wear_is_no_change_of_the_work() -> None:
    done = rig(course(cut(cells=1500)), HiddenTruth(wear_rate=0.004)).run()
    assert done.machine.truth.flank_wear > 0.05
    assert kinds(done) == {EventKind.WORKINGSTEP: 1}
    assert forces(done, 50).mean() == pytest.approx(SET_POINT, rel=0.01)


@pytest.mark.parametrize("missing", [0.2, 0.6])
def test_lost_samples_hold_no_feed(missing: float) -> None:
    by = replace(DYNAMOMETER, missing=missing)
    done = rig(course(cut(cells=1000)), instrument=by).run()
    assert kinds(done)[EventKind.HOLD] == 0
    assert np.nanmean(forces(done, 300)) == pytest.approx(SET_POINT, rel=0.05)
    assert max(done.sensor.truth) < 1.3 * SET_POINT


def test_with_hardly_a_sample_the_override_is_the_safe_one() -> None:
    done = rig(course(cut(cells=400)), instrument=replace(DYNAMOMETER, missing=0.9)).run()
    late = done.between(3.0, inf)
    assert {each.allowed.holding for each in late} == {OverrideReason.SILENCE}
    assert {each.allowed.override for each in late} == {0.5}


def test_a_silent_sensor_means_the_safe_override_until_it_speaks_again() -> None:
    done = rig(course(cut()), changed(HiddenQuantity.SILENCE, 1.5)).run()
    (silence,) = done.told(EventKind.SILENCE)
    assert silence.time == pytest.approx(RISE + OverrideBand().sensor_timeout, abs=0.03)
    blind = done.between(silence.time, RISE + 1.5)
    assert {each.allowed.override for each in blind} == {0.5}
    assert forces(done, 50).mean() == pytest.approx(SET_POINT, rel=0.01)


@pytest.mark.parametrize("revolutions", [1, 2, 3, 6, 20])
@pytest.mark.parametrize("force", [250.0, 600.0])
def test_cuts_between_short_airs_are_neither_overloads_nor_lost_on_the_law(
    revolutions: int, force: float
) -> None:
    one = np.concatenate([np.full(2 * revolutions, force), np.zeros(6)])
    done = rig(course(np.concatenate([AIR, np.tile(one, 120 // revolutions)]))).run()
    told = kinds(done)
    # The first contact of 600 N at 1.5 times the set point is one.
    assert told[EventKind.HOLD] <= (force > SET_POINT)
    assert told[EventKind.STOP] == 0
    late = max(done.sensor.truth[len(done.sensor.truth) // 2 :])
    assert late < 1.3 * SET_POINT
    if force < SET_POINT:
        overrides = [each.allowed.override for each in done.cycles[len(done.cycles) // 2 :]]
        assert min(overrides) >= 0.95


@pytest.mark.parametrize(("speed", "teeth"), [(1.0, 3), (2.0, 1), (400.0, 1), (400.0, 4)])
def test_slow_and_fast_spindles_keep_the_set_point(speed: float, teeth: int) -> None:
    path = turned(course(cut(force=500.0, cells=600)), speed=speed, teeth=teeth)
    done = rig(path).run()
    assert kinds(done)[EventKind.STOP] == 0
    assert forces(done, 50).mean() == pytest.approx(SET_POINT, rel=0.03)


def test_cells_without_a_force_in_a_cut_pass() -> None:
    force = cut()
    force[23::7] = 0.0
    done = rig(course(force)).run()
    assert kinds(done) == {EventKind.WORKINGSTEP: 1}
    assert max(done.sensor.truth) < 1.2 * SET_POINT


def test_a_set_point_that_the_band_cannot_reach_is_told_once() -> None:
    """Four times the force at a floor of 20 % is 1.1 times the set point."""
    done = rig(course(cut(cells=300)), HiddenTruth(force_factor=4.0)).run()
    told = kinds(done)
    assert told[EventKind.UNREACHABLE] == 1
    assert (told[EventKind.HOLD], told[EventKind.STOP]) == (1, 0)
    at_floor = 4.0 * 0.2**EXPONENT * SET_POINT
    assert forces(done, 50).mean() == pytest.approx(at_floor, rel=0.02)


@pytest.mark.parametrize("factor", [3.0, 8.0])
def test_where_the_floor_would_be_an_overload_the_override_goes_below_it(
    factor: float,
) -> None:
    """Resting just below the overload, without a second hold."""
    settings = LoopSettings(look_ahead=0, band=OverrideBand(floor=0.8))
    done = rig(course(cut(cells=200)), HiddenTruth(force_factor=factor), settings=settings).run(
        20.0
    )
    told = kinds(done)
    assert (told[EventKind.UNREACHABLE], told[EventKind.HOLD]) == (1, 1)
    assert forces(done, 50).std() < 0.02 * SET_POINT
    assert forces(done, 50).mean() < 1.5 * SET_POINT
    assert done.cycles[-1].allowed.override < 0.8


def test_a_force_at_the_edge_of_a_warning_does_not_flood_the_reader() -> None:
    """1.2 times the set point is over it: noise would tell so 50 times a second."""
    settings = LoopSettings(look_ahead=0, band=OverrideBand(floor=1.0, ceiling=1.0))
    done = rig(course(cut(cells=3000)), HiddenTruth(force_factor=1.2), settings=settings).run()
    assert len(done.events) <= 36 * done.machine.time / 60.0


def test_a_band_of_one_override_leaves_the_programs_feed() -> None:
    settings = LoopSettings(look_ahead=0, band=OverrideBand(floor=1.0, ceiling=1.0))
    done = rig(course(cut()), settings=settings).run()
    assert {each.allowed.override for each in done.cycles} == {1.0}


def test_where_nothing_bounds_the_force_the_feed_is_the_programs() -> None:
    done = rig(course(cut()), steps=[step(Reference(workingstep="FREE"))]).run()
    assert {each.allowed.override for each in done.cycles} == {1.0}
    assert {each.set_point for each in done.cycles} == {inf}


def test_feeds_too_short_for_a_revolution_are_watched_all_the_same() -> None:
    """Of one and a half revolutions each: the first two of them are overloads."""
    one = np.concatenate([np.zeros(4), np.full(3, 700.0)])
    is_feed = np.tile(np.arange(7) >= 4, 100)
    done = rig(course(np.tile(one, 100), can_override=is_feed)).run()
    assert kinds(done)[EventKind.STOP] == 0
    assert max(done.sensor.truth[len(done.sensor.truth) // 2 :]) < 1.5 * SET_POINT


def test_runout_is_no_overload_for_ever() -> None:
    """A tooth that takes half as much again as the mean at the set point."""
    done = rig(course(cut(force=300.0)), HiddenTruth(eccentricity=0.012)).run()
    assert kinds(done)[EventKind.HOLD] <= 1
    assert forces(done, 50).mean() > 0.6 * SET_POINT


def test_a_depth_that_changes_over_and_over_is_held_now_and_then() -> None:
    """And does not stop the program: each step is 1.75 times what the law has settled at.

    Of eight steps up, one teaches the next; what it has taught is eased little by little.
    """
    steps = np.tile(np.concatenate([np.full(50, SET_POINT), np.full(50, 1.75 * SET_POINT)]), 8)
    done = rig(course(np.concatenate([AIR, steps]))).run()
    told = kinds(done)
    assert 1 <= told[EventKind.HOLD] <= 8
    assert told[EventKind.STOP] == 0
    assert done.machine.share == pytest.approx(1.0)


def test_a_force_below_zero_is_no_force() -> None:
    """A zero that ran away: the loop is blind and says so."""
    done = rig(course(cut()), instrument=Instrument(drift=-400.0)).run()
    assert kinds(done)[EventKind.SILENCE] == 1
    assert done.cycles[-1].allowed.override <= 0.5


def test_a_tool_in_danger_below_the_band_stops_the_program() -> None:
    done = rig(course(cut(force=3000.0, cells=6000)), HiddenTruth(servo_lag=0.06)).run()
    assert kinds(done)[EventKind.STOP] == 1
    assert done.machine.share < 1.0
