"""Stock that is larger all around by a margin, to tell air from places near the material.

Heights and radii grow by the margin and spread by it along the axes of the map: at a corner the
stock grows a little more than the margin, never less. Units mm.
"""

from math import ceil

import numpy as np

from simulator.motion.segments import Floats
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from simulator.removal.zmap import zmap_of_heights
from stepnc_model.programs.program import Stock


def grown_milling_stock(stock: MillingStock, margin: float) -> MillingStock:
    """Copy of a stock on a mill that is larger by a margin, mm."""
    grid = stock.map.grid
    pads = ceil(margin / grid.dx), ceil(margin / grid.dy)
    bottom = grid.bottom - margin
    solid = np.where(grid.heights > grid.bottom, grid.heights + margin, bottom)
    heights = np.pad(solid, ((pads[0],) * 2, (pads[1],) * 2), constant_values=bottom)
    for axis, pad in enumerate(pads):
        heights = _greatest_within(heights, pad, axis)
    right = grid.x + grid.dx * grid.heights.shape[0]
    back = grid.y + grid.dy * grid.heights.shape[1]
    bounds = Stock(
        low=(grid.x - pads[0] * grid.dx, grid.y - pads[1] * grid.dy, bottom),
        high=(right + pads[0] * grid.dx, back + pads[1] * grid.dy, grid.top + margin),
    )
    return MillingStock(zmap_of_heights(np.ascontiguousarray(heights), bounds))


def grown_turning_stock(stock: TurningStock, margin: float) -> TurningStock:
    """Copy of a stock on a lathe that is larger by a margin, mm."""
    pad = ceil(margin / stock.cell)
    outer = _greatest_within(np.pad(stock.outer, pad), pad, 0)
    inner = -_greatest_within(-np.pad(stock.inner, pad, constant_values=np.inf), pad, 0)
    radius = float(outer.max()) + margin
    half = 0.5 * stock.cell
    low = float(stock.z[0]) - half - pad * stock.cell
    high = float(stock.z[-1]) + half + pad * stock.cell
    grown = TurningStock(
        Stock(low=(-radius, -radius, low), high=(radius, radius, high), radius=radius),
        cell=stock.cell,
    )
    is_solid = outer > np.where(np.isfinite(inner), inner, 0.0)
    grown.outer[:] = np.where(is_solid, outer + margin, 0.0)
    grown.inner[:] = np.where(is_solid, np.maximum(inner - margin, 0.0), 0.0)
    return grown


def _greatest_within(values: Floats, reach: int, axis: int) -> Floats:
    """Greatest value within a number of cells along an axis."""
    greatest = values.copy()
    for step in range(1, reach + 1):
        for to, source in (
            (slice(step, None), slice(None, -step)),
            (slice(None, -step), slice(step, None)),
        ):
            rows = [slice(None)] * values.ndim
            others = rows.copy()
            rows[axis], others[axis] = to, source
            at, of = tuple(rows), tuple(others)
            np.maximum(greatest[at], values[of], out=greatest[at])
    return greatest
