"""Stock as a map of heights over the XY plane, with the move that last lowered each cell.

A cell stands for solid material from the bottom up to one height, so that nothing can be cut
from below. Cells are rectangles that fit the stock exactly and are as square as possible. Units
mm.
"""

from dataclasses import dataclass
from math import ceil, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simulator.motion.segments import Floats
from stepnc_model.programs.program import Stock

MOST_CELLS = 4_000_000
"""Largest number of cells in a map whose cell size is not given."""

USUAL_CELLS = 1_000_000
"""Usual number of cells in a map, unless its tools require finer cells."""

CELLS_PER_TOOL = 20.0
"""Least number of cells across the diameter of a tool."""

UNCUT = -1
OUTSIDE = -2
"""Owner of a cell outside the stock; UNCUT marks a cell that was never cut."""


class HeightGrid(NamedTuple):
    """Height map of a stock in the form that kernels take."""

    heights: Floats
    """Heights of the stock, (X, Y), mm; changed by the kernels."""
    owner: NDArray[np.int32]
    """Number of the move that last lowered each cell, (X, Y)."""
    x: float
    y: float
    """Y coordinate of the corner of the first cell, mm."""
    dx: float
    dy: float
    """Size of a cell in y, mm."""
    bottom: float
    """Height of the bottom of the stock, mm."""
    top: float
    """Height of the top of the raw stock, mm."""
    radius: float
    """Radius of a bar about the middle of the map, mm; 0 for a box."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ZMap:
    """Height map of a stock; its arrays change as material is cut away."""

    grid: HeightGrid

    @property
    def cell(self) -> float:
        """Longer side of a cell, mm."""
        return max(self.grid.dx, self.grid.dy)

    @property
    def volume(self) -> float:
        """Remaining volume of the stock, mm³."""
        grid = self.grid
        return float((grid.heights - grid.bottom).sum() * grid.dx * grid.dy)


def cell_size(stock: Stock, *, smallest_diameter: float = np.inf) -> float:
    """Choose a cell size for a stock and its smallest tool, mm; at most 4 million cells."""
    area = (stock.high[0] - stock.low[0]) * (stock.high[1] - stock.low[1])
    wanted = min(sqrt(area / USUAL_CELLS), smallest_diameter / CELLS_PER_TOOL)
    return max(wanted, sqrt(area / MOST_CELLS))


def zmap_of(stock: Stock, *, cell: float) -> ZMap:
    """Create the height map of a raw part: a box, or an upright bar.

    Raises
    ------
    ValueError
        If the stock has no volume or the cell is not positive.
    """
    size = np.subtract(stock.high, stock.low)
    if not (np.isfinite(size).all() and (size > 0.0).all()):
        raise ValueError(f"stock of {size[0]:g} × {size[1]:g} × {size[2]:g} mm has no volume")
    if not 0.0 < cell < np.inf:
        raise ValueError(f"cell {cell:g} mm must be positive")
    columns, rows = (max(1, ceil(float(side) / cell - 1e-9)) for side in size[:2])
    return zmap_of_heights(np.full((columns, rows), stock.high[2], dtype=np.float64), stock)


def zmap_of_heights(heights: Floats, bounds: Stock) -> ZMap:
    """Create the map of a stock that already has a shape.

    No cell counts as cut, so that no engagement is taken for exact where the shape decides it.

    Parameters
    ----------
    heights : (X, Y) array, mm
        Heights of the cells, from the bottom to the top of the bounds; kept by the map. Beside
        a bar they become the bottom.
    bounds : Stock
        Box around the stock, or the bar from which it was cut.
    """
    columns, rows = heights.shape
    dx = float(bounds.high[0] - bounds.low[0]) / columns
    dy = float(bounds.high[1] - bounds.low[1]) / rows
    owner = np.full((columns, rows), UNCUT, dtype=np.int32)
    if bounds.radius is not None:
        across = (np.arange(columns) + 0.5 - 0.5 * columns) * dx
        along = (np.arange(rows) + 0.5 - 0.5 * rows) * dy
        beside = across[:, None] ** 2 + along**2 > bounds.radius**2
        heights[beside] = bounds.low[2]
        owner[beside] = OUTSIDE
    grid = HeightGrid(
        heights=heights,
        owner=owner,
        x=bounds.low[0],
        y=bounds.low[1],
        dx=dx,
        dy=dy,
        bottom=bounds.low[2],
        top=bounds.high[2],
        radius=bounds.radius or 0.0,
    )
    return ZMap(grid=grid)
