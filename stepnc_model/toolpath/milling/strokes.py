"""Milling passes over an area: parallel strokes, spirals of rings, and clipping to an area.

Strokes run to and fro or one way, linked without leaving the area. The rings of a spiral are
joined by slanted links without a stop. Passes are cut where they enter or leave an area.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from math import ceil

import numpy as np

from stepnc_model.toolpath.milling.contour import (
    TINY,
    Chain,
    ContourEdge,
    Loop,
    area,
    chain_length,
    line,
    moved,
    nearest,
    reversed_chain,
    rotated_to,
    vertices,
)
from stepnc_model.toolpath.milling.cover import MillingPass
from stepnc_model.toolpath.milling.offset import contains, crossings_with

CHORD = 1e-4
"""Chord tolerance for measuring an area across the strokes, mm."""

ASIDE = 1e-6
"""Distance by which the outermost strokes stay inside, so that they cross the wall, mm."""

SHORTEST = 1e-3
"""Shortest stroke that is kept, mm."""

MOST_ROWS = 20_000

TOUCH = 1e-6
"""Fraction of a link's length at its ends where it may touch the wall."""


@dataclass(frozen=True, slots=True)
class Stroke:
    """Part of a scan line inside the area, along increasing x of the rotated system."""

    low: complex
    high: complex


def singles(rows: Sequence[Sequence[Stroke]]) -> tuple[MillingPass, ...]:
    """Make each stroke a separate pass."""
    return tuple(
        MillingPass((line(stroke.low, stroke.high),), is_closed=False)
        for row in rows
        for stroke in row
    )


def scan(loops: Sequence[Loop], *, along: complex, step: float) -> list[list[Stroke]]:
    """Rows of parallel strokes over an area, from the right of a direction to its left."""
    back = along.conjugate()
    turned = [moved(loop, turned=back) for loop in loops]
    heights = [point.imag for loop in turned for point in vertices(loop, tolerance=CHORD)]
    if not heights:
        return []
    low, high = min(heights) + ASIDE, max(heights) - ASIDE
    count = max(1, ceil((high - low) / step - TINY) + 1) if high > low else 1
    if count > MOST_ROWS:
        raise ValueError(
            f"{count} parallel strokes: at most {MOST_ROWS} are allowed, increase the step"
        )
    rows = np.linspace(low, high, count) if count > 1 else [0.5 * (low + high)]
    return [_row(turned, float(height), along) for height in rows]


def rows_at(
    loops: Sequence[Loop], heights: Sequence[float], *, along: complex
) -> list[list[Stroke]]:
    """Rows of strokes at given distances to the left of the origin."""
    turned = [moved(loop, turned=along.conjugate()) for loop in loops]
    return [_row(turned, height, along) for height in heights]


def linked(start: complex, end: complex, loops: Sequence[Loop]) -> Chain | None:
    """Link between two points inside the area: straight, or along the wall; else None."""
    if abs(end - start) < TINY:
        return ()
    if is_inside(start, end, loops):
        return (line(start, end),)
    for loop in loops:
        way = _along_wall(loop, start, end)
        if way is not None:
            return way
    return None


def is_inside(start: complex, end: complex, loops: Sequence[Loop]) -> bool:
    """True if the straight line between two points of the area stays in it."""
    edges = [edge for loop in loops for edge in loop]
    way = line(start, end)
    parts = crossings_with([way], edges)[0]
    touch = max(TOUCH, 10.0 * ASIDE / way.length)
    if any(touch < part < 1.0 - touch for part in parts):
        return False
    return contains_point(way.at(0.5), loops)


def contains_point(point: complex, loops: Sequence[Loop]) -> bool:
    """True if a point lies in the area or nearly on its boundary."""
    if any(
        abs(loop[i].at(part) - point) < 10.0 * ASIDE
        for loop in loops
        for i, part in [nearest(loop, point)]
    ):
        return True
    return _is_within(point, loops)


def zigzags(rows: Sequence[Sequence[Stroke]], loops: Sequence[Loop]) -> tuple[MillingPass, ...]:
    """Join rows of strokes to and fro into zigzag passes."""
    return tuple(found for cell in _cells(rows) for found in _zigzag(cell, loops))


