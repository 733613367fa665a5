from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from simulator.motion.control import ExactStop
from simulator.motion.segments import AxisLimits, Motion, Segments, arc, lines
from tests.oracles.motion import move_time


def _mill(rapid: float) -> AxisLimits:
    """The machine of paper 003, Fig. 5, with 6 m/s² on all axes."""
    return AxisLimits(
        acceleration=np.full(3, 6000.0), rapid=np.full(3, rapid), feed=np.full(3, rapid)
    )


def test_rapid_of_100_mm_speeds_up_runs_and_slows_down() -> None:
    motion = ExactStop().plan(lines([(0, 0, 0), (100, 0, 0)]), _mill(16_000 / 60))
    assert np.diff(motion.knots) == pytest.approx([0.04444, 0.33056, 0.04444], abs=5e-6)
    assert motion.duration == pytest.approx(0.41944, abs=5e-6)


@pytest.mark.parametrize(
    ("length", "speed", "time"),
    [
        (500.0, 1600.0, 0.57917),
        (100.0, 1600.0, 0.25820),
        (2.0, 40.0, 0.056667),
        (0.2, 40.0, 0.011547),
        (101.6, 124.46 / 60, 48.980),
    ],
)
def test_moves_take_the_time_of_trapezoid_or_triangle(
    length: float, speed: float, time: float
) -> None:
    motion = ExactStop().plan(lines([(0, 0, 0), (0, length, 0)], speed=speed), _mill(1600.0))
    assert motion.duration == pytest.approx(time, rel=1e-4)
    assert motion.duration == pytest.approx(
        move_time(length, speed=speed, acceleration=6000.0), rel=1e-12
    )


def test_triangle_turns_at_its_peak() -> None:
    motion = ExactStop().plan(lines([(0, 0, 0), (100, 0, 0)]), _mill(1600.0))
    assert len(motion.knots) == 3
    peak = motion.at(motion.knots[1:2])
    assert peak.velocity[0, 0] == pytest.approx(774.6, abs=0.05)
    assert peak.station[0] == pytest.approx(50.0)


def test_feed_block_without_length_takes_the_block_time() -> None:
    slow = replace(_mill(1600.0), block_time=0.004)
    points = [(0, 0, 0), (5, 0, 0), (5, 0, 0), (9, 0, 0)]
    feeds, rapids = ExactStop().plan(lines(points, speed=9.0), slow), lines(points)
    assert np.diff(feeds.ends)[0] == pytest.approx(0.004)
    assert np.diff(ExactStop().plan(rapids, slow).ends)[0] == 0.0


def test_pieces_of_one_block_are_one_move() -> None:
    pieces = lines([(0, 0, 0), (3, 0, 0), (4, 0, 0), (10, 0, 0)], speed=50.0)
    whole = ExactStop().plan(lines([(0, 0, 0), (10, 0, 0)], speed=50.0), _mill(1600.0))
    split = ExactStop().plan(replace(pieces, block=np.zeros(3, np.int64)), _mill(1600.0))
    stops = ExactStop().plan(pieces, _mill(1600.0))
    assert split.duration == pytest.approx(whole.duration, rel=1e-12)
    assert stops.duration == pytest.approx(whole.duration + 2 * 50.0 / 6000.0)


def test_arc_takes_the_time_of_a_line_as_long() -> None:
    """Slow enough that the centripetal part takes nothing worth naming."""
    circle = arc([20, 0, 0], [0, 0, 0], 5.0, speed=2.0)
    motion = ExactStop().plan(circle, _mill(1600.0))
    assert motion.duration == pytest.approx(100.0 / 2.0 + 2.0 / 6000.0, rel=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_position_is_the_integral_of_velocity(
    seed: int,
    wander: Callable[[int], Segments],
    limits: AxisLimits,
    drift: Callable[[Motion], float],
) -> None:
    assert drift(ExactStop().plan(wander(seed), limits)) < 1e-9


@pytest.mark.parametrize("seed", range(3))
def test_axes_stand_at_the_end_of_each_block_and_keep_their_limits(
    seed: int, wander: Callable[[int], Segments], limits: AxisLimits
) -> None:
    path = wander(seed)
    motion = ExactStop().plan(path, limits)
    assert (np.diff(motion.ends) >= 0.0).all()
    assert np.abs(motion.at(motion.ends).velocity).max() < 1e-6
    assert motion.at(motion.ends[-1:]).position[0] == pytest.approx(path.end[-1], abs=1e-9)
    state = motion.at(np.linspace(0.0, motion.duration, 20_000))
    assert (np.abs(state.acceleration) <= limits.acceleration * (1.0 + 1e-9)).all()
    bound = np.where(path.is_rapid[state.segment, None], limits.rapid, limits.feed)
    assert (np.abs(state.velocity) <= bound * (1.0 + 1e-9)).all()
