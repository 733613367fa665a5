"""Tool-tip move along a line, or an arc or helix in XY, for kernels. Units mm and rad."""

from math import acos, atan2, cos, inf, pi, sin, sqrt
from typing import NamedTuple

from simulator.kernels.kernel import kernel
from simulator.motion.segments import Floats

LEAST = 1e-9
"""Thickness, mm, below which material counts as rounding error and is not cut."""

LEVEL = 1e-9
"""Largest rise, mm, of a move that still counts as level."""


class TipMove(NamedTuple):
    """Line, or arc or helix in the XY plane, along which the tip of the tool moves."""

    x: float
    y: float
    z: float
    end_x: float
    end_y: float
    end_z: float
    centre_x: float
    centre_y: float
    radius: float
    angle: float
    """Angle of the radius from the centre to the start point, rad."""
    turn: float
    """Signed angle of the arc, rad; 0 for a line."""


@kernel
def norm(x: float, y: float) -> float:
    """Length of a vector in the plane; mm need no guard against overflow, unlike hypot."""
    return sqrt(x * x + y * y)


@kernel
def place(row: Floats, part: float) -> tuple[float, float, float]:
    """Point on a row of :func:`rows_of` at a share of its length, mm."""
    # Ends are those of the row, so that a move goes on exactly where the last one ended.
    if part == 0.0:
        return row[0], row[1], row[2]
    if part == 1.0:
        return row[3], row[4], row[5]
    x = row[0] + part * (row[3] - row[0])
    y = row[1] + part * (row[4] - row[1])
    z = row[2] + part * (row[5] - row[2])
    if row[11] == 0.0:
        return x, y, z
    angle = row[10] + part * row[11]
    first, second = row[9] * cos(angle), row[9] * sin(angle)
    if row[12] == 2.0:
        return row[6] + first, row[7] + second, z
    if row[12] == 0.0:
        return x, row[7] + first, row[8] + second
    return row[6] + second, y, row[8] + first


@kernel
def way_between(row: Floats, begin: float, end: float) -> TipMove:
    """Part of a row between two shares of its length; a chord if the arc is not in XY."""
    x, y, z = place(row, begin)
    end_x, end_y, end_z = place(row, end)
    if row[11] == 0.0 or row[12] != 2.0:
        return TipMove(x, y, z, end_x, end_y, end_z, 0.0, 0.0, 0.0, 0.0, 0.0)
    angle, turn = row[10] + begin * row[11], (end - begin) * row[11]
    return TipMove(x, y, z, end_x, end_y, end_z, row[6], row[7], row[9], angle, turn)


@kernel
def bounds(way: TipMove, reach: float) -> tuple[float, float, float, float]:
    """Bounding box in XY of the sweep of an arc: low x, high x, low y, high y, mm."""
    low_x, high_x = min(way.x, way.end_x), max(way.x, way.end_x)
    low_y, high_y = min(way.y, way.end_y), max(way.y, way.end_y)
    for quarter in range(4):
        turned = (0.5 * pi * quarter - way.angle) * (1.0 if way.turn > 0.0 else -1.0)
        if turned % (2.0 * pi) < abs(way.turn):
            x = way.centre_x + way.radius * cos(0.5 * pi * quarter)
            y = way.centre_y + way.radius * sin(0.5 * pi * quarter)
            low_x, high_x = min(low_x, x), max(high_x, x)
            low_y, high_y = min(low_y, y), max(high_y, y)
    return low_x - reach, high_x + reach, low_y - reach, high_y + reach


@kernel
def arc_distance(way: TipMove, x: float, y: float) -> float:
    """Distance of a point, relative to the centre, from an arc of at most half a turn, mm."""
    if is_abreast(way, x, y):
        return abs(norm(x, y) - way.radius)
    start_x, start_y = way.x - way.centre_x, way.y - way.centre_y
    end_x, end_y = way.end_x - way.centre_x, way.end_y - way.centre_y
    return min(norm(x - start_x, y - start_y), norm(x - end_x, y - end_y))


@kernel
def is_abreast(way: TipMove, x: float, y: float) -> bool:
    """True if a point, relative to the centre, lies between the radii to an arc's ends."""
    start_x, start_y = way.x - way.centre_x, way.y - way.centre_y
    end_x, end_y = way.end_x - way.centre_x, way.end_y - way.centre_y
    sign = 1.0 if way.turn > 0.0 else -1.0
    return sign * (start_x * y - start_y * x) >= 0.0 and sign * (x * end_y - y * end_x) >= 0.0


@kernel
def helix_height(way: TipMove, x: float, y: float, reach: float) -> float:
    """Lowest height over a point of a flat tool on a helix of at most half a turn, mm."""
    sign = 1.0 if way.turn > 0.0 else -1.0
    whole = abs(way.turn)
    away = norm(x, y)
    span = (away * away + way.radius**2 - reach * reach) / (2.0 * max(away, LEAST) * way.radius)
    if span >= 1.0:
        return inf
    half = acos(max(span, -1.0))
    turned = sign * (atan2(y, x) - way.angle) % (2.0 * pi)
    best = inf
    for shift in (-2.0 * pi, 0.0, 2.0 * pi):
        low = max(turned + shift - half, 0.0)
        high = min(turned + shift + half, whole)
        if low <= high:
            part = (low if way.end_z > way.z else high) / whole
            best = min(best, way.z + part * (way.end_z - way.z))
    return best


@kernel
def copy(source: Floats, into: Floats, first: int) -> None:
    """Copy an array into another one, beginning at a position."""
    for index in range(len(source)):
        into[first + index] = source[index]


@kernel
def raised(row: Floats, lift: float, into: Floats) -> Floats:
    """Copy of a row shifted upward by a lift in mm."""
    copy(row, into, 0)
    into[2] += lift
    into[5] += lift
    into[8] += lift
    return into
