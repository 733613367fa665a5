"""Limits of axes and control along each segment, and the points where a path must stop.

Lines take of each axis its share of the direction, so that all axes arrive together. Arcs are
limited as if they turned fully round. Their acceleration is a right-angled pair: centripetal
``v²·κ`` and tangential; the sum of the two projected on any axis of the plane is at most
``√((v²·κ)² + (a·ρ)²)``, with ρ the share of the path in the plane, and that is kept within the
slower axis. The centripetal part gets at most 0.8 of it, which leaves 0.6 for the tangential
(3-4-5 triangle); an arc that runs slower keeps more.

Units mm, s.

References
----------
.. [1] A. Vijayaraghavan et al., "Addressing process planning and verification issues with
   MTConnect", 2009: a control takes a time for each block, ``v ≤ s/t_block``.
"""

from dataclasses import dataclass

import numpy as np

from simulator.motion.segments import AxisLimits, Bools, Floats, Segments

CENTRIPETAL_SHARE = 0.8
"""of the acceleration in the plane of an arc, at most"""

STRAIGHT_ON = 1e-6
"""rad; pieces cut from one block bend by rounding only"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PathLimits:
    """Greatest speed and tangential acceleration on each of N segments."""

    speed: Floats
    """Speed, (N,) mm/s; 0 where a segment has no length"""
    acceleration: Floats
    """Acceleration, (N,) mm/s²; infinite where no axis limits it"""

    def __getitem__(self, rows: slice) -> "PathLimits":
        """Those of some of the segments."""
        return PathLimits(speed=self.speed[rows], acceleration=self.acceleration[rows])


def path_limits(segments: Segments, limits: AxisLimits) -> PathLimits:
    """Speed and acceleration along the path within those of the axes.

    Parameters
    ----------
    segments : Segments
        N of them; commanded speeds are caps as well.
    limits : AxisLimits

    Returns
    -------
    PathLimits

    Raises
    ------
    ValueError
        When there is no segment, or a segment's speed has no bound at all.
    """
    if not len(segments):
        raise ValueError("a stretch of path needs at least one segment, got 0")
    turn_rate = _over(segments.turn, segments.length, 0.0)
    in_plane = segments.radius * np.abs(turn_rate)
    bend = in_plane * np.abs(turn_rate)
    share = _shares(segments, in_plane)
    grip = _slower_in_plane(segments, limits.acceleration)
    speeds = (
        segments.speed,
        least(np.where(segments.is_rapid[:, None], limits.rapid, limits.feed), share),
        _block_speed(segments, limits.block_time),
        np.sqrt(_over(CENTRIPETAL_SHARE * grip, bend, np.inf)),
    )
    speed = np.where(segments.length > 0.0, np.min(speeds, axis=0), 0.0)
    endless = np.flatnonzero(np.isinf(speed))
    if len(endless):
        raise ValueError(f"segment {endless[0]}: neither command nor axis bounds its speed")
    left = grip * np.sqrt(1.0 - (speed**2 * bend / grip) ** 2)
    acceleration = np.minimum(least(limits.acceleration, share), _over(left, in_plane, np.inf))
    return PathLimits(speed=speed, acceleration=acceleration)


def _over(value: Floats, divisor: Floats, otherwise: float) -> Floats:
    """Quotient, or another value where the divisor is 0."""
    quotient = np.full(divisor.shape, otherwise)
    np.divide(value, divisor, out=quotient, where=divisor > 0.0)
    return quotient


def _shares(segments: Segments, in_plane: Floats) -> Floats:
    """(N, 3) how much each axis moves at most per length of path."""
    moved = np.abs(segments.end - segments.start)
    share = _over(moved, np.broadcast_to(segments.length[:, None], moved.shape), 0.0)
    is_in_plane = np.arange(3) != segments.normal[:, None]
    is_arc = segments.turn[:, None] != 0.0
    return np.where(is_arc & is_in_plane, in_plane[:, None], share)


def _slower_in_plane(segments: Segments, acceleration: Floats) -> Floats:
    """(N,) acceleration of the slower of the two axes in a segment's plane, mm/s²."""
    is_normal = np.arange(3) == segments.normal[:, None]
    slower: Floats = np.where(is_normal, np.inf, acceleration).min(axis=1)
    return slower


def least(limit: Floats, share: Floats) -> Floats:
    """Value along the path at which the first axis reaches its limit.

    Parameters
    ----------
    limit : (3,) or (N, 3) array
        Of the axes.
    share : (N, 3) array
        How much of the path's value each axis has.

    Returns
    -------
    (N,) array
        In the unit of the limit.
    """
    first: Floats = _over(np.broadcast_to(limit, share.shape), share, np.inf).min(axis=1)
    return first


def block_lengths(segments: Segments) -> Floats:
    """(N,) length of the whole block of which each segment is a piece, mm."""
    is_new = np.append(True, segments.block[1:] != segments.block[:-1])
    block = np.cumsum(is_new) - 1
    whole: Floats = np.bincount(block, weights=segments.length)[block]
    return whole


def _block_speed(segments: Segments, block_time: float) -> Floats:
    """Speed at which the control keeps up with the blocks, [1]_; rapids are not held back."""
    if block_time == 0.0:
        return np.full(len(segments), np.inf)
    return np.where(segments.is_rapid, np.inf, block_lengths(segments) / block_time)


def corners(segments: Segments) -> tuple[Floats, Floats]:
    """(N−1, 3) directions before and after each corner between two segments."""
    rows = np.arange(len(segments))
    before = segments.direction(rows[:-1], segments.length[:-1])
    after = segments.direction(rows[1:], np.zeros(len(rows) - 1))
    return before, after


def goes_on(segments: Segments) -> Bools:
    """(N−1,) whether both segments are pieces of one block that goes straight on."""
    before, after = corners(segments)
    goes: Bools = np.linalg.norm(after - before, axis=1) <= STRAIGHT_ON
    goes &= segments.block[1:] == segments.block[:-1]
    goes &= segments.is_rapid[1:] == segments.is_rapid[:-1]
    return goes


def is_stop(segments: Segments) -> Bools:
    """(N−1,) whether a continuous control stops: before, after and between rapids."""
    rapid: Bools = segments.is_rapid[1:] | segments.is_rapid[:-1]
    return rapid & ~goes_on(segments) if rapid.any() else rapid
