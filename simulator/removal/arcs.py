"""Exact contact arcs: the front half of the tool's circle minus what earlier moves cleared.

At a given height, a level line of any cutter clears a stadium shape, and a level arc clears a
ring sector with round ends. The same holds for a flat cutter on a slope, for the part of its
path that lies below that height. Each cleared shape cuts a few intervals out of the circle;
their union is free, the rest is contact. Angles φ are measured from the normal of the feed in
the direction of rotation, as in ``simulator.physics.engagement``: 0 ≤ φ ≤ π is the front half.
Units mm and rad.
"""

from math import atan2, cos, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from simulator.kernels.kernel import kernel
from simulator.motion.segments import Floats
from simulator.removal.cutter import CutterProfile, is_upright, radius_at
from simulator.removal.tip_move import LEVEL, TipMove, arc_distance, norm, way_between
from simulator.removal.zmap import HeightGrid

TOUCH = 1e-10
"""Distance, mm, within which two outlines count as the same, so that a tool does not clear
its own front."""

NARROW = 1e-6
"""Width of an interval, rad, below which it is treated as rounding error."""

MOST_INTERVALS = 256
RECORD = 20
"""Number of columns of a remembered move: its row, then the profile of its tool."""


class ToolCircle(NamedTuple):
    """Circular section of the tool at one height, with its feed direction and rotation."""

    x: float
    y: float
    radius: float
    ahead_x: float
    ahead_y: float
    """Y component of the unit vector of the feed in the XY plane."""
    side: float
    """Rotation of the spindle seen from above: 1 clockwise, −1 counter-clockwise."""


class Intervals(NamedTuple):
    """Working buffers for the free and contact intervals of one circle."""

    cuts: Floats
    """Angles at which an outline crosses the circle, (16,), rad."""
    free: Floats
    """Intervals cleared by earlier moves, (MOST_INTERVALS, 2), rad."""
    contact: Floats
    """Intervals in contact with the stock, (MOST_INTERVALS, 2), rad."""


def intervals() -> Intervals:
    """Allocate the interval buffers for one circle."""
    return Intervals(np.empty(16), np.empty((MOST_INTERVALS, 2)), np.empty((MOST_INTERVALS, 2)))


@kernel
def free_by_move(
    room: Intervals, count: int, circle: ToolCircle, record: Floats, level: float
) -> int:
    """Add the intervals of the circle that an earlier move cleared at a height.

    Parameters
    ----------
    room : Intervals
        Buffers; the cleared intervals are added to ``free``.
    count : int
        Number of free intervals so far.
    record : (RECORD,) array
        Row of the move, then the profile of its tool.
    level : float, mm

    Returns
    -------
    int
        Number of free intervals; −1 when this move has no exact outline at this height.
    """
    profile = CutterProfile(
        record[13], record[14], record[15], record[16], record[17], record[18], record[19]
    )
    begin, end, radius = _cleared(record, profile, level)
    if radius <= 0.0:
        return -1
    way = way_between(record, begin, end)
    size = circle.radius
    reach = (
        radius + size + way.radius * abs(way.turn) + norm(way.end_x - way.x, way.end_y - way.y)
    )
    if norm(circle.x - way.x, circle.y - way.y) > reach:
        return count
    if way.turn == 0.0:
        cuts = _line_cuts(room.cuts, circle, way, radius)
    else:
        cuts = _arc_cuts(room.cuts, circle, way, radius)
    return _add_inside(room, count, cuts, circle, way, radius)


@kernel
def _cleared(
    record: Floats, profile: CutterProfile, level: float
) -> tuple[float, float, float]:
    """Part of a move that lies below a height, and the radius that it clears there, mm."""
    low, high = min(record[2], record[5]), max(record[2], record[5])
    if low > level + TOUCH:
        return 0.0, 0.0, 0.0
    bends_out = record[11] != 0.0 and record[12] != 2.0
    upright = record[11] == 0.0 and norm(record[3] - record[0], record[4] - record[1]) < TOUCH
    if high - low <= LEVEL or (upright and not bends_out):
        return 0.0, 1.0, radius_at(profile, max(level - low, 0.0))
    if bends_out or not is_upright(profile):
        return 0.0, 0.0, 0.0
    # The corner clears slightly more: up to its radius where it has nearly passed through.
    if level >= high:
        return 0.0, 1.0, radius_at(profile, level - high)
    if level >= low + profile.corner:
        reached, radius = level - profile.corner, profile.radius
    else:
        reached, radius = level, radius_at(profile, 0.5 * (level - low))
    part = min((reached - record[2]) / (record[5] - record[2]), 1.0)
    if record[5] > record[2]:
        return 0.0, part, radius
    return max(part, 0.0), 1.0, radius


