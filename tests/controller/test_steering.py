from dataclasses import replace

import numpy as np
import pytest

from controller.aims import Aims
from controller.guard import Keeping
from controller.law import Law, Plant
from controller.preview import Preview
from controller.steering import LEAST_WAY, Steering
from tests.controller.plugged import Wishing
from tests.controller.shown import REVOLUTION

KEEP = Keeping(set_point=500.0, breakage=2000.0, floor=0.2, ceiling=1.2, exponent=0.75)
PREVIEW = Preview(until=np.array([1.0, 100.0]), force=np.array([200.0, 800.0]))
AIMS = Aims(look_ahead=0, servo_lag=0.08)


class Counting:
    """Makes laws, and notes for which plants."""

    def __init__(self) -> None:
        self.plants: list[Plant] = []
        self.law = Wishing(wish=0.9)

    def __call__(self, plant: Plant) -> Law[None]:
        self.plants.append(plant)
        return self.law


def test_the_law_is_told_the_revolution_and_its_band() -> None:
    laws = Counting()
    steering = Steering(laws, PREVIEW)
    assert steering.wish(REVOLUTION, KEEP, aims=AIMS, override=0.7) == 0.9
    (told,) = laws.law.told
    assert (told.force, told.set_point, told.override) == (400.0, 500.0, 0.7)
    assert (told.actual, told.floor, told.ceiling) == (1.0, 0.2, 1.2)
    assert (told.expected, told.ahead) == (0.0, ())


def test_axes_that_stand_are_told_as_slow_ones() -> None:
    laws = Counting()
    standing = replace(REVOLUTION, override=0.0)
    Steering(laws, PREVIEW).wish(standing, KEEP, aims=AIMS, override=0.7)
    assert laws.law.told[0].actual == pytest.approx(LEAST_WAY * KEEP.floor)


def test_a_law_is_tuned_once_for_each_plant() -> None:
    laws = Counting()
    steering = Steering(laws, PREVIEW)
    for speed in (50.0, 50.0, 100.0, 50.0):
        turned = replace(REVOLUTION, spindle_speed=speed)
        steering.wish(turned, KEEP, aims=AIMS, override=1.0)
        steering.leave()
    assert laws.plants == [Plant(exponent=0.75, lag=4.0), Plant(exponent=0.75, lag=8.0)]


def test_what_lies_ahead_is_told_at_the_pace_of_now() -> None:
    laws = Counting()
    aims = replace(AIMS, look_ahead=4)
    near = replace(REVOLUTION, progress_before=0.93, progress=0.95)
    Steering(laws, PREVIEW).wish(near, KEEP, aims=aims, override=1.0)
    # 20 ms a revolution: the step at 1 s lies in the third, and is seen one before.
    assert laws.law.told[0].ahead == (200.0, 800.0, 800.0, 800.0)
    assert laws.law.told[0].expected == 200.0


def test_the_expected_force_is_that_of_the_override_that_was_run() -> None:
    slow = replace(REVOLUTION, override=0.5)
    found = Steering(Counting(), PREVIEW).expectation(slow, 0.75)
    assert found == pytest.approx(200.0 * 0.5**0.75)
