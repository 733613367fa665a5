"""Corners of a path of axis-parallel lines that arcs join, fitted to rounded positions.

A corner is where two lines meet at right angles; an arc of some radius may round it, tangent to
both. Each position is known to half of its rounding step only, so a sample pulls at the
path only when the path misses the sample's box. Units mm.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from simulator.motion.segments import Floats, Ints

CENTRING = (1.0, 0.1, 0.02)
"""pull of a sample inside its box, against that and 1 outside, from fit to fit: the last picks
the middle of what is possible"""
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
    values = np.concatenate([corners.offset, 0.5 * longest])
    # The boxes make the last fit bumpy; what is found without them is near its best valley.
    for centring in CENTRING:
        values = least_squares(
            lambda values, pull=centring: _miss(values, corners, samples, pull).distance,
            values,
            jac=lambda values, pull=centring: _slopes(
                _miss(values, corners, samples, pull), corners, samples
            ),
            bounds=(lower, upper),
            xtol=CLOSE,
            ftol=CLOSE,
            max_nfev=ROUNDS,
        ).x
    radius = np.where(values[lines:] < SHARP, 0.0, values[lines:])
    return replace(corners, offset=values[:lines], radius=radius)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Miss:
    """Residuals of a path from N samples."""

    distance: Floats
    """(N,) mm outside of each sample's box, and a little for what is inside"""
    push: Floats
    """(N, 2) its slope over the place of the sample as seen from the vertex into the corner"""
    growth: Floats
    """(N,) its slope over the radius"""


def _miss(values: Floats, corners: Corners, samples: CornerSamples, centring: float) -> _Miss:
    """Distances of the samples from the path that has these offsets and radii.

    ``d = r − |r − u|`` on the arc, u the place as seen from the vertex; the box reaches
    ``n·h`` along the normal ``n = (r − u)/|r − u|``, h the half rounding steps.
    """
    lines = len(corners.offset)
    moved = replace(corners, offset=values[:lines], radius=values[lines:])
    radius = moved.radius[samples.corner]
    inside = (samples.point - moved.vertex[samples.corner]) * moved.side[samples.corner]
    arm = radius[:, None] - inside
    reach = np.maximum(np.hypot(arm[:, 0], arm[:, 1]), TINY)
    on_arc = ((arm[:, 0] > 0.0) & (arm[:, 1] > 0.0)).astype(np.float64)
    is_bent = on_arc[:, None] > 0.0
    normal = np.where(is_bent, arm / reach[:, None], np.eye(2)[np.argmin(inside, axis=1)])
    distance = np.where(on_arc > 0.0, radius - reach, inside.min(axis=1))
    room = (normal * samples.half_step).sum(axis=1)
    beyond = np.maximum(0.0, np.abs(distance) - room)
    pull = (beyond > 0.0) + centring
    # The normal turns as the arc moves, and the box's reach with it.
    swing = (samples.half_step - normal * room[:, None]) / reach[:, None]
    swing *= (on_arc * np.sign(distance) * (beyond > 0.0))[:, None]
    return _Miss(
        distance=np.sign(distance) * beyond + centring * distance,
        push=pull[:, None] * normal + swing,
        growth=on_arc * pull * (1.0 - normal.sum(axis=1)) - swing.sum(axis=1),
    )


def _slopes(miss: _Miss, corners: Corners, samples: CornerSamples) -> Floats:
    """(N, 2K + 1) slope of each distance over each offset and radius."""
    lines, rows = len(corners.offset), np.arange(len(samples.corner))
    slope = np.zeros((len(rows), 2 * lines - 1))
    inwards = -miss.push * corners.side[samples.corner]
    along_x = corners.is_along_x[samples.corner] == 1
    slope[rows, samples.corner] = np.where(along_x, inwards[:, 1], inwards[:, 0])
    slope[rows, samples.corner + 1] = np.where(along_x, inwards[:, 0], inwards[:, 1])
    slope[rows, lines + samples.corner] = miss.growth
    return slope
