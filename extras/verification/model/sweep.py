"""Kernels that sweep a tool along lines: lower a height map, and approach points on walls.

The distance of a point from the area that a tool sweeps at the height of the point is exact in
the plane: the least distance from the path of the axis, less the radius of the tool at that
height. It is positive in material that the tool does not reach, and negative where the tool
has been. Cells play no part in it. Units mm.
"""

from math import floor, hypot
from typing import NamedTuple

import numpy as np

from simulator.kernels.kernel import entry, kernel
from simulator.motion.segments import Floats, Ints
from simulator.removal.carve import carve_part
from simulator.removal.cutter import CutterProfile, is_plain, radius_at
from simulator.removal.zmap import HeightGrid

FAR = 5.0
"""Greatest distance from the swept area that is measured, mm."""

BIN = 2.0
"""Size of the squares in which points are found, mm."""

TOUCHED = 1e-6
"""Height, mm, by which a tip must be below a point to reach it."""


UNSEEN = 6
"""Column of a row with the distance, mm, by which the tool may have left the line unseen."""


class WallTargets(NamedTuple):
    """Points on walls, sorted by squares of the plane, with what came nearest to each."""

    x: Floats
    y: Floats
    z: Floats
    away: Floats
    """Signed distance from the swept area, (P,), mm; lowered by the kernel."""
    row: Ints
    """Number of the row that came nearest, (P,); -1 for none."""
    first: Ints
    """Index of the first point of each square, (columns · rows + 1,)."""
    low_x: float
    low_y: float
    columns: int
    rows: int


@entry
def sweep(grid: HeightGrid, profile: CutterProfile, rows: Floats, number: int) -> None:
    """Lower the cells of a map under a tool that runs along rows without a break.

    Parameters
    ----------
    grid : HeightGrid
        Changed in place.
    rows : (N, 13) array
    number : int
        Number of the first row, which its cells get as their owner.
    """
    for index in range(len(rows)):
        carve_part(grid, profile, rows[index], (0.0, 1.0), number + index, index > 0)


@entry
def approach(targets: WallTargets, profile: CutterProfile, rows: Floats, number: int) -> None:
    """Lower the distances of points from the area that a tool sweeps along rows.

    Parameters
    ----------
    targets : WallTargets
        Changed in place.
    rows : (N, 13) array
        Lines only.
    number : int
        Number of the first row.
    """
    for index in range(len(rows)):
        row = rows[index]
        reach = profile.radius + FAR + row[UNSEEN]
        low_x, high_x = min(row[0], row[3]) - reach, max(row[0], row[3]) + reach
        low_y, high_y = min(row[1], row[4]) - reach, max(row[1], row[4]) + reach
        first = max(floor((low_x - targets.low_x) / BIN), 0)
        last = min(floor((high_x - targets.low_x) / BIN), targets.columns - 1)
        begin = max(floor((low_y - targets.low_y) / BIN), 0)
        end = min(floor((high_y - targets.low_y) / BIN), targets.rows - 1)
        for column in range(first, last + 1):
            base = column * targets.rows
            if begin <= end:
                span = (targets.first[base + begin], targets.first[base + end + 1])
                _approach(targets, profile, row, span, number + index)


@kernel
def _approach(
    targets: WallTargets,
    profile: CutterProfile,
    row: Floats,
    span: tuple[int, int],
    number: int,
) -> None:
    """Lower the distances of some points from the sweep along one line."""
    low = min(row[2], row[5])
    along_x, along_y, climb = row[3] - row[0], row[4] - row[1], row[5] - row[2]
    square = along_x * along_x + along_y * along_y
    plain = is_plain(profile)
    for point in range(span[0], span[1]):
        z = targets.z[point]
        if low > z - TOUCHED:
            continue
        x, y = targets.x[point] - row[0], targets.y[point] - row[1]
        # Only the part of the line below the point reaches it.
        begin, end = 0.0, 1.0
        if climb < 0.0 and row[2] > z:
            begin = min((z - row[2]) / climb, 1.0)
        elif climb > 0.0 and row[5] > z:
            end = (z - row[2]) / climb
        share = begin if climb > 0.0 else end
        if square > 0.0:
            share = min(max((x * along_x + y * along_y) / square, begin), end)
        away = hypot(x - share * along_x, y - share * along_y) - row[UNSEEN]
        if away - profile.radius >= targets.away[point]:
            continue
        tip = row[2] + share * climb
        away -= profile.radius if plain else radius_at(profile, max(z - tip, 0.0))
        if away < targets.away[point]:
            targets.away[point] = away
            targets.row[point] = number


def targets_at(points: Floats) -> tuple[WallTargets, Ints]:
    """Prepare points for :func:`approach`.

    Parameters
    ----------
    points : (P, 3) array, mm
        At least one.

    Returns
    -------
    targets : WallTargets
    order : (P,) array of int
        Index of each target among the points.
    """
    low = points[:, :2].min(axis=0)
    square = np.floor((points[:, :2] - low) / BIN).astype(np.int64)
    columns, rows = (square.max(axis=0) + 1).tolist()
    key = square[:, 0] * rows + square[:, 1]
    order = np.argsort(key, kind="stable")
    first = np.searchsorted(key[order], np.arange(columns * rows + 1))
    sorted_points = points[order]
    targets = WallTargets(
        x=sorted_points[:, 0].copy(),
        y=sorted_points[:, 1].copy(),
        z=sorted_points[:, 2].copy(),
        away=np.full(len(points), FAR),
        row=np.full(len(points), -1, dtype=np.int64),
        first=first.astype(np.int64),
        low_x=float(low[0]),
        low_y=float(low[1]),
        columns=int(columns),
        rows=int(rows),
    )
    return targets, order


def renewed(targets: WallTargets) -> WallTargets:
    """The same points, which no tool has approached yet."""
    return targets._replace(
        away=np.full(len(targets.away), FAR),
        row=np.full(len(targets.row), -1, dtype=np.int64),
    )


def foot(rows: Floats, points: Floats) -> Floats:
    """Nearest point in the plane on each of N lines to each of N points, (N, 2), mm."""
    along = rows[:, 3:5] - rows[:, 0:2]
    square = np.sum(along * along, axis=1)
    share = np.sum((points[:, :2] - rows[:, 0:2]) * along, axis=1)
    share = np.clip(share / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    return np.asarray(rows[:, 0:2] + share[:, None] * along)
