"""Walls and floors: how far a cutter must stay away, worked out from the drawing."""

from math import radians, sqrt, tan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.entities.entity import Entity
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.milling.contour import area, circle, clockwise, polygon
from stepnc_model.toolpath.milling.cover import (
    Area,
    Flank,
    Wall,
    chord,
    extra,
    leaning,
    rounding,
    upright,
)
from stepnc_model.toolpath.milling.strategy import EndMillShape

FLAT = EndMillShape(radius=5.0)
BALL = EndMillShape(radius=5.0, corner=5.0)
SQUARE = polygon([0j, 40 + 0j, 40 + 40j, 40j])
REF = Ref[Entity](1)


def test_chord_of_a_circle_above_its_lowest_point() -> None:
    assert [chord(5.0, h) for h in (0.0, 2.0, 5.0, 9.0)] == pytest.approx([0.0, 4.0, 5.0, 5.0])


def test_rounding_goes_from_its_radius_at_the_floor_to_nothing() -> None:
    assert [rounding(h, 5.0) for h in (0.0, 2.0, 5.0, 6.0)] == pytest.approx([5, 1, 0, 0])


def test_wall_leans_in_by_the_tangent_of_its_angle() -> None:
    wall = leaning(depth=10.0, slope_deg=5.0)
    assert wall(10.0) == 0.0
    assert wall(0.0) == pytest.approx(10.0 * tan(radians(5.0)))
    assert leaning(depth=10.0, slope_deg=None) is upright


def test_flat_cutter_at_a_leaning_wall_touches_with_its_tip() -> None:
    wall = leaning(depth=10.0, slope_deg=5.0)
    found = extra(wall, FLAT, bottom=4.0, top=10.0)
    assert found == pytest.approx(6.0 * tan(radians(5.0)))


def test_ball_at_a_leaning_wall_touches_above_its_tip() -> None:
    """Tangent: the middle of the ball stays R·√(1 + t²) from the wall in the plane, at the
    height of the middle; the wall there stands (10 - 5)·t in."""
    slope = tan(radians(30.0))
    found = extra(leaning(depth=10.0, slope_deg=30.0), BALL, bottom=0.0, top=10.0)
    assert found == pytest.approx(5.0 * sqrt(1.0 + slope**2) + 5.0 * slope - 5.0, abs=1e-9)


def test_ball_follows_a_radius_of_its_own_size_without_a_gap() -> None:
    assert extra(
        leaning(depth=20.0, slope_deg=None, fillet=5.0), BALL, bottom=0.0, top=20.0
    ) == (pytest.approx(0.0, abs=1e-9))


def test_flat_cutter_on_the_floor_keeps_clear_of_the_radius() -> None:
    wall = leaning(depth=20.0, slope_deg=None, fillet=3.0)
    assert extra(wall, FLAT, bottom=0.0, top=20.0) == pytest.approx(3.0)


def test_tapered_cutter_in_an_upright_hole_touches_at_the_top() -> None:
    cutter = EndMillShape(radius=5.0, taper=0.1)
    assert extra(upright, cutter, bottom=2.0, top=12.0) == pytest.approx(1.0)


def test_tapered_cutter_fits_a_wall_of_its_own_angle() -> None:
    cutter = EndMillShape(radius=5.0, taper=tan(radians(5.0)))
    wall = leaning(depth=10.0, slope_deg=5.0)
    assert extra(wall, cutter, bottom=0.0, top=10.0) == pytest.approx(10.0 * tan(radians(5.0)))


@given(
    slope=st.floats(0.0, 40.0),
    fillet=st.floats(0.0, 8.0),
    corner=st.floats(0.0, 5.0),
    taper=st.floats(0.0, 0.3),
    bottom=st.floats(0.0, 15.0),
)
def test_no_height_of_the_cutter_is_in_the_wall(
    slope: float, fillet: float, corner: float, taper: float, bottom: float
) -> None:
    """And at one height at least it touches, unless an upright wall alone keeps it away."""
    wall = leaning(depth=16.0, slope_deg=slope, fillet=fillet)
    cutter = EndMillShape(radius=5.0, corner=corner, taper=taper)
    away = extra(wall, cutter, bottom=bottom, top=16.0)
    # Fillets and corners are steep at the tip: look closer there.
    heights = [(16.0 - bottom) * (i / 997) ** 2 for i in range(998)]
    gaps = [5.0 + away - cutter.reach(h) - wall(bottom + h) for h in heights]
    assert min(gaps) >= -1e-6
    assert away == 0.0 or min(gaps) < 0.02


def boxed(*walls: Wall) -> Area:
    return Area(ref=REF, walls=walls, top=0.0, bottom=-10.0)


def test_walls_stand_in_by_their_lean_at_each_height() -> None:
    (loop,) = boxed(Wall(loop=SQUARE, inset=leaning(depth=10.0, slope_deg=45.0))).boundaries(
        -6.0, FLAT
    )
    assert area(loop) == pytest.approx(28.0**2)


def test_island_counts_only_below_its_own_top() -> None:
    island = Wall(loop=clockwise(circle(20 + 20j, 5.0)), inset=upright, top=-4.0)
    found = boxed(Wall(loop=SQUARE, inset=upright), island)
    assert len(found.boundaries(-3.0, FLAT)) == 1
    assert len(found.boundaries(-4.0, FLAT)) == 1
    assert len(found.boundaries(-5.0, FLAT)) == 2
    assert found.terraces == [-4.0]


def test_walls_that_meet_leave_no_boundary_though_an_island_stands() -> None:
    wall = Wall(loop=SQUARE, inset=leaning(depth=10.0, slope_deg=80.0))
    island = Wall(loop=clockwise(circle(20 + 20j, 5.0)), inset=upright)
    assert boxed(wall, island).boundaries(-9.0, FLAT) == ()


def test_depth_is_from_top_to_bottom() -> None:
    flank = Flank(ref=REF, chain=SQUARE, is_closed=True, inset=upright, top=2.0, bottom=-7.0)
    assert flank.depth == 9.0
    assert boxed().depth == 10.0
