"""What is read again is what the march would meet, also where a block was split."""

from math import pi

import numpy as np
import pytest

from simulator.motion.segments import Segments, lines
from simulator.removal.cutter import Cutter
from simulator.removal.engage import MillingStock
from simulator.removal.march_cache import KeptMarches
from simulator.removal.stations import Stations
from stepnc_model.programs.program import Stock

BOX = Stock(low=(0.0, 0.0, -10.0), high=(80.0, 40.0, 0.0))
CUTTERS = {
    "flat": Cutter(diameter=8.0),
    "bull": Cutter(diameter=8.0, corner_radius=2.0),
    "ball": Cutter(diameter=8.0, corner_radius=4.0),
}


def raster(*, speed: float = 10.0, split: bool = False) -> Segments:
    """Lines over a waved surface, of 1500 rows; one of them in two halves if split."""
    points = [
        (2.0 + 0.3 * column if row % 2 == 0 else 78.0 - 0.3 * column, 4.0 + 5.5 * row,
         -2.0 - 1.5 * np.sin(0.1 * column * pi))
        for row in range(6)
        for column in range(254)
    ]  # fmt: skip
    if split:
        middle = tuple((a + b) / 2.0 for a, b in zip(points[700], points[701], strict=True))
        points.insert(701, middle)
    return lines(points, speed=speed)


def cut(
    path: Segments, cutter: Cutter, marches: KeptMarches | None
) -> tuple[MillingStock, Stations]:
    stock = MillingStock(BOX, cell=0.4)
    stock.marches = marches
    return stock, stock.cut(path, cutter)


@pytest.mark.parametrize("cutter", CUTTERS.values(), ids=CUTTERS)
@pytest.mark.parametrize("split", [False, True], ids=["whole", "split"])
def test_a_second_run_meets_what_marching_would_meet(cutter: Cutter, split: bool) -> None:
    marches = KeptMarches()
    cut(raster(), cutter, marches)
    assert marches.again == 0
    path = raster(speed=3.0, split=split)
    stock, again = cut(path, cutter, marches)
    # All rows of a run with other feeds; but for some groups where one row was divided.
    assert marches.again == len(path) if not split else 0 < marches.again < len(path)
    plain, met = cut(path, cutter, None)
    assert stock.volume == plain.volume
    assert np.array_equal(stock.map.grid.heights, plain.map.grid.heights)
    assert np.array_equal(again.section, met.section)
    assert np.array_equal(again.station, met.station)
    assert np.array_equal(again.segment, met.segment)


def test_what_is_kept_holds_where_the_tool_reaches_all_of_the_stock() -> None:
    """A box as wide as the map is no copy of its cells by itself."""
    cutter = Cutter(diameter=80.0)
    points = [(-40.0 + 0.1 * (n % 1500), 20.0, -1.0 - 0.5 * (n // 1500)) for n in range(3000)]
    path, marches = lines(points, speed=10.0), KeptMarches()
    cut(path, cutter, marches)
    stock, _ = cut(path, cutter, marches)
    assert marches.again > 0
    plain, _ = cut(path, cutter, None)
    assert stock.volume == plain.volume > 0.0
    assert np.array_equal(stock.map.grid.heights, plain.map.grid.heights)


def test_another_stock_is_marched() -> None:
    marches = KeptMarches()
    path, cutter = raster(), CUTTERS["flat"]
    cut(path, cutter, marches)
    stock = MillingStock(BOX, cell=0.4)
    stock.cut(lines([(40.0, 20.0, 5.0), (40.0, 20.0, -4.0)], speed=2.0), cutter)
    stock.marches = marches
    before = marches.again
    stock.cut(path, cutter)
    assert marches.again - before < len(path)


def test_a_path_that_runs_twice_leaves_nothing_behind() -> None:
    marches, path, cutter = KeptMarches(is_once=True), raster(), CUTTERS["bull"]
    cut(path, cutter, marches)
    stock, _ = cut(path, cutter, marches)
    plain, _ = cut(path, cutter, None)
    assert np.array_equal(stock.map.grid.heights, plain.map.grid.heights)
    assert marches.again == len(path)
    # Everything was read, so a third run marches, and a fourth reads again.
    cut(path, cutter, marches)
    assert marches.again == len(path)
    cut(path, cutter, marches)
    assert marches.again == 2 * len(path)


def test_no_more_is_kept_than_there_is_room_for() -> None:
    marches = KeptMarches(most=0)
    for _ in range(2):
        cut(raster(), CUTTERS["flat"], marches)
    assert marches.again == 0
