"""Centres and angles of arcs as controls compute them from the words of a block."""

from collections.abc import Sequence
from math import copysign, hypot, isnan, nan, sqrt

from stepnc_model.post.grid import FULL, sweep
from stepnc_model.toolpath.path import ArcPlane, Point

RADIUS_SLACK = 0.05
"""Greatest difference of the radii to both ends of an arc that is still read as an arc, mm."""

SHARE = 0.001
"""The same as a share of the radius (LinuxCNC, "G-Code reference", G2 and G3)."""

CLOSED = 1e-7
"""Distance below which the ends of an arc are the same point, mm."""


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
    plane : ArcPlane
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


def turn_of(
    start: Sequence[float],
    end: Sequence[float],
    centre: Point,
    plane: ArcPlane,
    *,
    sense: float,
) -> float:
    """Signed angle of an arc, rad; NaN if its radii differ too much or a point is unknown."""
    first, second, _ = plane.axes
    radii = [hypot(p[first] - centre[first], p[second] - centre[second]) for p in (start, end)]
    slack = max(RADIUS_SLACK, SHARE * max(radii))
    if isnan(sum(radii)) or min(radii) <= 0.0 or abs(radii[0] - radii[1]) > slack:
        return nan
    gap = hypot(end[first] - start[first], end[second] - start[second])
    if gap < CLOSED:
        return sense * FULL
    return sense * sweep(_point(start), _point(end), centre, plane, sense=sense)


def _point(numbers: Sequence[float]) -> Point:
    return numbers[0], numbers[1], numbers[2]
