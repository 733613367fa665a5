"""What one path changes in a stock, so that it can be undone and done again.

A path touches the cells under its box only, and writes the outlines of its own moves. Units mm.
"""

from dataclasses import dataclass
from math import ceil, floor, pi

import numpy as np
from numpy.typing import NDArray

from simulator.motion.segments import Floats, Ints, Segments
from simulator.removal.rim import Past
from simulator.removal.zmap import Grid

Box = tuple[slice, slice]
"""columns and rows of a map"""

MARGIN = 2
"""cells beside the sweep of a tool that its rim may look at"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Patch:
    """State of a stock where a path may have touched it."""

    box: Box
    heights: Floats
    owner: NDArray[np.int32]
    moves: Ints
    """rows of the outlines that the path may write"""
    records: Floats
    """those outlines"""
    next: int
    """number of the next move"""


def patch_of(grid: Grid, past: Past, box: Box, moves: Ints) -> Patch:
    """Keep what is in a box, and some outlines."""
    return Patch(
        box=box,
        heights=grid.heights[box].copy(),
        owner=grid.owner[box].copy(),
        moves=moves,
        records=past.records[moves].copy(),
        next=int(past.next[0]),
    )


def put_back(patch: Patch, grid: Grid, past: Past) -> None:
    """Make a stock in a box what it was when the patch was made."""
    grid.heights[patch.box] = patch.heights
    grid.owner[patch.box] = patch.owner
    past.records[patch.moves] = patch.records
    past.next[0] = patch.next


def box_of(grid: Grid, segments: Segments, radius: float) -> Box:
    """Cells that a tool of a radius may touch or look at along segments."""
    reach = radius + MARGIN * max(grid.dx, grid.dy)
    bulge = np.where(segments.turn == 0.0, 0.0, 2.0 * segments.radius)[:, None]
    low = np.minimum(segments.start, segments.end) - bulge
    high = np.maximum(segments.start, segments.end) + bulge
    is_deep = low[:, 2] < grid.top
    if not is_deep.any():
        return slice(0, 0), slice(0, 0)
    low, high = low[is_deep].min(axis=0), high[is_deep].max(axis=0)
    spans = []
    for axis, origin, size, count in (
        (0, grid.x, grid.dx, grid.heights.shape[0]),
        (1, grid.y, grid.dy, grid.heights.shape[1]),
    ):
        first = floor((low[axis] - reach - origin) / size)
        last = ceil((high[axis] + reach - origin) / size)
        spans.append(slice(min(max(first, 0), count), min(max(last, 0), count)))
    return spans[0], spans[1]


def moves_of(past: Past, segments: Segments) -> Ints:
    """Rows of the outlines that a path may write: one a line, one a quarter turn."""
    parts = np.maximum(1.0, np.ceil(np.abs(segments.turn) / (0.5 * pi)))
    count = min(int(parts.sum()), len(past.records))
    return (past.next[0] + np.arange(count)) % len(past.records)
