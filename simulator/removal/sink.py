"""Plunge cut of a tool at a point: the contact of its lips, and the existing hole.

Units mm and rad.
"""

from math import cos, floor, pi, sin

from simulator.kernels.kernel import kernel
from simulator.removal.arcs import hole_radius
from simulator.removal.cutter import CutterProfile, rise
from simulator.removal.rim import FORGETTING, RecentOutlines
from simulator.removal.tip_move import LEAST
from simulator.removal.zmap import HeightGrid

LIP_RINGS = 16
LIP_ERROR = 1.0 / LIP_RINGS
"""Possible error of the inner end of a lip, as a share of the tool radius."""


@kernel
def lip(
    grid: HeightGrid, profile: CutterProfile, x: float, y: float, z: float
) -> tuple[float, float]:
    """Inner and outer radius of the contact of a tool that plunges to a point, mm."""
    rings, spokes = LIP_RINGS, 16
    inner, outer = profile.radius, 0.0
    wide = profile.radius / rings
    for spoke in range(spokes):
        angle = 2.0 * pi * (spoke + 0.5) / spokes
        before = 0.0
        for ring in range(rings):
            radius = (ring + 0.5) * wide
            tip = max(z + rise(profile, radius), grid.bottom) + LEAST
            over = _stock_at(grid, x + radius * cos(angle), y + radius * sin(angle)) - tip
            if over > 0.0:
                inner = min(inner, ring * wide)
                outer = max(outer, profile.radius if ring == rings - 1 else radius)
            elif before > 0.0:
                # Edge and stock surface are straight here: they cross between the rings.
                outer = max(outer, radius - wide * over / (over - before))
            before = over
    return inner, outer


@kernel
def _stock_at(grid: HeightGrid, x: float, y: float) -> float:
    """Height of the stock at a point, mm; the bottom of the stock outside the map."""
    columns, rows = grid.heights.shape
    column, row = floor((x - grid.x) / grid.dx), floor((y - grid.y) / grid.dy)
    if 0 <= column < columns and 0 <= row < rows:
        return float(grid.heights[column, row])
    return grid.bottom


@kernel
def hole(grid: HeightGrid, before: RecentOutlines, axis: tuple[float, float, float]) -> float:
    """Radius at a height of the hole made by the last move down an axis, mm; 0 if none."""
    x, y, level = axis[0], axis[1], max(axis[2], grid.bottom)
    columns, rows = grid.heights.shape
    column, row = floor((x - grid.x) / grid.dx), floor((y - grid.y) / grid.dy)
    if not (0 <= column < columns and 0 <= row < rows):
        return 0.0
    owner = grid.owner[column, row]
    if owner < max(before.next[0] - FORGETTING, 0) or grid.heights[column, row] > level + LEAST:
        return 0.0
    return hole_radius(before.records[owner % FORGETTING], x, y, level)
