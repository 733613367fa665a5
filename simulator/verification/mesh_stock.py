"""Raw part that a mesh of triangles describes, such as a casting or what another setup left.

On a mill it is what can be seen from above: undercuts count as full, down to the lowest
triangle. On a lathe it must be a closed body of revolution about Z. Units mm.
"""

import numpy as np

from simulator.motion.segments import Floats
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from simulator.removal.zmap import cell_size, zmap_of
from simulator.verification.mesh import raise_to
from simulator.verification.revolved import required_bar
from stepnc_model.program import Stock


def bounds_of(triangles: Floats) -> Stock:
    """Box around triangles, (T, 3, 3), mm."""
    corners = triangles.reshape(-1, 3)
    low, high = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    return Stock(low=tuple(low), high=tuple(high))


def milling_stock_of(triangles: Floats, *, cell: float | None = None) -> MillingStock:
    """Stock of a mill from triangles.

    Parameters
    ----------
    triangles : (T, 3, 3) array, mm
    cell : float, mm
        Size of the map's cells; by default chosen from the size of the part.
    """
    bounds = bounds_of(triangles)
    size = cell_size(bounds) if cell is None else cell
    raised = zmap_of(bounds, cell=size)
    raised.grid.heights[:] = raised.grid.bottom
    raise_to(raised.grid, np.ascontiguousarray(triangles, dtype=np.float64))
    return MillingStock(raised)


def turning_stock_of(triangles: Floats) -> TurningStock:
    """Stock of a lathe from triangles.

    Parameters
    ----------
    triangles : (T, 3, 3) array, mm

    Raises
    ------
    ValueError
        If the mesh is not a closed body of revolution about Z.
    """
    corners = triangles.reshape(-1, 3)
    radius = float(np.hypot(corners[:, 0], corners[:, 1]).max())
    low, high = float(corners[:, 2].min()), float(corners[:, 2].max())
    bar = Stock(low=(-radius, -radius, low), high=(radius, radius, high), radius=radius)
    return required_bar(triangles, bar).bar