@kernel
def hole_radius(record: Floats, x: float, y: float, level: float) -> float:
    """Radius at a height of the hole that an earlier move made at (x, y), mm; 0 if none."""
    away = norm(record[0] - x, record[1] - y) + norm(record[3] - x, record[4] - y)
    if away > TOUCH or record[11] != 0.0:
        return 0.0
    profile = CutterProfile(
        record[13], record[14], record[15], record[16], record[17], record[18], record[19]
    )
    return _cleared(record, profile, level)[2]


@kernel
def _front(circle: ToolCircle, x: float, y: float) -> float:
    """Angle φ of a direction on the front half of the circle, rad; −1 for the rear half."""
    onward = x * circle.ahead_x + y * circle.ahead_y
    if onward <= 0.0:
        return -1.0
    return atan2(onward, circle.side * (y * circle.ahead_x - x * circle.ahead_y))


@kernel
def _line_cuts(cuts: Floats, circle: ToolCircle, way: TipMove, radius: float) -> int:
    """Find where the outline of a stadium crosses the front half of the circle."""
    along_x, along_y = way.end_x - way.x, way.end_y - way.y
    length = norm(along_x, along_y)
    if length < TOUCH:
        return _disc_cuts(cuts, 0, circle, (way.x, way.y), radius)
    along_x, along_y = along_x / length, along_y / length
    u = (circle.x - way.x) * along_x + (circle.y - way.y) * along_y
    v = (circle.y - way.y) * along_x - (circle.x - way.x) * along_y
    count = 0
    for side in (-radius, radius):
        square = circle.radius**2 - (side - v) ** 2
        if square <= 0.0:
            continue
        for du in (-sqrt(square), sqrt(square)):
            if 0.0 <= u + du <= length:
                x = du * along_x - (side - v) * along_y
                y = du * along_y + (side - v) * along_x
                count = _cut(cuts, count, _front(circle, x, y))
    count = _disc_cuts(cuts, count, circle, (way.x, way.y), radius)
    return _disc_cuts(cuts, count, circle, (way.end_x, way.end_y), radius)


@kernel
def _arc_cuts(cuts: Floats, circle: ToolCircle, way: TipMove, radius: float) -> int:
    """Find where the outline of a ring sector crosses the front half of the circle."""
    centre = (way.centre_x, way.centre_y)
    count = _disc_cuts(cuts, 0, circle, centre, way.radius + radius)
    count = _disc_cuts(cuts, count, circle, centre, abs(way.radius - radius))
    count = _disc_cuts(cuts, count, circle, (way.x, way.y), radius)
    return _disc_cuts(cuts, count, circle, (way.end_x, way.end_y), radius)


@kernel
def _disc_cuts(
    cuts: Floats, count: int, circle: ToolCircle, centre: tuple[float, float], radius: float
) -> int:
    """Find where another circle crosses the front half of the tool's circle."""
    x, y = centre[0] - circle.x, centre[1] - circle.y
    away = norm(x, y)
    if away < TOUCH:
        return count
    along = (circle.radius**2 - radius * radius + away * away) / (2.0 * away)
    square = circle.radius**2 - along * along
    if square <= 0.0:
        return count
    x, y, across = x / away, y / away, sqrt(square)
    for offset in (-across, across):
        angle = _front(circle, along * x - offset * y, along * y + offset * x)
        count = _cut(cuts, count, angle)
    return count


@kernel
def _cut(cuts: Floats, count: int, angle: float) -> int:
    """Insert a crossing of the front half into the sorted list; return the new count."""
    if not 0.0 < angle < pi or count == len(cuts):
        return count
    place = count
    while place > 0 and cuts[place - 1] > angle:
        cuts[place] = cuts[place - 1]
        place -= 1
    cuts[place] = angle
    return count + 1


@kernel
def _add_inside(
    room: Intervals, count: int, cuts: int, circle: ToolCircle, way: TipMove, radius: float
) -> int:
    """Add the intervals between crossings whose middle points lie within the swept area."""
    low = 0.0
    for index in range(cuts + 1):
        high = room.cuts[index] if index < cuts else pi
        if high - low > NARROW:
            middle = 0.5 * (low + high)
            across, onward = circle.radius * cos(middle), circle.radius * sin(middle)
            across *= circle.side
            x = circle.x + onward * circle.ahead_x - across * circle.ahead_y
            y = circle.y + onward * circle.ahead_y + across * circle.ahead_x
            if _way_distance(way, x, y) < radius - TOUCH:
                count = add_free(room, count, low, high)
        low = high
    return count


