"""Two moving averages over a path with piecewise constant speed, in closed form.

With p the path over time and P its double integral, averages over the T1 and then the T2
seconds before t give ``q(t) = [P(t) − P(t−T1) − P(t−T2) + P(t−T1−T2)]/(T1·T2)``; the same
expression of the first integral gives the velocity, and of p itself the acceleration. To avoid
cancellation of large numbers, time and position are measured from the state at t−T1−T2, and the
integrals are accumulated from there over the pieces within the window. Units mm, s, rad.

The functions c_k are Stumpff functions: they integrate a turning velocity without division by
its rate, so that flat arcs and lines stay accurate.
"""

from math import cos, sin

import numpy as np

from simulator.kernels.kernel import entry, kernel
from simulator.motion.segments import Floats, Ints

SERIES_BELOW = 0.5
"""Angle, rad, below which the closed forms of c_3 and c_4 lose accuracy."""

TERMS = 5
"""Number of terms of the series; the first omitted term is below 10⁻¹⁵ of the sum."""

STRAIGHT, SPIN, CROSS = 0, 1, 2
"""Rows of a velocity: constant part, turning part, and the latter advanced by a quarter
turn."""

WAY, ONCE, TWICE = 0, 1, 2
"""Rows of a state: position from the origin, its integral, and its double integral."""


def states_at_ends(time: Floats, velocity: Floats, rate: Floats) -> Floats:
    """Contribution of each complete piece to the integrals.

    Parameters
    ----------
    time, velocity, rate : arrays
        As in :func:`averaged`.

    Returns
    -------
    (K, 3, 3) array
        State at the end of each piece, with its start as origin, in rows as above.
    """
    ends = np.zeros((len(rate), 3, 3))
    _find_ends(time, velocity, rate, ends)
    return ends


@entry
def _find_ends(time: Floats, velocity: Floats, rate: Floats, ends: Floats) -> None:
    """Kernel of :func:`states_at_ends`; writes the states into ``ends`` (initially zeros)."""
    for now in range(len(rate)):
        _advance(ends[now], velocity[now], rate[now], time[now + 1] - time[now], ends[now])


def averaged(
    begin: Floats,
    piece: Ints,
    pieces: tuple[Floats, Floats, Floats, Floats, Floats],
    first: float,
    second: float,
) -> Floats:
    """Acceleration, velocity and position after both averages.

    Parameters
    ----------
    begin : (M,) array, s
        Requested times minus T1 + T2.
    piece : (M,) array of int
        Index of the piece, of K, that contains each of these times.
    pieces : tuple of five arrays
        Start times of the pieces and end of the last, (K+1,), s; start positions, (K, 3), mm;
        velocities at the start, (K, 3, 3), mm/s, in rows as above; turning rates, (K,), rad/s;
        and states at the ends.
    first, second : float, s
        T1 ≥ T2 > 0.

    Returns
    -------
    (3, M, 3) array
        Acceleration, velocity and position in mm/s², mm/s and mm.
    """
    result = np.zeros((3, len(begin), 3))
    _average(begin, piece, pieces, (first, second), np.zeros((10, 3)), result)
    return result


