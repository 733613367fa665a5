"""What a tool that goes straight down cuts at a place, and the hole it leaves there."""

from math import pi, tan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.motion.segments import lines
from simulator.removal.cutter import Cutter, CutterProfile, profile_of
from simulator.removal.engage import MillingStock
from simulator.removal.rim import FORGETTING, past
from simulator.removal.sink import LIP_ERROR, hole, lip
from simulator.removal.zmap import zmap_of
from stepnc_model.programs.program import Stock
from tests.every_case import every_case

PLATE = Stock(low=(0.0, 0.0, -12.0), high=(30.0, 30.0, 0.0))
X, Y = 15.0, 15.0
CELL = 0.1
GRID = zmap_of(PLATE, cell=CELL).grid
FLAT = Cutter(diameter=10.0)
CONE = Cutter(diameter=10.0, point_angle=0.5 * pi)
"""as deep as it is wide: a radius of 1 mm at 1 mm over its tip"""


def profile(cutter: Cutter) -> CutterProfile:
    return profile_of(cutter, reach=12.0)


def sunk(cutter: Cutter, *depths: float) -> MillingStock:
    """The plate after a tool went down at its middle, and on from there."""
    work = MillingStock(PLATE, cell=CELL)
    work.cut(lines([(X, Y, 5.0), *[(X, Y, -depth) for depth in depths]], speed=1.0), cutter)
    return work


def radius_left(work: MillingStock, level: float, *, x: float = X, y: float = Y) -> float:
    return hole(work.map.grid, work._past, (x, y, level))


@pytest.fixture(scope="module")
def flat_hole() -> MillingStock:
    return sunk(FLAT, 6.0)


@pytest.fixture(scope="module")
def cone_hole() -> MillingStock:
    return sunk(CONE, 6.0)


@given(point_angle=st.floats(0.3 * pi, 0.9 * pi), share=st.floats(0.05, 0.95))
def test_a_cone_sunk_into_a_plate_cuts_as_wide_as_it_is_at_the_surface(
    point_angle: float, share: float
) -> None:
    """``r = t·tan(ε/2)`` at a depth t."""
    cone = profile_of(Cutter(diameter=10.0, point_angle=point_angle), reach=12.0)
    depth = share * 5.0 / tan(0.5 * point_angle)
    inner, outer = lip(GRID, cone, X, Y, -depth)
    assert inner == 0.0
    assert outer == pytest.approx(5.0 * share, abs=1e-6)


def test_past_its_point_a_drill_cuts_with_all_of_its_lips() -> None:
    assert lip(GRID, profile(CONE), X, Y, -5.5) == (0.0, 5.0)


def test_a_flat_tool_cuts_with_all_of_its_end_from_the_first_touch() -> None:
    assert lip(GRID, profile(FLAT), X, Y, -1e-6) == (0.0, 5.0)


@every_case("cutter", [FLAT, CONE])
@every_case("place", [(X, Y, 0.0), (X, Y, 3.0), (60.0, Y, -5.0)])
def test_above_or_beside_the_stock_nothing_is_cut(
    cutter: Cutter, place: tuple[float, float, float]
) -> None:
    inner, outer = lip(GRID, profile(cutter), *place)
    assert outer == 0.0
    assert inner == 5.0


def test_half_beside_the_stock_the_lips_cut_on_the_other_half() -> None:
    assert lip(GRID, profile(FLAT), 0.0, Y, -1.0) == (0.0, 5.0)


@pytest.mark.parametrize("pilot", [2.0, 5.0, 8.0])
def test_after_a_pilot_hole_the_lips_cut_outside_it(pilot: float) -> None:
    work = sunk(Cutter(diameter=pilot), 6.0)
    inner, outer = lip(work.map.grid, profile(FLAT), X, Y, -3.0)
    assert outer == 5.0
    assert inner == pytest.approx(0.5 * pilot, abs=LIP_ERROR * 5.0 + CELL)


