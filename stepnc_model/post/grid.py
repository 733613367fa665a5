"""Rounding of blocks to the coordinate grid of a control, with arcs fitted to rounded ends.

The centre of an arc is moved onto the bisector of its rounded chord, so that the radii to both
ends agree within the rounding and no control refuses it. Nearly full circles, whose chord
hardly determines the centre, are first cut in two; arcs below the grid become lines.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from math import copysign, pi

from stepnc_model.post.blocks import (
    Block,
    Circular,
    DrillingCycle,
    Linear,
    Rapid,
    Retract,
    RigidTap,
    ThreadingMove,
)
from stepnc_model.toolpath.arc import (
    FULL,
    WHOLE,
    full_turns,
    gap,
    point_at,
    radius,
    swept,
)
from stepnc_model.toolpath.path import Arc, ArcPlane, Point

LEAST_RADIUS = 0.005
"""Least radius of an arc, mm; LinuxCNC treats smaller arcs as points."""

WIDE = 1.5 * pi
"""Angle above which an arc's chord is too short to place its centre, rad."""

NARROW = 0.5 * pi
"""Angle below which the rest after full turns has too short a chord, rad."""


def on_grid(blocks: Iterable[Block], places: int) -> Iterator[Block]:
    """Round the coordinates of blocks to the grid of a control.

    Parameters
    ----------
    places : int
        Decimal places of a coordinate in mm.
    """
    at: Point = (0.0, 0.0, 0.0)
    for block in blocks:
        if isinstance(block, Linear):
            end = rounded(block.end, places)
            if end != at:
                at = end
                yield Linear(end=end, rate=block.rate)
        elif isinstance(block, Circular):
            for piece in _arc(at, block, places):
                yield piece
                at = piece.end
        elif isinstance(block, Rapid):
            at = rounded(block.end, places)
            yield Rapid(end=at)
        elif isinstance(block, Retract):
            at = (at[0], at[1], round(block.z, places) + 0.0)
            yield Retract(z=at[2])
        elif isinstance(block, ThreadingMove):
            end = rounded(block.end, places)
            if end != at:
                at = end
                yield replace(block, end=end)
        elif isinstance(block, RigidTap):
            at = rounded(block.start, places)
            yield replace(block, start=at, bottom_z=round(block.bottom_z, places))
        elif isinstance(block, DrillingCycle):
            at = rounded((*block.at, block.retract_z), places)
            bottom = round(block.bottom_z, places)
            yield replace(block, at=at[:2], retract_z=at[2], bottom_z=bottom)
        else:
            yield block


def flat(
    blocks: Iterable[Block], keeps: Callable[[DrillingCycle], bool] | None = None
) -> Iterator[Block]:
    """Replace cycles that are not kept by their expansion into single moves."""
    for block in blocks:
        if isinstance(block, DrillingCycle) and not (keeps is not None and keeps(block)):
            yield from block.expansion
        else:
            yield block


def merged(blocks: Iterable[Block]) -> Iterator[Block]:
    """Remove rapids that lead from one cycle to the next on its retract plane."""
    last: DrillingCycle | None = None
    held: Rapid | None = None
    for block in blocks:
        if isinstance(block, DrillingCycle):
            is_there = held is not None and held.end == (*block.at, block.retract_z)
            if held is not None and not is_there:
                yield held
            held, last = None, block
            yield block
            continue
        if held is not None:
            yield held
            held = None
        if isinstance(block, Rapid) and last is not None and block.end[2] == last.retract_z:
            held = block
            continue
        last = None
        yield block
    if held is not None:
        yield held


def single_turns(blocks: Iterable[Block]) -> Iterator[Block]:
    """Split every arc of more than one turn into single turns."""
    at: Point = (0.0, 0.0, 0.0)
    for block in blocks:
        if isinstance(block, Circular):
            yield from turns(at, block)
        else:
            yield block
        at = end_of(block, at)


def pieces(start: Point, block: Circular) -> Iterator[Circular]:
    """Split an arc so that each chord determines its centre well."""
    full, rest = full_turns(block.arc.turn)
    whole = full * FULL
    if rest < WHOLE:
        parts = [whole]
    elif full and rest < NARROW:
        parts = [whole, rest]
    elif rest > WIDE:
        parts = [whole + 0.5 * rest, 0.5 * rest]
    else:
        parts = [whole + rest]
    yield from cut(start, block, [part for part in parts if part])


