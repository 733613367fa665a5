from collections.abc import Callable
from dataclasses import replace
from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.motion.fir import FilterWithinLimits, FixedTimeFilter, shortest_filter
from simulator.motion.segments import AxisLimits, Motion, Segments, chained, lines

EVEN = AxisLimits(
    acceleration=np.full(3, 1000.0), rapid=np.full(3, 500.0), feed=np.full(3, 200.0)
)
CONTROL = FixedTimeFilter(first=0.08, second=0.03)


def _corner(turn: float, speed: float) -> Segments:
    end = (60 + 60 * cos(turn), 60 * sin(turn), 0)
    return lines([(0, 0, 0), (60, 0, 0), end], speed=speed)


@settings(max_examples=20)
@given(
    turn=st.floats(0.1, 3.1),
    speed=st.floats(1.0, 190.0),
    first=st.floats(0.02, 0.15),
    share=st.floats(0.01, 1.0),
)
def test_corner_is_rounded_by_the_error_of_the_formula(
    turn: float, speed: float, first: float, share: float
) -> None:
    control = FixedTimeFilter(first=first, second=share * first)
    motion = control.plan(_corner(turn, speed), EVEN)
    nearest = motion.at(motion.ends[:1]).position[0]
    error = speed * (first / 4 + (share * first) ** 2 / (12 * first)) * sin(turn / 2)
    assert np.linalg.norm(nearest - [60, 0, 0]) == pytest.approx(error, rel=1e-9)


def test_run_takes_its_length_over_speed_and_one_window() -> None:
    motion = CONTROL.plan(_corner(1.0, 50.0), EVEN)
    assert motion.duration == pytest.approx(120.0 / 50.0 + 0.11)


def test_rapids_wait_until_the_filter_has_run_out() -> None:
    path = chained([
        lines([(0, 0, 0), (10, 0, 0)], speed=50.0),
        lines([(10, 0, 0), (10, 0, 30), (40, 0, 30)]),
        lines([(40, 0, 30), (40, 0, 20), (50, 0, 20)], speed=50.0),
    ])
    motion = CONTROL.plan(path, EVEN)
    lengths = 10 / 50 + 30 / 500 + 30 / 500 + 20 / 50
    assert motion.duration == pytest.approx(lengths + 4 * 0.11)
    stops = motion.at(motion.ends[[0, 1, 2, 4]])
    assert np.abs(stops.velocity).max() < 1e-6
    assert stops.position == pytest.approx(path.end[[0, 1, 2, 4]], abs=1e-9)
    assert stops.segment.tolist() == [1, 2, 3, 4]


def test_station_is_that_of_the_path_half_a_window_earlier() -> None:
    motion = CONTROL.plan(_corner(1.0, 50.0), EVEN)
    state = motion.at(np.array([0.0, 0.055, 0.655, 1.255, 1.355, motion.duration]))
    assert state.segment.tolist() == [0, 0, 0, 1, 1, 1]
    assert state.station == pytest.approx([0.0, 0.0, 30.0, 0.0, 5.0, 60.0], abs=1e-9)


