"""Lines in sequences of rounded positions."""

import numpy as np

from benchmarks.logged_path.sampled_path import PathSamples
from benchmarks.logged_path.straight import straight_lines


def samples(points: list[tuple[float, float, float]], half_step: float) -> PathSamples:
    count = len(points)
    return PathSamples(
        position=np.array(points),
        block=np.zeros(count),
        is_rapid=np.zeros(count, dtype=np.bool_),
        half_step=np.full((count, 3), half_step),
    )


def test_lines_are_where_two_coordinates_stay() -> None:
    points = [(float(x), 0.0, 0.0) for x in range(8)]
    points += [(7.0, float(y), 0.0) for y in range(1, 8)]
    points += [(7.0, 7.0, float(z)) for z in range(1, 8)]
    lines = straight_lines(samples(points, 0.05))
    assert [line.axis for line in lines] == [0, 1, 2]
    assert [line.length for line in lines] == [7.0, 7.0, 7.0]


def test_line_on_the_edge_of_its_rounding_step_is_one() -> None:
    points = [(0.0 if 2 <= y <= 9 else 1.0, float(y), 0.0) for y in range(16)]
    (line,) = straight_lines(samples(points, 0.5))
    assert line.axis == 1
    assert line.first[0] == 0.0


def test_short_arc_between_parallel_lines_gets_a_crossing() -> None:
    points = [(float(x), 0.0, 0.0) for x in range(6)]
    points += [(5.7, 0.8, 0.0), (6.0, 1.5, 0.0), (5.7, 2.2, 0.0)]
    points += [(float(x), 3.0, 0.0) for x in range(5, -1, -1)]
    lines = straight_lines(samples(points, 0.05))
    assert [line.axis for line in lines] == [0, 1, 0]


def test_slanted_move_is_no_line() -> None:
    points = [(float(i), 2.0 * i, 3.0 * i) for i in range(20)]
    assert straight_lines(samples(points, 0.05)) == []
