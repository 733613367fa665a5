"""Parallel strokes over an area, to and fro or one way, linked without leaving the area."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil

import numpy as np

from stepnc_model.toolpath.milling.arrays import crossings_with
from stepnc_model.toolpath.milling.contour import (
    TINY,
    Chain,
    Edge,
    Loop,
    area,
    chain_length,
    line,
    moved,
    nearest,
    reversed_chain,
    vertices,
)
from stepnc_model.toolpath.milling.cover import Pass
from stepnc_model.toolpath.milling.offset import contains

CHORD = 1e-4
"""mm of tolerance where an area is measured across the strokes"""

ASIDE = 1e-6
"""mm by which the outermost strokes stay inside: they cross the wall and do not lie on it"""

SHORTEST = 1e-3
"""mm; a shorter stroke is left out"""

MOST_ROWS = 20_000

TOUCH = 1e-6
"""part of a link's length near its ends where it may touch the wall"""


@dataclass(frozen=True, slots=True)
class Stroke:
    """Part of a scan line inside the area, along increasing x of the turned system."""

    low: complex
    high: complex


def singles(rows: Sequence[Sequence[Stroke]]) -> tuple[Pass, ...]:
    """Each stroke a pass of its own."""
    return tuple(
        Pass((line(stroke.low, stroke.high),), is_closed=False)
        for row in rows
        for stroke in row
    )


def scan(loops: Sequence[Loop], *, along: complex, step: float) -> list[list[Stroke]]:
    """Strokes row by row from the right of a direction to its left."""
    back = along.conjugate()
    turned = [moved(loop, turned=back) for loop in loops]
    heights = [point.imag for loop in turned for point in vertices(loop, tolerance=CHORD)]
    if not heights:
        return []
    low, high = min(heights) + ASIDE, max(heights) - ASIDE
    count = max(1, ceil((high - low) / step - TINY) + 1) if high > low else 1
    if count > MOST_ROWS:
        raise ValueError(f"{count} strokes side by side: {MOST_ROWS} are enough")
    rows = np.linspace(low, high, count) if count > 1 else [0.5 * (low + high)]
    return [_row(turned, float(height), along) for height in rows]


def rows_at(
    loops: Sequence[Loop], heights: Sequence[float], *, along: complex
) -> list[list[Stroke]]:
    """Strokes at given distances to the left of the origin."""
    turned = [moved(loop, turned=along.conjugate()) for loop in loops]
    return [_row(turned, height, along) for height in heights]


def linked(start: complex, end: complex, loops: Sequence[Loop]) -> Chain | None:
    """Way from one point to another inside the area: straight, or along the wall."""
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
    """Whether the straight way between two points of the area stays in it."""
    edges = [edge for loop in loops for edge in loop]
    way = line(start, end)
    parts = crossings_with([way], edges)[0]
    touch = max(TOUCH, 10.0 * ASIDE / way.length)
    if any(touch < part < 1.0 - touch for part in parts):
        return False
    return contains_point(way.at(0.5), loops)


def contains_point(point: complex, loops: Sequence[Loop]) -> bool:
    """Whether a point lies in the area, or within a hair of its boundary."""
    if any(
        abs(loop[i].at(part) - point) < 10.0 * ASIDE
        for loop in loops
        for i, part in [nearest(loop, point)]
    ):
        return True
    return _is_within(point, loops)


def zigzags(rows: Sequence[Sequence[Stroke]], loops: Sequence[Loop]) -> tuple[Pass, ...]:
    """Rows joined to and fro."""
    return tuple(found for cell in _cells(rows) for found in _zigzag(cell, loops))


def _is_within(point: complex, loops: Sequence[Loop]) -> bool:
    """Whether a point lies within an outer loop and outside all islands."""
    outer = [loop for loop in loops if area(loop) > 0.0]
    islands = [loop for loop in loops if area(loop) <= 0.0]
    return any(contains([loop, *islands], [point], tolerance=CHORD)[0] for loop in outer)


def _row(turned: Sequence[Loop], height: float, along: complex) -> list[Stroke]:
    """Strokes of one scan line in the turned system, given back in the original one."""
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
    """Runs of strokes that lie side by side, one in each row."""
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
    """Whether two strokes of neighbouring rows lie side by side."""
    way = one.high - one.low
    way /= abs(way)
    ends = [((point - one.low) / way).real for point in (other.low, other.high)]
    return ends[0] < abs(one.high - one.low) and ends[1] > 0.0


def _zigzag(cell: Sequence[Stroke], loops: Sequence[Loop]) -> list[Pass]:
    """The strokes of a cell to and fro, joined where a way between them stays inside."""
    chains: list[list[Edge]] = []
    for index, stroke in enumerate(cell):
        ends = (stroke.low, stroke.high) if index % 2 == 0 else (stroke.high, stroke.low)
        way = linked(chains[-1][-1].end, ends[0], loops) if chains else None
        if way is None:
            chains.append([])
        chains[-1] += [*(way or ()), line(*ends)]
    return [Pass(tuple(chain), is_closed=False) for chain in chains]


def _along_wall(loop: Loop, start: complex, end: complex) -> Chain | None:
    """Shorter way along a loop between two points that lie on it."""
    (i, p), (j, q) = nearest(loop, start), nearest(loop, end)
    if abs(loop[i].at(p) - start) > 1e-3 or abs(loop[j].at(q) - end) > 1e-3:
        return None
    forward = _between(loop, (i, p), (j, q))
    back = reversed_chain(_between(loop, (j, q), (i, p)))
    way = forward if chain_length(forward) <= chain_length(back) else back
    if not way:
        return None
    first, last = way[0], way[-1]
    joined = [Edge(start, first.end, first.centre, first.turn), *way[1:]]
    joined[-1] = Edge(joined[-1].start, end, last.centre, last.turn)
    return tuple(joined)


def _between(loop: Loop, first: tuple[int, float], last: tuple[int, float]) -> Chain:
    """Part of a loop from one place to another, each an edge and a part of its length."""
    (i, p), (j, q) = first, last
    if i == j and q >= p:
        pieces = [loop[i].between(p, q)]
    else:
        count = (j - i) % len(loop) or len(loop)
        middle = [loop[(i + k) % len(loop)] for k in range(1, count)]
        pieces = [loop[i].between(p, 1.0), *middle, loop[j].between(0.0, q)]
    return tuple(piece for piece in pieces if piece.length > 1e-7)
