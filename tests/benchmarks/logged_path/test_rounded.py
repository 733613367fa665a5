"""Paths with rounded corners against plane geometry."""

from math import pi, sqrt

import numpy as np
import pytest

from benchmarks.logged_path.rounded import rounded

CORNER = np.array([[0.0, 0.0, 5.0], [10.0, 0.0, 5.0], [10.0, 8.0, 5.0]])


def test_quarter_circle_joins_two_lines() -> None:
    path = rounded(CORNER, np.array([0.0, 2.0, 0.0]))
    np.testing.assert_allclose(path.length, [8.0, pi, 6.0])
    np.testing.assert_allclose(path.turn, [0.0, pi / 2.0, 0.0])
    np.testing.assert_allclose(path.centre[1, :2], [8.0, 2.0])
    np.testing.assert_allclose(path.end[:-1], path.start[1:])


def test_right_turn_is_negative() -> None:
    path = rounded(CORNER * [1.0, -1.0, 1.0], np.array([0.0, 2.0, 0.0]))
    assert path.turn[1] == pytest.approx(-pi / 2.0)


def test_slanted_corner_is_tangent() -> None:
    vertices = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [20.0, 10.0, 0.0]])
    path = rounded(vertices, np.array([0.0, 3.0, 0.0]))
    ends = path.length[np.array([0, 1, 2])]
    before = path.direction(np.array([0, 1]), ends[:2])
    after = path.direction(np.array([1, 2]), np.zeros(2))
    np.testing.assert_allclose(before, after, atol=1e-12)
    assert path.radius[1] == pytest.approx(3.0)


def test_corner_without_a_radius_stays_sharp() -> None:
    path = rounded(CORNER, np.zeros(3))
    np.testing.assert_allclose(path.length, [10.0, 8.0])


def test_arcs_that_do_not_fit_are_made_smaller() -> None:
    vertices = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 4.0, 0.0], [0.0, 4.0, 0.0]])
    path = rounded(vertices, np.array([0.0, 3.0, 3.0, 0.0]))
    np.testing.assert_allclose(path.radius[path.turn != 0.0], [2.0, 2.0])


def test_vertex_that_repeats_is_one() -> None:
    vertices = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [3.0, 0.0, 4.0]])
    assert rounded(vertices, np.zeros(3)).length == pytest.approx([5.0])


def test_slanted_line_in_space_keeps_its_length() -> None:
    vertices = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [1.0, 1.0, 3.0]])
    np.testing.assert_allclose(rounded(vertices, np.zeros(3)).length, [sqrt(3.0), 2.0])
