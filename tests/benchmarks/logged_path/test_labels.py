"""Rapids and block numbers of rebuilt segments."""

import numpy as np
import pytest

from benchmarks.logged_path.labels import labelled
from benchmarks.logged_path.sampled_path import PathSamples
from simulator.motion.segments import lines

PATH = lines([(0.0, 0.0, 10.0), (0.0, 0.0, 0.0), (20.0, 0.0, 0.0)], speed=1.0)


def test_line_is_cut_where_rapid_becomes_feed() -> None:
    station = np.arange(0.25, 30.0, 0.5)
    down = station <= 10.0
    samples = PathSamples(
        position=np.column_stack([
            np.where(down, 0.0, station - 10.0),
            0.0 * station,
            np.maximum(0.0, 10.0 - station),
        ]),
        block=np.where(down, 7.0, 9.0),
        is_rapid=station < 6.0,
        half_step=np.full((len(station), 3), 0.01),
    )
    found = labelled(PATH, samples, station=station)
    assert found.is_rapid.tolist() == [True, False, False]
    assert found.seen_block.tolist() == [7.0, 7.0, 9.0]
    assert found.segments.length.sum() == pytest.approx(30.0)
    assert found.segments.length[0] == pytest.approx(6.0, abs=0.3)


def test_segment_without_a_sample_is_like_the_one_before() -> None:
    path = lines([(0.0, 0.0, 0.0), (10.0, 0.0, 0.0), (10.2, 0.0, 0.0)], speed=1.0)
    station = np.arange(0.5, 9.0)
    samples = PathSamples(
        position=np.column_stack([station, 0.0 * station, 0.0 * station]),
        block=np.full(len(station), 4.0),
        is_rapid=np.ones(len(station), dtype=np.bool_),
        half_step=np.full((len(station), 3), 0.01),
    )
    found = labelled(path, samples, station=station)
    assert found.is_rapid.tolist() == [True, True]
    assert found.seen_block.tolist() == [4.0, 4.0]
