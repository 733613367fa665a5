"""Stock as a map of heights over the XY plane, with the move that last lowered each cell.

A cell stands for the material above the bottom up to one height, so that nothing can be cut
from below. Cells are rectangles that fit the stock exactly and are square but for that. Units
mm.
"""

from dataclasses import dataclass
from math import ceil, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simulator.motion.segments import Floats
from stepnc_model.program import Stock

MOST_CELLS = 4_000_000
"""of a map without a given cell size"""

USUAL_CELLS = 1_000_000
"""of a map when its tools do not ask for finer cells"""

CELLS_PER_TOOL = 20.0
"""least number of cells over a tool's diameter"""

UNCUT = -1
OUTSIDE = -2
"""owner of a cell that was never cut; of one beside the stock"""


class HeightGrid(NamedTuple):
    """Heights and what the kernels must know of them."""

    heights: Floats
    """Heights, (X, Y) mm, changed by the kernels"""
    owner: NDArray[np.int32]
    """Owner, (X, Y) number of the move that last lowered a cell"""
    x: float
    y: float
    """Y, mm, corner of the first cell"""
    dx: float
    dy: float
    """Dy, mm, size of a cell"""
    bottom: float
    """Bottom, mm"""
    top: float
    """Top, mm, of the raw stock"""
    radius: float
    """Radius, mm, of a bar about the middle of the map; 0: a box"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ZMap:
    """Heights of a stock; its arrays change as material is cut away."""

    grid: HeightGrid

    @property
    def cell(self) -> float:
        """Longer side of a cell, mm."""
        return max(self.grid.dx, self.grid.dy)

    @property
    def volume(self) -> float:
        """Remaining volume, mm³."""
        grid = self.grid
        return float((grid.heights - grid.bottom).sum() * grid.dx * grid.dy)


def cell_size(stock: Stock, *, smallest_diameter: float = np.inf) -> float:
    """Cell that suits a stock and its smallest tool, mm, in at most 4 million cells."""
    area = (stock.high[0] - stock.low[0]) * (stock.high[1] - stock.low[1])
    wanted = min(sqrt(area / USUAL_CELLS), smallest_diameter / CELLS_PER_TOOL)
    return max(wanted, sqrt(area / MOST_CELLS))


def zmap_of(stock: Stock, *, cell: float) -> ZMap:
    """Map of a raw part: a box, or an upright bar.

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
    heights = np.full((columns, rows), stock.high[2], dtype=np.float64)
    owner = np.full((columns, rows), UNCUT, dtype=np.int32)
    dx, dy = float(size[0]) / columns, float(size[1]) / rows
    if stock.radius is not None:
        across = (np.arange(columns) + 0.5) * dx - 0.5 * size[0]
        along = (np.arange(rows) + 0.5) * dy - 0.5 * size[1]
        beside = across[:, None] ** 2 + along**2 > stock.radius**2
        heights[beside] = stock.low[2]
        owner[beside] = OUTSIDE
    grid = HeightGrid(
        heights=heights,
        owner=owner,
        x=stock.low[0],
        y=stock.low[1],
        dx=dx,
        dy=dy,
        bottom=stock.low[2],
        top=stock.high[2],
        radius=stock.radius or 0.0,
    )
    return ZMap(grid=grid)
