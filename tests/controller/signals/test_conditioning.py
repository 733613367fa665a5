"""From what sensors show to a force, from what the operator wants to a set point."""

from math import e, exp, isnan, log, nan, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller.signals.conditioning import (
    MEMORY,
    RISE,
    IdlePower,
    Tare,
    conditioned,
    force_from_power,
    idled,
    tared,
    without_offset,
)
from controller.signals.ports import Reading
from tests.controller.shown import turn
from tests.every_case import every_case

IDLE = turn(np.full((1, 4), 5.0))[0]._replace(period=0.25, time=0.25, can_override=False)
"""a quarter of a second in rapid, with 5 N of offset"""


def rest(force: list[float], *, time: float) -> Reading:
    return IDLE._replace(force=np.array(force), time=time)


def test_offset_is_the_mean_without_chips() -> None:
    tare = tared(Tare(), rest([4.0, 6.0, nan, 5.0], time=1.0))
    assert tare.offset == pytest.approx(5.0)
    # A quarter of the samples was lost, and counts for nothing.
    assert tare.seconds == pytest.approx(0.25 * 3 / 4)


def test_nothing_is_learnt_from_chips_or_from_silence() -> None:
    known = Tare(offset=3.0, seconds=1.0)
    assert tared(known, IDLE._replace(can_override=True)) is known
    assert tared(known, IDLE, has_chips=True) is known
    assert tared(known, rest([nan, nan], time=1.0)) is known
    assert tared(known, rest([], time=1.0)) is known
    assert tared(known, IDLE._replace(period=0.0)) is known
    assert not Tare().is_known


def test_caller_who_knows_of_air_at_feed_has_it_learnt() -> None:
    assert tared(Tare(), IDLE._replace(can_override=True), has_chips=False).offset == 5.0


def test_what_was_learnt_counts_less_the_older_it_is() -> None:
    old = tared(Tare(), rest([0.0], time=0.0))
    now = tared(old, rest([10.0], time=MEMORY))
    assert now.offset == pytest.approx(10.0 / (1.0 + 1.0 / e))


def test_clock_that_is_set_back_makes_nothing_older() -> None:
    old = tared(Tare(), rest([0.0], time=1000.0))
    assert tared(old, rest([10.0], time=0.0)).offset == pytest.approx(5.0)


@given(seed=st.integers(0, 2**32 - 1), drift=st.floats(-0.05, 0.05))
def test_drift_is_followed_within_its_lag(seed: int, drift: float) -> None:
    """An exponential mean trails a ramp by slope times memory; noise averages out."""
    random = np.random.default_rng(seed)
    tare = Tare()
    for row in range(400):
        time = 0.25 * row
        force = 3.0 + drift * time + random.normal(0.0, 1.0, 8)
        force[random.random(8) < 0.2] = nan
        tare = tared(tare, rest(force.tolist(), time=time))
    now = 3.0 + drift * 0.25 * 399
    noise = 1.0 / np.sqrt(2.0 * MEMORY / 0.25 * 8 * 0.8)
    assert abs(tare.offset - (now - drift * MEMORY)) < 6.0 * noise + 0.01


def test_offset_is_subtracted_and_what_is_lost_stays_lost() -> None:
    reading = IDLE._replace(force=np.array([15.0, nan]))
    shown = without_offset(reading, Tare(offset=5.0, seconds=1.0))
    np.testing.assert_array_equal(shown.force, [10.0, nan])
    np.testing.assert_array_equal(reading.force, [15.0, nan])


CUT = IDLE._replace(can_override=True, power=1000.0, spindle_speed=35_000.0 / 60 / (pi * 18.0))
"""35 m/min with a cutter of 18 mm, the worked case of the paper"""


def idle_at(spindle_speed: float, power: float = 710.0) -> IdlePower:
    reading = IDLE._replace(spindle_speed=spindle_speed, power=power)
    return idled(IdlePower(), reading)


def test_power_of_the_papers_case_gives_its_force() -> None:
    """447.43 N at 35 m/min are 261 W at the edge and 290 W of the motor at η 0.9."""
    shown = force_from_power(
        CUT, idle_at(CUT.spindle_speed), tool_diameter=18.0, efficiency=0.9
    )
    assert shown.force == pytest.approx([447.43], rel=1e-3)
    assert shown.power == CUT.power


@pytest.mark.parametrize(
    ("reading", "idle"),
    [
        (CUT, IdlePower()),
        (CUT, idle_at(2.0 * CUT.spindle_speed)),
        (CUT._replace(power=nan), idle_at(CUT.spindle_speed)),
        (CUT._replace(spindle_speed=0.0), idle_at(0.0)),
    ],
    ids=["never idled", "at another speed", "lost", "standing"],
)
def test_force_is_not_known_without(reading: Reading, idle: IdlePower) -> None:
    shown = force_from_power(reading, idle, tool_diameter=18.0, efficiency=0.9)
    assert shown.force.shape == (1,)
    assert isnan(shown.force[0])


def test_idle_power_is_learnt_anew_at_another_speed() -> None:
    slow = idle_at(50.0, power=300.0)
    same = idled(slow, IDLE._replace(spindle_speed=50.2, power=320.0))
    assert same.tare.offset == pytest.approx(310.0)
    assert same.spindle_speed == 50.0
    fast = idled(same, IDLE._replace(spindle_speed=100.0, power=700.0))
    assert (fast.spindle_speed, fast.tare.offset) == (100.0, 700.0)


def test_power_in_a_cut_or_lost_is_no_idle_power() -> None:
    idle = idle_at(CUT.spindle_speed)
    assert idled(idle, CUT) is idle
    assert idled(idle, IDLE._replace(power=nan)) is idle


@every_case(("diameter", "efficiency"), [(0.0, 0.9), (18.0, 0.0), (18.0, 1.1)])
def test_impossible_drive_is_refused(diameter: float, efficiency: float) -> None:
    with pytest.raises(ValueError, match="must be"):
        force_from_power(CUT, IdlePower(), tool_diameter=diameter, efficiency=efficiency)


@given(st.floats(1.0, 1e4), st.floats(1.0, 1e4))
def test_set_point_rises_slowly_and_falls_at_once(now: float, wanted: float) -> None:
    following = conditioned(now, wanted)
    if wanted <= now:
        assert following == wanted
    else:
        assert now < following <= min(wanted, now * exp(RISE))


def test_set_point_arrives_after_the_revolutions_that_its_logarithm_takes() -> None:
    at, count = 200.0, 0
    while at < 900.0:
        at, count = conditioned(at, 900.0), count + 1
    assert at == 900.0
    assert count == int(np.ceil(log(4.5) / RISE))


def test_first_set_point_holds_at_once() -> None:
    assert conditioned(0.0, 700.0) == 700.0
    with pytest.raises(ValueError, match="set point 0 N must be greater"):
        conditioned(100.0, 0.0)
