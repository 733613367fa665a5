"""Samples laid onto a path."""

import numpy as np
import pytest

from benchmarks.logged_path.sampled_path import (
    PathSamples,
    course_of,
    course_of_samples,
    joined,
    shifted,
    stations,
)
from simulator.motion.segments import lines

# Out along X, back 0.05 mm beside it: only the block number tells the two ways apart.
PATH = lines(
    [(0.0, 0.0, 0.0), (20.0, 0.0, 0.0), (20.0, 0.05, 0.0), (0.0, 0.05, 0.0)], speed=1.0
)
BLOCKS = np.array([10.0, 30.0, 50.0])


def at(points: list[tuple[float, float, float]], blocks: list[float]) -> PathSamples:
    return PathSamples(
        position=np.array(points),
        block=np.array(blocks),
        is_rapid=np.zeros(len(points), dtype=np.bool_),
        half_step=np.full((len(points), 3), 0.05),
    )


def test_station_is_that_of_the_nearest_point() -> None:
    samples = at([(5.0, 0.0, 0.0), (12.0, 0.0, 0.0)], [10.0, 10.0])
    found = stations(samples, course_of(PATH, BLOCKS))
    np.testing.assert_allclose(found, [5.0, 12.0], atol=0.1)


def test_block_number_decides_where_the_path_comes_back() -> None:
    samples = at([(5.0, 0.025, 0.0), (5.0, 0.025, 0.0)], [12.0, 48.0])
    found = stations(samples, course_of(PATH, BLOCKS))
    np.testing.assert_allclose(found, [5.0, 35.05], atol=0.15)


def test_polyline_of_ordered_samples_has_their_length() -> None:
    course = course_of_samples(at([(0.0, 0.0, 0.0), (3.0, 4.0, 0.0)], [1.0, 2.0]))
    assert course.station[-1] == pytest.approx(5.0)


def test_work_offset_is_taken_off_and_rounding_is_not() -> None:
    course = course_of(PATH, BLOCKS)
    points = [(x + 0.01, 0.0, 0.2) for x in range(1, 15)]
    moved = shifted(at(points, [10.0] * len(points)), course)
    np.testing.assert_allclose(moved.position[:, 2], 0.0, atol=1e-9)
    np.testing.assert_allclose(moved.position[0, 0], 1.01, atol=1e-9)


def test_parts_join_and_rows_are_taken() -> None:
    both = joined([at([(1.0, 0.0, 0.0)], [1.0]), at([(2.0, 0.0, 0.0)], [2.0])])
    assert len(both) == 2
    np.testing.assert_allclose(both[np.array([1])].position, [[2.0, 0.0, 0.0]])
