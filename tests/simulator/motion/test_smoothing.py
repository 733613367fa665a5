"""How far a control smooths, against the motion that its filter makes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.motion.control import ExactStop, JunctionDeviation
from simulator.motion.fir import FilterWithinLimits, FixedTimeFilter, shortest_filter
from simulator.motion.segments import AxisLimits, arc, lines
from simulator.motion.smoothing import Smoothing, smoothing_of

LIMITS = AxisLimits(
    acceleration=np.full(3, 2000.0), rapid=np.full(3, 500.0), feed=np.full(3, 300.0)
)


@given(st.floats(1.0, 100.0))
def test_a_control_within_limits_has_the_filter_of_its_greatest_feed(feed: float) -> None:
    found = smoothing_of(FilterWithinLimits(), LIMITS, feed)
    chosen = shortest_filter(LIMITS, np.full(3, 2.0 * feed))
    assert (found.first, found.second) == (chosen.first, chosen.second)
    assert found.reach == 0.5 * found.window


@pytest.mark.parametrize("control", [ExactStop(), JunctionDeviation(deviation=0.01)])
def test_controls_without_a_filter_smooth_nothing(
    control: ExactStop | JunctionDeviation,
) -> None:
    found = smoothing_of(control, LIMITS, 50.0)
    assert found == Smoothing()
    assert found.window == found.corner_gain == found.arc_gain == 0.0


@given(st.floats(2.0, 40.0), st.floats(0.3, 2.5))
def test_corners_are_rounded_as_the_motion_rounds_them(feed: float, turn: float) -> None:
    control = FixedTimeFilter(first=0.04, second=0.02)
    far = (60.0 + 60.0 * np.cos(turn), 60.0 * np.sin(turn), 0.0)
    path = lines([(0, 0, 0), (60, 0, 0), far], speed=feed)
    motion = control.plan(path, LIMITS)
    times = np.linspace(0.4 * motion.duration, 0.6 * motion.duration, 40_000)
    nearest = np.linalg.norm(motion.at(times).position - path.end[0], axis=1).min()
    found = smoothing_of(control, LIMITS, feed)
    expected = found.corner_gain * feed * np.sin(0.5 * turn)
    assert nearest == pytest.approx(expected, rel=5e-3, abs=1e-5)


@given(st.floats(5.0, 40.0))
def test_circles_shrink_as_the_motion_shrinks_them(feed: float) -> None:
    control = FixedTimeFilter(first=0.03, second=0.02)
    path = arc((20.0, 0.0, 0.0), (0.0, 0.0, 0.0), 6.0 * np.pi, speed=feed)
    motion = control.plan(path, LIMITS)
    middle = motion.at(np.array([0.5 * motion.duration])).position[0]
    found = smoothing_of(control, LIMITS, feed)
    shrunk = 20.0 - np.hypot(middle[0], middle[1])
    assert shrunk == pytest.approx(found.arc_gain * feed**2 / 20.0, rel=0.01)
