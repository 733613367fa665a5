"""Meshes of required parts: a block with a round-cornered pocket, and a body of revolution."""

from collections.abc import Sequence
from itertools import pairwise
from math import cos, hypot, pi, sin

import numpy as np

from simulator.motion.segments import Floats

Spot = tuple[float, float]


def strip(one: Floats, other: Floats) -> list[Floats]:
    """Triangles between two closed rows of points, (N, 3)."""
    found = []
    for index in range(len(one)):
        after = (index + 1) % len(one)
        found.append(np.array([one[index], one[after], other[index]]))
        found.append(np.array([one[after], other[after], other[index]]))
    return found


def fan(ring: Floats, middle: Floats) -> list[Floats]:
    """Triangles from a closed row of points to its middle."""
    return [
        np.array([ring[index], ring[(index + 1) % len(ring)], middle])
        for index in range(len(ring))
    ]


def pocketed_block(
    low: Sequence[float],
    high: Sequence[float],
    *,
    half: Spot,
    radius: float,
    depth: float,
    fine: float = 0.02,
) -> Floats:
    """A block with a pocket in its middle, (T, 3, 3), mm.

    Parameters
    ----------
    half : tuple of 2 floats, mm
        Half the length and width of the pocket.
    radius : float, mm
        Radius of its corners.
    depth : float, mm
    fine : float, rad
        Greatest angle between points as seen from the middle.
    """
    middle = np.array([0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])])
    size = (0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1]))
    corner = (half[0] - radius, half[1] - radius)
    arcs = [
        np.arctan2(sy * (corner[1] + radius * sin(turn)), sx * (corner[0] + radius * cos(turn)))
        for sx in (1, -1)
        for sy in (1, -1)
        for turn in np.linspace(0.0, 0.5 * pi, 33).tolist()
    ]
    corners = [np.arctan2(sy * size[1], sx * size[0]) for sx in (1, -1) for sy in (1, -1)]
    even = np.arange(-pi, pi, fine)
    angles = np.unique(np.round(np.concatenate((arcs, corners, even)), 9))
    outer = np.array([_on_box(angle, size) for angle in angles.tolist()]) + middle
    inner = np.array([_on_round(angle, half, radius) for angle in angles.tolist()]) + middle

    def at(ring: Floats, z: float) -> Floats:
        return np.column_stack([ring, np.full(len(ring), z)])

    top, bottom, floor = high[2], low[2], high[2] - depth
    return np.array([
        *strip(at(outer, top), at(inner, top)),
        *strip(at(inner, top), at(inner, floor)),
        *fan(at(inner, floor), np.array([*middle, floor])),
        *strip(at(outer, bottom), at(outer, top)),
        *fan(at(outer, bottom)[::-1], np.array([*middle, bottom])),
    ])


def revolved(profile: Sequence[Spot], *, count: int = 96) -> Floats:
    """Body of revolution about Z through points z and r, from axis to axis, (T, 3, 3), mm."""
    angles = 2.0 * pi * np.arange(count) / count
    rings = [
        np.column_stack([r * np.cos(angles), r * np.sin(angles), np.full(count, z)])
        for z, r in profile
    ]
    found: list[Floats] = []
    for one, other in pairwise(rings):
        found += strip(one, other)
    triangles = np.array(found)
    size = np.linalg.norm(
        np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1
    )
    return np.asarray(triangles[size > 1e-12])


def _on_box(angle: float, half: Spot) -> Spot:
    x, y = cos(angle), sin(angle)
    scale = min(half[axis] / abs(each) for axis, each in enumerate((x, y)) if abs(each) > 1e-12)
    return scale * x, scale * y


def _on_round(angle: float, half: Spot, radius: float) -> Spot:
    """Point of a rectangle with rounded corners along a ray from its middle."""
    x, y = _on_box(angle, half)
    corner = (half[0] - radius, half[1] - radius)
    if abs(x) <= corner[0] or abs(y) <= corner[1]:
        return x, y
    # The ray meets the circle of the corner.
    centre = (np.copysign(corner[0], x), np.copysign(corner[1], y))
    along = (x / hypot(x, y), y / hypot(x, y))
    near = centre[0] * along[0] + centre[1] * along[1]
    rest = radius**2 - (hypot(*centre) ** 2 - near**2)
    scale = near + rest**0.5
    return scale * along[0], scale * along[1]
