"""Speeds of the axes at places of a workingstep's path, leg by leg."""

from math import cos, inf, radians, sin, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.motion.control import ExactStop, control_model
from simulator.motion.fir import FixedTimeFilter
from simulator.motion.model_name import ControlModelName
from simulator.motion.passing import motion_of
from simulator.motion.segments import (
    AxisLimits,
    ControlModel,
    Floats,
    Ints,
    Leg,
    Segments,
    arc,
    chained,
    lines,
)
from simulator.motion.tool_path import ToolPathRun

AXES = AxisLimits(
    acceleration=np.full(3, 100.0), rapid=np.full(3, 500.0), feed=np.full(3, 500.0)
)


def run(segments: Segments, *ends: int, wait: float = 0.0) -> ToolPathRun:
    """Legs that end after these rows."""
    firsts = (0, *ends[:-1])
    return ToolPathRun(
        moves=(),
        segments=segments,
        spindle=np.full(len(segments), 20.0),
        is_clockwise=True,
        legs=tuple(
            Leg(first=first, last=last, wait=wait)
            for first, last in zip(firsts, ends, strict=True)
        ),
    )


def straight(*x: float, speed: float = 20.0) -> Segments:
    """One block that goes straight on through places."""
    path = lines([(each, 0, 0) for each in x], speed=speed)
    path.block[:] = 0
    return path


def reached_speeds(
    of: ToolPathRun,
    control: ControlModel,
    limits: AxisLimits,
    *,
    segment: Ints,
    station: Floats,
) -> Floats:
    found = motion_of(of, control, limits).velocities(segment, station)
    speeds: Floats = np.linalg.norm(found, axis=1)
    return speeds


def speeds(of: ToolPathRun, *places: tuple[int, float]) -> list[float]:
    rows, stations = zip(*places, strict=True)
    found = reached_speeds(
        of, ExactStop(), AXES, segment=np.array(rows), station=np.array(stations, dtype=float)
    )
    return [float(each) for each in found]


def test_a_line_is_as_fast_as_its_ramps_allow() -> None:
    """At 100 mm/s²: 10 mm/s after 0.5 mm, 20 mm/s from 2 mm on, and the same before the end."""
    found = speeds(
        run(straight(0, 50), 1), (0, 0), (0, 0.5), (0, 2), (0, 25), (0, 49.5), (0, 50)
    )
    assert found == pytest.approx([0.0, 10.0, 20.0, 20.0, 10.0, 0.0], abs=1e-6)


def test_a_leg_begins_and_ends_at_rest_although_the_path_goes_straight_on() -> None:
    path = straight(0, 50, 100)
    places = (0, 49.5), (0, 50.0), (1, 0.0), (1, 0.5)
    assert speeds(run(path, 2), *places) == pytest.approx([20.0] * 4)
    found = speeds(run(path, 1, 2), *places)
    assert found == pytest.approx([10.0, 0.0, 0.0, 10.0], abs=1e-6)


def test_how_long_a_leg_waits_changes_no_speed() -> None:
    path, places = straight(0, 50, 100), ((0, 1.0), (1, 1.0), (1, 49.0))
    assert speeds(run(path, 1, 2, wait=3.0), *places) == speeds(run(path, 1, 2), *places)


def test_legs_without_rows_and_rows_without_places_are_passed_over() -> None:
    of = run(straight(0, 10, 20, 30), 0, 1, 2, 2, 3)
    assert speeds(of, (2, 0.5), (2, 5.0)) == pytest.approx([10.0, 20.0])


def test_no_place_has_no_speed() -> None:
    none = np.zeros(0)
    found = reached_speeds(
        run(straight(0, 10), 1), ExactStop(), AXES, segment=none.astype(np.int64), station=none
    )
    assert found.shape == (0,)


def test_axes_are_slower_than_the_feed_on_a_small_arc() -> None:
    """``v = √(a·r)`` at the most: 100 mm/s² around 1 mm."""
    limits = AxisLimits(
        acceleration=np.full(3, 100.0), rapid=np.full(3, inf), feed=np.full(3, inf)
    )
    circle = run(arc([1, 0, 0], [0, 0, 0], 40.0, speed=50.0), 1)
    stations = np.linspace(5.0, 35.0, 30)
    found = reached_speeds(
        circle, ExactStop(), limits, segment=np.zeros(30, np.int64), station=stations
    )
    assert (found <= sqrt(100.0 * 1.0) * (1.0 + 1e-9)).all()
    assert (found > 0.5 * sqrt(100.0 * 1.0)).all()


def test_a_filter_has_reached_half_the_feed_when_the_path_begins() -> None:
    """Half a window after the start, both averages hold as much rest as feed."""
    path = run(lines([(0, 0, 0), (100, 0, 0)], speed=30.0), 1)
    found = reached_speeds(
        path,
        FixedTimeFilter(first=0.4, second=0.1),
        AXES,
        segment=np.zeros(3, np.int64),
        station=np.array([1e-6, 3.0, 50.0]),
    )
    assert found[0] == pytest.approx(15.0, rel=1e-6)
    assert found[2] == pytest.approx(30.0)
    assert (np.diff(found) > 0.0).all()


@pytest.mark.parametrize("control", ControlModelName)
@given(
    turn=st.integers(-170, 170).map(radians),
    feeds=st.tuples(st.floats(1.0, 200.0), st.floats(1.0, 200.0)),
    at=st.lists(st.floats(0.0, 1.0), min_size=1, max_size=5).map(sorted),
)
def test_no_axis_is_faster_than_the_feeds(
    control: ControlModelName, turn: float, feeds: tuple[float, float], at: list[float]
) -> None:
    """In a corner a filter runs at a mean of both feeds, and nowhere faster than either."""
    path = chained([
        lines([(0, 0, 0), (15, 0, 0)], speed=feeds[0]),
        lines([(15, 0, 0), (15 + 12 * cos(turn), 12 * sin(turn), 0)], speed=feeds[1]),
    ])
    segment = np.repeat([0, 1], len(at))
    station = np.array(at * 2) * path.length[segment]
    found = reached_speeds(
        run(path, 2), control_model(control, AXES), AXES, segment=segment, station=station
    )
    assert (found >= 0.0).all()
    assert (found <= max(feeds) * (1.0 + 1e-9)).all()
