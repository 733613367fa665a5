"""Offsets against areas in closed form, and against shapely where there is none."""

from cmath import rect
from math import pi, sqrt

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from stepnc_model.toolpath.milling.contour import (
    Loop,
    area,
    circle,
    clockwise,
    line,
    polygon,
    shape,
)
from stepnc_model.toolpath.milling.offset import (
    contains,
    dilate,
    erode,
    offset,
    offset_left,
    rounded,
)

SQUARE = polygon([0j, 10 + 0j, 10 + 10j, 10j])


def total(loops: tuple[Loop, ...]) -> float:
    return sum(map(area, loops))


def test_square_shrinks_to_a_square() -> None:
    (loop,) = erode([SQUARE], 2.0)
    assert area(loop) == pytest.approx(36.0)
    assert all(edge.centre is None for edge in loop)


def test_square_grows_by_its_sides_and_a_circle_in_its_corners() -> None:
    (loop,) = dilate([SQUARE], 2.0)
    assert area(loop) == pytest.approx(100.0 + 4 * 20.0 + 4.0 * pi)
    assert sum(edge.centre is not None for edge in loop) == 4


def test_one_outline_goes_either_way_by_its_sign() -> None:
    assert total(offset(SQUARE, 2.0)) == pytest.approx(36.0)
    assert total(offset(SQUARE, -2.0)) == pytest.approx(180.0 + 4.0 * pi)
    assert offset(SQUARE, 0.0) == (SQUARE,)


def test_circles_stay_circles() -> None:
    (inner,) = erode([circle(1j, 5.0)], 2.0)
    assert area(inner) == pytest.approx(9.0 * pi)
    assert {edge.centre for edge in inner} == {1j}
    assert erode([circle(1j, 5.0)], 5.0) == ()
    assert erode([circle(1j, 5.0)], 6.0) == ()


def test_disc_that_is_too_large_finds_no_room() -> None:
    assert erode([SQUARE], 5.001) == ()


def test_island_gets_a_ring_of_its_own() -> None:
    rings = erode([SQUARE, clockwise(circle(5 + 5j, 1.0))], 1.0)
    assert sorted(map(area, rings)) == pytest.approx([-4.0 * pi, 64.0])


def test_overlapping_islands_share_one_ring() -> None:
    islands = [clockwise(circle(x + 5j, 1.0)) for x in (4.5, 5.5)]
    rings = erode([SQUARE, *islands], 1.0)
    assert len(rings) == 2
    union = shapely.Point(4.5, 5).buffer(2, 256) | shapely.Point(5.5, 5).buffer(2, 256)
    assert min(map(area, rings)) == pytest.approx(-union.area, rel=1e-4)


def test_waist_that_is_too_narrow_leaves_two_rings() -> None:
    """Two squares of 10 joined by a neck of 2, into which the disc bulges between its corners:
    twice the area between a chord and an arc of 2 mm, over 1 mm."""
    outline = polygon([
        0j, 10, 10 + 4j, 14 + 4j, 14, 24, 24 + 10j, 14 + 10j, 14 + 6j, 10 + 6j, 10 + 10j, 10j
    ])  # fmt: skip
    bulge = 2.0 * (2.0 - 0.5 * sqrt(3.0) - pi / 3.0)
    assert sorted(map(area, erode([outline], 2.0))) == pytest.approx([36.0 + bulge] * 2)


def test_rounded_square_lacks_its_corners() -> None:
    (loop,) = rounded(SQUARE, 2.0)
    assert area(loop) == pytest.approx(100.0 - (4.0 - pi) * 4.0)
    assert rounded(SQUARE, 5.1) == ()


def test_chain_beside_a_corner_bends_around_it_outside_and_is_cut_inside() -> None:
    chain = (line(0j, 10 + 0j), line(10 + 0j, 10 + 10j))
    (left,) = offset_left(chain, 2.0)
    assert [edge.start for edge in left] == pytest.approx([2j, 8 + 2j])
    back = (line(10 + 10j, 10 + 0j), line(10 + 0j, 0j))
    (right,) = offset_left(back, 2.0)
    assert [edge.centre for edge in right] == [None, 10 + 0j, None]


def test_vertex_almost_in_line_loses_no_ring() -> None:
    """The lines at the vertex bend by 0.1°; pieces behind their crossing lead nowhere."""
    radii = [23.375, 16.705397705532185 * sqrt(2.0), 20, 20, 20, 20, 20, 55]
    outline = polygon([rect(r, 0.25 * pi * k) for k, r in enumerate(radii)])
    expected = shape(outline, tolerance=1e-4).buffer(-1.0).area
    assert total(erode([outline], 1.0)) == pytest.approx(expected, rel=1e-5)


@given(
    radii=st.lists(st.floats(10.0, 60.0), min_size=3, max_size=12),
    distance=st.floats(0.1, 15.0),
)
@settings(max_examples=200, deadline=None)
def test_area_of_any_star_agrees_with_shapely(radii: list[float], distance: float) -> None:
    count = len(radii)
    outline = polygon([rect(r, 2.0 * pi * k / count) for k, r in enumerate(radii)])
    solid = shape(outline, tolerance=1e-4)
    inner = solid.buffer(-distance, quad_segs=256)
    slack = 1e-3 * solid.length + 1e-4 * solid.area
    assert total(erode([outline], distance)) == pytest.approx(inner.area, abs=slack)
    outer = solid.buffer(distance, quad_segs=256)
    assert total(dilate([outline], distance)) == pytest.approx(outer.area, rel=1e-3)


def test_points_are_inside_on_the_left_of_every_loop() -> None:
    loops = [SQUARE, clockwise(circle(5 + 5j, 1.0))]
    points = [1 + 1j, 5 + 5j, 11 + 1j]
    assert contains(loops, points, tolerance=1e-3) == [True, False, False]
