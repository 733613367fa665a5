"""A trial leaves no trace, and what it made can be taken as if it had been cut."""

from dataclasses import replace
from math import pi
from typing import Any

import numpy as np
import pytest

from simulator.motion.segments import Segments, arc, chained, lines
from simulator.removal.cutter import Cutter
from simulator.removal.engage import MillingStock
from simulator.removal.rim import FORGETTING
from simulator.removal.trial import (
    PathTrial,
    box_of,
    do_overlap,
    is_remembered_alike,
    renumbered,
)
from stepnc_model.programs.program import Stock

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


def test_an_arc_reaches_as_far_as_it_bulges() -> None:
    """From (20, 10) a quarter turn about (10, 10): never left of 10, never below 10."""
    stock = MillingStock(BOX, cell=0.5)
    quarter = arc((20.0, 10.0, -1.0), (10.0, 10.0, -1.0), 0.5 * pi, speed=10.0)
    columns, rows = box_of(stock.map.grid, quarter, 1.0)
    assert (columns.start, columns.stop) == (16, 44)
    assert (rows.start, rows.stop) == (16, 44)
    wide = arc((20.0, 10.0, -1.0), (10.0, 10.0, -1.0), -0.5 * pi, speed=10.0)
    columns, rows = box_of(stock.map.grid, wide, 1.0)
    assert (columns.start, columns.stop) == (16, 44)
    assert (rows.start, rows.stop) == (0, 24)


def test_boxes_that_only_touch_do_not_overlap() -> None:
    one = slice(0, 4), slice(0, 4)
    assert do_overlap(one, (slice(3, 9), slice(0, 1)))
    assert not do_overlap(one, (slice(4, 9), slice(0, 4)))
    assert not do_overlap(one, (slice(0, 0), slice(0, 0)))


def test_what_another_has_made_before_shifts_the_numbers() -> None:
    """Two places, cut in either order: only the numbers of the moves differ."""
    straight, other = MillingStock(BOX, cell=0.5), MillingStock(BOX, cell=0.5)
    copy = MillingStock(BOX, cell=0.5)
    straight.cut(path(10.0), MILL)
    straight.cut(path(40.0), MILL)
    straight.cut(path(43.0), MILL)
    other.cut(path(10.0), MILL)
    numbers: dict[int, int] = {}
    for x in (40.0, 43.0):
        _, trial = copy.tried(path(x), MILL)
        copy.take(trial.after)
        numbers[trial.before.next] = other.next_move
        other.take(renumbered(trial, other.next_move, numbers))
    assert state(other) == state(straight)


def test_outlines_must_be_remembered_in_both_or_in_neither() -> None:
    stock = MillingStock(BOX, cell=0.5)
    stock.cut(path(10.0), MILL)
    _, trial = stock.tried(path(12.0), MILL)
    assert is_remembered_alike(trial, 0)
    assert is_remembered_alike(trial, 100)
    assert not is_remembered_alike(trial, FORGETTING - 3)
    late = replace(trial.before, next=trial.before.next + 2 * FORGETTING)
    after = replace(trial.after, next=trial.after.next + 2 * FORGETTING)
    assert is_remembered_alike(PathTrial(before=late, after=after), FORGETTING - 3)
