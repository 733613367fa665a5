"""Required part as triangles: its outline at a height, and its heights. Units mm."""

import numpy as np

from simulator.motion.segments import Floats
from simulator.verification.nominal import NEAR_FLOOR, NominalOutline

FLAT = 1e-9
"""Area in plan, mm², below which a triangle is upright."""

EDGE = 1e-9
"""Share by which a place may lie beside a triangle that counts as over it."""


def outline_at(triangles: Floats, height: float) -> NominalOutline:
    """Cut triangles at a height.

    Parameters
    ----------
    triangles : (T, 3, 3) array, mm
    height : float, mm
    """
    above = triangles[:, :, 2] > height
    cut = triangles[above.any(axis=1) & ~above.all(axis=1)]
    sides = above[above.any(axis=1) & ~above.all(axis=1)]
    lines = []
    for corners, is_above in zip(cut, sides, strict=True):
        ends = [
            _crossing(corners[first], corners[second], height)
            for first, second in ((0, 1), (1, 2), (2, 0))
            if is_above[first] != is_above[second]
        ]
        lines.append(np.array(ends))
    return NominalOutline(points=tuple(lines))


def height_deviation(places: Floats, triangles: Floats) -> Floats:
    """Height of places over the nearest triangle above or below, (N,), mm.

    Parameters
    ----------
    places : (N, 3) array, mm
    triangles : (T, 3, 3) array, mm

    Returns
    -------
    (N,) array, mm
        Positive where the triangle is below; NaN without one within 1 mm.
    """
    order = np.argsort(places[:, 0], kind="stable")
    sorted_places = places[order]
    found = np.full(len(places), np.inf)
    for a, b, c in triangles:
        area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        if abs(area) < FLAT:
            continue
        low, high = min(a[0], b[0], c[0]), max(a[0], b[0], c[0])
        first, last = sorted_places[:, 0].searchsorted([low, high + EDGE])
        near = sorted_places[first:last]
        x, y = near[:, 0] - a[0], near[:, 1] - a[1]
        one = (x * (c[1] - a[1]) - y * (c[0] - a[0])) / area
        two = (y * (b[0] - a[0]) - x * (b[1] - a[1])) / area
        height = a[2] + one * (b[2] - a[2]) + two * (c[2] - a[2])
        is_over = (one >= -EDGE) & (two >= -EDGE) & (one + two <= 1.0 + EDGE)
        away = np.where(is_over, near[:, 2] - height, np.inf)
        part = found[first:last]
        found[first:last] = np.where(np.abs(away) < np.abs(part), away, part)
    whole = np.empty(len(places))
    whole[order] = np.where(np.abs(found) <= NEAR_FLOOR, found, np.nan)
    return whole


def _crossing(one: Floats, other: Floats, height: float) -> Floats:
    """Point of a side of a triangle at a height, (2,), mm."""
    share = (height - one[2]) / (other[2] - one[2])
    return np.asarray(one[:2] + share * (other[:2] - one[:2]))
