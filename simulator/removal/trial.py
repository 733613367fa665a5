"""Trial cuts: changes of a stock by one path, which can be undone and redone.

A path touches only the cells under its bounding box and writes only the outlines of its own
moves. The module also defines the arguments of the march of a tool through its stock, as
kernels take them. Units mm and rad.
"""

from dataclasses import dataclass
from math import ceil, floor, pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simulator.motion.segments import Floats, Ints, Segments
from simulator.removal.cutter import CutterProfile, is_upright
from simulator.removal.rim import ENGAGEMENT, FORGETTING, RecentOutlines
from simulator.removal.ring import ROUND_SAMPLES, SAMPLES, RimBuffers, RimTool, room_for
from simulator.removal.zmap import HeightGrid
from stepnc_model.toolpath.arc_columns import to_quadrants

DEEPEST = 12
"""Largest number of times that a stretch is halved."""


class MarchSettings(NamedTuple):
    """Settings for the march of a tool through its stock."""

    step: float
    """Longest stretch between two stations, mm."""
    least: float
    """Shortest stretch between two stations, mm."""
    shank: float
    """Height above the tip where the cutting edge ends, mm; infinite if it does not end."""
    coarse: float
    """Length of path over which the section read from the map exceeds its noise, mm."""
    shape: Floats
    """Numbers of the tool's profile, (7,)."""
    neck: CutterProfile
    """Profile of the shank above the cutting edge."""
    holder: CutterProfile
    overhang: float
    """Height above the tip where the holder begins, mm; infinite without a holder."""
    tip_sine: float
    """Sine of half the point angle."""


class RowBuffers(NamedTuple):
    """Working buffers for a part of a row."""

    rim: RimBuffers
    parts: Floats
    """Ends of the waiting stretches, (DEEPEST,), as shares of the row."""
    seen: Floats
    """Engagement at the ends of the waiting stretches, (DEEPEST, ENGAGEMENT)."""
    left: Floats
    """Engagement at the beginning of the stretch, (ENGAGEMENT,)."""
    raised: Floats
    """Row shifted up to the shank or the holder, (13,)."""


class RemovalTask(NamedTuple):
    """Arguments of a march: stock, earlier moves, tool, settings and buffers."""

    grid: HeightGrid
    past: RecentOutlines
    tool: RimTool
    how: MarchSettings
    desk: RowBuffers


def desk_for(tool: RimTool) -> RowBuffers:
    """Allocate the working buffers for a tool."""
    samples = SAMPLES if is_upright(tool.profile) else ROUND_SAMPLES
    return RowBuffers(
        room_for(samples),
        np.empty(DEEPEST),
        np.empty((DEEPEST, ENGAGEMENT)),
        np.empty(ENGAGEMENT),
        np.empty(13),
    )


def rows_of(segments: Segments) -> Floats:
    """Rows of segments for kernels, (N, 13).

    Columns: start, end, centre, radius, angle of the start point from the centre, turn, normal.
    """
    points = (segments.start, segments.end, segments.centre)
    angles = (segments.start_angle, segments.turn)
    normal = segments.normal.astype(np.float64)
    return np.ascontiguousarray(np.column_stack([*points, segments.radius, *angles, normal]))


_ROUNDING = 1e-9  # rad

Box = tuple[slice, slice]
"""Ranges of columns and rows of a height map."""

MARGIN = 2
"""Number of cells beside the sweep of a tool that its rim may sample."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StockPatch:
    """Saved state of the part of a stock that a path may change."""

    box: Box
    heights: Floats
    owner: NDArray[np.int32]
    moves: Ints
    """Indices of the outlines that the path may write."""
    records: Floats
    """Saved outlines at these indices."""
    next: int
    """Number of the next move."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PathTrial:
    """State of the stock within the box of a path, before and after the path."""

    before: StockPatch
    after: StockPatch

    @property
    def box(self) -> Box:
        """Cells that the path may have changed or sampled."""
        return self.before.box


def patch_of(grid: HeightGrid, past: RecentOutlines, box: Box, moves: Ints) -> StockPatch:
    """Save the state of the stock in a box, and some outlines."""
    return StockPatch(
        box=box,
        heights=grid.heights[box].copy(),
        owner=grid.owner[box].copy(),
        moves=moves,
        records=past.records[moves].copy(),
        next=int(past.next[0]),
    )


def put_back(patch: StockPatch, grid: HeightGrid, past: RecentOutlines) -> None:
    """Restore the state of a stock that a patch has saved."""
    grid.heights[patch.box] = patch.heights
    grid.owner[patch.box] = patch.owner
    past.records[patch.moves] = patch.records
    past.next[0] = patch.next


