"""A trial leaves no trace, and what it made can be taken as if it had been cut."""

from math import pi
from typing import Any

import numpy as np
import pytest

from simulator.motion.segments import Segments, arc, chained, lines
from simulator.removal.cutter import Cutter
from simulator.removal.engage import MillingStock
from simulator.removal.trial import box_of
from stepnc_model.toolpath.job import Stock

BOX = Stock(low=(0.0, 0.0, -20.0), high=(60.0, 40.0, 0.0))
MILL = Cutter(diameter=8.0)


def path(x: float) -> Segments:
    """Along y, with half a turn on the way, and back at another height."""
    return chained([
        lines([(x, 5.0, 5.0), (x, 5.0, -2.0), (x, 15.0, -2.0)], speed=10.0),
        arc((x, 15.0, -2.0), centre=(x, 20.0, -2.0), turn=pi, speed=10.0),
        lines([(x, 25.0, -2.0), (x, 35.0, -4.0), (x, 35.0, 5.0)], speed=10.0),
    ])


def state(stock: MillingStock) -> list[Any]:
    grid, past = stock.map.grid, stock._past
    parts = (grid.heights, grid.owner, past.records, past.next)
    return [part.ravel().tolist() for part in parts]


def test_a_trial_leaves_no_trace() -> None:
    stock = MillingStock(BOX, cell=0.5)
    stock.cut(path(10.0), MILL)
    before, volume = state(stock), stock.volume
    stock.tried(path(12.0), MILL)
    assert state(stock) == before
    assert stock.volume == volume
    assert not stock.collisions


def test_what_a_trial_made_can_be_taken() -> None:
    tried, cut = MillingStock(BOX, cell=0.5), MillingStock(BOX, cell=0.5)
    for x in (10.0, 13.0, 40.0):
        told, trial = tried.tried(path(x), MILL)
        tried.take(trial.after)
        met = cut.cut(path(x), MILL)
        assert (told.section == met.section).all()
        assert (told.entry_angle == met.entry_angle).all()
    assert state(tried) == state(cut)


@pytest.mark.parametrize("x", [-30.0, 3.0, 30.0, 59.0])
def test_what_changes_lies_within_the_box(x: float) -> None:
    stock = MillingStock(BOX, cell=0.5)
    grid = stock.map.grid
    outside = np.ones(grid.heights.shape, dtype=bool)
    outside[box_of(grid, path(x), 4.0)] = False
    stock.cut(path(x), MILL)
    assert (grid.heights[outside] == 0.0).all()


def test_a_path_above_the_stock_has_an_empty_box() -> None:
    stock = MillingStock(BOX, cell=0.5)
    over = lines([(0.0, 0.0, 5.0), (60.0, 40.0, 5.0)])
    box = box_of(stock.map.grid, over, 4.0)
    assert stock.map.grid.heights[box].size == 0
