"""Axes stamped separately make no staircase; axes stamped together are left as they are."""

import numpy as np
import pytest

from extras.verification.axes import without_held


def circle(time: np.ndarray) -> np.ndarray:
    angle = 0.4 * time
    return np.column_stack([10.0 * np.cos(angle), 10.0 * np.sin(angle), 0.0 * time])


def test_a_staircase_becomes_the_circle_that_it_was() -> None:
    time = 0.005 * np.arange(400)
    held = circle(time)
    held[1::2, 0] = held[:-1:2, 0]
    held[2::2, 1] = held[1:-1:2, 1]
    known = without_held(held)
    assert np.isnan(known).any(axis=1).sum() > 390
    for axis in range(2):
        rows = ~np.isnan(known[:, axis])
        known[:, axis] = np.interp(time, time[rows], known[rows, axis])
    radius = np.hypot(known[5:-5, 0], known[5:-5, 1])
    # Held values are up to 0.01 mm off the circle; interpolated ones by the sagitta.
    assert np.abs(np.hypot(held[5:-5, 0], held[5:-5, 1]) - 10.0).max() > 0.005
    assert radius == pytest.approx(10.0, abs=5e-5)


def test_axes_stamped_together_stay() -> None:
    points = circle(0.01 * np.arange(200))
    assert np.array_equal(without_held(points), points)


def test_a_square_link_between_passes_stays() -> None:
    x = [*range(10), 9, 9, *range(9, 0, -1)]
    y = [*[0] * 10, 1, 2, *[2] * 9]
    points = np.column_stack([x, y, np.zeros(len(x))]).astype(np.float64)
    assert np.array_equal(without_held(points), points)
