"""Surface of the programmed part: points on its walls, and its height map with owners.

Walls are steps between neighbouring cells. Points are put on the exact boundary of the area
that the programmed path sweeps, at several levels of each wall, so that the size of cells has
no effect on what is measured there. Units mm.
"""

from dataclasses import dataclass

import numpy as np

from extras.verification.model.path import ProgrammedPath, rows_between
from extras.verification.model.sweep import (
    WallTargets,
    approach,
    foot,
    renewed,
    sweep,
    targets_at,
)
from simulator.motion.segments import Bools, Floats, Ints
from simulator.removal.cutter import Cutter, CutterProfile, Insert, profile_of
from simulator.removal.mesh_stock import raise_to
from simulator.removal.zmap import ZMap, cell_size, zmap_of
from stepnc_model.programs.program import Stock

LEAST_STEP = 0.5
"""Least height of a step that is a wall, mm."""

LEVELS = (0.1, 0.5, 0.9)
"""Levels of points on a wall, as shares of its height."""

EXACT = 1e-3
"""Distance from the swept area, mm, beyond which a point is not on the boundary."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WallPoints:
    """P points on the walls of the programmed part."""

    targets: WallTargets
    """The points, as no tool has approached them yet."""
    area: Floats
    """Area of wall that each point stands for, (P,), mm²."""
    chord: Ints
    """Chord of the programmed path that made the wall at each point, (P,)."""
    normal: Floats
    """Direction from the air into the material at each point, (P, 2)."""
    rest: Floats
    """Distance of each point from the programmed sweep, (P,), mm; at most ``EXACT``."""
    foot: Floats
    """Point of the programmed path nearest to each point, (P, 2), mm."""
    chord_start: Floats
    """Start of the chord on which that point lies, (P, 2), mm."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProgrammedPart:
    """Part that the programmed path leaves."""

    path: ProgrammedPath
    map: ZMap
    """Height map; owners are numbers of chords."""
    walls: WallPoints
    is_wall: Bools
    """Cells beside a wall, (X, Y)."""

    @property
    def targets(self) -> WallTargets:
        """Points on the walls, as no tool has approached them yet."""
        return self.walls.targets


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WallCells:
    """P points between neighbouring cells of different height."""

    points: Floats
    """(P, 3), mm."""
    area: Floats
    """Area of a wall across the line between the two cells, (P,), mm²."""
    axis: Ints
    """Axis along which the two cells are neighbours, (P,): 0 or 1."""


class PartSweep:
    """Stock from which tools that run along lines remove their sweep. Running state."""

    def __init__(self, stock: Stock, *, cell: float, raw: Floats | None = None) -> None:
        self.map = zmap_of(stock, cell=cell)
        if raw is not None:
            self.map.grid.heights[:] = self.map.grid.bottom
            raise_to(self.map.grid, np.ascontiguousarray(raw))
        self.number = 0
        """Number of the next row."""

    def profile(self, cutter: Cutter) -> CutterProfile:
        """Profile of a cutter over the height of the stock."""
        return profile_of(cutter, reach=self.map.grid.top - self.map.grid.bottom)

    def cut(self, cutter: Cutter | Insert | None, points: Floats) -> None:
        """Remove the sweep of a tool along the lines through points, (N, 3), mm."""
        rows = rows_between(points)
        if isinstance(cutter, Cutter):
            sweep(self.map.grid, self.profile(cutter), rows, self.number)
        self.number += len(rows)


def programmed_part(
    path: ProgrammedPath, stock: Stock, *, cell: float | None = None, raw: Floats | None = None
) -> ProgrammedPart:
    """Remove the sweep of a programmed path from a stock.

    Parameters
    ----------
    cell : float, mm
        Size of the cells of the height map; by default chosen from the stock.
    raw : (T, 3, 3) array, mm
        Triangles of the raw part in the stock; without them it fills the stock.

    Raises
    ------
    ValueError
        If the stock has no volume, a tool is impossible, or the path leaves no wall.
    """
    left = PartSweep(stock, cell=cell_size(stock) if cell is None else cell, raw=raw)
    for run, points in zip(path.runs, path.chords, strict=True):
        left.cut(run.cutter, points)
    found, is_wall = wall_cells(left.map)
    if not len(found.points):
        raise ValueError(
            "the programmed path leaves no wall in the stock, as when a part is only faced: a "
            "verification compares walls and the floors between them, and has nothing to "
            "compare here; the cycle time can still be compared"
        )
    walls = _on_boundary(path, found, left)
    return ProgrammedPart(path=path, map=left.map, walls=walls, is_wall=is_wall)


