"""Geometry of many lines, arcs and helices at once, as columns; one row is one move.

The formulas are those of :mod:`stepnc_model.toolpath.arc`. A line has the turn 0. The normal is
the axis, 0, 1 or 2, that is normal to the plane of an arc; the coordinate of a centre along it
has no meaning. Units mm and rad.
"""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FIRST = np.array([1, 2, 0])
"""First axis of the plane whose normal is axis 0, 1 or 2: YZ, ZX, XY."""

SECOND = np.array([2, 0, 1])

QUARTERS = np.arange(4) * 0.5 * np.pi


def arms(start: Floats, centre: Floats, normal: Ints) -> tuple[Floats, Floats]:
    """Components of the vectors from centres to starts in the planes of arcs, (N,), mm."""
    arm, rows = start - centre, np.arange(len(normal))
    return arm[rows, FIRST[normal]], arm[rows, SECOND[normal]]


def lengths(
    start: Floats, end: Floats, *, radius: Floats, turn: Floats, normal: Ints
) -> Floats:
    """Lengths of moves, (N,), mm.

    Parameters
    ----------
    start, end : (N, 3) array, mm
    radius : (N,) array, mm
        Radius of arcs; of no meaning for lines.
    turn : (N,) array, rad
    normal : (N,) array of int
    """
    way = end - start
    straight = np.linalg.norm(way, axis=1)
    rise = way[np.arange(len(turn)), normal]
    return np.where(turn == 0.0, straight, np.hypot(radius * turn, rise))


def to_quadrants(angle: Floats, turn: Floats) -> Floats:
    """Angles that arcs turn until they are farthest out along each axis, (N, 4), rad.

    They are out along the first axis of the plane, the second, and against both; an arc that
    turns less does not get there.

    Parameters
    ----------
    angle : (N,) array, rad
        Angle of the start point from the centre.
    turn : (N,) array, rad
    """
    ways: Floats = np.sign(turn)[:, None] * (QUARTERS - angle[:, None]) % (2.0 * np.pi)
    return ways
