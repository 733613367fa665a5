"""Parallel strokes: where they lie, how they are joined, and that no link cuts a corner."""

from collections.abc import Sequence

import pytest
import shapely
from shapely import LineString

from stepnc_model.toolpath.milling.contour import (
    Loop,
    circle,
    clockwise,
    polygon,
    shape,
    vertices,
)
from stepnc_model.toolpath.milling.cover import MillingPass
from stepnc_model.toolpath.milling.strokes import (
    contains_point,
    is_inside,
    linked,
    rows_at,
    scan,
    singles,
    zigzags,
)

FIELD = polygon([0j, 40 + 0j, 40 + 20j, 20j])
ISLAND = clockwise(circle(20 + 10j, 5.0))
COMB = polygon([0j, 30, 30 + 20j, 20 + 20j, 20 + 5j, 10 + 5j, 10 + 20j, 20j])
"""two teeth upwards"""


def to_and_fro(
    loops: Sequence[Loop], *, along: complex, step: float
) -> tuple[MillingPass, ...]:
    """Strokes over an area in alternating directions."""
    return zigzags(scan(loops, along=along, step=step), loops)


def stays_inside(passes: tuple[MillingPass, ...], loops: list[Loop]) -> bool:
    solid = shape(loops[0], tolerance=1e-4)
    for loop in loops[1:]:
        solid -= shape(loop, tolerance=1e-4)
    lines = [
        LineString([(p.real, p.imag) for p in [*vertices(cut.chain, tolerance=1e-4), cut.end]])
        for cut in passes
    ]
    return bool(shapely.covers(solid.buffer(1e-3), lines).all())


def test_strokes_alternate_and_are_joined_to_one_pass() -> None:
    (found,) = to_and_fro([FIELD], along=1 + 0j, step=10.0)
    points = [found.start, *(edge.end for edge in found.chain)]
    expected = [0, 40, 40 + 10j, 10j, 20j, 40 + 20j]
    assert points == pytest.approx(expected, abs=1e-5)


def test_strokes_one_way_are_passes_of_their_own_in_one_direction() -> None:
    found = singles(scan([FIELD], along=-1 + 0j, step=10.0))
    assert len(found) == 3
    assert all(cut.chain[0].along(0.0) == pytest.approx(-1 + 0j) for cut in found)
    # The right of a way along -x is the side of greater y.
    assert [cut.start.imag for cut in found] == pytest.approx([20.0, 10.0, 0.0], abs=1e-5)


def test_rows_are_equally_far_apart_and_never_further_than_the_step() -> None:
    heights = [row[0].low.imag for row in scan([FIELD], along=1 + 0j, step=7.0)]
    assert heights == pytest.approx([0.0, 20 / 3, 40 / 3, 20.0], abs=1e-5)


def test_rows_lie_where_they_are_asked_for() -> None:
    ((stroke,),) = rows_at([FIELD], [12.5], along=1 + 0j)
    assert (stroke.low, stroke.high) == pytest.approx((12.5j, 40 + 12.5j))


def test_row_through_an_island_is_two_strokes() -> None:
    ((first, second),) = rows_at([FIELD, ISLAND], [10.0], along=1 + 0j)
    assert (first.high, second.low) == pytest.approx((15 + 10j, 25 + 10j))


def test_links_follow_the_wall_of_an_island() -> None:
    for step in (1.0, 2.5, 4.0):
        passes = to_and_fro([FIELD, ISLAND], along=1 + 0j, step=step)
        assert stays_inside(passes, [FIELD, ISLAND])


@pytest.mark.parametrize("along", [1 + 0j, 1j, (0.6 + 0.8j)])
def test_no_link_cuts_through_what_stands_between_two_teeth(along: complex) -> None:
    passes = to_and_fro([COMB], along=along, step=1.7)
    assert stays_inside(passes, [COMB])


def test_strokes_that_no_way_inside_joins_are_passes_of_their_own() -> None:
    apart = [polygon([0j, 4, 4 + 4j, 4j]), polygon([2 + 5j, 6 + 5j, 6 + 9j, 2 + 9j])]
    passes = to_and_fro(apart, along=1 + 0j, step=3.0)
    assert len(passes) >= 2
    assert all(any(stays_inside((cut,), [part]) for part in apart) for cut in passes)


def test_link_is_straight_where_that_stays_inside() -> None:
    way = linked(1 + 1j, 39 + 1j, [FIELD, ISLAND])
    assert way is not None
    assert len(way) == 1
    assert linked(1 + 10j, 39 + 10j, [FIELD, ISLAND]) is None


def test_straight_way_through_an_island_is_not_inside() -> None:
    assert not is_inside(1 + 10j, 39 + 10j, [FIELD, ISLAND])
    assert is_inside(1 + 1j, 39 + 1j, [FIELD, ISLAND])


def test_boundary_belongs_to_the_area_and_an_island_does_not() -> None:
    assert contains_point(0j, [FIELD, ISLAND])
    assert not contains_point(20 + 10j, [FIELD, ISLAND])
    assert not contains_point(41 + 1j, [FIELD, ISLAND])


def test_nothing_to_cover_makes_no_stroke() -> None:
    assert to_and_fro([], along=1 + 0j, step=1.0) == ()


def test_more_strokes_than_any_machine_makes_are_refused() -> None:
    with pytest.raises(ValueError, match="parallel strokes"):
        scan([FIELD], along=1 + 0j, step=1e-4)
