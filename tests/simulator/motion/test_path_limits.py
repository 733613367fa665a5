from dataclasses import replace
from math import cos, pi, sin, sqrt

import numpy as np
import pytest

from simulator.motion.path_limits import goes_on, is_stop, path_limits
from simulator.motion.segments import AxisLimits, Segments, arc, chained, lines


@pytest.fixture
def even() -> AxisLimits:
    return AxisLimits(
        acceleration=np.full(3, 1000.0), rapid=np.full(3, 500.0), feed=np.full(3, 100.0)
    )


def test_axes_arrive_together_on_a_diagonal(limits: AxisLimits) -> None:
    diagonal = lines([(0, 0, 0), (30, 40, 0)])
    bounds = path_limits(diagonal, limits)
    # Y moves 0.8 of the path at up to 500 mm/s and 3000 mm/s².
    assert bounds.speed[0] == pytest.approx(500.0 / 0.8)
    assert bounds.acceleration[0] == pytest.approx(3000.0 / 0.8)


def test_feed_is_held_to_the_greatest_feed_of_the_axes(limits: AxisLimits) -> None:
    bounds = path_limits(lines([(0, 0, 0), (0, 0, -9)], speed=1e4), limits)
    assert bounds.speed[0] == 200.0


def test_blocks_are_no_shorter_than_the_control_takes(even: AxisLimits) -> None:
    slow = replace(even, block_time=0.004)
    chords = lines([(0, 0, 0), (0.1, 0, 0), (0.3, 0, 0)], speed=80.0)
    assert path_limits(chords, slow).speed == pytest.approx([25.0, 50.0])
    pieces = replace(chords, block=np.zeros(2, np.int64))
    assert path_limits(pieces, slow).speed == pytest.approx([75.0, 75.0])


def test_block_time_does_not_hold_rapids_back(even: AxisLimits) -> None:
    rapid = lines([(0, 0, 0), (0.1, 0, 0)])
    assert path_limits(rapid, replace(even, block_time=0.004)).speed[0] == 500.0


def test_fast_arc_keeps_centripetal_and_tangential_three_to_four(even: AxisLimits) -> None:
    circle = arc([2.0, 0.0, 0.0], [0.0, 0.0, 0.0], 2 * pi, speed=100.0)
    bounds = path_limits(circle, even)
    assert bounds.speed[0] == pytest.approx(sqrt(0.8 * 1000.0 * 2.0))
    assert bounds.acceleration[0] == pytest.approx(600.0)


def test_slow_arc_accelerates_nearly_like_a_line(even: AxisLimits) -> None:
    bounds = path_limits(arc([2.0, 0.0, 0.0], [0.0, 0.0, 0.0], 2 * pi, speed=1.0), even)
    assert bounds.speed[0] == 1.0
    assert bounds.acceleration[0] == pytest.approx(1000.0 * sqrt(1.0 - 0.0005**2))


def test_steep_helix_is_bounded_along_its_axis(limits: AxisLimits) -> None:
    helix = arc([1.0, 0.0, 0.0], [0.0, 0.0, 0.0], 2 * pi, rise=100.0, speed=1e4)
    rise = 100.0 / helix.length[0]
    bounds = path_limits(helix, limits)
    assert bounds.speed[0] == pytest.approx(200.0 / rise)
    assert bounds.acceleration[0] == pytest.approx(2000.0 / rise)


@pytest.mark.parametrize("seed", range(4))
def test_no_axis_passes_its_acceleration_at_any_angle(seed: int, limits: AxisLimits) -> None:
    random = np.random.default_rng(seed)
    centre = random.normal(size=3) * 10.0
    helix = arc(
        [0, 0, 0], list(centre), 7.0, normal=seed % 3, rise=random.normal() * 9, speed=1e3
    )
    bounds = path_limits(helix, limits)
    rows = np.zeros(500, np.int64)
    station = np.linspace(0.0, helix.length[0], 500)
    reached = (
        np.abs(helix.direction(rows, station)) * bounds.acceleration[0]
        + np.abs(helix.curvature(rows, station)) * bounds.speed[0] ** 2
    )
    assert (reached <= limits.acceleration * (1.0 + 1e-12)).all()
    moved = np.abs(helix.direction(rows, station)) * bounds.speed[0]
    assert (moved <= limits.feed * (1.0 + 1e-12)).all()


def test_axis_that_is_not_there_does_not_limit(even: AxisLimits) -> None:
    y_free = replace(even, acceleration=np.array([1000.0, np.inf, 1000.0]))
    bounds = path_limits(lines([(0, 0, 0), (0, 5, 0)], speed=50.0), y_free)
    assert bounds.acceleration[0] == np.inf


def test_segment_without_length_does_not_move(even: AxisLimits) -> None:
    assert path_limits(lines([(0, 0, 0), (0, 0, 0)]), even).speed[0] == 0.0


def test_speed_without_any_bound_is_refused(even: AxisLimits) -> None:
    free = replace(even, rapid=np.full(3, np.inf))
    with pytest.raises(ValueError, match="segment 1: neither command nor axis"):
        path_limits(
            chained([lines([(0, 0, 0), (1, 0, 0)], speed=5.0), lines([(1, 0, 0), (2, 0, 0)])]),
            free,
        )


def test_path_without_segments_is_refused(even: AxisLimits) -> None:
    with pytest.raises(ValueError, match="at least one segment"):
        path_limits(lines([(0, 0, 0)]), even)


def _around() -> Segments:
    """A feed line, an arc from it without a corner, two rapids in one line, a feed."""
    bend = arc([10, 0, 0], [10, 5, 0], pi / 2, speed=10.0)
    end = list(bend.end[0])
    up = [[end[0], end[1], z] for z in (0.0, 4.0, 9.0)]
    return chained([
        lines([(0, 0, 0), (10, 0, 0)], speed=10.0),
        bend,
        lines(up),
        lines([up[-1], (0, 0, 9)], speed=10.0),
    ])


def test_continuous_control_stops_before_after_and_between_rapids() -> None:
    assert is_stop(_around()).tolist() == [False, True, True, True]


def test_pieces_of_one_block_go_on_where_they_are_straight() -> None:
    path = replace(_around(), block=np.array([0, 0, 1, 1, 1]))
    assert goes_on(path).tolist() == [True, False, True, False]
    assert is_stop(path).tolist() == [False, True, False, True]


def test_piece_that_bends_is_a_corner() -> None:
    angle = 1e-3
    bent = lines([(0, 0, 0), (1, 0, 0), (1 + cos(angle), sin(angle), 0)], speed=1.0)
    assert not goes_on(replace(bent, block=np.zeros(2, np.int64)))[0]