def box_of(grid: HeightGrid, segments: Segments, radius: float) -> Box:
    """Cells that a tool with a given radius may touch or sample along segments."""
    low, high = _deep_extents(grid, segments)
    if not len(low):
        return slice(0, 0), slice(0, 0)
    low, high = low.min(axis=0), high.max(axis=0)
    reach = radius + MARGIN * max(grid.dx, grid.dy)
    spans = []
    for axis, origin, size, count in (
        (0, grid.x, grid.dx, grid.heights.shape[0]),
        (1, grid.y, grid.dy, grid.heights.shape[1]),
    ):
        first = floor((low[axis] - reach - origin) / size)
        last = ceil((high[axis] + reach - origin) / size)
        spans.append(slice(min(max(first, 0), count), min(max(last, 0), count)))
    return spans[0], spans[1]


def row_boxes(grid: HeightGrid, segments: Segments, radius: float) -> Floats:
    """Number of cells within reach of each segment that is as deep as the stock, (M,)."""
    low, high = _deep_extents(grid, segments)
    reach = radius + MARGIN * max(grid.dx, grid.dy)
    sides = np.ceil((high - low + 2.0 * reach)[:, :2] / (grid.dx, grid.dy))
    cells: Floats = np.minimum(sides, grid.heights.shape).prod(axis=1)
    return cells


def _deep_extents(grid: HeightGrid, segments: Segments) -> tuple[Floats, Floats]:
    """Extents of the segments that are as deep as the stock, (M, 3) each, mm."""
    low, high = _extents(segments)
    is_deep = low[:, 2] < grid.top
    return low[is_deep], high[is_deep]


def _extents(segments: Segments) -> tuple[Floats, Floats]:
    """Lowest and highest coordinates of each segment, (N, 3), mm.

    Arcs outside the XY plane are bounded by their full circle.
    """
    low = np.minimum(segments.start, segments.end)
    high = np.maximum(segments.start, segments.end)
    rows = np.flatnonzero((segments.turn != 0.0) & (segments.normal != 2))
    low[rows] -= 2.0 * segments.radius[rows, None]
    high[rows] += 2.0 * segments.radius[rows, None]
    rows = np.flatnonzero((segments.turn != 0.0) & (segments.normal == 2))
    centre, radius = segments.centre[rows], segments.radius[rows]
    turn = segments.turn[rows]
    ways = to_quadrants(segments.start_angle[rows], turn)
    for quarter, (ends, axis, sign) in enumerate((
        (high, 0, 1.0),
        (high, 1, 1.0),
        (low, 0, -1.0),
        (low, 1, -1.0),
    )):
        passed = ways[:, quarter] <= np.abs(turn) + _ROUNDING
        ends[rows[passed], axis] = (centre[:, axis] + sign * radius)[passed]
    return low, high


def moves_of(past: RecentOutlines, segments: Segments) -> Ints:
    """Indices of the outlines that a path may write: one per line, one per quarter turn."""
    parts = np.maximum(1.0, np.ceil(np.abs(segments.turn) / (0.5 * pi)))
    count = min(int(parts.sum()), len(past.records))
    return (past.next[0] + np.arange(count)) % len(past.records)


def do_overlap(one: Box, other: Box) -> bool:
    """True if two boxes have a cell in common."""
    return all(a.start < b.stop and b.start < a.stop for a, b in zip(one, other, strict=True))


def is_remembered_alike(trial: PathTrial, later: int) -> bool:
    """True if a path would find the same remembered outlines if it ran some moves later."""
    made = trial.after.next - trial.before.next
    ages = trial.before.next - trial.before.owner[trial.before.owner >= 0]
    is_young = ages + max(later, 0) + made <= FORGETTING
    is_old = ages + min(later, 0) > FORGETTING
    return bool((is_young | is_old).all())


def renumbered(trial: PathTrial, number: int, known: dict[int, int]) -> StockPatch:
    """Result of a trial when the first move of its path gets another number.

    Parameters
    ----------
    number : int
        New number of its first move.
    known : dict
        New numbers of first moves by their old ones: for this trial, and for earlier trials
        whose moves it may have met.
    """
    after, made = trial.after, trial.after.next - trial.before.next
    moves = after.moves[:made]
    firsts = np.array(sorted(known))
    shifts = np.array([known[first] - first for first in sorted(known)])
    owner = after.owner.astype(np.int64)
    place = np.searchsorted(firsts, owner, side="right")
    owner += np.append(0, shifts)[place]
    return StockPatch(
        box=after.box,
        heights=after.heights,
        owner=owner.astype(np.int32),
        moves=(number + np.arange(made)) % FORGETTING,
        records=after.records[: len(moves)],
        next=number + made,
    )
