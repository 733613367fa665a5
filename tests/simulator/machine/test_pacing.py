"""A feed per revolution follows the spindle as it really turns.

The judge is the motion of an encoder-locked axis, from Newton's law alone: with the angular
acceleration a, ``x = f·(n₀·t + a·t²/2)`` and ``n² = n₀² + 2·a·x/f``.
"""

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.machine.samples import Episode
from simulator.machine.sensing import sensed
from simulator.spec import Machine
from stepnc_model.post import blocks as nc
from tests.simulator.machine.test_virtual import Ran, run


def faced(
    lathe: Machine, *, feed: float, acceleration: float | None, end: float = 5.0
) -> tuple[Ran, Episode]:
    """A face from x = 50 mm inwards at 3000 mm/s, and the episode of its feed."""
    machine = replace(lathe, spindle=replace(lathe.spindle, acceleration=acceleration))
    found = run(
        machine,
        nc.Rapid(end=(50.0, 0.0, 5.0)),
        nc.SurfaceSpeed(speed=3000.0),
        nc.Rapid(end=(50.0, 0.0, 0.0)),
        nc.Linear(
            end=(end, 0.0, 0.0), rate=nc.Rate(value=feed, mode=nc.RateMode.PER_REVOLUTION)
        ),
    )
    return found, found.episodes[-2]


def feeds(episode: Episode, lathe: Machine) -> tuple[np.ndarray, np.ndarray]:
    """Mm of path per revolution, and speed of the spindle in rev/s, every ms."""
    samples = sensed(episode, lathe, np.arange(episode.begin, episode.end, 1e-3))
    return samples.path_speed / np.abs(samples.spindle_speed), samples.spindle_speed


@settings(max_examples=20)
@given(feed=st.floats(0.1, 0.8), acceleration=st.floats(2.0, 40.0))
def test_mean_chip_is_the_programmed_one_while_the_spindle_ramps(
    lathe: Machine, feed: float, acceleration: float
) -> None:
    _, cut = faced(lathe, feed=feed, acceleration=acceleration)
    found, _ = feeds(cut, lathe)
    # The axis itself starts and stops: a tenth of a second of either is not counted. Pieces of
    # the path have one feed each, so that the chip is a staircase about its mean.
    assert found[100:-100].mean() == pytest.approx(feed, rel=0.01)
    assert np.abs(found[100:-100] / feed - 1.0).max() < 0.08


def test_spindle_that_never_gets_there_turns_as_newton_says(lathe: Machine) -> None:
    """Slow enough to ramp all the way."""
    begin, feed, acceleration = 3000.0 / (2.0 * pi * 50.0), 0.6, 1.0
    _, cut = faced(lathe, feed=feed, acceleration=acceleration, end=10.0)
    _, speed = feeds(cut, lathe)
    final = sqrt(begin**2 + 2.0 * acceleration * 40.0 / feed)
    assert final < 3000.0 / (2.0 * pi * 10.0)
    assert speed[-1] == pytest.approx(final, rel=0.01)
    assert cut.end - cut.begin == pytest.approx((final - begin) / acceleration, rel=0.01)


def test_spindle_that_follows_at_once_changes_nothing(lathe: Machine) -> None:
    """``∫ dx/(f·n)`` with n = v_c/(2π·x)."""
    _, cut = faced(lathe, feed=0.2, acceleration=None, end=20.0)
    assert cut.end - cut.begin == pytest.approx(
        pi * (50.0**2 - 20.0**2) / (0.2 * 3000.0), rel=0.01
    )


def test_feed_by_time_is_left_as_it_is(lathe: Machine) -> None:
    found = run(
        lathe,
        nc.Rapid(end=(50.0, 0.0, 5.0)),
        nc.SurfaceSpeed(speed=3000.0),
        nc.Rapid(end=(50.0, 0.0, 0.0)),
        nc.Linear(end=(5.0, 0.0, 0.0), rate=nc.Rate(value=20.0)),
    )
    course = found.episodes[-2].course
    assert course is not None
    assert set(course.segments.speed.tolist()) == {20.0}