def test_far_from_corners_the_line_is_kept_to_the_last_digit() -> None:
    """After three hours of feed as after one second."""
    motion = CONTROL.plan(lines([(0, 0, 0), (5e4, 0, 0)], speed=5.0), EVEN)
    times = np.array([1.0, 9_000.0])
    assert motion.at(times).position[:, 0] == pytest.approx((times - 0.055) * 5.0, abs=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_position_is_the_integral_of_velocity(
    seed: int,
    wander: Callable[[int], Segments],
    limits: AxisLimits,
    drift: Callable[[Motion], float],
) -> None:
    assert drift(CONTROL.plan(wander(seed), limits)) < 1e-9


@pytest.mark.parametrize("seed", range(3))
def test_velocity_and_acceleration_go_on_and_axes_keep_their_limits(
    seed: int, wander: Callable[[int], Segments], limits: AxisLimits
) -> None:
    path = wander(seed)
    motion = FilterWithinLimits().plan(path, limits)
    assert (np.diff(motion.ends) >= 0.0).all()
    assert motion.ends[-1] == motion.duration
    moment = 1e-9
    inner = motion.knots[1:-1]
    before, after = motion.at(inner - moment), motion.at(inner + moment)
    assert np.abs(after.velocity - before.velocity).max() < 1e4 * 2 * moment
    assert np.abs(after.acceleration - before.acceleration).max() < 4e6 * 2 * moment
    state = motion.at(np.linspace(0.0, motion.duration, 20_000))
    assert (np.abs(state.acceleration) <= limits.acceleration * (1.0 + 1e-9)).all()
    bound = np.where(path.is_rapid[state.segment, None], limits.rapid, limits.feed)
    assert (np.abs(state.velocity) <= bound * (1.0 + 1e-9)).all()
    assert state.position[-1] == pytest.approx(path.end[-1], abs=1e-9)


def test_lines_are_cubic_between_knots() -> None:
    points = [(0, 0, 0), (3, 1, 0), (2, 5, 4), (2.1, 5, 4), (9, 9, 9)]
    motion = CONTROL.plan(lines(points, speed=40.0), EVEN)
    steps = np.linspace(0.0, 1.0, 5)
    times = motion.knots[:-1, None] + np.diff(motion.knots)[:, None] * steps
    position = motion.at(times.ravel()).position.reshape(-1, 5, 3)
    assert np.abs(np.diff(position, n=4, axis=1)).max() < 1e-11


def test_path_without_length_stays_where_it_is() -> None:
    motion = CONTROL.plan(lines([(1, 2, 3), (1, 2, 3)]), EVEN)
    assert motion.duration == 0.0
    assert motion.at(np.zeros(1)).position[0] == pytest.approx([1.0, 2.0, 3.0])


def test_block_without_length_is_read_over() -> None:
    path = lines([(1, 2, 3), (1, 2, 3), (4, 2, 3), (4, 2, 3)], speed=10.0)
    motion = CONTROL.plan(path, EVEN)
    assert motion.duration == pytest.approx(0.3 + 0.11)
    assert motion.ends.tolist() == [0.0, motion.duration, motion.duration]


def test_shortest_filter_is_that_of_the_slowest_axis(limits: AxisLimits) -> None:
    # Rapids from rest: 0.15, 0.1667, 0.2 s.
    assert shortest_filter(limits, limits.rapid).first == pytest.approx(0.2)
    assert shortest_filter(limits, limits.rapid).second == pytest.approx(0.05)
    lathe = replace(limits, acceleration=np.array([4000.0, np.inf, 2000.0]))
    assert shortest_filter(lathe, limits.rapid).first == pytest.approx(0.2)


def test_jerk_lengthens_both_times_of_a_small_change(limits: AxisLimits) -> None:
    jerk = replace(limits, jerk=np.full(3, 2e4))
    # 2000 mm/s² is reached in 0.1 s: a change of 200 mm/s just reaches it.
    small = shortest_filter(jerk, np.full(3, 50.0))
    assert (small.first, small.second) == pytest.approx(((50.0 / 2e4) ** 0.5,) * 2)
    large = shortest_filter(jerk, np.full(3, 400.0))
    assert (large.first, large.second) == pytest.approx((0.2, 0.1))


def test_feeds_are_filtered_for_their_own_speed(limits: AxisLimits) -> None:
    """A slow feed between rapids rounds its corners less than rapids would."""
    path = chained([
        lines([(0, 0, 9), (0, 0, 0)]),
        lines([(0, 0, 0), (20, 0, 0), (20, 20, 0)], speed=10.0),
        lines([(20, 20, 0), (20, 20, 9)]),
    ])
    motion = FilterWithinLimits().plan(path, limits)
    filter_ = shortest_filter(limits, np.full(3, 2.0 * 10.0))
    corner = np.array([20.0, 0.0, 0.0])
    times = motion.ends[1] + np.linspace(-0.1, 0.1, 20_001)
    error = np.linalg.norm(motion.at(times).position - corner, axis=1).min()
    wanted = 10.0 * (filter_.first / 4 + filter_.second**2 / (12 * filter_.first)) * sin(pi / 4)
    assert error == pytest.approx(wanted, rel=1e-3)
    assert motion.ends[2] - motion.ends[0] == pytest.approx(40.0 / 10.0 + filter_.window)


def test_filter_needs_axes_that_limit() -> None:
    free = np.full(3, np.inf)
    with pytest.raises(ValueError, match="finite rapid, feed and acceleration"):
        shortest_filter(AxisLimits(acceleration=free, rapid=free, feed=free), free)


@pytest.mark.parametrize(("first", "second"), [(0.1, 0.0), (0.1, 0.2), (-0.1, -0.2)])
def test_second_time_is_positive_and_no_longer_than_the_first(
    first: float, second: float
) -> None:
    with pytest.raises(ValueError, match="T1 ≥ T2 > 0"):
        FixedTimeFilter(first=first, second=second)


def test_reversal_at_full_feed_reaches_the_axis_acceleration() -> None:
    there_and_back = lines([(0, 0, 0), (100, 0, 0), (0, 0, 0)], speed=200.0)
    control = FixedTimeFilter(first=2 * 200.0 / 1000.0, second=0.1)
    motion = control.plan(there_and_back, EVEN)
    state = motion.at(np.linspace(0.0, motion.duration, 1001))
    assert np.abs(state.acceleration).max() == pytest.approx(1000.0)
