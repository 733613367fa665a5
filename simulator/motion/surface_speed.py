"""A spindle that follows the radius at constant surface speed: moves in pieces, and its lag."""

from dataclasses import replace
from math import sqrt

import numpy as np

from simulator.motion.segments import Floats, Ints, Segments

PIECE = 0.02
"""relative change of the radius within one piece at constant surface speed"""

MOST_PIECES = 400

NEAREST = 0.02
"""mm from the axis, within which no piece is told from the next"""


def in_pieces(segments: Segments, least: float) -> Segments:
    """Segments split so that the speed changes by little from piece to piece.

    Parameters
    ----------
    segments : Segments
    least : float, mm
        Radius within which the spindle has its greatest speed.
    """
    return _split(segments, _pieces(segments, max(least, NEAREST)))


def behind(wanted: Floats, length: Floats, advance: Floats, *, ramp: float) -> Floats:
    """Mean speeds of a spindle that follows the radius as fast as it can.

    A feed per revolution goes on with the spindle as it turns: within a piece of path of so
    many revolutions it ramps towards the speed of the piece, and keeps it once it is reached.
    On the way to the next feed it has caught up.

    Parameters
    ----------
    wanted : (N,) array, rev/s
        What the radius asks for; the first is met, as a feed waits for the spindle.
    length : (N,) array, mm
    advance : (N,) array, mm
        Feeds per revolution; 0: none.
    ramp : float, rev/s²
    """
    mean, speed, is_late = wanted.copy(), 0.0, False
    is_locked = (advance > 0.0) & (length > 0.0)
    for row in np.flatnonzero(is_locked):
        if row == 0 or not is_locked[row - 1]:
            speed, is_late = float(wanted[row]), False
        turns, goal = float(length[row] / advance[row]), float(wanted[row])
        rise = ramp if goal > speed else -ramp
        until = abs(goal - speed) / ramp
        if turns >= 0.5 * (speed + goal) * until:
            # One that is not late follows within the piece too.
            catch_up = 0.5 * (speed + goal) * until
            seconds = until + (turns - catch_up) / goal if is_late else turns / goal
            speed, is_late = goal, False
        else:
            is_late = True
            seconds = (sqrt(speed * speed + 2.0 * rise * turns) - speed) / rise
            speed += rise * seconds
        mean[row] = turns / seconds
    return mean


def _pieces(segments: Segments, least: float) -> Ints:
    """(N,) into how many pieces each is split because the spindle follows the radius.

    Within ``least``, mm, the spindle has its greatest speed.
    """
    one, other = np.abs(segments.start[:, 0]), np.abs(segments.end[:, 0])
    low = np.maximum(np.minimum(one, other), least)
    high = np.maximum(np.maximum(one, other), low)
    count = np.clip(np.ceil(np.log(high / low) / PIECE), 1, MOST_PIECES)
    pieces: Ints = np.where(segments.is_rapid, 1, count).astype(np.int64)
    return pieces


def _split(segments: Segments, pieces: Ints) -> Segments:
    """Each segment in so many pieces of equal length."""
    rows = np.repeat(np.arange(len(segments)), pieces)
    number = np.arange(len(rows)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    step = (segments.length / pieces)[rows]
    is_last = number + 1 == pieces[rows]
    end = segments.position(rows, (number + 1) * step)
    end[is_last] = segments.end
    start = np.concatenate((segments.start[:1], end[:-1]))
    start[number == 0] = segments.start
    return replace(segments[rows], start=start, end=end, turn=(segments.turn / pieces)[rows])
