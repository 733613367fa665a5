"""Geometry of lines, arcs and helices: lengths, points, angles, divisions and crossings.

A move is given by its start, its end and, unless it is a line, its :class:`Arc`. A helix is an
arc that rises along the normal of its plane, evenly with its angle. Columns of moves have the
same formulas in :mod:`stepnc_model.toolpath.arc_columns`. Units mm and rad.
"""

from collections.abc import Iterator, Sequence
from math import atan2, ceil, copysign, cos, dist, hypot, isnan, nan, pi, sin, sqrt
from typing import Protocol

from stepnc_model.toolpath.path import Arc, ArcPlane, Point

Flat = tuple[float, float]
"""Coordinates of a point in a plane, mm."""

FULL = 2.0 * pi
"""Angle of a whole turn, rad."""

WHOLE = 1e-6
"""Difference from whole turns that does not count, rad."""

COUNTED = 1e-9
"""Part of a turn that does not count as a begun one."""

NOISE = 1e-9
"""Angle below which an arc's ends are the same point, rad."""

RADIUS_SLACK = 0.05
"""Greatest difference of the radii to both ends of an arc that is still read as an arc, mm."""

SHARE = 0.001
"""The same as a share of the radius (LinuxCNC, "G-Code reference", G2 and G3)."""

CLOSED = 1e-7
"""Distance below which the ends of an arc are the same point, mm."""


class PathCurve(Protocol):
    """Line, arc or helix up to its end."""

    @property
    def end(self) -> Point:
        """End point, mm."""
        ...

    @property
    def arc(self) -> Arc | None:
        """Arc of the move; None for a line."""
        ...


def radius(start: Point, arc: Arc) -> float:
    """Radius of an arc, mm."""
    return gap(start, arc.centre, arc.plane)


def gap(one: Sequence[float], other: Sequence[float], plane: ArcPlane) -> float:
    """Distance of two points in a plane, mm."""
    first, second, _ = plane.axes
    return hypot(one[first] - other[first], one[second] - other[second])


def length(start: Point, move: PathCurve) -> float:
    """Length of a line, an arc or a helix, mm."""
    if move.arc is None:
        return dist(start, move.end)
    normal = move.arc.plane.axes[2]
    return hypot(radius(start, move.arc) * move.arc.turn, move.end[normal] - start[normal])


def point_at(start: Point, move: PathCurve, part: float) -> Point:
    """Point of a move at a fraction of its length, 0 to 1."""
    x, y, z = (a + part * (b - a) for a, b in zip(start, move.end, strict=True))
    if move.arc is None:
        return x, y, z
    arc = move.arc
    return on_circle(start, (x, y, z), arc.centre, arc.plane, part * arc.turn)


def on_circle(
    start: Sequence[float], level: Point, centre: Point, plane: ArcPlane, turned: float
) -> Point:
    """Point on a circle at an angle from its start, rad, at the level of another point."""
    first, second, _ = plane.axes
    u, v = start[first] - centre[first], start[second] - centre[second]
    point = list(level)
    point[first] = centre[first] + u * cos(turned) - v * sin(turned)
    point[second] = centre[second] + u * sin(turned) + v * cos(turned)
    return point[0], point[1], point[2]


def points_along(start: Point, move: PathCurve, *, step: float) -> Iterator[Point]:
    """Points on a move after its start, up to and including its end.

    Parameters
    ----------
    step : float, rad
        Greatest angle between two points of an arc.
    """
    if move.arc is not None:
        count = max(1, int(abs(move.arc.turn) / min(step, pi)) + 1)
        yield from inner_points(start, move, count)
    yield move.end


def inner_points(start: Point, move: PathCurve, count: int) -> Iterator[Point]:
    """Points that divide a move into a number of equal parts, without its ends."""
    return (point_at(start, move, index / count) for index in range(1, count))


def chord_angle(radius: float, tolerance: float) -> float:
    """Angle of a chord that lies within a tolerance in mm beside its arc, rad; 2 at most."""
    return 2.0 * sqrt(2.0 * min(tolerance / max(radius, tolerance), 0.5))


def begun_turns(turn: float) -> int:
    """Number of turns of an arc, the last one full or in part; at least 1."""
    return max(1, ceil(abs(turn) / FULL - COUNTED))


