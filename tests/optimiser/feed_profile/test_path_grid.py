"""Stations on lines, arcs and helices, with what the path does on both sides of each."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.feed_paths import AXES, PATHS, random_path, wavy_caps
from optimiser.errors import Infeasible
from optimiser.feed_profile.path_grid import PathEnds, path_grid, problem_on
from optimiser.feed_profile.sweep import sweep_axes
from simulator.motion.segments import arc, chained, lines
from tests.optimiser.profiles import stations_of


@given(seed=st.integers(0, 500), step=st.floats(0.2, 4.0))
@settings(max_examples=30, deadline=None)
def test_intervals_cover_each_segment_once(seed: int, step: float) -> None:
    segments = random_path(seed, parts=6)
    grid = path_grid(segments, step=step, greatest_turn=0.2)
    assert (grid.lengths > 0.0).all()
    assert grid.lengths.max() <= step * (1.0 + 1e-6)
    rate = np.abs(segments.turn / segments.length)[grid.row]
    assert (grid.lengths * rate).max() <= 0.2 * (1.0 + 1e-6)
    covered = np.bincount(grid.row, weights=grid.lengths)
    assert covered == pytest.approx(segments.length)
    inside = np.diff(grid.row) == 0
    assert (grid.finish[:-1][inside] == grid.begin[1:][inside]).all()
    assert grid.boundaries.tolist() == (np.flatnonzero(~inside) + 1).tolist()


@given(seed=st.integers(0, 500))
@settings(max_examples=20, deadline=None)
def test_tangents_have_length_one_and_curvature_is_their_derivative(seed: int) -> None:
    grid = path_grid(random_path(seed, parts=6), step=0.05, greatest_turn=0.01)
    limit = grid.axis_limit(AXES)
    for tangent in (limit.start_tangent, limit.end_tangent):
        assert np.linalg.norm(tangent, axis=1) == pytest.approx(1.0)
    turned = (limit.end_tangent - limit.start_tangent) / grid.lengths[:, None]
    mean = 0.5 * (limit.start_curvature + limit.end_curvature)
    assert turned == pytest.approx(mean, abs=1e-4)


def test_a_circle_has_stations_at_its_quadrants_and_closer_ones_beside_them() -> None:
    circle = arc((10.0, 0.0, 0.0), (0.0, 0.0, 0.0), 2 * pi, speed=10.0)
    grid = path_grid(circle, step=5.0, greatest_turn=0.5)
    stations = stations_of(grid)
    for quadrant in range(1, 4):
        at = int(np.abs(stations - quadrant * 5.0 * pi).argmin())
        assert stations[at] == pytest.approx(quadrant * 5.0 * pi)
        tangent = grid.axis_limit(AXES).start_tangent[at]
        assert (tangent == 0.0).sum() == 2
        assert grid.lengths[at] == pytest.approx(grid.lengths.max() / 8.0)


def test_the_cap_at_a_quadrant_is_that_of_the_axis_across() -> None:
    circle = arc((10.0, 0.0, 0.0), (0.0, 0.0, 0.0), 2 * pi, speed=10.0)
    grid = path_grid(circle, step=0.5)
    problem = problem_on(grid, np.full(len(grid), 1e6))
    squares = sweep_axes(problem, grid.axis_limit(np.array([1e7, 50.0, 1.0]))).squares
    at = int(np.abs(stations_of(grid) - 5.0 * pi).argmin())
    assert squares[at] == pytest.approx(500.0, rel=1e-6)


@pytest.mark.parametrize("name", PATHS)
def test_a_finer_cut_takes_the_same_time(name: str) -> None:
    times = []
    for step, turn in ((0.1, 0.01), (0.03, 0.005)):
        grid = path_grid(PATHS[name](), step=step, greatest_turn=turn)
        problem = problem_on(grid, wavy_caps(stations_of(grid)))
        times.append(sweep_axes(problem, grid.axis_limit(AXES)).time)
    assert times[1] == pytest.approx(times[0], rel=1e-4)


def test_a_short_line_has_a_station_between_its_ends() -> None:
    grid = path_grid(lines([(0, 0, 0), (0.1, 0, 0)], speed=1.0), step=1.0)
    assert len(grid) == 3
    assert len(problem_on(grid, np.full(3, 9.0))) == 3


def test_turns_are_those_of_the_corners() -> None:
    path = lines([(0, 0, 0), (2, 0, 0), (2, 2, 0), (4, 4, 0)], speed=1.0)
    grid = path_grid(path, step=1.0)
    assert grid.turns[grid.boundaries] == pytest.approx([pi / 2, pi / 4])
    assert np.count_nonzero(grid.turns) == 2


def test_a_path_that_turns_back_has_to_stop() -> None:
    grid = path_grid(lines([(0, 0, 0), (4, 0, 0), (1, 0, 0)], speed=1.0), step=1.0)
    message = r"station 4 \(4 mm\): the path turns back, .* cap is 5 mm/s instead of 0"
    with pytest.raises(Infeasible, match=message) as caught:
        problem_on(grid, np.full(8, 25.0))
    assert caught.value.station == 4
    stopped = problem_on(grid, np.full(8, 25.0), ends=PathEnds(stops=np.array([4])))
    assert stopped.caps.tolist() == [25.0] * 4 + [0.0] + [25.0] * 3


def test_equal_points_and_empty_paths_are_refused() -> None:
    double = lines([(0, 0, 0), (4, 0, 0), (4, 0, 0), (4, 1, 0)], speed=1.0)
    with pytest.raises(ValueError, match=r"segment 1 from \(4, 0, 0\) mm has no length"):
        path_grid(double, step=1.0)
    with pytest.raises(ValueError, match="at least one segment, got 0"):
        path_grid(double[:0], step=1.0)
    with pytest.raises(ValueError, match="step of 0 mm must be positive"):
        path_grid(double, step=0.0)
    with pytest.raises(ValueError, match="greatest turn of nan rad must be positive"):
        path_grid(chained([double[:1]]), step=1.0, greatest_turn=np.nan)
