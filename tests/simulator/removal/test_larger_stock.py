"""Stock that is larger all around by a margin."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.motion.segments import Floats
from simulator.removal.engage import MillingStock
from simulator.removal.larger_stock import grown_milling_stock, grown_turning_stock
from simulator.removal.lathe import TurningStock
from simulator.removal.zmap import zmap_of_heights
from stepnc_model.programs.program import Stock

BOX = Stock(low=(0.0, 0.0, -10.0), high=(12.0, 8.0, 0.0))
BAR = Stock(low=(-10.0, -10.0, -20.0), high=(10.0, 10.0, 0.0), radius=10.0)


def stepped() -> MillingStock:
    """Block of 1 mm cells with a pocket 4 mm deep in its left half, and a hole through it."""
    heights = np.zeros((12, 8))
    heights[:6] = -4.0
    heights[9, 4] = -10.0
    return MillingStock(zmap_of_heights(heights, BOX))


def height_at(stock: MillingStock, x: float, y: float) -> float:
    """Height of the stock at a point; that of its bottom beside the map."""
    grid = stock.map.grid
    column, row = int((x - grid.x) // grid.dx), int((y - grid.y) // grid.dy)
    is_inside = 0 <= column < grid.heights.shape[0] and 0 <= row < grid.heights.shape[1]
    return float(grid.heights[column, row]) if is_inside else grid.bottom


def test_a_box_grows_on_all_sides() -> None:
    grown = grown_milling_stock(MillingStock(BOX, cell=1.0), 2.0)
    assert height_at(grown, 6.0, 4.0) == pytest.approx(2.0)
    for x, y in ((-1.5, 4.0), (13.5, 4.0), (6.0, -1.5), (6.0, 9.5)):
        assert height_at(grown, x, y) == pytest.approx(2.0)
    for x, y in ((-2.5, 4.0), (14.5, 4.0), (6.0, -2.5), (6.0, 10.5)):
        assert height_at(grown, x, y) == pytest.approx(-12.0)


def test_a_wall_grows_into_the_pocket_beside_it() -> None:
    grown = grown_milling_stock(stepped(), 1.5)
    assert height_at(grown, 5.5, 4.5) == pytest.approx(1.5)
    assert height_at(grown, 4.5, 4.5) == pytest.approx(1.5)
    assert height_at(grown, 3.5, 4.5) == pytest.approx(-2.5)


def test_a_narrow_hole_closes() -> None:
    assert height_at(grown_milling_stock(stepped(), 1.0), 9.5, 4.5) == pytest.approx(1.0)


@given(margin=st.floats(0.1, 4.0), seed=st.integers(0, 99))
def test_no_point_within_the_margin_is_outside(margin: float, seed: int) -> None:
    heights = np.random.default_rng(seed).choice([-10.0, -6.0, -2.0, 0.0], size=(12, 8))
    stock = MillingStock(zmap_of_heights(heights.copy(), BOX))
    grown = grown_milling_stock(stock, margin)
    for column, row in np.argwhere(heights > -10.0):
        x, y, z = column + 0.5, row + 0.5, heights[column, row]
        for dx, dy in ((0.0, 0.0), (margin, 0.0), (0.0, -margin), (-margin, margin)):
            assert height_at(grown, x + dx, y + dy) >= z + margin - 1e-9


def test_the_given_stock_stays() -> None:
    stock = stepped()
    before = stock.map.grid.heights.copy()
    grown_milling_stock(stock, 2.0).map.grid.heights[:] = -12.0
    assert (stock.map.grid.heights == before).all()


def radius_at(stock: TurningStock, values: Floats, z: float) -> float:
    """Radius over a place of the axis; 0 beside the bar."""
    inside = np.flatnonzero(np.abs(stock.z - z) <= 0.5 * stock.cell + 1e-9)
    return float(values[inside[0]]) if len(inside) else 0.0


def test_a_bar_grows_in_radius_and_at_both_ends() -> None:
    grown = grown_turning_stock(TurningStock(BAR, cell=0.1), 1.0)
    assert radius_at(grown, grown.outer, -10.0) == pytest.approx(11.0)
    assert radius_at(grown, grown.outer, 0.95) == pytest.approx(11.0)
    assert radius_at(grown, grown.outer, -20.95) == pytest.approx(11.0)
    assert radius_at(grown, grown.outer, 1.15) == 0.0


def test_a_bore_narrows_and_a_groove_fills() -> None:
    stock = TurningStock(BAR, cell=0.1)
    stock.inner[:] = 4.0
    stock.outer[95:105] = 6.0
    grown = grown_turning_stock(stock, 1.0)
    assert radius_at(grown, grown.inner, -5.0) == pytest.approx(3.0)
    assert radius_at(grown, grown.outer, -10.0) == pytest.approx(11.0)
    stock.outer[50:150] = 6.0
    wide = grown_turning_stock(stock, 1.0)
    assert radius_at(wide, wide.outer, -10.0) == pytest.approx(7.0)


def test_a_small_bore_closes() -> None:
    stock = TurningStock(BAR, cell=0.1)
    stock.inner[:] = 0.5
    grown = grown_turning_stock(stock, 1.0)
    assert radius_at(grown, grown.inner, -5.0) == 0.0
