from collections.abc import Callable
from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.motion.control import JunctionDeviation, corner_squares
from simulator.motion.segments import AxisLimits, Motion, Segments, arc, chained, lines

EVEN = AxisLimits(
    acceleration=np.full(3, 1000.0), rapid=np.full(3, 500.0), feed=np.full(3, 200.0)
)
CONTROL = JunctionDeviation(deviation=0.01)


def _bent(angle: float) -> Segments:
    """Two lines with this angle between them; π goes straight on."""
    corner = pi - angle
    return lines(
        [(0, 0, 0), (50, 0, 0), (50 + 50 * cos(corner), 50 * sin(corner), 0)], speed=60
    )


def test_right_angle_is_taken_at_the_speed_of_the_formula() -> None:
    # The change is along −x+y, where two axes of 1000 mm/s² reach √2 as much.
    sine = sin(pi / 4)
    expected = sqrt(2) * 1000.0 * 0.01 * sine / (1.0 - sine)
    assert corner_squares(_bent(pi / 2), EVEN.acceleration, deviation=0.01) == pytest.approx(
        expected
    )
    motion = CONTROL.plan(_bent(pi / 2), EVEN)
    speed = np.linalg.norm(motion.at(motion.ends[:1]).velocity[0])
    assert speed == pytest.approx(sqrt(expected))


@given(angle=st.floats(0.05, 3.0))
def test_circle_of_the_corner_passes_it_at_the_deviation(angle: float) -> None:
    squares = corner_squares(_bent(angle), np.array([1e3, 1e3, 1e3]), deviation=0.01)
    change = np.array([-cos(angle) - 1.0, sin(angle), 0.0])
    change /= np.linalg.norm(change)
    acceleration = 1000.0 / np.abs(change).max()
    # v² = a·R, and the corner lies R/sin(θ/2) from the centre of the circle.
    radius = squares[0] / acceleration
    assert radius / sin(angle / 2.0) - radius == pytest.approx(0.01)


def test_straight_on_is_no_limit_and_turning_back_is_a_stop() -> None:
    path = lines([(0, 0, 0), (1, 0, 0), (2, 0, 0), (1, 0, 0)], speed=9.0)
    squares = corner_squares(path, EVEN.acceleration, deviation=0.01)
    assert squares.tolist() == [np.inf, 0.0]


def test_arc_that_leaves_a_line_without_a_corner_is_no_limit() -> None:
    path = chained([
        lines([(0, 0, 0), (10, 0, 0)], speed=20.0),
        arc([10, 0, 0], [10, 5, 0], 2, speed=20.0),
    ])
    motion = CONTROL.plan(path, EVEN)
    # Centripetal 20²/5 mm/s² on the arc leaves a little less for slowing down.
    slowing = sqrt(1000.0**2 - 80.0**2)
    assert motion.duration == pytest.approx(1.0 + 10.0 / 1000.0 + 10.0 / slowing)


@settings(max_examples=25)
@given(cuts=st.lists(st.floats(0.01, 0.99), min_size=1, max_size=6, unique=True))
def test_pieces_of_a_line_move_as_the_line(cuts: list[float]) -> None:
    end = np.array([30.0, 20.0, -5.0])
    parts = np.array([0.0, *sorted(cuts), 1.0])
    whole = CONTROL.plan(lines([(0, 0, 0), end], speed=150.0), EVEN)
    split = CONTROL.plan(lines(parts[:, None] * end, speed=150.0), EVEN)
    assert split.duration == pytest.approx(whole.duration, rel=1e-12)
    times = np.linspace(0.0, whole.duration, 50)
    assert split.at(times).position == pytest.approx(whole.at(times).position, abs=1e-9)
    assert split.at(times).velocity == pytest.approx(whole.at(times).velocity, abs=1e-7)


def test_block_without_length_is_read_over() -> None:
    straight = CONTROL.plan(lines([(0, 0, 0), (5, 0, 0), (10, 0, 0)], speed=50.0), EVEN)
    path = lines([(0, 0, 0), (5, 0, 0), (5, 0, 0), (10, 0, 0)], speed=50.0)
    assert CONTROL.plan(path, EVEN).duration == pytest.approx(straight.duration, rel=1e-12)


def test_rapids_begin_and_end_at_rest() -> None:
    path = chained([
        lines([(0, 0, 0), (10, 0, 0)], speed=50.0),
        lines([(10, 0, 0), (20, 0, 0), (30, 0, 0)]),
        lines([(30, 0, 0), (40, 0, 0)], speed=50.0),
    ])
    motion = CONTROL.plan(path, EVEN)
    assert not np.abs(motion.at(motion.ends).velocity).max() > 1e-6


@pytest.mark.parametrize("seed", range(3))
def test_speed_goes_on_over_corners_and_axes_keep_their_limits(
    seed: int, wander: Callable[[int], Segments], limits: AxisLimits
) -> None:
    path = wander(seed)
    motion = CONTROL.plan(path, limits)
    assert (np.diff(motion.ends) >= 0.0).all()
    moment = 1e-9
    inner = motion.knots[1:-1]
    before, after = (
        np.linalg.norm(motion.at(inner + by).velocity, axis=1) for by in (-moment, moment)
    )
    assert np.abs(after - before).max() < 1e4 * 2 * moment
    state = motion.at(np.linspace(0.0, motion.duration, 20_000))
    assert (np.abs(state.acceleration) <= limits.acceleration * (1.0 + 1e-9)).all()
    bound = np.where(path.is_rapid[state.segment, None], limits.rapid, limits.feed)
    assert (np.abs(state.velocity) <= bound * (1.0 + 1e-9)).all()


@pytest.mark.parametrize("seed", range(3))
def test_position_is_the_integral_of_velocity(
    seed: int,
    wander: Callable[[int], Segments],
    limits: AxisLimits,
    drift: Callable[[Motion], float],
) -> None:
    assert drift(CONTROL.plan(wander(seed), limits)) < 1e-9


def test_greater_deviation_is_never_slower(
    wander: Callable[[int], Segments], limits: AxisLimits
) -> None:
    path = wander(7)
    times = [
        JunctionDeviation(deviation=each).plan(path, limits).duration
        for each in (1e-6, 0.01, 1)
    ]
    assert times == sorted(times, reverse=True)


@pytest.mark.parametrize("deviation", [0.0, -0.1, np.nan])
def test_deviation_must_be_positive(deviation: float) -> None:
    with pytest.raises(ValueError, match="junction deviation"):
        JunctionDeviation(deviation=deviation)
