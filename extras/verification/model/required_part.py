"""Required part of triangles: points on its walls, and its height map.

Without a program the logged part is compared with this one. Points lie on sections of the
triangles at several levels of each wall. Where the path turned between samples follows from
the lines between these. Units mm.
"""

from dataclasses import dataclass
from math import inf

import numpy as np
from scipy.spatial import cKDTree

from extras.verification.model.deviation import (
    SurfacePlaces,
    floor_cells,
    rounding_uncertainty,
    wall_uncertainty,
)
from extras.verification.model.logged_part import LoggedPart
from extras.verification.model.mesh import section_at
from extras.verification.model.path import divided
from extras.verification.model.surface import EXACT, WallCells, wall_cells
from extras.verification.model.sweep import WallTargets, targets_at
from simulator.motion.segments import Bools, Floats
from simulator.removal.mesh_stock import edges_of, raise_to
from simulator.removal.zmap import OUTSIDE, UNCUT, ZMap, cell_size, zmap_of
from stepnc_model.programs.program import Stock

PIECE = 0.25
"""Longest piece of a section whose middle stands for it, mm."""

LEVEL = 0.05
"""Step to which the levels of walls are rounded, mm: walls have few sections then."""

NEAR = 1.5
"""Greatest distance of a wall from the cells that show it, as a multiple of a cell."""


LEFT = 0.05
"""Height up to which raw and required part count as the same, mm: facets lie beside both."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RequiredPart:
    """Part that a mesh of triangles describes, within a stock."""

    map: ZMap
    """Height map."""
    targets: WallTargets
    """P points on its walls."""
    area: Floats
    """Area of wall that each point stands for, (P,), mm²."""
    sag: Floats
    """Distance of each triangle from the curved surface that it stands for, (P,), mm."""
    is_wall: Bools
    """Cells beside a wall, (X, Y)."""
    is_part: Bools
    """Cells over which there is any triangle, (X, Y)."""
    open: int
    """Edges that do not belong to two triangles: the mesh is not closed."""


def required_part(
    triangles: Floats,
    stock: Stock,
    *,
    cell: float | None = None,
    most_sag: float = inf,
    raw: Floats | None = None,
) -> RequiredPart:
    """Prepare a required part for comparison.

    Parameters
    ----------
    triangles : (T, 3, 3) array, mm
        In the coordinates of the log.
    cell : float, mm
        Size of the cells of the height map; by default chosen from the stock.
    most_sag : float, mm
        Greatest distance of the triangles from the surface, where it is known.
    raw : (T, 3, 3) array, mm
        Triangles of the raw part in the stock; without them it fills the stock. Walls that it
        has already are not compared.

    Raises
    ------
    ValueError
        If the stock has no volume, or the part has no wall within it.
    """
    whole = zmap_of(stock, cell=cell_size(stock) if cell is None else cell)
    grid = whole.grid
    is_outside = grid.owner == OUTSIDE
    if raw is not None:
        grid.heights[:] = grid.bottom
        raise_to(grid, np.ascontiguousarray(raw))
    uncut = grid.heights.copy()
    grid.heights[:] = -np.inf
    raise_to(grid, np.ascontiguousarray(triangles))
    is_part = (grid.heights > grid.bottom) & ~is_outside
    np.clip(grid.heights, grid.bottom, uncut, out=grid.heights)
    # Every wall counts, also where nothing was cut, but those that the raw part has already.
    is_left = is_outside | ((uncut - grid.heights <= LEFT) & (raw is not None))
    grid.owner[:] = np.where(is_left, OUTSIDE, 0)
    found, is_wall = wall_cells(whole)
    grid.owner[:] = np.where(is_outside, OUTSIDE, UNCUT)
    edges = edges_of(triangles)
    points, area, sag = _on_sections(triangles, edges.bend, found, whole)
    if not len(points):
        raise ValueError("the required part has no wall within the stock")
    targets, order = targets_at(points)
    return RequiredPart(
        map=whole, targets=targets, area=area[order],
        sag=np.minimum(sag[order], most_sag), is_wall=is_wall, is_part=is_part,
        open=edges.open,
    )  # fmt: skip


def _on_sections(
    triangles: Floats, bend: Floats, cells: WallCells, whole: ZMap
) -> tuple[Floats, Floats, Floats]:
    """Move points between cells to the section of the triangles at their height."""
    points, area, axis = cells.points, cells.area, cells.axis
    level = np.round(points[:, 2] / LEVEL).astype(np.int64)
    kept, areas, sags = [], [], []
    for each in np.unique(level).tolist():
        rows = np.flatnonzero(level == each)
        lines, owner = section_at(triangles, each * LEVEL)
        along = lines[:, 1] - lines[:, 0]
        length = np.linalg.norm(along, axis=1)
        is_long = length > EXACT * EXACT
        if not is_long.any():
            continue
        lines, along, owner, length = (x[is_long] for x in (lines, along, owner, length))
        start, piece, line, _ = divided(lines[:, 0], along, PIECE)
        count = min(3, len(start))
        best = cKDTree(start + 0.5 * piece).query(points[rows, :2], k=count)[1]
        best = best.reshape(len(rows), count)
        arm = points[rows, None, :2] - start[best]
        square = np.sum(piece[best] * piece[best], axis=2)
        share = np.clip(np.sum(arm * piece[best], axis=2) / square, 0.0, 1.0)
        feet = start[best] + share[:, :, None] * piece[best]
        away = np.linalg.norm(points[rows, None, :2] - feet, axis=2)
        nearest = away.argmin(axis=1)
        index = np.arange(len(rows))
        near = away[index, nearest] <= NEAR * whole.cell
        own = line[best[index, nearest]][near]
        foot = feet[index, nearest][near]
        kept.append(np.column_stack([foot, np.full(len(foot), each * LEVEL)]))
        normal = np.abs(along[own][:, ::-1] / length[own, None])
        areas.append(area[rows][near] * normal[np.arange(len(own)), axis[rows][near]])
        sags.append(0.5 * length[own] * np.tan(0.25 * bend[owner[own]]))
    if not kept:
        return np.zeros((0, 3)), np.zeros(0), np.zeros(0)
    return np.concatenate(kept), np.concatenate(areas), np.concatenate(sags)


def required_places(part: RequiredPart, logged: LoggedPart) -> SurfacePlaces:
    """Compare the logged part with the required one at walls and floors."""
    targets, rounding = logged.targets, rounding_uncertainty(logged.facts)
    grid = part.map.grid
    floors = floor_cells(grid, part.is_part, part.is_wall, logged)
    counts = len(targets.away), len(floors.deviation)
    # Only what goes up or down beside a place makes its height uncertain.
    height = np.minimum(logged.floors.bend, logged.floors.rise)[floors.cells]
    by = np.concatenate((logged.walls.workingstep, logged.floors.workingstep[floors.cells]))
    return SurfacePlaces(
        is_wall=np.repeat([True, False], counts),
        position=np.concatenate((
            np.column_stack([targets.x, targets.y, targets.z]),
            floors.position,
        )),
        deviation=np.concatenate((targets.away, floors.deviation)),
        uncertainty=np.concatenate((
            wall_uncertainty(logged, logged.walls.bend + part.sag + rounding + EXACT),
            height + floors.uncertainty,
        )),
        certain=np.zeros(sum(counts)),
        area=np.concatenate((part.area, floors.area)),
        workingstep=by,
        block=np.zeros(sum(counts), dtype=np.int64),
        time=np.concatenate((logged.walls.time, logged.floors.time[floors.cells])),
        cut_by=by,
    )
