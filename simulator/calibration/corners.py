"""Corners of a path of axis-parallel lines that arcs join, fitted to rounded positions.

A corner is where two lines meet at right angles; an arc of some radius may round it, tangent to
both. Each position is known to half of its rounding step only, so a sample pulls at the
path only when the path misses the sample's box. Units mm.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from simulator.motion.segments import Floats, Ints

CENTRING = 0.02
"""pull of a sample inside its box, against 1 outside: picks the middle of what is possible"""
SHARP = 0.3  # mm, an arc below this radius is none


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Corners:
    """K corners in one plane, and K + 1 lines, the first before the first corner."""

    offset: Floats
    """(K + 1,) mm, the coordinate that stays the same along a line"""
    is_along_x: Ints
    """(K + 1,) 1 where a line runs along X, 0 along Y; they alternate"""
    side: Floats
    """(K, 2) of +1 and −1: where in X and in Y the rest of the two lines lies"""
    radius: Floats
    """(K,) mm"""

    @property
    def vertex(self) -> Floats:
        """(K, 2) mm, where the lines meet."""
        first, second = self.offset[:-1], self.offset[1:]
        along_x = self.is_along_x[:-1] == 1
        return np.stack(
            [np.where(along_x, second, first), np.where(along_x, first, second)], axis=1
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CornerSamples:
    """N rounded positions, each with the corner to which it belongs."""

    corner: Ints
    """(N,)"""
    point: Floats
    """(N, 2) mm"""
    half_step: Floats
    """(N, 2) mm"""


def fitted(corners: Corners, samples: CornerSamples, *, longest: Floats) -> Corners:
    """Corners moved and rounded to pass through the samples.

    Parameters
    ----------
    corners : Corners
        Its offsets are right to within a rounding step; its radii are ignored.
    samples : CornerSamples
    longest : (K,) array, mm
        Greatest radius of each.
    """
    lines = len(corners.offset)
    step = 2.0 * float(samples.half_step.max())

    def moved(values: Floats) -> Corners:
        return replace(corners, offset=values[:lines], radius=values[lines:])

    lower = np.concatenate([corners.offset - step, np.zeros(lines - 1)])
    upper = np.concatenate([corners.offset + step, longest])
    start = np.concatenate([corners.offset, 0.5 * longest])
    found = least_squares(
        lambda values: _misses(moved(values), samples),
        start,
        bounds=(lower, upper),
        loss="soft_l1",
        f_scale=float(samples.half_step.min()),
    )
    corners = moved(found.x)
    return replace(corners, radius=np.where(corners.radius < SHARP, 0.0, corners.radius))


def _misses(corners: Corners, samples: CornerSamples) -> Floats:
    """How far the path passes outside of each sample's box, mm."""
    side, radius = corners.side[samples.corner], corners.radius[samples.corner]
    inside = (samples.point - corners.vertex[samples.corner]) * side
    arm = inside - radius[:, None]
    reach = np.hypot(arm[:, 0], arm[:, 1])
    on_arc = (arm < 0.0).all(axis=1) & (reach > 0.0)
    nearer = np.argmin(inside, axis=1)
    normal = np.where(
        on_arc[:, None], np.abs(arm) / np.where(on_arc, reach, 1.0)[:, None], np.eye(2)[nearer]
    )
    distance = np.where(on_arc, radius - reach, inside.min(axis=1))
    room = (normal * samples.half_step).sum(axis=1)
    outside = np.sign(distance) * np.maximum(0.0, np.abs(distance) - room)
    return outside + CENTRING * distance