@kernel
def _way_distance(way: TipMove, x: float, y: float) -> float:
    """Distance in the plane between a point and a line or an arc, mm."""
    if way.turn != 0.0:
        return arc_distance(way, x - way.centre_x, y - way.centre_y)
    along_x, along_y = way.end_x - way.x, way.end_y - way.y
    square = along_x * along_x + along_y * along_y
    x, y = x - way.x, y - way.y
    part = 0.0
    if square > 0.0:
        part = min(max((x * along_x + y * along_y) / square, 0.0), 1.0)
    return norm(x - part * along_x, y - part * along_y)


@kernel
def add_free(room: Intervals, count: int, low: float, high: float) -> int:
    """Add a free interval or extend the last one; ignored when the buffer is full."""
    if count > 0 and room.free[count - 1, 0] <= low <= room.free[count - 1, 1]:
        room.free[count - 1, 1] = max(room.free[count - 1, 1], high)
        return count
    if count == len(room.free):
        return count
    room.free[count, 0], room.free[count, 1] = low, high
    return count + 1


@kernel
def free_by_outline(room: Intervals, count: int, circle: ToolCircle, grid: HeightGrid) -> int:
    """Add the intervals of the circle that lie outside the raw stock; return their count."""
    width = grid.heights.shape[0] * grid.dx
    depth = grid.heights.shape[1] * grid.dy
    cuts = 0
    if grid.radius > 0.0:
        centre = (grid.x + 0.5 * width, grid.y + 0.5 * depth)
        cuts = _disc_cuts(room.cuts, 0, circle, centre, grid.radius)
    for wall in (grid.x - circle.x, grid.x + width - circle.x):
        square = circle.radius**2 - wall * wall
        if square > 0.0 and grid.radius == 0.0:
            cuts = _cut(room.cuts, cuts, _front(circle, wall, -sqrt(square)))
            cuts = _cut(room.cuts, cuts, _front(circle, wall, sqrt(square)))
    for wall in (grid.y - circle.y, grid.y + depth - circle.y):
        square = circle.radius**2 - wall * wall
        if square > 0.0 and grid.radius == 0.0:
            cuts = _cut(room.cuts, cuts, _front(circle, -sqrt(square), wall))
            cuts = _cut(room.cuts, cuts, _front(circle, sqrt(square), wall))
    low = 0.0
    for index in range(cuts + 1):
        high = room.cuts[index] if index < cuts else pi
        if high - low > NARROW:
            middle = 0.5 * (low + high)
            across = circle.side * circle.radius * cos(middle)
            onward = circle.radius * sin(middle)
            x = circle.x + onward * circle.ahead_x - across * circle.ahead_y
            y = circle.y + onward * circle.ahead_y + across * circle.ahead_x
            if is_outside(grid, x, y):
                count = add_free(room, count, low, high)
        low = high
    return count


@kernel
def is_outside(grid: HeightGrid, x: float, y: float) -> bool:
    """True if a point lies outside the outline of the raw stock."""
    across = (x - grid.x) / (grid.heights.shape[0] * grid.dx)
    along = (y - grid.y) / (grid.heights.shape[1] * grid.dy)
    if not (0.0 <= across <= 1.0 and 0.0 <= along <= 1.0):
        return True
    if grid.radius == 0.0:
        return False
    x -= grid.x + 0.5 * grid.heights.shape[0] * grid.dx
    y -= grid.y + 0.5 * grid.heights.shape[1] * grid.dy
    return norm(x, y) > grid.radius


@kernel
def contact_arcs(room: Intervals, count: int) -> int:
    """Subtract the free intervals from the front half; return the number of contact arcs."""
    free, contact = room.free, room.contact
    for index in range(1, count):
        low, high, place = free[index, 0], free[index, 1], index
        while place > 0 and free[place - 1, 0] > low:
            free[place, 0], free[place, 1] = free[place - 1, 0], free[place - 1, 1]
            place -= 1
        free[place, 0], free[place, 1] = low, high
    found, reached = 0, 0.0
    for index in range(count):
        if free[index, 0] - reached > NARROW:
            contact[found, 0], contact[found, 1] = reached, free[index, 0]
            found += 1
        reached = max(reached, free[index, 1])
    if pi - reached > NARROW and found < len(contact):
        contact[found, 0], contact[found, 1] = reached, pi
        found += 1
    return found
