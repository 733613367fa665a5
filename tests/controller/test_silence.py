from dataclasses import replace
from math import nan

import numpy as np

from controller.silence import HEARD, REVOLUTIONS, Silence, is_blind, is_implausible, listened
from tests.controller.plugged import PERIOD, SPINDLE_SPEED, reading
from tests.controller.shown import REVOLUTION


def after(count: int, *, has_force: bool) -> Silence:
    silence = HEARD
    for _ in range(count):
        silence = listened(silence, reading(nan), None, has_force=has_force)
    return silence


def test_a_revolution_with_a_force_is_heard() -> None:
    silence = after(10, has_force=False)
    assert listened(silence, reading(1.0), REVOLUTION, has_force=True) == HEARD


def test_without_samples_it_is_blind_after_the_time_allowed() -> None:
    assert not is_blind(after(49, has_force=False), allowed=0.5, spindle_speed=SPINDLE_SPEED)
    assert is_blind(after(51, has_force=False), allowed=0.5, spindle_speed=SPINDLE_SPEED)


def test_samples_that_make_no_revolution_are_waited_for_some_revolutions_more() -> None:
    waited = round((0.5 + REVOLUTIONS / SPINDLE_SPEED) / PERIOD)
    few = after(waited - 1, has_force=True)
    many = after(waited + 1, has_force=True)
    assert not is_blind(few, allowed=0.5, spindle_speed=SPINDLE_SPEED)
    assert is_blind(many, allowed=0.5, spindle_speed=SPINDLE_SPEED)


def test_a_revolution_with_too_few_samples_is_not_heard() -> None:
    empty = replace(REVOLUTION, force=nan, coverage=0.2)
    assert listened(HEARD, reading(1.0), empty, has_force=True).revolutions == PERIOD


def test_a_slow_spindle_has_its_time() -> None:
    slow = listened(HEARD, reading(1.0, period=1.0), None, has_force=True)
    assert not is_blind(slow, allowed=0.5, spindle_speed=1.0)


def test_a_standing_spindle_makes_no_revolution_to_be_missed() -> None:
    standing = Silence(samples=0.0, revolutions=np.inf)
    assert not is_blind(standing, allowed=0.5, spindle_speed=0.0)


def test_a_little_below_zero_is_noise_and_far_below_no_force() -> None:
    assert not is_implausible(-30.0, 10.0)
    assert is_implausible(-60.0, 10.0)
    assert not is_implausible(float("nan"), 10.0)
