"""Points on profiles of turned parts, and their distances from other profiles.

Profiles are lines through the middles of cells of the bar. Units mm.
"""

from dataclasses import dataclass
from math import pi

import numpy as np
from scipy.spatial import cKDTree

from simulator.motion.segments import Bools, Floats, Ints
from simulator.removal.lathe import TurningStock
from simulator.verification.path import pieces_of
from simulator.verification.sweep import FAR

PIECE = 0.1
"""Longest piece of a line whose middle stands for it, mm."""

STEEP = 1.0
"""Slope of the profile above which a surface is a face."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProfilePoints:
    """P points on a programmed profile."""

    radius: Floats
    """(P,), mm"""
    z: Floats
    """(P,), mm"""
    cell: Ints
    """Cell whose cut made the surface there, (P,)."""
    is_face: Bools
    """(P,)"""
    area: Floats
    """Area that a point stands for, (P,), mm²."""
    sign: Floats
    """Whether there is material beyond (1), less (-1) or neither (0) in the log, (P,)."""


def points_along(radius: Floats, other: Floats, bar: TurningStock) -> ProfilePoints:
    """Points in the middles of cells, where anything is left."""
    slope = np.abs(np.gradient(radius, bar.cell))
    kept = np.flatnonzero(radius > 0.0)
    area = 2.0 * pi * radius * bar.cell * np.sqrt(1.0 + np.minimum(slope, STEEP) ** 2)
    return ProfilePoints(
        radius=radius[kept],
        z=bar.z[kept],
        cell=kept,
        is_face=(slope > STEEP)[kept],
        area=area[kept],
        sign=np.sign(other - radius)[kept],
    )


def points_on_faces(radius: Floats, other: Floats, bar: TurningStock) -> ProfilePoints:
    """Points on faces, as :func:`face_places` has them."""
    cell, level, wide = _face_points(radius, bar.cell)
    low = np.minimum(other[cell], other[cell + 1])
    high = np.maximum(other[cell], other[cell + 1])
    return ProfilePoints(
        radius=level,
        z=bar.z[cell] + 0.5 * bar.cell,
        # The cell with the smaller radius was cut.
        cell=np.where(wide > 0.0, cell, cell + 1),
        is_face=np.ones(len(cell), dtype=np.bool_),
        area=2.0 * pi * level * np.abs(wide),
        sign=np.where(level < low, 1.0, np.where(level > high, -1.0, 0.0)),
    )


def face_places(radius: Floats, bar: TurningStock) -> Floats:
    """Radius and z of points on the faces of a profile, (F, 2), mm."""
    before, level, _ = _face_points(radius, bar.cell)
    return np.column_stack([level, bar.z[before] + 0.5 * bar.cell])


def _face_points(radius: Floats, cell: float) -> tuple[Ints, Floats, Floats]:
    """Points between cells whose radii differ by more than their length.

    Returns
    -------
    (F,) array of int, (F,) array, (F,) array
        Cell before each, its radius in mm, and the height in mm that it stands for.
    """
    step = np.diff(radius)
    rows = np.flatnonzero(np.abs(step) > 2.0 * STEEP * cell)
    counts = np.ceil(np.abs(step[rows]) / PIECE).astype(np.int64)
    before = np.repeat(rows, counts)
    index = np.arange(len(before)) - np.repeat(np.cumsum(counts) - counts, counts)
    wide = step[before] / np.repeat(counts, counts)
    return before, radius[before] + (index + 0.5) * wide, wide


def profile_distance(points: Floats, profile: Floats, cell: float) -> Floats:
    """Distance of points from a profile of lines, (P,), mm; at most ``FAR``."""
    return nearest_on(points, profile, cell)[0]


def nearest_on(points: Floats, profile: Floats, cell: float) -> tuple[Floats, Ints]:
    """Distance of points from a profile of lines, mm, at most ``FAR``, and the nearest line."""
    start, piece, line, _ = pieces_of(profile, cell)
    best = cKDTree(start + 0.5 * piece).query(points, k=3)[1]
    begin, along = start[best], piece[best]
    square = np.maximum(np.sum(along * along, axis=2), 1e-18)
    share = np.clip(np.sum((points[:, None] - begin) * along, axis=2) / square, 0.0, 1.0)
    near = begin + share[:, :, None] * along
    away = np.linalg.norm(points[:, None] - near, axis=2)
    chosen = away.argmin(axis=1)
    rows = np.arange(len(points))
    return np.asarray(np.minimum(away[rows, chosen], FAR)), line[best[rows, chosen]]
