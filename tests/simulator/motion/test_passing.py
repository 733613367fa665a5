"""When places of a way are passed, and how fast."""

from collections.abc import Callable
from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.motion.control import ExactStop, control_model
from simulator.motion.fir import FixedTimeFilter
from simulator.motion.model_name import ControlModelName
from simulator.motion.passing import Passing
from simulator.motion.segments import AxisLimits, Floats, Segments, arc, lines
from tests.oracles.motion import move_time, peak_speed

Wander = Callable[[int], Segments]


def stiff(acceleration: float) -> AxisLimits:
    """Axes with one acceleration, mm/s², as fast as they are told."""
    return AxisLimits(
        acceleration=np.full(3, acceleration), rapid=np.full(3, 1e3), feed=np.full(3, 1e3)
    )


def stopping(segments: Segments, *, acceleration: float = 100.0) -> Passing:
    motion = ExactStop().plan(segments, stiff(acceleration))
    return Passing(segments=segments, motion=motion)


def trapezoid_speed(
    places: Floats, *, length: float, speed: float, acceleration: float
) -> Floats:
    """``v = min(√(2as), v_f, √(2a(L − s)))``."""
    ramp = np.sqrt(2.0 * acceleration * np.minimum(places, length - places))
    return np.minimum(ramp, speed)


@given(
    length=st.floats(0.1, 500.0),
    speed=st.floats(0.5, 300.0),
    acceleration=st.floats(50.0, 5000.0),
)
def test_a_line_is_passed_as_its_trapezoid_or_triangle_says(
    length: float, speed: float, acceleration: float
) -> None:
    passing = stopping(
        lines([(0, 0, 0), (length, 0, 0)], speed=speed), acceleration=acceleration
    )
    places = np.linspace(0.0, length, 41)[1:-1]
    rows = np.zeros(len(places), dtype=np.int64)
    expected = trapezoid_speed(places, length=length, speed=speed, acceleration=acceleration)
    assert passing.speeds(rows, places) == pytest.approx(expected, rel=1e-6)
    (half,) = passing.times(np.array([0.5 * length]))
    whole = move_time(length, speed=speed, acceleration=acceleration)
    assert half == pytest.approx(0.5 * whole, rel=1e-9)


def test_the_first_metres_per_second_are_reached_by_the_square_of_the_time() -> None:
    """``t = √(2s/a)``: at 100 mm/s² after 2, 8 and 18 mm in 0.2, 0.4 and 0.6 s."""
    passing = stopping(lines([(0, 0, 0), (0, 100, 0)], speed=90.0))
    assert passing.times(np.array([2.0, 8.0, 18.0])) == pytest.approx([0.2, 0.4, 0.6])


def test_the_axes_stand_at_both_ends_and_in_a_corner() -> None:
    passing = stopping(lines([(0, 0, 0), (30, 0, 0), (30, 40, 0)], speed=20.0))
    rows, stations = np.array([0, 0, 1, 1]), np.array([0.0, 30.0, 0.0, 40.0])
    assert passing.speeds(rows, stations) == pytest.approx(0.0, abs=1e-6)
    one, other = (move_time(way, speed=20.0, acceleration=100.0) for way in (30.0, 40.0))
    ends = passing.times(np.array([0.0, 30.0, 70.0]))
    assert ends == pytest.approx([0.0, one, one + other])


def test_a_short_move_is_fastest_in_its_middle() -> None:
    passing = stopping(lines([(0, 0, 0), (4, 0, 0)], speed=50.0))
    (found,) = passing.speeds(np.zeros(1, dtype=np.int64), np.array([2.0]))
    assert found == pytest.approx(peak_speed(4.0, speed=50.0, acceleration=100.0))
    assert found == pytest.approx(sqrt(2.0 * 100.0 * 2.0))


def test_an_arc_is_passed_at_its_feed_although_its_axes_turn_round() -> None:
    """10 mm/s on a radius of 20 mm: the axes need 5 of 100 mm/s²."""
    circle = stopping(arc([20, 0, 0], [0, 0, 0], 2.0 * pi, speed=10.0))
    stations = np.linspace(5.0, 40.0 * pi - 5.0, 30)
    speeds = circle.speeds(np.zeros(30, dtype=np.int64), stations)
    assert speeds == pytest.approx(10.0, rel=1e-9)
    assert np.diff(circle.times(stations)) == pytest.approx(np.diff(stations) / 10.0, rel=1e-6)


def test_offsets_are_the_way_before_each_segment() -> None:
    passing = stopping(lines([(0, 0, 0), (3, 4, 0), (3, 4, 0), (3, 4, 7)], speed=1.0))
    assert passing.offsets.tolist() == [0.0, 5.0, 5.0, 12.0]


@pytest.mark.parametrize("control", ControlModelName)
@pytest.mark.parametrize("seed", range(3))
def test_the_axes_are_at_a_place_when_it_is_passed(
    control: ControlModelName, seed: int, wander: Wander, limits: AxisLimits
) -> None:
    path = wander(seed)
    passing = Passing(segments=path, motion=control_model(control, limits).plan(path, limits))
    places = np.linspace(0.0, passing.offsets[-1], 1001)
    times = passing.times(places)
    assert (np.diff(times) >= 0.0).all()
    found = passing.motion.at(times)
    # On a rounded corner the way that is moved is not that along the path.
    within = 1e-4 if control is ControlModelName.LINUXCNC else 1e-6
    assert passing.offsets[found.segment] + found.station == pytest.approx(places, abs=within)


@pytest.mark.parametrize("length", [0.5, 3.0, 200.0])
def test_behind_a_filter_a_place_is_passed_half_a_window_later(length: float) -> None:
    """``t = (T1 + T2)/2 + s/v``, however short the move."""
    path = lines([(0, 0, 0), (length, 0, 0)], speed=50.0)
    motion = FixedTimeFilter(first=0.2, second=0.05).plan(path, stiff(100.0))
    places = np.linspace(0.0, length, 11)[1:-1]
    found = Passing(segments=path, motion=motion).times(places)
    assert found == pytest.approx(0.125 + places / 50.0, rel=1e-9)