def turns(start: Point, block: Circular) -> Iterator[Circular]:
    """Split an arc into full turns and the rest."""
    full, rest = full_turns(block.arc.turn)
    parts = [FULL] * full + ([rest] if rest >= WHOLE or not full else [])
    yield from cut(start, block, parts)


def cut(start: Point, block: Circular, parts: list[float]) -> Iterator[Circular]:
    """Split an arc into parts by the sizes of their angles; the last keeps its end."""
    if len(parts) < 2:
        yield block
        return
    sense, total, turned = copysign(1.0, block.arc.turn), sum(parts), 0.0
    for part in parts[:-1]:
        turned += part
        end = point_at(start, block, turned / total)
        if turned % FULL <= WHOLE or FULL - turned % FULL <= WHOLE:
            # Full turns return to the start exactly.
            end = _above(start, end, block.arc.plane)
        yield replace(block, end=end, arc=replace(block.arc, turn=sense * part))
    yield replace(block, arc=replace(block.arc, turn=sense * parts[-1]))


def _above(start: Point, end: Point, plane: ArcPlane) -> Point:
    """Point over another one in a plane, at the level of a third."""
    normal = plane.axes[2]
    x, y, z = (end[axis] if axis == normal else start[axis] for axis in range(3))
    return x, y, z


def end_of(block: Block, at: Point) -> Point:
    """Position of the tool after a block."""
    if isinstance(block, (Rapid, Linear, Circular, ThreadingMove)):
        return block.end
    if isinstance(block, Retract):
        return (at[0], at[1], block.z)
    if isinstance(block, RigidTap):
        return block.start
    if isinstance(block, DrillingCycle):
        return (*block.at, block.retract_z)
    return at


def rounded(point: Point, places: int) -> Point:
    """Point rounded to the grid, without negative zeros."""
    x, y, z = point
    return round(x, places) + 0.0, round(y, places) + 0.0, round(z, places) + 0.0


def _arc(at: Point, block: Circular, places: int) -> Iterator[Circular | Linear]:
    """Fit an arc to the grid, starting from a point of the grid."""
    start = at
    for piece in pieces(at, block):
        for fitted in _fitted(start, piece, places):
            yield fitted
            start = fitted.end


def _fitted(start: Point, block: Circular, places: int) -> Iterator[Circular | Linear]:
    """Fit one arc piece to the grid; a line where the grid is too coarse for an arc."""
    arc, end = block.arc, rounded(block.end, places)
    plane, sense, size = arc.plane, copysign(1.0, arc.turn), radius(start, arc)
    full = round(abs(arc.turn) / FULL)
    is_whole = full > 0 and abs(abs(arc.turn) - full * FULL) < WHOLE
    if size >= LEAST_RADIUS and is_whole:
        closed = _above(start, end, plane)
        centre = _from(start, arc.centre, plane, places)
        whole = Arc(centre=centre, turn=sense * full * FULL, plane=plane)
        yield replace(block, end=closed, arc=whole)
        if closed != end:
            yield Linear(end=end, rate=block.rate)
        return
    if size >= LEAST_RADIUS and gap(start, end, plane) > 0.0:
        centre = _from(start, _bisected(start, end, arc), plane, places)
        angle = swept(start, end, centre, plane, sense=sense)
        more = round((abs(arc.turn) - angle) / FULL)
        if more >= 0:
            turn = sense * (angle + more * FULL)
            yield replace(block, end=end, arc=Arc(centre=centre, turn=turn, plane=plane))
            return
    if end != start:
        yield Linear(end=end, rate=block.rate)


def _bisected(start: Point, end: Point, arc: Arc) -> Point:
    """Centre of an arc moved onto the bisector of its chord."""
    first, second, _ = arc.plane.axes
    u, v = end[first] - start[first], end[second] - start[second]
    p = arc.centre[first] - 0.5 * (start[first] + end[first])
    q = arc.centre[second] - 0.5 * (start[second] + end[second])
    shift = (p * u + q * v) / (u * u + v * v)
    point = list(arc.centre)
    point[first] -= shift * u
    point[second] -= shift * v
    return point[0], point[1], point[2]


def _from(start: Point, centre: Point, plane: ArcPlane, places: int) -> Point:
    """Centre at a rounded distance from the start, as given by I, J and K."""
    first, second, _ = plane.axes
    point = list(start)
    for axis in (first, second):
        point[axis] = round(start[axis] + round(centre[axis] - start[axis], places), places)
    return point[0], point[1], point[2]
