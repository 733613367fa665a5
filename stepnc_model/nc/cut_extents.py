"""Box around all cutting moves of a milling program: the raw part where nothing states one.

The box is rather too large than too small. In the plane it holds every place of every tool at a
feed. Its top lies where tools begin to go down into material at a feed, the highest of such
places: the start of a helix, or of a straight descent behind its faster approach. Where a tool
comes down beside the part in a rapid, material may stand as high as the place from which it
came. Drills count for the top only where nothing else cuts, because their planes of retract lie
over clamps and bosses.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from stepnc_model.nc.moves import MoveKind, NcMoves
from stepnc_model.programs.program import Stock
from stepnc_model.toolpath.arc_columns import FIRST, SECOND, arms, to_quadrants

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

MARGIN = 1.0
"""Distance by which the box is larger than what the tools reach, mm."""

STEEP = 0.9
"""Sine of the descent from which a move goes straight down, as for feeds."""

FASTER = 1.001
"""Ratio of feeds above which the first of two pieces of a descent is the approach."""

LEVEL = 1e-6
"""Change of height below which a move is level, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CutExtents:
    """Box around the cutting moves of a program."""

    box: Stock
    """Box, mm, in the frame of the moves."""
    top_row: int
    """Row of the move that gives its top; -1 if none does."""


def cut_extents(
    moves: NcMoves, rows: Bools, *, radius: Callable[[int], float], drills: frozenset[int]
) -> CutExtents | None:
    """Box around cutting moves; None if there are none at known places.

    Parameters
    ----------
    moves : NcMoves
    rows : (N,) array of bool
        Moves that are looked at: those in the frame of the stock.
    radius : callable
        Radius of the tool with a number, mm.
    drills : frozenset of int
        Numbers of the tools that cut with their end only.
    """
    is_fed = np.isin(moves.kind, (MoveKind.LINE, MoveKind.ARC)) & moves.is_known & rows
    fed = np.flatnonzero(is_fed)
    if not len(fed):
        return None
    low, high = np.full(3, inf), np.full(3, -inf)
    for number in np.unique(moves.tool[fed]).tolist():
        own = fed[moves.tool[fed] == number]
        least, most = _reach(moves, own)
        around = np.array([radius(number), radius(number), 0.0])
        low, high = np.minimum(low, least - around), np.maximum(high, most + around)
    is_drilled = np.isin(moves.tool, list(drills))
    top, row = _top(moves, is_fed & ~is_drilled, rows)
    if row < 0:
        top, row = _top(moves, is_fed, rows)
    if row < 0:
        top = float(high[2])
    low -= MARGIN
    high += MARGIN
    # At the place of entry itself the tool meets nothing yet: no margin lifts it.
    height = max(top, float(low[2]) + MARGIN)
    return CutExtents(
        box=Stock(
            low=(float(low[0]), float(low[1]), float(low[2])),
            high=(float(high[0]), float(high[1]), height),
        ),
        top_row=row,
    )


def _reach(moves: NcMoves, rows: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Least and greatest coordinates of some moves, mm."""
    part = NcMoves(
        rows=moves.rows[rows], arcs=moves.arcs, settings=moves.settings, frames=moves.frames,
        calls=moves.calls,
    )  # fmt: skip
    points = [part.start, part.end]
    arcs = np.flatnonzero(part.turn != 0.0)
    if len(arcs):
        points.append(_bulges(part, arcs))
    whole = np.concatenate(points)
    return whole.min(axis=0), whole.max(axis=0)


def _bulges(moves: NcMoves, arcs: NDArray[np.int64]) -> Floats:
    """Points at which arcs are farthest out along an axis, (K, 3), mm."""
    start, centre, normal = moves.start[arcs], moves.centre[arcs], moves.normal[arcs]
    turn = moves.turn[arcs]
    first, second = arms(start, centre, normal)
    radius, angle = np.hypot(first, second), np.arctan2(second, first)
    ways = to_quadrants(angle, turn)
    found = []
    for quarter in range(4):
        gets_there = np.flatnonzero(ways[:, quarter] <= np.abs(turn))
        at = 0.5 * np.pi * quarter
        points = start[gets_there].copy()
        of = np.arange(len(gets_there))
        axes = normal[gets_there]
        points[of, FIRST[axes]] = centre[gets_there, FIRST[axes]] + radius[gets_there] * np.cos(
            at
        )
        points[of, SECOND[axes]] = centre[gets_there, SECOND[axes]] + radius[
            gets_there
        ] * np.sin(at)
        found.append(points)
    return np.concatenate(found)


def _top(moves: NcMoves, is_fed: Bools, rows: Bools) -> tuple[float, int]:
    """Highest place at which tools go down into material, and its row; -1 if there is none."""
    drop = np.where(is_fed, moves.start[:, 2] - moves.end[:, 2], 0.0)
    is_down = drop > LEVEL
    with np.errstate(divide="ignore", invalid="ignore"):
        is_steep = is_down & (drop >= STEEP * np.where(is_fed, moves.length, 1.0))
    best, row = -inf, -1
    follows = np.append(is_down[1:] & (moves.kind[1:] == MoveKind.ARC), False)
    last = np.flatnonzero(is_steep & ~np.append(is_steep[1:], False) & ~follows)
    # Pieces of a descent that are faster than what follows are the approach through air.
    word = moves.word
    joins = np.append(False, is_steep[:-1] & is_steep[1:] & ~(word[:-1] > FASTER * word[1:]))
    begins = np.maximum.accumulate(np.where(joins, 0, np.arange(len(joins))))
    ramps = is_down & ~is_steep
    ramps &= ~np.append(False, is_down[:-1]) | (moves.kind == MoveKind.ARC)
    entries = np.concatenate((begins[last], np.flatnonzero(ramps)))
    if len(entries):
        highest = int(entries[np.argmax(moves.start[entries, 2])])
        best, row = float(moves.start[highest, 2]), highest
    beside, at = _beside(moves, is_fed, rows)
    return (beside, at) if beside > best else (best, row)


def _beside(moves: NcMoves, is_fed: Bools, rows: Bools) -> tuple[float, int]:
    """Height from which rapids come down beside the part to a cut that goes on level."""
    is_rapid = (moves.kind == MoveKind.RAPID) & rows
    level = is_fed & (np.abs(moves.start[:, 2] - moves.end[:, 2]) <= LEVEL)
    first = np.flatnonzero(level & np.concatenate(([False], is_rapid[:-1])))
    ends = moves.end[is_rapid]
    is_across = ~(moves.start[is_rapid, :2] == ends[:, :2]).all(axis=1)
    planes, others = (np.unique(z[~np.isnan(z)]) for z in (ends[is_across, 2], ends[:, 2]))
    best, row = -inf, -1
    for at in first.tolist():
        z = float(moves.start[at, 2])
        # The lowest plane above the cut in which the program goes across, else the highest end.
        above = np.append(planes[planes > z + LEVEL], others[-1:])
        height = max(float(above[0]), z) if len(above) else max(z, 0.0)
        if height > best:
            best, row = height, at
    return best, row
