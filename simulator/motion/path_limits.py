"""Limits of axes and control along each segment, and the points where a path must stop.

On a line each axis contributes its share of the direction, so that all axes arrive together.
Arcs are limited as if they were full circles. Their acceleration has two perpendicular parts:
centripetal, ``v²·κ``, and tangential. The projection of their sum on any axis of the plane is
at most ``√((v²·κ)² + (a·ρ)²)``, where ρ is the share of the path in the plane; this is kept
within the limit of the slower axis. The centripetal part gets at most 0.8 of it, which leaves
0.6 for the tangential part (3-4-5 triangle); on slower arcs more remains.

Units mm, s.

References
----------
.. [1] A. Vijayaraghavan et al., "Addressing process planning and verification issues with
   MTConnect", 2009: a control takes a time for each block, ``v ≤ s/t_block``. ``stepnc
   blockfit`` finds it.
"""

from dataclasses import dataclass

import numpy as np

from simulator.motion.segments import AxisLimits, Bools, Floats, Segments

CENTRIPETAL_SHARE = 0.8
"""Largest centripetal share of the acceleration in the plane of an arc."""

STRAIGHT_ON = 1e-6
"""Angle, rad, below which pieces of one block count as straight: rounding error."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PathLimits:
    """Greatest speed and tangential acceleration on each of N segments."""

    speed: Floats
    """Greatest speed, (N,), mm/s; 0 if a segment has no length."""
    acceleration: Floats
    """Greatest tangential acceleration, (N,), mm/s²; infinite if no axis limits it."""

    def __getitem__(self, rows: slice) -> "PathLimits":
        """Limits of a slice of the segments."""
        return PathLimits(speed=self.speed[rows], acceleration=self.acceleration[rows])


def path_limits(segments: Segments, limits: AxisLimits) -> PathLimits:
    """Convert the limits of the axes to limits of speed and acceleration along the path.

    Parameters
    ----------
    segments : Segments
        N segments; their commanded speeds are upper limits, too.

    Returns
    -------
    PathLimits

    Raises
    ------
    ValueError
        If there is no segment, or a segment's speed is unlimited.
    """
    if not len(segments):
        raise ValueError("a stretch of path needs at least one segment, got 0")
    bend, share = segments.bend, segments.greatest_shares
    grip = slower_in_plane(segments, limits.acceleration)
    speeds = (
        segments.speed,
        least(np.where(segments.is_rapid[:, None], limits.rapid, limits.feed), share),
        _block_speed(segments, limits.block_time),
        np.sqrt(_over(CENTRIPETAL_SHARE * grip, bend, np.inf)),
    )
    speed = np.where(segments.length > 0.0, np.min(speeds, axis=0), 0.0)
    endless = np.flatnonzero(np.isinf(speed))
    if len(endless):
        raise ValueError(f"segment {endless[0]}: neither command nor axis limits its speed")
    left = grip * np.sqrt(1.0 - (speed**2 * bend / grip) ** 2)
    acceleration = np.minimum(
        least(limits.acceleration, share), _over(left, segments.in_plane, np.inf)
    )
    return PathLimits(speed=speed, acceleration=acceleration)


def _over(value: Floats, divisor: Floats, otherwise: float) -> Floats:
    """Quotient of two arrays, or another value where the divisor is 0."""
    quotient = np.full(divisor.shape, otherwise)
    np.divide(value, divisor, out=quotient, where=divisor > 0.0)
    return quotient


def slower_in_plane(segments: Segments, acceleration: Floats) -> Floats:
    """Acceleration of the slower of the two axes in each segment's plane, (N,), mm/s²."""
    is_normal = np.arange(3) == segments.normal[:, None]
    slower: Floats = np.where(is_normal, np.inf, acceleration).min(axis=1)
    return slower


def least(limit: Floats, share: Floats) -> Floats:
    """Value along the path at which the first axis reaches its limit.

    Parameters
    ----------
    limit : (3,) or (N, 3) array
        Limits of the axes.
    share : (N, 3) array
        Share of each axis in the value along the path.

    Returns
    -------
    (N,) array
        In the unit of the limits.
    """
    first: Floats = _over(np.broadcast_to(limit, share.shape), share, np.inf).min(axis=1)
    return first


def block_lengths(segments: Segments) -> Floats:
    """Length of the whole block to which each segment belongs, (N,), mm."""
    is_new = np.append(True, segments.block[1:] != segments.block[:-1])
    block = np.cumsum(is_new) - 1
    whole: Floats = np.bincount(block, weights=segments.length)[block]
    return whole


def _block_speed(segments: Segments, block_time: float) -> Floats:
    """Greatest speed at which the control keeps up with the blocks, [1]_; none for rapids."""
    if block_time == 0.0:
        return np.full(len(segments), np.inf)
    return np.where(segments.is_rapid, np.inf, block_lengths(segments) / block_time)


def corners(segments: Segments) -> tuple[Floats, Floats]:
    """Directions before and after each corner between two segments, each (N−1, 3)."""
    rows = np.arange(len(segments))
    before = segments.direction(rows[:-1], segments.length[:-1])
    after = segments.direction(rows[1:], np.zeros(len(rows) - 1))
    return before, after


def goes_on(segments: Segments) -> Bools:
    """True if two successive segments continue one block straight on, (N−1,)."""
    before, after = corners(segments)
    goes: Bools = np.linalg.norm(after - before, axis=1) <= STRAIGHT_ON
    goes &= segments.block[1:] == segments.block[:-1]
    goes &= segments.is_rapid[1:] == segments.is_rapid[:-1]
    return goes


def is_stop(segments: Segments) -> Bools:
    """True if a continuous control stops at a corner, (N−1,): at begin and end of rapids."""
    rapid: Bools = segments.is_rapid[1:] | segments.is_rapid[:-1]
    return rapid & ~goes_on(segments) if rapid.any() else rapid
