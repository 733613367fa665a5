"""Crossings and distances of many edges, against places worked out by hand."""

from math import pi, sqrt

import numpy as np
import pytest

from stepnc_model.toolpath.milling.contour import ContourEdge, circle, line, polygon
from stepnc_model.toolpath.milling.offset import (
    ContourEdges,
    crossings,
    crossings_with,
    distances,
)

ARC = ContourEdge(5 + 0j, -5 + 0j, 0j, pi)


def test_two_lines_cross_at_their_middles() -> None:
    found = crossings([line(0j, 2 + 2j), line(2j, 2 + 0j)])
    assert found == [pytest.approx([0.5]), pytest.approx([0.5])]


def test_line_crosses_a_circle_twice() -> None:
    """At y = 3 a circle of 5 has x = ±4."""
    (parts,) = crossings_with([line(-10 + 3j, 10 + 3j)], circle(0j, 5.0))
    assert parts == pytest.approx([0.3, 0.7])


def test_tangent_touches_once_or_twice_at_the_same_place() -> None:
    (parts,) = crossings_with([line(-10 + 5j, 10 + 5j)], [ARC])
    assert parts
    assert parts == pytest.approx([0.5] * len(parts), abs=1e-4)


def test_circles_cross_where_their_radii_meet() -> None:
    """Two of 5 mm, 6 mm apart, cross at x = 3, y = 4."""
    other = ContourEdge(11 + 0j, 1 + 0j, 6 + 0j, pi)
    (parts,) = crossings_with([ARC], [other])
    assert [ARC.at(part) for part in parts] == pytest.approx([3 + 4j])


@pytest.mark.parametrize(
    "other",
    [line(0j + 1, 2 + 1j), line(20 + 0j, 21 + 1j), ContourEdge(6 + 0j, -6 + 0j, 0j, pi)],
)
def test_what_does_not_reach_does_not_cross(other: ContourEdge) -> None:
    assert crossings_with([line(-1 + 0j, -1 + 1j)], [other]) == [[]]


def test_parallel_and_concentric_edges_do_not_cross() -> None:
    assert crossings([line(0j, 4 + 0j), line(1j, 4 + 1j)]) == [[], []]
    assert crossings([ARC, ContourEdge(3 + 0j, -3 + 0j, 0j, pi)]) == [[], []]


def test_distance_from_a_line_is_square_to_it_or_from_its_end() -> None:
    edges = ContourEdges.of([line(0j, 10 + 0j)])
    points = np.array([5 + 3j, 13 + 4j, -3 - 4j])
    assert distances(points, edges) == pytest.approx([3.0, 5.0, 5.0])


def test_distance_from_an_arc_is_along_the_spoke_or_from_its_end() -> None:
    points = np.array([7j, 2j, 5 - 12j, 0j])
    assert distances(points, ContourEdges.of([ARC])) == pytest.approx([2.0, 3.0, 12.0, 5.0])


def test_distance_is_that_of_the_nearest_edge() -> None:
    edges = ContourEdges.of([*polygon([0j, 10 + 0j, 10 + 10j, 10j]), *circle(5 + 5j, 1.0)])
    found = distances(np.array([5 + 5j, 1 + 4j, 3 + 3j]), edges)
    assert found == pytest.approx([1.0, 1.0, sqrt(8.0) - 1.0])


def test_box_of_an_arc_holds_it() -> None:
    for turn in (0.1, pi, -2.0):
        arc = ContourEdge(5 + 0j, 5 * complex(np.cos(turn), np.sin(turn)), 0j, turn)
        x0, y0, x1, y1 = (float(side[0]) for side in ContourEdges.of([arc]).boxes())
        for point in (arc.at(i / 50) for i in range(51)):
            assert x0 - 1e-12 <= point.real <= x1 + 1e-12
            assert y0 - 1e-12 <= point.imag <= y1 + 1e-12
