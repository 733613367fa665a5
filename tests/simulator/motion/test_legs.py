"""Spindles that change their speed during the rapids of a path."""

from math import inf

import pytest

from simulator.motion.segments import SpindleRamp

UP = SpindleRamp(speed=50.0, acceleration=20.0, is_awaited=True)


def test_a_ramp_takes_the_time_of_its_acceleration() -> None:
    assert UP.time_from(10.0) == pytest.approx(2.0)
    assert UP.time_from(50.0) == 0.0


@pytest.mark.parametrize(
    ("begin", "seconds", "reached"),
    [(10.0, 0.0, 10.0), (10.0, 1.0, 30.0), (10.0, 9.0, 50.0), (80.0, 1.0, 60.0)],
)
def test_a_ramp_that_is_cut_short_goes_as_far_as_it_can(
    begin: float, seconds: float, reached: float
) -> None:
    assert UP.after(seconds, begin) == pytest.approx(reached)


def test_a_spindle_without_inertia_is_there_at_once() -> None:
    ramp = SpindleRamp(speed=50.0, acceleration=inf, is_awaited=True)
    assert ramp.time_from(0.0) == 0.0
    assert ramp.after(1e-3, 0.0) == 50.0