def _is_within(point: complex, loops: Sequence[Loop]) -> bool:
    """True if a point lies within an outer loop and outside all islands."""
    outer = [loop for loop in loops if area(loop) > 0.0]
    islands = [loop for loop in loops if area(loop) <= 0.0]
    return any(contains([loop, *islands], [point], tolerance=CHORD)[0] for loop in outer)


def _row(turned: Sequence[Loop], height: float, along: complex) -> list[Stroke]:
    """Strokes of one scan line of the rotated system, returned in the original system."""
    edges = [edge for loop in turned for edge in loop]
    xs = [point.real for edge in edges for point in (edge.start, edge.end, edge.at(0.5))]
    span = max(xs) - min(xs) + 2.0
    scanline = line(complex(min(xs) - span, height), complex(max(xs) + span, height))
    parts = crossings_with([scanline], edges)[0]
    found: list[Stroke] = []
    for low, high in pairwise(parts):
        start, end = scanline.at(low), scanline.at(high)
        if abs(end - start) > SHORTEST and _is_within(scanline.at(0.5 * (low + high)), turned):
            found.append(Stroke(start * along, end * along))
    return found


def _cells(rows: Sequence[Sequence[Stroke]]) -> list[list[Stroke]]:
    """Groups of adjacent strokes, one stroke in each row."""
    cells: list[list[Stroke]] = []
    open_cells: list[list[Stroke]] = []
    for row in rows:
        following: list[list[Stroke]] = []
        for stroke in row:
            beside = [cell for cell in open_cells if _overlap(cell[-1], stroke)]
            if len(beside) == 1 and sum(_overlap(beside[0][-1], other) for other in row) == 1:
                beside[0].append(stroke)
                following.append(beside[0])
            else:
                cell = [stroke]
                cells.append(cell)
                following.append(cell)
        open_cells = following
    return cells


def _overlap(one: Stroke, other: Stroke) -> bool:
    """True if two strokes of adjacent rows overlap sideways."""
    way = one.high - one.low
    way /= abs(way)
    ends = [((point - one.low) / way).real for point in (other.low, other.high)]
    return ends[0] < abs(one.high - one.low) and ends[1] > 0.0


def _zigzag(cell: Sequence[Stroke], loops: Sequence[Loop]) -> list[MillingPass]:
    """Zigzag over the strokes of a cell, joined where the link stays inside."""
    chains: list[list[ContourEdge]] = []
    for index, stroke in enumerate(cell):
        ends = (stroke.low, stroke.high) if index % 2 == 0 else (stroke.high, stroke.low)
        way = linked(chains[-1][-1].end, ends[0], loops) if chains else None
        if way is None:
            chains.append([])
        chains[-1] += [*(way or ()), line(*ends)]
    return [MillingPass(tuple(chain), is_closed=False) for chain in chains]


def _along_wall(loop: Loop, start: complex, end: complex) -> Chain | None:
    """Shorter route along a loop between two points on it; None if they are not on it."""
    (i, p), (j, q) = nearest(loop, start), nearest(loop, end)
    if abs(loop[i].at(p) - start) > 1e-3 or abs(loop[j].at(q) - end) > 1e-3:
        return None
    forward = _between(loop, (i, p), (j, q))
    back = reversed_chain(_between(loop, (j, q), (i, p)))
    way = forward if chain_length(forward) <= chain_length(back) else back
    if not way:
        return None
    first, last = way[0], way[-1]
    joined = [ContourEdge(start, first.end, first.centre, first.turn), *way[1:]]
    joined[-1] = ContourEdge(joined[-1].start, end, last.centre, last.turn)
    return tuple(joined)


def _between(loop: Loop, first: tuple[int, float], last: tuple[int, float]) -> Chain:
    """Part of a loop between two places, each given as edge index and part of its length."""
    (i, p), (j, q) = first, last
    if i == j and q >= p:
        pieces = [loop[i].between(p, q)]
    else:
        count = (j - i) % len(loop) or len(loop)
        middle = [loop[(i + k) % len(loop)] for k in range(1, count)]
        pieces = [loop[i].between(p, 1.0), *middle, loop[j].between(0.0, q)]
    return tuple(piece for piece in pieces if piece.length > 1e-7)


