"""What one path changes in a stock, so that it can be undone and done again.

A path touches the cells under its box only, and writes the outlines of its own moves. Units mm.
"""

from dataclasses import dataclass
from math import ceil, floor, pi

import numpy as np
from numpy.typing import NDArray

from simulator.motion.segments import Floats, Ints, Segments
from simulator.removal.rim import FORGETTING, Past
from simulator.removal.zmap import Grid

_ROUNDING = 1e-9  # rad

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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trial:
    """What a path found in its box, and what it made of it."""

    before: Patch
    after: Patch

    @property
    def box(self) -> Box:
        """Cells that the path may have touched or looked at."""
        return self.before.box


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
    low, high = _extents(segments)
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


def _extents(segments: Segments) -> tuple[Floats, Floats]:
    """(N, 3) least and greatest coordinates of each segment; arcs out of XY by their circle."""
    low = np.minimum(segments.start, segments.end)
    high = np.maximum(segments.start, segments.end)
    rows = np.flatnonzero((segments.turn != 0.0) & (segments.normal != 2))
    low[rows] -= 2.0 * segments.radius[rows, None]
    high[rows] += 2.0 * segments.radius[rows, None]
    rows = np.flatnonzero((segments.turn != 0.0) & (segments.normal == 2))
    centre, radius = segments.centre[rows], segments.radius[rows]
    turn, arm = segments.turn[rows], segments.start[rows] - centre
    angle = np.arctan2(arm[:, 1], arm[:, 0])
    for quarter, (ends, axis, sign) in enumerate((
        (high, 0, 1.0),
        (high, 1, 1.0),
        (low, 0, -1.0),
        (low, 1, -1.0),
    )):
        way = (0.5 * pi * quarter - angle) * np.sign(turn) % (2.0 * pi)
        passed = way <= np.abs(turn) + _ROUNDING
        ends[rows[passed], axis] = (centre[:, axis] + sign * radius)[passed]
    return low, high


def moves_of(past: Past, segments: Segments) -> Ints:
    """Rows of the outlines that a path may write: one a line, one a quarter turn."""
    parts = np.maximum(1.0, np.ceil(np.abs(segments.turn) / (0.5 * pi)))
    count = min(int(parts.sum()), len(past.records))
    return (past.next[0] + np.arange(count)) % len(past.records)


def do_overlap(one: Box, other: Box) -> bool:
    """Whether two boxes have a cell in common."""
    return all(a.start < b.stop and b.start < a.stop for a, b in zip(one, other, strict=True))


def is_remembered_alike(trial: Trial, later: int) -> bool:
    """Whether a path finds the same outlines remembered when it comes some moves later."""
    made = trial.after.next - trial.before.next
    ages = trial.before.next - trial.before.owner[trial.before.owner >= 0]
    is_young = ages + max(later, 0) + made <= FORGETTING
    is_old = ages + min(later, 0) > FORGETTING
    return bool((is_young | is_old).all())


def renumbered(trial: Trial, number: int, known: dict[int, int]) -> Patch:
    """What a path makes when the number of its first move is another one.

    Parameters
    ----------
    trial : Trial
    number : int
        Of its first move.
    known : dict
        New numbers of first moves by the old ones: of this trial, and of earlier ones whose
        moves it may have met.
    """
    after, made = trial.after, trial.after.next - trial.before.next
    moves = after.moves[:made]
    firsts = np.array(sorted(known))
    shifts = np.array([known[first] - first for first in sorted(known)])
    owner = after.owner.astype(np.int64)
    place = np.searchsorted(firsts, owner, side="right")
    owner += np.append(0, shifts)[place]
    return Patch(
        box=after.box,
        heights=after.heights,
        owner=owner.astype(np.int32),
        moves=(number + np.arange(made)) % FORGETTING,
        records=after.records[: len(moves)],
        next=number + made,
    )
