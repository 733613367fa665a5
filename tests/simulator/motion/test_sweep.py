from math import sqrt

import numpy as np
import pytest

from simulator.motion.path_limits import PathLimits
from simulator.motion.segments import lines
from simulator.motion.sweep import ends_of_all, swept

BARS = lines([(0, 0, 0), (10, 0, 0), (10, 0, 0), (40, 0, 0)], speed=1e3)
MOVING = np.array([0, 2])


def _limits(*speeds: float) -> PathLimits:
    return PathLimits(speed=np.array(speeds), acceleration=np.full(3, 50.0))


def test_speed_at_a_corner_is_within_reach_of_both_ends() -> None:
    motion = swept(BARS, MOVING, limits=_limits(1e3, 0.0, 1e3), corner=np.array([1e9]))
    # 10 mm from rest at 50 mm/s² give √(2·50·10); the whole 40 mm are one triangle.
    speed = motion.at(motion.ends[:1]).velocity[0, 0]
    assert speed == pytest.approx(sqrt(1000.0))
    assert motion.duration == pytest.approx(2.0 * sqrt(40.0 / 50.0))


def test_corner_speed_binds_where_it_is_lower() -> None:
    motion = swept(BARS, MOVING, limits=_limits(1e3, 0.0, 1e3), corner=np.array([100.0]))
    assert motion.at(motion.ends[:1]).velocity[0, 0] == pytest.approx(10.0)


def test_slow_segment_is_entered_at_its_own_speed() -> None:
    motion = swept(BARS, MOVING, limits=_limits(20.0, 0.0, 5.0), corner=np.array([np.inf]))
    assert motion.at(motion.ends[:1]).velocity[0, 0] == pytest.approx(5.0)
    # 0.4 s up, 0.3 s down to 5 mm/s, 2.25 mm at 20 mm/s; then 29.75 mm at 5 and 0.1 s down.
    assert motion.ends[0] == pytest.approx(0.4 + 2.25 / 20.0 + 0.3)
    assert motion.duration - motion.ends[0] == pytest.approx(29.75 / 5.0 + 0.1)


def test_pause_is_spent_where_a_row_has_no_length() -> None:
    rows = np.array([0, 1, 2])
    free = swept(BARS, rows, limits=_limits(9.0, 0.0, 9.0), corner=np.zeros(2))
    held = swept(BARS, rows, limits=_limits(9.0, 0.0, 9.0), corner=np.zeros(2), pause=0.7)
    assert held.duration - free.duration == pytest.approx(0.7)
    assert held.ends[1] - held.ends[0] == pytest.approx(0.7)
    assert not held.at(held.ends[:1] + 0.3).velocity.any()


def test_path_without_length_stays_where_it_is() -> None:
    point = lines([(1, 2, 3), (1, 2, 3)])
    limits = PathLimits(speed=np.zeros(1), acceleration=np.full(1, np.inf))
    motion = swept(point, np.array([], np.int64), limits=limits, corner=np.empty(0))
    assert motion.duration == 0.0
    assert motion.at(np.zeros(1)).position[0] == pytest.approx([1.0, 2.0, 3.0])


def test_acceleration_without_limit_takes_no_time() -> None:
    limits = PathLimits(speed=np.full(3, 10.0), acceleration=np.full(3, np.inf))
    motion = swept(BARS, MOVING, limits=limits, corner=np.zeros(1))
    assert motion.duration == pytest.approx(4.0)


def test_row_that_takes_no_time_ends_with_the_one_before_it() -> None:
    ends = ends_of_all(5, np.array([1, 3]), np.array([2.0, 7.0]))
    assert ends.tolist() == [0.0, 2.0, 2.0, 7.0, 7.0]