COARSE_CHORD = 1e-3
"""Chord tolerance for testing whether a point lies in an area, mm."""

SHORTEST_PIECE = 0.1
"""Shortest clipped piece that is cut, mm."""


@dataclass(frozen=True, slots=True)
class ClippedChain:
    """Part of a clipped chain on one side of the clipping boundary."""

    chain: Chain
    is_inside: bool


def pieces(chain: Chain, loops: Sequence[Loop]) -> list[ClippedChain]:
    """Split a chain at the boundary of the area on the left of every loop."""
    edges = [edge for loop in loops for edge in loop]
    parts = crossings_with(chain, edges)
    split = [piece for edge, at in zip(chain, parts, strict=True) for piece in _split(edge, at)]
    inside = contains(loops, [piece.at(0.5) for piece in split], tolerance=COARSE_CHORD)
    pairs = zip(split, inside, strict=True)
    return [
        ClippedChain(tuple(edge for edge, _ in group), is_inside)
        for is_inside, group in groupby(pairs, key=lambda pair: pair[1])
    ]


def inside(cut: MillingPass, loops: Sequence[Loop]) -> list[MillingPass]:
    """Clip a pass to an area; the pass is unchanged where it stays inside."""
    found = pieces(cut.chain, loops)
    if len(found) == 1:
        return [cut] if found[0].is_inside else []
    if cut.is_closed and found[0].is_inside and found[-1].is_inside:
        last = found.pop()
        found[0] = ClippedChain((*last.chain, *found[0].chain), is_inside=True)
    return [
        MillingPass(piece.chain, is_closed=False)
        for piece in found
        if piece.is_inside and chain_length(piece.chain) > SHORTEST_PIECE
    ]


def _split(edge: ContourEdge, parts: list[float]) -> Chain:
    """Split a contour edge at given fractions of its length."""
    cuts = [0.0, *(part for part in parts if 1e-9 < part < 1.0 - 1e-9), 1.0]
    return tuple(edge.between(low, high) for low, high in pairwise(cuts) if high > low)


SLANT = 2.0
"""Length of the link between two rings along the path, in steps across it."""

FARTHEST = 2.0 * SLANT
"""Greatest distance of two rings that are linked, in steps."""


def spirals(
    rings: Iterable[MillingPass], loops: Sequence[Loop], *, step: float
) -> tuple[MillingPass, ...]:
    """Join neighbouring rings into spiral passes; every ring is still cut completely.

    Parameters
    ----------
    rings : iterable of MillingPass
        Rings in cutting order; open passes remain separate.
    loops : sequence of Loop
        Boundary of the area allowed for the cutter centre.
    step : float, mm
        Distance between neighbouring rings.
    """
    found: list[list[MillingPass]] = []
    for ring in rings:
        following = _following(found[-1][-1], ring, loops, step) if found else None
        if following is None:
            found.append([ring])
        else:
            found[-1].append(following)
    return tuple(_joined(run) for run in found)


def _following(
    last: MillingPass, ring: MillingPass, loops: Sequence[Loop], step: float
) -> MillingPass | None:
    """Next ring, started where the slanted link meets it; None if it cannot be linked."""
    if not (last.is_closed and ring.is_closed):
        return None
    ahead = last.end + SLANT * step * last.chain[-1].along(1.0)
    turned = MillingPass(rotated_to(ring.chain, ahead), is_closed=True)
    is_near = 0.0 < abs(turned.start - last.end) <= FARTHEST * step
    return turned if is_near and is_inside(last.end, turned.start, loops) else None


def _joined(run: Sequence[MillingPass]) -> MillingPass:
    """Join a run of rings with slanted links."""
    if len(run) == 1:
        return run[0]
    chain: Chain = run[0].chain
    for ring in run[1:]:
        chain = (*chain, line(chain[-1].end, ring.start), *ring.chain)
    return MillingPass(chain, is_closed=False)
