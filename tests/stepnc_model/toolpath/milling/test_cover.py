"""Rings within rings: where they lie, in which order, and what they sweep."""

from math import ceil, pi

import pytest

from stepnc_model.toolpath.milling.contour import area, circle, clockwise, line, polygon
from stepnc_model.toolpath.milling.cover import MillingPass, area_of, rings, swept

SQUARE = polygon([0j, 40 + 0j, 40 + 40j, 40j])


def test_rings_of_a_square_are_squares_from_the_inside_out() -> None:
    """Centres 5, 10, 15 mm from the walls: squares of 10, 20 and 30 mm."""
    found = rings([SQUARE], distance=5.0, radius=5.0, step=5.0)
    assert [area(each.chain) for each in found] == pytest.approx([100.0, 400.0, 900.0])
    assert all(each.is_closed for each in found)


def test_allowance_keeps_the_outermost_ring_away() -> None:
    found = rings([SQUARE], distance=5.5, radius=5.0, step=5.0)
    assert area(found[-1].chain) == pytest.approx(29.0**2)


def test_rings_around_an_island_run_clockwise() -> None:
    found = rings(
        [SQUARE, clockwise(circle(20 + 20j, 5.0))], distance=2.0, radius=2.0, step=2.0
    )
    assert any(area(each.chain) == pytest.approx(-49.0 * pi) for each in found)


def test_cutter_that_does_not_fit_makes_no_ring() -> None:
    assert rings([SQUARE], distance=21.0, radius=21.0, step=5.0) == ()


@pytest.mark.parametrize("step", [3.0, 5.0, 6.5, 8.0, 9.5])
def test_square_is_swept_whole_but_for_the_corners_of_a_round_tool(step: float) -> None:
    """Steps above the radius would leave islands in the corners and in the middle."""
    found = rings([SQUARE], distance=5.0, radius=5.0, step=step)
    assert swept(found, 5.0).area == pytest.approx(1600.0 - (4.0 - pi) * 25.0, abs=0.1)


def test_steps_too_small_for_an_area_are_refused() -> None:
    with pytest.raises(ValueError, match="more than 2000 rings"):
        rings([polygon([0j, 9e3 + 0j, 9e3 + 9e3j, 9e3j])], distance=1.0, radius=1.0, step=1.0)


def test_number_of_rings_follows_from_the_step() -> None:
    found = rings([circle(0j, 50.0)], distance=5.0, radius=5.0, step=4.0)
    assert len(found) == ceil(45.0 / 4.0)


def test_swept_area_of_a_stroke_is_a_stadium() -> None:
    stroke = MillingPass((line(0j, 10 + 0j),), is_closed=False)
    assert swept([stroke], 2.0).area == pytest.approx(40.0 + 4.0 * pi, rel=1e-3)


def test_area_of_loops_is_less_their_islands() -> None:
    loops = [SQUARE, clockwise(circle(20 + 20j, 5.0))]
    assert area_of(loops).area == pytest.approx(1600.0 - 25.0 * pi, rel=1e-3)


def test_pass_starts_where_it_is_nearest_to_the_tool() -> None:
    loop = MillingPass(SQUARE, is_closed=True)
    assert loop.from_near(20 - 9j).start == pytest.approx(20 + 0j)
    assert loop.from_near(None) is loop
    stroke = MillingPass((line(0j, 1 + 0j),), is_closed=False)
    assert stroke.from_near(9 + 0j) is stroke
