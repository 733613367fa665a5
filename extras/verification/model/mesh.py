"""Required part as triangles: its edges, its outline at a height, and its heights. Units mm.

Deviation of the programmed part from the nominal walls and floors of its features.

A wall of the programmed part is compared in the plane with the nearest line of the nominal
outline; a floor by its height. Excess is positive, a gouge negative. Units mm.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from extras.verification.model.path import pieces_of
from extras.verification.model.sweep import FAR
from simulator.motion.segments import Floats, Ints
from simulator.removal.mesh_stock import EDGE, FLAT

PIECE = 0.05
"""Longest piece of an outline whose middle stands for it, mm."""

END = 0.3
"""Share of the first and last piece of a profile whose points are not compared: the surface
may turn away there."""

NEAR_FLOOR = 1.0
"""Greatest difference of heights, mm, at which a floor is that of the feature."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NominalOutline:
    """Outline of nominal walls at one height, as the lines between points."""

    points: tuple[Floats, ...]
    """Points of each chain, (N, 2), mm."""


def wall_deviation(points: Floats, normal: Floats, outline: NominalOutline) -> Floats:
    """Deviation of points on programmed walls from a nominal outline.

    Parameters
    ----------
    points : (P, 2) array, mm
    normal : (P, 2) array
        Direction from the air into the material.

    Returns
    -------
    (P,) array, mm
        NaN where the outline is farther away than 5 mm.
    """
    starts, vectors = [], []
    for chain in outline.points:
        start, vector, _, _ = pieces_of(chain, PIECE)
        starts.append(start)
        vectors.append(vector)
    if not starts:
        return np.full(len(points), np.nan)
    start, vector = np.concatenate(starts), np.concatenate(vectors)
    best = cKDTree(start + 0.5 * vector).query(points)[1]
    start, vector = start[best], vector[best]
    square = np.maximum(np.sum(vector * vector, axis=1), 1e-18)
    share = np.clip(np.sum((points - start) * vector, axis=1) / square, 0.0, 1.0)
    away = start + share[:, None] * vector - points
    size = np.hypot(*away.T)
    # Material is too much where the nominal wall lies deeper in it.
    deviation = np.sum(away * normal, axis=1)
    return np.where(size <= FAR, deviation, np.nan)


def profile_side(points: Floats, chains: Sequence[Floats]) -> Floats:
    """Deviation of points of a turned profile from nominal ones.

    Parameters
    ----------
    points : (P, 2) array, mm
        z and radius.
    chains : sequence of (N, 2) array, mm
        z and radius along each nominal profile, from the front: material lies to the left.

    Returns
    -------
    (P,) array, mm
        Excess positive; NaN beyond the ends of the profiles, and farther away than 5 mm.
    """
    if not chains:
        return np.full(len(points), np.nan)
    parts = [pieces_of(chain, PIECE) for chain in chains]
    start = np.concatenate([part[0] for part in parts])
    vector = np.concatenate([part[1] for part in parts])
    last = np.cumsum([len(part[0]) for part in parts]) - 1
    best = cKDTree(start + 0.5 * vector).query(points)[1]
    start, vector = start[best], vector[best]
    square = np.maximum(np.sum(vector * vector, axis=1), 1e-18)
    share = np.sum((points - start) * vector, axis=1) / square
    is_before = np.isin(best, np.append(0, last[:-1] + 1)) & (share < END)
    is_after = np.isin(best, last) & (share > 1.0 - END)
    away = points - start - np.clip(share, 0.0, 1.0)[:, None] * vector
    side = away[:, 0] * vector[:, 1] - away[:, 1] * vector[:, 0]
    size = np.hypot(*away.T)
    is_known = (size <= FAR) & ~is_before & ~is_after
    return np.where(is_known, np.where(side < 0.0, -size, size), np.nan)


def floor_deviation(heights: Floats, floors: Sequence[float]) -> Floats:
    """Deviation of programmed floors from the nearest nominal floor, (P,), mm; NaN: none."""
    if not floors:
        return np.full(len(heights), np.nan)
    differences = heights[:, None] - np.array(floors, dtype=np.float64)
    best = np.abs(differences).argmin(axis=1)
    nearest = differences[np.arange(len(heights)), best]
    return np.where(np.abs(nearest) <= NEAR_FLOOR, nearest, np.nan)


def section_at(triangles: Floats, height: float) -> tuple[Floats, Ints]:
    """Cut triangles at a height.

    Parameters
    ----------
    triangles : (T, 3, 3) array, mm
    height : float, mm

    Returns
    -------
    lines : (L, 2, 2) array, mm
    triangle : (L,) array of int
    """
    above = triangles[:, :, 2] > height
    cut = np.flatnonzero(above.any(axis=1) & ~above.all(axis=1))
    # Turned so that the corner that is alone on its side comes first.
    is_alone = above[cut] == (above[cut].sum(axis=1) == 1)[:, None]
    first = is_alone.argmax(axis=1)
    rows = np.arange(len(cut))
    one, two, three = (triangles[cut][rows, (first + step) % 3] for step in range(3))
    ends = []
    for other in (two, three):
        share = ((height - one[:, 2]) / (other[:, 2] - one[:, 2]))[:, None]
        ends.append(one[:, :2] + share * (other[:, :2] - one[:, :2]))
    return np.stack(ends, axis=1), cut


def outline_at(triangles: Floats, height: float) -> NominalOutline:
    """Outline of triangles, (T, 3, 3) in mm, at a height."""
    return NominalOutline(points=tuple(section_at(triangles, height)[0]))


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
