"""A program rebuilt from rounded positions in any order."""

import numpy as np
import pytest

from benchmarks.logged_path.rebuild import Rebuilt, rebuilt
from benchmarks.logged_path.rounded import rounded
from benchmarks.logged_path.sampled_path import PathSamples
from simulator.errors import CalibrationError
from simulator.motion.segments import Floats, Segments

VERTICES = np.array([
    [60.0, 40.0, 90.0],
    [10.3, 12.0, 40.0],
    [10.3, 12.0, 20.0],
    [42.7, 12.0, 20.0],
    [42.7, 33.5, 20.0],
    [8.4, 33.5, 20.0],
    [8.4, 55.0, 20.0],
    [30.0, 55.0, 20.0],
    [30.0, 55.0, 50.0],
])  # fmt: skip
RADIUS = np.array([0.0, 0.0, 0.0, 4.0, 2.5, 3.0, 0.0, 0.0, 0.0])
STEP = np.array([1.0, 0.1, 0.1])
RAPID = 50.0


def path() -> Segments:
    return rounded(VERTICES, RADIUS)


def seen(spacing: float, first: float, *, order: Floats | None = None) -> PathSamples:
    """Samples of the path at even stations, rounded; rapid is what is above Z = 20."""
    whole = path()
    ends = np.cumsum(whole.length)
    station = np.arange(first, ends[-1], spacing)
    if order is not None:
        station = station[np.argsort(order[: len(station)])]
    row = np.searchsorted(ends, station)
    exact = whole.position(row, station - (ends - whole.length)[row])
    return PathSamples(
        position=np.round(exact / STEP) * STEP,
        block=(10 * row).astype(np.float64),
        is_rapid=exact[:, 2] > 20.01,
        half_step=np.tile(0.5 * STEP, (len(station), 1)),
    )


@pytest.fixture(scope="module")
def program() -> Rebuilt:
    shuffle = np.random.default_rng(1).random(10_000)
    return rebuilt(seen(0.61, 0.0), [seen(0.37, 0.2, order=shuffle)], rapid=RAPID)


def test_length_is_found_within_the_rounding(program: Rebuilt) -> None:
    feed = program.segments.length[~program.segments.is_rapid].sum()
    truth = path()
    expected = truth.length[np.isclose(truth.end[:, 2], 20.0)][1:].sum()
    # Each of both ends is known to half a step of 1 mm, and each radius to about as much.
    assert feed == pytest.approx(expected, abs=1.5)


def test_path_is_whole(program: Rebuilt) -> None:
    segments = program.segments
    np.testing.assert_allclose(segments.end[:-1], segments.start[1:], atol=1e-9)
    np.testing.assert_allclose(segments.start[0], VERTICES[0], atol=1e-9)
    np.testing.assert_allclose(segments.end[-1], VERTICES[-1], atol=0.7)


def test_arcs_are_found(program: Rebuilt) -> None:
    arcs = program.segments.turn != 0.0
    np.testing.assert_allclose(np.sign(program.segments.turn[arcs]), [1.0, 1.0, -1.0])
    np.testing.assert_allclose(program.segments.radius[arcs], [4.0, 2.5, 3.0], atol=1.0)


def test_rapids_are_what_is_seen_to_be_rapid(program: Rebuilt) -> None:
    segments = program.segments
    assert (segments.speed[segments.is_rapid] == RAPID).all()
    assert segments.is_rapid[0]
    assert segments.is_rapid[-1]
    assert not segments.is_rapid[segments.turn != 0.0].any()


def test_feed_is_that_of_the_run(program: Rebuilt) -> None:
    segments = program.at_feed(6.0)
    assert set(segments.speed.tolist()) == {6.0, RAPID}


def test_every_segment_is_a_block_and_shows_one(program: Rebuilt) -> None:
    np.testing.assert_array_equal(program.segments.block, np.arange(len(program.segments)))
    assert (np.diff(program.seen_block) >= 0.0).all()


def test_path_without_a_line_is_refused() -> None:
    samples = seen(0.61, 0.0)
    slanted = samples[np.arange(20)]
    with pytest.raises(CalibrationError, match="no axis-parallel line"):
        rebuilt(slanted, [], rapid=RAPID)
