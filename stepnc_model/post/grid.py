"""Rounding of blocks to the coordinate grid of a control, with arcs fitted to rounded ends.

The centre of an arc is moved onto the bisector of its rounded chord, so that the radii to both
ends agree within the rounding and no control refuses it. Nearly full circles, whose chord
hardly determines the centre, are first cut in two; arcs below the grid become lines.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from math import atan2, cos, hypot, pi, sin

from stepnc_model.errors import PostError
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
from stepnc_model.toolpath.path import ArcPlane, Point

FULL = 2.0 * pi

LEAST_RADIUS = 0.005
"""Least radius of an arc, mm; LinuxCNC treats smaller arcs as points."""

WHOLE = 1e-6
"""Tolerance within which an angle counts as a full turn, rad."""

NOISE = 1e-9
"""Angle below which an arc's ends are the same point, rad."""

WIDE = 1.5 * pi
"""Angle above which an arc's chord is too short to place its centre, rad."""

NARROW = 0.5 * pi
"""Angle below which the rest after full turns has too short a chord, rad."""


def on_grid(blocks: Iterable[Block], places: int) -> Iterator[Block]:
    """Round the coordinates of blocks to the grid of a control.

    Parameters
    ----------
    blocks : iterable of Block
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


def pieces(start: Point, arc: Circular) -> Iterator[Circular]:
    """Split an arc so that each chord determines its centre well."""
    sense = 1.0 if arc.turn > 0.0 else -1.0
    full, rest = divmod(abs(arc.turn), FULL)
    if FULL - rest < WHOLE:
        full, rest = full + 1.0, 0.0
    whole = full * FULL
    if rest < WHOLE:
        parts = [whole]
    elif full and rest < NARROW:
        parts = [whole, rest]
    elif rest > WIDE:
        parts = [whole + 0.5 * rest, 0.5 * rest]
    else:
        parts = [whole + rest]
    yield from cut(start, arc, [sense * part for part in parts if part])


def turns(start: Point, arc: Circular) -> Iterator[Circular]:
    """Split an arc into full turns and the rest."""
    sense = 1.0 if arc.turn > 0.0 else -1.0
    full, rest = divmod(abs(arc.turn), FULL)
    if FULL - rest < WHOLE:
        full, rest = full + 1.0, 0.0
    parts = [FULL] * int(full) + ([rest] if rest >= WHOLE or not full else [])
    yield from cut(start, arc, [sense * part for part in parts])


def cut(start: Point, arc: Circular, parts: list[float]) -> Iterator[Circular]:
    """Split an arc into parts by angle; the last part ends where the arc ends."""
    if len(parts) < 2:
        yield arc
        return
    total, turned = sum(parts), 0.0
    for part in parts[:-1]:
        turned += part
        end = along(start, arc, turned, turned / total)
        yield replace(arc, end=end, turn=part)
    yield replace(arc, turn=parts[-1])


def along(start: Point, arc: Circular, turned: float, part: float) -> Point:
    """Point of an arc at an angle from its start in rad, and at a fraction of its rise."""
    first, second, normal = arc.plane.axes
    u, v = start[first] - arc.centre[first], start[second] - arc.centre[second]
    point = list(start)
    # Full turns return to the start exactly.
    if abs(turned) % FULL > WHOLE and FULL - abs(turned) % FULL > WHOLE:
        point[first] = arc.centre[first] + u * cos(turned) - v * sin(turned)
        point[second] = arc.centre[second] + u * sin(turned) + v * cos(turned)
    point[normal] = start[normal] + part * (arc.end[normal] - start[normal])
    return point[0], point[1], point[2]


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


def sweep(start: Point, end: Point, centre: Point, plane: ArcPlane, *, sense: float) -> float:
    """Angle from start to end about a centre, rad, above 0 and at most 2π."""
    first, second, _ = plane.axes
    a, b = start[first] - centre[first], start[second] - centre[second]
    c, d = end[first] - centre[first], end[second] - centre[second]
    angle = sense * atan2(a * d - b * c, a * c + b * d)
    return angle if angle > NOISE else angle + FULL


def turn_between(
    start: Point, end: Point, centre: Point, plane: ArcPlane, *, sense: float, slack: float
) -> float:
    """Signed angle of an arc given by its ends and centre, rad.

    Raises
    ------
    PostError
        If the radii to both ends differ by more than ``slack`` in mm.
    """
    first, second, _ = plane.axes
    radii = [hypot(p[first] - centre[first], p[second] - centre[second]) for p in (start, end)]
    if min(radii) <= 0.0 or abs(radii[0] - radii[1]) > slack:
        raise PostError(
            f"invalid arc: the radii to its ends are {radii[0]:.4f} and {radii[1]:.4f} mm, "
            f"they may differ by {slack:g} mm"
        )
    return sense * sweep(start, end, centre, plane, sense=sense)


def _arc(at: Point, arc: Circular, places: int) -> Iterator[Circular | Linear]:
    """Fit an arc to the grid, starting from a point of the grid."""
    start = at
    for piece in pieces(at, arc):
        for fitted in _fitted(start, piece, places):
            yield fitted
            start = fitted.end


def _fitted(start: Point, arc: Circular, places: int) -> Iterator[Circular | Linear]:
    """Fit one arc piece to the grid; a line where the grid is too coarse for an arc."""
    first, second, _ = arc.plane.axes
    end = rounded(arc.end, places)
    sense = 1.0 if arc.turn > 0.0 else -1.0
    size = hypot(start[first] - arc.centre[first], start[second] - arc.centre[second])
    full = round(abs(arc.turn) / FULL)
    is_whole = full > 0 and abs(abs(arc.turn) - full * FULL) < WHOLE
    if size >= LEAST_RADIUS and is_whole:
        back = list(end)
        back[first], back[second] = start[first], start[second]
        closed = (back[0], back[1], back[2])
        centre = _from(start, arc.centre, arc.plane, places)
        yield replace(arc, end=closed, centre=centre, turn=sense * full * FULL)
        if closed != end:
            yield Linear(end=end, rate=arc.rate)
        return
    is_closed = (start[first], start[second]) == (end[first], end[second])
    if size >= LEAST_RADIUS and not is_closed:
        centre = _from(start, _bisected(start, end, arc), arc.plane, places)
        angle = sweep(start, end, centre, arc.plane, sense=sense)
        more = round((abs(arc.turn) - angle) / FULL)
        if more >= 0:
            yield replace(arc, end=end, centre=centre, turn=sense * (angle + more * FULL))
            return
    if end != start:
        yield Linear(end=end, rate=arc.rate)


def _bisected(start: Point, end: Point, arc: Circular) -> Point:
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
