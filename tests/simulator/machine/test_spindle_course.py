"""Speed of the spindle by time."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.machine.spindle_course import SpindleCourse, following, ramped, standing

SPEEDS = st.floats(-300.0, 300.0).map(lambda speed: round(speed, 3))


def area(course: SpindleCourse, begin: float, end: float) -> float:
    """``∫ n dt`` by the trapezoidal rule on knots, independent of the closed form."""
    inside = course.times[(course.times > begin) & (course.times < end)]
    times = np.concatenate(([begin], inside, [end]))
    return float(np.trapezoid(course.speed(times), times))


def test_ramp_takes_speed_over_acceleration() -> None:
    """1750 rpm at 10 rev/s²: 2.9167 s."""
    course = ramped(standing(0.0), 4.0, 1750 / 60, acceleration=10.0)
    assert course.reached - 4.0 == pytest.approx(2.91667, rel=1e-5)
    assert course.target == 1750 / 60
    times = np.array([4.0, 5.0, course.reached + 1.0])
    np.testing.assert_allclose(course.speed(times), [0.0, 10.0, 1750 / 60])
    np.testing.assert_allclose(course.acceleration(times), [10.0, 10.0, 0.0])


def test_reversal_stands_for_a_moment() -> None:
    course = ramped(standing(0.0, 30.0), 1.0, -10.0, acceleration=20.0)
    assert course.times.tolist() == [1.0, 2.5, 3.0]
    assert course.speeds.tolist() == [30.0, 0.0, -10.0]
    np.testing.assert_allclose(course.acceleration(np.array([1.5, 2.7])), -20.0)


def test_interrupted_ramp_goes_on_from_where_it_is() -> None:
    up = ramped(standing(0.0), 0.0, 100.0, acceleration=20.0)
    down = ramped(up, 2.0, 0.0, acceleration=20.0)
    assert down.speeds.tolist() == [40.0, 0.0]
    assert down.reached == pytest.approx(4.0)
    assert down.turned == pytest.approx(40.0)


def test_without_acceleration_the_speed_is_there_at_once() -> None:
    course = ramped(standing(0.0, 5.0), 3.0, -50.0, acceleration=None)
    assert course.reached == 3.0
    np.testing.assert_allclose(course.speed(np.array([3.0, 4.0])), -50.0)
    np.testing.assert_allclose(course.acceleration(np.array([3.0, 4.0])), 0.0)
    assert course.revolutions(np.array([5.0]))[0] == pytest.approx(15.0 - 100.0)


def test_same_speed_takes_no_time() -> None:
    assert ramped(standing(0.0, 5.0), 3.0, 5.0, acceleration=10.0).reached == 3.0


@settings(max_examples=60)
@given(
    turns=st.lists(st.tuples(st.floats(0.0, 5.0), SPEEDS), min_size=1, max_size=6),
    acceleration=st.floats(1.0, 500.0),
)
def test_speed_never_jumps_nor_changes_too_fast(
    turns: list[tuple[float, float]], acceleration: float
) -> None:
    now, course, made = 0.0, standing(0.0), 0.0
    for pause, speed in turns:
        before = course
        made += area(course, now, now + pause)
        now += pause
        course = ramped(course, now, speed, acceleration=acceleration)
        here = np.array([now])
        assert course.speed(here)[0] == pytest.approx(before.speed(here)[0])
        assert course.revolutions(here)[0] == pytest.approx(made, abs=1e-6)
        times = np.linspace(now, course.reached + 1.0, 50)
        assert np.abs(course.acceleration(times)).max() <= acceleration * (1.0 + 1e-6)
        assert course.speed(times)[-1] == speed
        # Between two knots the sense does not change.
        assert np.all(course.speeds[1:] * course.speeds[:-1] >= 0.0)


@settings(max_examples=40)
@given(
    spans=st.lists(st.just(0.0) | st.floats(1e-6, 2.0), min_size=1, max_size=8),
    data=st.data(),
    acceleration=st.floats(1.0, 100.0),
)
def test_following_is_as_near_as_the_acceleration_lets_it(
    spans: list[float], data: st.DataObject, acceleration: float
) -> None:
    count = len(spans)
    wanted = np.array(data.draw(st.lists(SPEEDS, min_size=count, max_size=count)))
    ends = 3.0 + np.cumsum(spans)
    start = standing(0.0, 20.0)
    course = following(start, 3.0, ends, wanted=wanted, acceleration=acceleration)
    assert course.speeds[0] == 20.0
    slopes = course.acceleration(0.5 * (course.times[1:] + course.times[:-1]))
    assert np.abs(slopes).max(initial=0.0) <= acceleration * (1.0 + 1e-6)
    here = np.array([ends[-1] + 1.0])
    total = start.revolutions(np.array([3.0]))[0] + area(course, 3.0, float(here[0]))
    assert course.revolutions(here)[0] == pytest.approx(total, abs=1e-6)
    exact = following(start, 3.0, ends, wanted=wanted, acceleration=np.inf)
    moved = np.diff(ends, prepend=3.0) > 0.0
    np.testing.assert_allclose(exact.speed(ends[moved]), wanted[moved], atol=1e-9)


def test_following_keeps_the_speed_where_none_is_wanted() -> None:
    course = following(
        standing(0.0, 20.0),
        1.0,
        np.array([2.0, 3.0, 4.0]),
        wanted=np.array([np.nan, 30.0, np.nan]),
        acceleration=100.0,
    )
    assert course.speeds.tolist() == [20.0, 20.0, 30.0, 30.0]
