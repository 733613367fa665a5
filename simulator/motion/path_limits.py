"""What the axes and the control allow along each segment, and where a path has to stop.

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

from simulator.motion.motion import AxisLimits
from simulator.motion.segments import Bools, Floats, Segments

CENTRIPETAL_SHARE = 0.8
"""of the acceleration in the plane of an arc, at most"""

STRAIGHT_ON = 1e-6
"""rad; pieces cut from one block bend by rounding only"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PathLimits:
    """Greatest speed and tangential acceleration on each of N segments."""

    speed: Floats
    """(N,) mm/s; 0 where a segment has no length"""
    acceleration: Floats
    """(N,) mm/s²; infinite where no axis limits it"""


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
    share = _shares(segments)
    greatest = np.where(segments.is_rapid[:, None], limits.rapid, limits.feed)
    speed = np.minimum(segments.speed, least(greatest, share))
    speed = np.minimum(speed, _block_speed(segments, limits.block_time))
    speed = np.where(segments.length > 0.0, speed, 0.0)
    acceleration = least(np.broadcast_to(limits.acceleration, share.shape), share)
    _bound_arcs(segments, limits.acceleration, speed, acceleration)
    endless = np.flatnonzero(~np.isfinite(speed))
    if len(endless):
        raise ValueError(f"segment {endless[0]}: neither command nor axis bounds its speed")
    return PathLimits(speed=speed, acceleration=acceleration)


def _shares(segments: Segments) -> Floats:
    """(N, 3) how much each axis moves at most per length of path."""
    length = np.where(segments.length > 0.0, segments.length, 1.0)
    share: Floats = np.abs(segments.end - segments.start) / length[:, None]
    bent = np.flatnonzero(segments.turn != 0.0)
    normal = segments.normal[bent]
    along_normal = share[bent, normal]
    in_plane = segments.radius[bent] * np.abs(segments.turn[bent]) / length[bent]
    share[bent] = in_plane[:, None]
    share[bent, normal] = along_normal
    return share


def least(limit: Floats, share: Floats) -> Floats:
    """Least path value at which an axis reaches its own."""
    whole = np.full(share.shape, np.inf)
    np.divide(limit, share, out=whole, where=share > 0.0)
    return whole.min(axis=1)


def block_lengths(segments: Segments) -> Floats:
    """(N,) length of the whole block to which each segment belongs, mm."""
    is_new = np.append(True, segments.block[1:] != segments.block[:-1])
    block = np.cumsum(is_new) - 1
    return np.bincount(block, weights=segments.length)[block]


def _block_speed(segments: Segments, block_time: float) -> Floats:
    """Speed at which the control keeps up with the blocks, [1]_; rapids are not held back."""
    free = np.full(len(segments), np.inf)
    if block_time == 0.0:
        return free
    return np.where(segments.is_rapid, free, block_lengths(segments) / block_time)


def _bound_arcs(segments: Segments, axis: Floats, speed: Floats, acceleration: Floats) -> None:
    """Lower speed and acceleration of arcs in place, by the split of the module's head."""
    bent = np.flatnonzero((segments.turn != 0.0) & (segments.radius > 0.0))
    turn_rate = segments.turn[bent] / segments.length[bent]
    bend = segments.radius[bent] * turn_rate**2
    in_plane = segments.radius[bent] * np.abs(turn_rate)
    grip = np.where(np.arange(3) == segments.normal[bent][:, None], np.inf, axis).min(axis=1)
    speed[bent] = np.minimum(speed[bent], np.sqrt(CENTRIPETAL_SHARE * grip / bend))
    used = np.where(np.isfinite(grip), speed[bent] ** 2 * bend / grip, 0.0)
    left = grip * np.sqrt(1.0 - used**2) / in_plane
    acceleration[bent] = np.minimum(acceleration[bent], left)


def corners(segments: Segments) -> tuple[Floats, Floats]:
    """(N−1, 3) directions before and after each corner between two segments."""
    rows = np.arange(len(segments))
    before = segments.direction(rows[:-1], segments.length[:-1])
    after = segments.direction(rows[1:], np.zeros(len(rows) - 1))
    return before, after


def goes_on(segments: Segments) -> Bools:
    """(N−1,) whether both segments are pieces of one block that goes straight on."""
    before, after = corners(segments)
    is_straight = np.linalg.norm(after - before, axis=1) <= STRAIGHT_ON
    is_same = (segments.block[1:] == segments.block[:-1]) & (
        segments.is_rapid[1:] == segments.is_rapid[:-1]
    )
    return is_same & is_straight


def is_stop(segments: Segments) -> Bools:
    """(N−1,) whether a continuous control stops: before, after and between rapids."""
    return (segments.is_rapid[1:] | segments.is_rapid[:-1]) & ~goes_on(segments)
