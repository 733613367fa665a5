"""Difference of two stocks: what their maps resolve is none, stairs and sinks are."""

import numpy as np
import pytest

from simulator.removal.difference import StockDifference, bar_difference, height_difference
from simulator.removal.lathe import BarRadii

CELLS, SIZE = 40, 0.25


def heights(*steps: tuple[float, float]) -> np.ndarray:
    """Surface of 10 × 10 mm that falls to a height from each x on."""
    x = (np.arange(CELLS) + 0.5) * SIZE
    found = np.full((CELLS, CELLS), 10.0)
    for begin, height in steps:
        found[x > begin] = height
    return found


def difference(one: np.ndarray, other: np.ndarray) -> StockDifference:
    return height_difference(one, other, cells=(SIZE, SIZE), within=SIZE)


def test_a_wall_that_lies_one_cell_aside_is_the_same() -> None:
    found = difference(heights((5.0, 2.0)), heights((5.0 + SIZE, 2.0)))
    assert not found.is_seen
    assert found.volume == pytest.approx(-8.0 * SIZE * 10.0)


def test_a_stair_that_is_left_is_more_and_the_other_way_less() -> None:
    """One step of 4 mm instead of two of 2 mm leaves 2 mm over a width of 1 mm."""
    fine, coarse = heights((4.0, 8.0), (5.0, 6.0)), heights((5.0, 6.0))
    more, less = difference(coarse, fine), difference(fine, coarse)
    assert more.deviation == pytest.approx(2.0)
    assert more.volume == pytest.approx(2.0 * 1.0 * 10.0)
    assert (less.deviation, less.volume) == pytest.approx((-2.0, -more.volume))
    assert "2 mm more" in more.words
    assert "2 mm less" in less.words


def test_a_floor_that_is_too_deep_by_ten_micrometres_is_seen() -> None:
    found = difference(heights((5.0, 1.99)), heights((5.0, 2.0)))
    assert found.deviation == pytest.approx(-0.01)


def test_steps_within_the_resolution_are_a_slope() -> None:
    """Stairs of half a cell, and the slope that they follow."""
    x = (np.arange(CELLS) + 0.5) * SIZE
    slope = np.repeat((10.0 - x)[:, None], CELLS, axis=1)
    stairs = np.floor(slope / (0.5 * SIZE)) * 0.5 * SIZE
    assert not difference(stairs, slope).is_seen


def test_a_bar_and_its_bore_differ_by_their_radii() -> None:
    outer, inner = np.full(200, 20.0), np.full(200, 5.0)
    bar = BarRadii(outer=outer, inner=inner)
    thicker = BarRadii(outer=np.where(np.arange(200) < 50, 20.4, outer), inner=inner)
    wider = BarRadii(outer=outer, inner=inner + 0.2)
    assert not bar_difference(bar, bar, cell=0.01, within=0.01).is_seen
    more = bar_difference(thicker, bar, cell=0.01, within=0.01)
    assert more.deviation == pytest.approx(0.4)
    assert more.volume == pytest.approx(np.pi * (20.4**2 - 20.0**2) * 0.5)
    assert bar_difference(wider, bar, cell=0.01, within=0.01).deviation == pytest.approx(-0.2)
