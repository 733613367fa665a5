"""Corners found again from positions that were rounded."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.logged_path.corners import Corners, CornerSamples, fitted
from benchmarks.logged_path.rounded import rounded

STEP = np.array([1.0, 0.1])


def elbow(offset: float, radius: float) -> tuple[Corners, CornerSamples]:
    """A corner of X = offset and Y = 0, and its samples rounded to 1 mm and 0.1 mm."""
    vertices = np.array([[offset - 12.0, 0.0, 0.0], [offset, 0.0, 0.0], [offset, 12.0, 0.0]])
    path = rounded(vertices, np.array([0.0, radius, 0.0]))
    rows = np.repeat(np.arange(len(path)), 60)
    along = np.tile(np.linspace(0.0, 1.0, 60), len(path)) * path.length[rows]
    point = np.round(path.position(rows, along)[:, :2] / STEP) * STEP
    truth = Corners(
        offset=np.array([0.0, offset]),
        is_along_x=np.array([1, 0]),
        side=np.array([[-1.0, 1.0]]),
        radius=np.array([radius]),
    )
    samples = CornerSamples(
        corner=np.zeros(len(rows), dtype=np.int64),
        point=point,
        half_step=np.tile(0.5 * STEP, (len(rows), 1)),
    )
    return truth, samples


@settings(max_examples=20)
@given(offset=st.floats(140.0, 141.0), radius=st.floats(1.5, 5.0))
def test_corner_is_as_long_as_it_was(offset: float, radius: float) -> None:
    truth, samples = elbow(offset, radius)
    guess = replace(truth, offset=np.array([0.0, np.round(offset)]), radius=np.zeros(1))
    found = fitted(guess, samples, longest=np.array([12.0]))
    assert found.offset[0] == pytest.approx(0.0, abs=0.1)
    # An arc saves 2 - π/2 of its radius; where the line lies adds to the way or saves of it.
    longer = (found.offset[1] - offset) - (2.0 - pi / 2.0) * (found.radius[0] - radius)
    assert abs(longer) < 0.75


def test_sharp_corner_has_no_radius() -> None:
    truth, samples = elbow(140.3, 0.0)
    found = fitted(truth, samples, longest=np.array([12.0]))
    assert found.radius[0] == pytest.approx(0.0, abs=0.35)


def test_vertex_is_where_the_lines_meet() -> None:
    truth, _ = elbow(140.3, 2.0)
    np.testing.assert_allclose(truth.vertex, [[140.3, 0.0]])