def wall_cells(whole: ZMap) -> tuple[WallCells, Bools]:
    """Points between cells of different height, and the cells beside them."""
    grid = whole.grid
    least = max(LEAST_STEP, 2.0 * whole.cell)
    is_wall = np.zeros(grid.heights.shape, dtype=np.bool_)
    points, areas, axes = [], [], []
    for axis, across in ((0, grid.dy), (1, grid.dx)):
        below, above = _neighbours(axis)
        step = grid.heights[above] - grid.heights[below]
        is_step = np.abs(step) >= least
        is_wall[below] |= is_step
        is_wall[above] |= is_step
        # Where the lower side was never cut, the wall is one of the stock.
        owner = np.where(step > 0.0, grid.owner[below], grid.owner[above])
        column, row = np.nonzero(is_step & (owner >= 0))
        low = np.minimum(grid.heights[below], grid.heights[above])[column, row]
        high = low + np.abs(step[column, row])
        x = grid.x + (column + (1.0 if axis == 0 else 0.5)) * grid.dx
        y = grid.y + (row + (0.5 if axis == 0 else 1.0)) * grid.dy
        for level in LEVELS:
            points.append(np.column_stack([x, y, low + level * (high - low)]))
            areas.append((high - low) * across / len(LEVELS))
            axes.append(np.full(len(x), axis))
    cells = WallCells(
        points=np.concatenate(points), area=np.concatenate(areas), axis=np.concatenate(axes)
    )
    return cells, is_wall


def _neighbours(axis: int) -> tuple[tuple[slice, ...], tuple[slice, ...]]:
    """Slices of all cells but the last, and of all but the first, along an axis."""
    whole = slice(None)
    first, last = slice(None, -1), slice(1, None)
    return ((first, whole), (last, whole)) if axis == 0 else ((whole, first), (whole, last))


def _on_boundary(path: ProgrammedPath, cells: WallCells, left: PartSweep) -> WallPoints:
    """Move points to the exact boundary of the programmed sweep; drop those that miss it."""
    targets, order = targets_at(cells.points)
    _approached(path, targets, left)
    rows = np.concatenate([rows_between(points) for points in path.chords])
    is_met = targets.row >= 0
    points = np.column_stack([targets.x, targets.y, targets.z])[is_met]
    chord, away = targets.row[is_met], targets.away[is_met]
    feet = foot(rows[chord], points)
    arm = points[:, :2] - feet
    reach = np.hypot(*arm.T)
    normal = arm / np.where(reach > 0.0, reach, 1.0)[:, None]
    points[:, :2] -= normal * away[:, None]
    moved, again = targets_at(points)
    _approached(path, moved, left)
    axis, area = cells.axis[order][is_met][again], cells.area[order][is_met][again]
    normal = normal[again]
    is_exact = (np.abs(moved.away) <= EXACT) & (reach[again] > 0.0)
    kept = np.flatnonzero(is_exact)
    rest, chord = moved.away[kept], moved.row[kept]
    targets, last = targets_at(np.column_stack([moved.x, moved.y, moved.z])[kept])
    kept, rest, chord = kept[last], rest[last], chord[last]
    return WallPoints(
        targets=renewed(targets),
        area=area[kept] * np.abs(normal[kept, axis[kept]]),
        chord=chord,
        normal=normal[kept],
        rest=rest,
        foot=foot(rows[chord], np.column_stack([targets.x, targets.y])),
        chord_start=rows[chord, 0:2],
    )


def _approached(path: ProgrammedPath, targets: WallTargets, left: PartSweep) -> None:
    """Let the programmed path approach points."""
    number = 0
    for run, points in zip(path.runs, path.chords, strict=True):
        rows = rows_between(points)
        if isinstance(run.cutter, Cutter):
            approach(targets, left.profile(run.cutter), rows, number)
        number += len(rows)
