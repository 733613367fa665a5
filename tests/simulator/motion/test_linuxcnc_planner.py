"""LinuxCNC's planner beside what LinuxCNC 2.9 was measured to do, and its parts by themselves.

Axes of 600, 600 and 500 mm/s and 4000 mm/s²; measured with feed override up to 2.
"""

from dataclasses import replace
from math import cos, inf, pi, sin, sqrt

import numpy as np
import pytest

from simulator.motion.linuxcnc_planner import LinuxCncPlanner, PlannedMotion, joined
from simulator.motion.segments import AxisLimits, Segments, arc, chained, lines
from simulator.planner_settings import PlannerSettings
from stepnc_model.post.blocks import PathControl

AXES = AxisLimits(
    acceleration=np.full(3, 4000.0),
    rapid=np.array([600.0, 600.0, 500.0]),
    feed=np.full(3, 333.0),
)
CORNER = [(0, 0, 0), (20, 0, 0), (20, 20, 0)]


def planner(tolerance: float, joining: float | None = None) -> LinuxCncPlanner:
    return LinuxCncPlanner(
        settings=PlannerSettings(max_feed_override=2.0),
        mode=PathControl(tolerance=tolerance, joining=joining),
    )


def planned(path: Segments, control: LinuxCncPlanner) -> PlannedMotion:
    motion = control.plan(path, AXES)
    assert isinstance(motion, PlannedMotion)
    return motion


@pytest.mark.parametrize(
    ("tolerance", "feed", "speed", "deviation"),
    [
        (0.01, 50.0, 9.14, 0.0100),
        (0.1, 50.0, 28.92, 0.1000),
        (inf, 50.0, 50.0, 1.3186),
        (inf, 200.0, 186.12, 4.1429),
    ],
)
def test_a_corner_is_rounded_as_measured(
    tolerance: float, feed: float, speed: float, deviation: float
) -> None:
    motion = planned(lines(CORNER, speed=feed), planner(tolerance))
    states = motion.at(np.linspace(0.0, motion.duration, 20_001))
    beside = np.linalg.norm(states.position - np.array([20.0, 0.0, 0.0]), axis=1)
    assert beside.min() == pytest.approx(deviation, rel=2e-3)
    middle = np.argmin(beside)
    found = float(np.linalg.norm(states.velocity[middle]))
    assert found == pytest.approx(speed, rel=2e-3)


@pytest.mark.parametrize("angle", [12.0, 40.0, 90.0, 140.0, 168.0])
def test_a_rounded_path_is_smooth(angle: float) -> None:
    turn = np.radians(angle)
    points = [(0, 0, 0), (20, 0, 0), (20 + 20 * cos(turn), 20 * sin(turn), 0)]
    motion = planned(lines(points, speed=100.0), planner(0.05))
    times = np.linspace(0.0, motion.duration, 50_001)
    states = motion.at(times)
    steps = np.diff(states.position, axis=0) / np.diff(times)[:, None]
    mean = 0.5 * (states.velocity[1:] + states.velocity[:-1])
    # The cubic is passed at 100 mm/s to within 2 %.
    assert np.abs(steps - mean).max() < 2.0
    # The cubic is no arc: its curvature differs a little.
    assert np.linalg.norm(states.acceleration, axis=1).max() < 1.1 * sqrt(2.0) * 4000.0
    assert (np.diff(motion.ends) > 0.0).all()


def test_an_arc_runs_at_the_speed_of_its_acceleration() -> None:
    path = chained([arc((5, 0, 0), (0, 0, 0), 2.0 * pi, speed=200.0)])
    motion = planned(path, planner(0.01))
    speeds = np.linalg.norm(motion.at(motion.knots).velocity, axis=1)
    assert speeds.max() == pytest.approx(131.6, rel=1e-3)


def test_exact_path_stops_at_corners_and_takes_half_a_period() -> None:
    motion = planned(lines(CORNER, speed=50.0), planner(0.0))
    # Twice 20 mm from rest to rest, and a corner that keeps a tenth of the acceleration.
    assert motion.duration == pytest.approx(2 * (0.4 + 50.0 / 3600.0) + 0.001, rel=1e-6)
    assert motion.at(motion.ends[:1]).position[0] == pytest.approx([20.0, 0.0, 0.0])


def test_exact_stop_stops_where_lines_go_straight_on() -> None:
    control = replace(planner(0.0), mode=PathControl(tolerance=0.0, is_exact_stop=True))
    straight = lines([(0, 0, 0), (20, 0, 0), (40, 0, 0)], speed=50.0)
    assert planned(straight, control).duration == pytest.approx(2 * 0.4125 + 0.001, rel=1e-6)
    assert planned(straight, planner(0.0)).duration == pytest.approx(0.8125 + 0.0005, rel=1e-6)


def test_the_last_move_before_a_wait_has_half_its_acceleration() -> None:
    path, control = lines([(0, 0, 0), (60, 0, 0)], speed=50.0), planner(0.01)
    waits = planned(path, control).duration
    goes_on = planned(path, replace(control, is_drained=False)).duration
    assert waits - goes_on == pytest.approx(50.0 / 4000.0, rel=1e-6)


def test_feeds_that_follow_the_spindle_round_corners_as_far_as_they_may() -> None:
    path, control = lines(CORNER, speed=1.0), planner(0.05)
    synchronised = replace(control, is_synchronised=True)
    slow, wide = (planned(path, each).joints.trim[0] for each in (control, synchronised))
    assert wide == pytest.approx(0.05 * cos(pi / 4) / (1 - sin(pi / 4)))
    assert slow < 0.1 * wide


def test_short_lines_are_joined_within_their_distance() -> None:
    angles = np.linspace(0.0, 2.0 * pi, 629)
    path = lines([(10 * cos(a), 10 * sin(a), 0.0) for a in angles], speed=100.0)
    moves, last = joined(path, 0.01)
    assert last[-1] == len(path) - 1
    # A chord of the circle leaves it by 0.01 mm where it is 0.89 mm long.
    assert moves.length.max() == pytest.approx(2 * sqrt(2 * 10 * 0.01), abs=0.1)
    assert len(joined(path, 0.0)[0]) == len(path)
    # Measured: 0.653 s joined within 0.05 mm; unjoined it takes 1.02 servo periods for 0.1 mm.
    assert planned(path, planner(0.05)).duration == pytest.approx(0.653, rel=0.01)
    short = planned(path, planner(0.01, joining=0.0))
    speeds = np.linalg.norm(short.at(short.knots).velocity, axis=1)
    assert speeds.max() <= 100.0 * (1.0 + 1e-9)
    assert speeds.max() == pytest.approx(0.1 / 0.00102, rel=0.01)


def test_rapids_and_feeds_meet_at_rest() -> None:
    path = chained([
        lines([(0, 0, 0), (20, 0, 0)]),
        lines([(20, 0, 0), (40, 0, 0)], speed=50.0),
    ])
    motion = planned(path, planner(0.01))
    assert np.linalg.norm(motion.at(motion.ends[:1]).velocity) == pytest.approx(0.0)


def test_points_without_way_take_no_time() -> None:
    motion = planner(0.01).plan(lines([(1, 2, 3), (1, 2, 3)], speed=10.0), AXES)
    assert motion.duration == 0.0
    path = lines([(0, 0, 0), (5, 0, 0), (5, 0, 0), (9, 0, 0)], speed=10.0)
    ends = planned(path, planner(0.01)).ends
    assert ends[1] == ends[0]
    assert (np.diff(ends) >= 0.0).all()