def test_below_the_pilot_hole_all_of_the_end_cuts_again() -> None:
    work = sunk(Cutter(diameter=6.0), 6.0)
    assert lip(work.map.grid, profile(FLAT), X, Y, -6.5) == (0.0, 5.0)


def test_a_tip_that_is_through_cuts_only_where_it_is_still_wider_than_its_hole() -> None:
    """The plate is 12 mm thick: a drill of 90° at 13 mm left 1 mm of radius at the bottom."""
    work = sunk(CONE, 13.0)
    inner, outer = lip(work.map.grid, profile(CONE), X, Y, -14.0)
    assert outer == 5.0
    assert inner == pytest.approx(1.0, abs=LIP_ERROR * 5.0 + CELL)


@given(level=st.floats(-6.0, 0.0))
def test_a_flat_tool_leaves_its_radius_at_every_height(
    flat_hole: MillingStock, level: float
) -> None:
    assert radius_left(flat_hole, level) == 5.0


@given(above=st.floats(2.0 * CELL, 5.0))
def test_a_cone_leaves_its_own_radius_at_a_height_over_its_tip(
    cone_hole: MillingStock, above: float
) -> None:
    """``r = t·tan(ε/2)``, not a multiple of the cells."""
    assert radius_left(cone_hole, -6.0 + above) == pytest.approx(above, rel=1e-9)


def test_below_the_bottom_of_a_hole_there_is_none(
    flat_hole: MillingStock, cone_hole: MillingStock
) -> None:
    assert radius_left(flat_hole, -6.01) == 0.0
    assert radius_left(cone_hole, -6.01) == 0.0


@pytest.mark.parametrize("place", [(X + 0.01, Y), (2.0, 2.0), (-1.0, Y), (X, 30.5)])
def test_a_hole_is_told_on_its_axis_only(
    flat_hole: MillingStock, place: tuple[float, float]
) -> None:
    assert radius_left(flat_hole, -1.0, x=place[0], y=place[1]) == 0.0


def test_pecking_deepens_one_hole() -> None:
    assert radius_left(sunk(FLAT, 2.0, 0.5, 6.0), -5.0) == 5.0


def test_a_wider_tool_that_went_less_deep_does_not_widen_what_is_below() -> None:
    work = sunk(Cutter(diameter=4.0), 8.0)
    work.cut(lines([(X, Y, 5.0), (X, Y, -3.0)], speed=1.0), FLAT)
    assert radius_left(work, -5.0) == 2.0


def test_where_a_point_left_through_the_bottom_no_hole_is_told_wider_than_it_is() -> None:
    """The tip stops 2 mm below the plate; the axis was free before, and knows no more."""
    work = sunk(CONE, 14.0)
    assert radius_left(work, -2.0) == 5.0
    assert 0.0 < radius_left(work, -12.0) <= 2.0
    assert radius_left(work, -13.5) == radius_left(work, -12.0)


def test_a_slot_is_no_hole() -> None:
    work = MillingStock(PLATE, cell=CELL)
    work.cut(lines([(5.0, Y, -2.0), (25.0, Y, -2.0)], speed=1.0), FLAT)
    assert radius_left(work, -1.0) == 0.0


def test_a_hole_that_is_milled_away_is_none() -> None:
    work = sunk(Cutter(diameter=4.0), 6.0)
    work.cut(lines([(5.0, Y, -8.0), (25.0, Y, -8.0)], speed=1.0), FLAT)
    assert radius_left(work, -1.0) == 0.0


def test_what_was_sunk_too_many_moves_ago_is_forgotten() -> None:
    work = sunk(FLAT, 6.0)
    work._past.next[0] += FORGETTING
    assert radius_left(work, -1.0) == 0.0


def test_in_a_new_plate_there_is_no_hole() -> None:
    assert hole(GRID, past(), (X, Y, -1.0)) == 0.0