def full_turns(turn: float) -> tuple[int, float]:
    """Number of full turns of an arc, and the size of the rest, rad."""
    full, rest = divmod(abs(turn), FULL)
    return (int(full) + 1, 0.0) if FULL - rest < WHOLE else (int(full), rest)


def angle_between(centre: Flat, one: Flat, other: Flat) -> float:
    """Angle from one point to another about a centre, rad, -π to π."""
    a, b = one[0] - centre[0], one[1] - centre[1]
    c, d = other[0] - centre[0], other[1] - centre[1]
    return atan2(a * d - b * c, a * c + b * d)


def swept(
    start: Sequence[float],
    end: Sequence[float],
    centre: Point,
    plane: ArcPlane,
    *,
    sense: float,
) -> float:
    """Angle from start to end about a centre, rad, above 0 and at most 2π.

    Parameters
    ----------
    start, end : sequence of 3 floats, mm
    sense : float
        1 counter-clockwise, -1 clockwise.
    """
    first, second, _ = plane.axes
    about, one, other = ((p[first], p[second]) for p in (centre, start, end))
    angle = sense * angle_between(about, one, other)
    return angle if angle > NOISE else angle + FULL


def turn_of(
    start: Sequence[float],
    end: Sequence[float],
    centre: Point,
    plane: ArcPlane,
    *,
    sense: float,
) -> float:
    """Signed angle of an arc, rad; NaN if its radii differ too much or a point is unknown."""
    radii = [gap(point, centre, plane) for point in (start, end)]
    slack = max(RADIUS_SLACK, SHARE * max(radii))
    if isnan(sum(radii)) or min(radii) <= 0.0 or abs(radii[0] - radii[1]) > slack:
        return nan
    if gap(start, end, plane) < CLOSED:
        return sense * FULL
    return sense * swept(start, end, centre, plane, sense=sense)


def centre_of_radius(
    start: Sequence[float],
    end: Sequence[float],
    *,
    radius: float,
    plane: ArcPlane,
    sense: float,
) -> Point:
    """Centre of an arc given by its radius; a negative radius turns more than half a turn.

    Parameters
    ----------
    start, end : sequence of 3 floats, mm
    radius : float, mm
    sense : float
        1 counter-clockwise, -1 clockwise.

    Returns
    -------
    Point
        NaN where the ends are equal, unknown, or farther apart than the diameter.
    """
    first, second, _ = plane.axes
    u, v = end[first] - start[first], end[second] - start[second]
    chord = hypot(u, v)
    square = radius * radius - 0.25 * chord * chord
    # Rounded ends of half a circle may lie farther apart than its diameter.
    if not chord > CLOSED or square < -RADIUS_SLACK * abs(radius):
        return (nan, nan, nan)
    height = copysign(sqrt(max(0.0, square)), radius) * sense / chord
    centre = list(start)
    centre[first] = 0.5 * (start[first] + end[first]) - height * v
    centre[second] = 0.5 * (start[second] + end[second]) + height * u
    return centre[0], centre[1], centre[2]


def line_meets_circle(
    point: Flat, way: Flat, centre: Flat, radius: float
) -> tuple[Flat, Flat] | tuple[()]:
    """Points where a line with a unit direction meets a circle, along the line."""
    u, v = point[0] - centre[0], point[1] - centre[1]
    along = -(u * way[0] + v * way[1])
    inside = radius**2 - (way[0] * v - way[1] * u) ** 2
    if inside < 0.0:
        return ()
    low, high = along - sqrt(inside), along + sqrt(inside)
    return (
        (point[0] + low * way[0], point[1] + low * way[1]),
        (point[0] + high * way[0], point[1] + high * way[1]),
    )


def circles_meet(
    one: Flat, one_radius: float, other: Flat, other_radius: float
) -> tuple[Flat, Flat] | tuple[()]:
    """Points where two circles meet; none of concentric ones."""
    u, v = other[0] - one[0], other[1] - one[1]
    apart = hypot(u, v)
    if apart < NOISE:
        return ()
    along = (apart**2 + one_radius**2 - other_radius**2) / (2.0 * apart)
    inside = one_radius**2 - along**2
    if inside < 0.0:
        return ()
    beside = sqrt(inside)
    x, y = one[0] + along * u / apart, one[1] + along * v / apart
    u, v = beside * u / apart, beside * v / apart
    return (x - v, y + u), (x + v, y - u)
