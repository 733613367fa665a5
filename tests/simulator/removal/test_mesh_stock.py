"""Raw parts from meshes."""

from math import pi

import numpy as np
import pytest

from simulator.removal.mesh_stock import bounds_of, milling_stock_of, turning_stock_of
from tests.extras.verification.model.meshes import pocketed_block, revolved

BLOCK = pocketed_block((0, 0, -20), (60, 40, 0), half=(20, 10), radius=5, depth=8)


def test_the_box_around_triangles() -> None:
    found = bounds_of(BLOCK)
    assert found.low == pytest.approx((0.0, 0.0, -20.0), abs=1e-12)
    assert found.high == pytest.approx((60.0, 40.0, 0.0), abs=1e-12)
    assert found.radius is None


def test_a_pocketed_block_lacks_its_pocket() -> None:
    stock = milling_stock_of(BLOCK, cell=0.1)
    pocket = (40.0 * 20.0 - (4.0 - pi) * 25.0) * 8.0
    assert stock.map.volume == pytest.approx(60.0 * 40.0 * 20.0 - pocket, rel=1e-3)
    grid = stock.map.grid
    assert np.unique(grid.heights).tolist() == [-8.0, 0.0]
    assert (grid.bottom, grid.top) == (-20.0, 0.0)


def test_the_cell_is_chosen_by_the_size() -> None:
    assert milling_stock_of(BLOCK).map.cell == pytest.approx(0.049, abs=1e-3)


def test_a_body_of_revolution_is_turned() -> None:
    ends = [(-30.0, 0.0), (-30.0, 15.0), (-20.0, 15.0), (-20.0, 10.0), (0.0, 10.0), (0.0, 0.0)]
    mesh = revolved(ends)
    bar = turning_stock_of(mesh)
    assert bar.volume == pytest.approx(pi * (100.0 * 20.0 + 225.0 * 10.0), rel=2e-3)


def test_a_block_is_no_body_of_revolution() -> None:
    with pytest.raises(ValueError, match=r"turned part needs a closed mesh|no body of revol"):
        turning_stock_of(BLOCK)