@entry
def _average(
    begin: Floats,
    piece: Ints,
    pieces: tuple[Floats, Floats, Floats, Floats, Floats],
    times: tuple[float, float],
    room: Floats,
    result: Floats,
) -> None:
    """Kernel of :func:`averaged`; adds to ``result``; ``room`` is a (10, 3) work space."""
    time, start, velocity, rate, ends = pieces
    first, second = times
    state, there, leg, origin = room[:3], room[3:6], room[6:9], room[9]
    taps = ((second, -1.0), (first, -1.0), (first + second, 1.0))
    scale = 1.0 / (first * second)
    for row in range(len(begin)):
        now = piece[row]
        passed = begin[row] - time[now]
        state[:] = 0.0
        _enter(velocity, now, 0.0, leg)
        _advance(state, leg, rate[now], passed, there)
        for axis in range(3):
            origin[axis] = start[now, axis] + there[WAY, axis]
        _enter(velocity, now, rate[now] * passed, leg)
        entered, gone, left = now, 0.0, time[now + 1] - begin[row]
        for tap, sign in taps:
            while tap - gone > left and now + 1 < len(rate):
                if now == piece[row]:
                    _advance(state, leg, rate[now], left, state)
                else:
                    _pass(state, ends, now, left)
                now += 1
                gone += left
                left = time[now + 1] - time[now]
                for axis in range(3):
                    state[WAY, axis] = start[now, axis] - origin[axis]
            if now != entered:
                _enter(velocity, now, 0.0, leg)
                entered = now
            _advance(state, leg, rate[now], tap - gone, there)
            for level in range(3):
                for axis in range(3):
                    result[level, row, axis] += sign * scale * there[level, axis]
        for axis in range(3):
            result[TWICE, row, axis] += origin[axis]


@kernel
def _pass(state: Floats, ends: Floats, now: int, time: float) -> None:
    """Advance the integrals in place over a whole piece."""
    for axis in range(3):
        way, once = state[WAY, axis], state[ONCE, axis]
        state[TWICE, axis] += (once + 0.5 * way * time) * time + ends[now, TWICE, axis]
        state[ONCE, axis] += way * time + ends[now, ONCE, axis]


@kernel
def _enter(velocity: Floats, now: int, angle: float, leg: Floats) -> None:
    """Write the velocity on a piece after its turning part has turned by an angle."""
    cosine, sine = cos(angle), sin(angle)
    for axis in range(3):
        spin, cross = velocity[now, SPIN, axis], velocity[now, CROSS, axis]
        leg[STRAIGHT, axis] = velocity[now, STRAIGHT, axis]
        leg[SPIN, axis] = cosine * spin + sine * cross
        leg[CROSS, axis] = cosine * cross - sine * spin


@kernel
def _advance(state: Floats, leg: Floats, rate: float, time: float, there: Floats) -> None:
    """Write the state after a time on a leg to ``there``, which may be ``state`` itself."""
    angle = rate * time
    c_1, c_2, c_3, c_4 = _stumpff(angle)
    square, cube = time * time, time * time * time
    for axis in range(3):
        way, once = state[WAY, axis], state[ONCE, axis]
        stay, spin, cross = leg[STRAIGHT, axis], leg[SPIN, axis], leg[CROSS, axis]
        there[TWICE, axis] = (
            state[TWICE, axis]
            + once * time
            + way * square / 2.0
            + cube * (stay / 6.0 + c_3 * spin + angle * c_4 * cross)
        )
        there[ONCE, axis] = (
            once + way * time + square * (stay / 2.0 + c_2 * spin + angle * c_3 * cross)
        )
        there[WAY, axis] = way + time * (stay + c_1 * spin + angle * c_2 * cross)


@kernel
def _stumpff(angle: float) -> tuple[float, float, float, float]:
    """Functions c_1 to c_4 of the squared angle: ``c_k = 1/k! − x²/(k+2)! + x⁴/(k+4)! − …``."""
    square = angle * angle
    if square == 0.0:
        return 1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0
    if abs(angle) > SERIES_BELOW:
        cosine, sine = cos(angle), sin(angle)
        return (
            sine / angle,
            (1.0 - cosine) / square,
            (angle - sine) / (square * angle),
            (square / 2.0 - 1.0 + cosine) / (square * square),
        )
    third, fourth = 1.0, 1.0
    for term in range(TERMS, 0, -1):
        third = 1.0 - third * square / ((2 * term + 2) * (2 * term + 3))
        fourth = 1.0 - fourth * square / ((2 * term + 3) * (2 * term + 4))
    c_3, c_4 = third / 6.0, fourth / 24.0
    return 1.0 - square * c_3, 0.5 - square * c_4, c_3, c_4
