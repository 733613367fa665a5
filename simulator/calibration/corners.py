"""Corners of a path of axis-parallel lines that arcs join, fitted to rounded positions.

A corner is where two lines meet at right angles; an arc of some radius may round it, tangent to
both. Each position is known to half of its rounding step only, so a sample pulls at the
path only when the path misses the sample's box. Units mm.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from simulator.motion.segments import Bools, Floats, Ints

CENTRING = 0.02
"""pull of a sample inside its box, against 1 outside: picks the middle of what is possible"""
SHARP = 0.3  # mm, an arc below this radius is none
TINY = 1e-12  # mm
CLOSE, ROUNDS = 1e-4, 100
"""the fit ends when nothing changes by this share, or after so many rounds"""


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
    lower = np.concatenate([corners.offset - step, np.zeros(lines - 1)])
    upper = np.concatenate([corners.offset + step, longest])
    found = least_squares(
        lambda values: _miss(values, corners, samples).distance,
        np.concatenate([corners.offset, 0.5 * longest]),
        jac=lambda values: _slopes(_miss(values, corners, samples), corners, samples),
        bounds=(lower, upper),
        xtol=CLOSE,
        ftol=CLOSE,
        max_nfev=ROUNDS,
    )
    radius = np.where(found.x[lines:] < SHARP, 0.0, found.x[lines:])
    return replace(corners, offset=found.x[:lines], radius=radius)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Miss:
    """How a path passes N samples."""

    distance: Floats
    """(N,) mm outside of each sample's box, and a little for what is inside"""
    pull: Floats
    """(N,) slope of that over the distance from the sample itself"""
    normal: Floats
    """(N, 2) from the path, positive into the corner"""
    is_on_arc: Bools
    """(N,)"""


def _miss(values: Floats, corners: Corners, samples: CornerSamples) -> _Miss:
    """Distances of the samples from the path that has these offsets and radii."""
    lines = len(corners.offset)
    moved = replace(corners, offset=values[:lines], radius=values[lines:])
    radius = moved.radius[samples.corner]
    inside = (samples.point - moved.vertex[samples.corner]) * moved.side[samples.corner]
    arm = inside - radius[:, None]
    reach = np.hypot(arm[:, 0], arm[:, 1])
    is_on_arc = (arm < 0.0).all(axis=1)
    on_line = np.eye(2)[np.argmin(inside, axis=1)]
    normal = np.where(is_on_arc[:, None], -arm / np.maximum(reach, TINY)[:, None], on_line)
    distance = np.where(is_on_arc, radius - reach, inside.min(axis=1))
    beyond = np.maximum(0.0, np.abs(distance) - (normal * samples.half_step).sum(axis=1))
    return _Miss(
        distance=np.sign(distance) * beyond + CENTRING * distance,
        pull=(beyond > 0.0) + CENTRING,
        normal=normal,
        is_on_arc=is_on_arc,
    )


def _slopes(miss: _Miss, corners: Corners, samples: CornerSamples) -> Floats:
    """(N, 2K + 1) slope of each distance over each offset and radius.

    ``d = r − |u − r|`` on the arc, with u the place of the sample as seen from the vertex into
    the corner: a line that moves inwards takes its share of the normal off the distance.
    """
    lines, rows = len(corners.offset), np.arange(len(samples.corner))
    slope = np.zeros((len(rows), 2 * lines - 1))
    inwards = -miss.normal * corners.side[samples.corner]
    along_x = corners.is_along_x[samples.corner] == 1
    slope[rows, samples.corner] = np.where(along_x, inwards[:, 1], inwards[:, 0])
    slope[rows, samples.corner + 1] = np.where(along_x, inwards[:, 0], inwards[:, 1])
    growth = np.where(miss.is_on_arc, 1.0 - miss.normal.sum(axis=1), 0.0)
    slope[rows, lines + samples.corner] = growth
    return miss.pull[:, None] * slope
