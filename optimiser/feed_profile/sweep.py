"""Fastest feed along a path, exactly, in one sweep backward and one forward.

**Tangential limits** (:class:`optimiser.feed_profile.profile.TangentialLimit`). In b = v² a
limit of the acceleration along the path reads ``|Δb| ≤ 2·a·Δs``. The least of two feasible
profiles is feasible, and so is the greatest: the feasible set is a lattice. Its greatest
element is ``bᵢ = minⱼ (capⱼ + reach from j to i)``; a sweep from the end, which applies
braking, and one from the start, which applies accelerating, find it. It is optimal for every
objective that falls as the feed rises.

**Limits of the axes** (:class:`optimiser.feed_profile.profile.AxisLimit`). The sweep from the
end finds at each station the greatest b from which the rest of the path can be travelled, [1]_:
as the limits are symmetric, rest is always possible, and what can be travelled is all of [0,
K]. The sweep from the start then takes the greatest acceleration that stays within K. An
interval keeps the limits of the axes at both of its ends with its one acceleration, as the
interpolation scheme of [1]_ does. On lines and where the curvature is smooth this is the
optimum of the discrete problem; where the curvature jumps its time may lie above that of the
optimum, on the paths of the tests and benchmarks by at most 3e-5, which
:mod:`optimiser.feed_profile.profile_program` measures.

Both need O(N) time and, besides the result, no memory. Other limits than these, such as one of
the jerk, are those of :mod:`optimiser.feed_profile.jerk_program`.

References
----------
.. [1] H. Pham, Q.-C. Pham, "A new approach to time-optimal path parameterization based on
   reachability analysis", IEEE Trans. Robotics 34 (2018) 645-659,
   doi:10.1109/TRO.2018.2819195.
"""

from math import inf, sqrt

import numpy as np

from optimiser.feed_profile.profile import (
    AxisLimit,
    Floats,
    PathProfile,
    ProfileProblem,
    TangentialLimit,
    too_fast_at_start,
)
from simulator.kernels.kernel import entry, kernel, reordered


def sweep(problem: ProfileProblem, limit: TangentialLimit) -> PathProfile:
    """Fastest profile within caps and limits of the acceleration along the path.

    Parameters
    ----------
    problem : ProfileProblem
        N stations.
    limit : TangentialLimit
        Its arrays have length 1 or N−1.

    Returns
    -------
    PathProfile

    Raises
    ------
    ValueError
        If the limit does not fit the problem.
    Infeasible
        If the path is entered too fast to brake for what follows.
    """
    for name in ("accelerating", "braking"):
        size = getattr(limit, name).shape
        if size not in {(1,), problem.lengths.shape}:
            raise ValueError(f"{name} must have shape (1,) or {problem.lengths.shape}: {size}")
    squares, total = np.empty(len(problem)), np.zeros(1)
    sweep_along(
        problem.lengths,
        (np.ascontiguousarray(limit.accelerating), np.ascontiguousarray(limit.braking)),
        problem.caps,
        np.array((problem.start, problem.end)),
        squares,
        total,
    )
    if squares[0] < problem.start:
        raise too_fast_at_start(problem.start, float(squares[0]), limit="braking")
    return PathProfile(squares=squares, time=float(total[0]))


def sweep_axes(problem: ProfileProblem, limit: AxisLimit) -> PathProfile:
    """Fastest profile within caps and limits of the acceleration of the axes.

    Parameters
    ----------
    problem : ProfileProblem
        N stations.
    limit : AxisLimit
        Of N−1 intervals.

    Returns
    -------
    PathProfile

    Raises
    ------
    ValueError
        If the limit does not fit the problem.
    Infeasible
        If the path is entered too fast for what follows.
    """
    if len(limit.start_tangent) != len(problem.lengths):
        message = f"{len(limit.start_tangent)} intervals of the axes"
        raise ValueError(f"{message} do not fit {len(problem.lengths)} intervals of the path")
    squares, total = problem.bounds(), np.zeros(1)
    geometry = (
        np.ascontiguousarray(limit.start_tangent),
        np.ascontiguousarray(limit.start_curvature),
        np.ascontiguousarray(limit.end_tangent),
        np.ascontiguousarray(limit.end_curvature),
    )
    reach_along(problem.lengths, limit.acceleration, geometry, squares, total)
    if squares[0] < problem.start:
        limits = "acceleration of the axes"
        raise too_fast_at_start(problem.start, float(squares[0]), limit=limits)
    return PathProfile(squares=squares, time=float(total[0]))


@entry
def sweep_along(
    lengths: Floats,
    limits: tuple[Floats, Floats],
    caps: Floats,
    ends: Floats,
    squares: Floats,
    total: Floats,
) -> None:
    """Find the squared feeds that can be reached within caps, and add up the time.

    Parameters
    ----------
    lengths : (N−1,) array, mm
    limits : tuple of (1,) or (N−1,) arrays, mm/s²
        Accelerating and braking.
    caps : (N,) array, mm²/s²
    ends : (2,) array, mm²/s²
        Further caps, on the first and the last station.
    squares : (N,) array, mm²/s²
        Squared feeds; from the end alone if the first of them is lower than its caps.
    total : (1,) array, s
        Time.
    """
    accelerating, braking = limits
    start = min(caps[0], ends[0])
    _sweep_back(lengths, braking, caps, min(caps[len(lengths)], ends[1]), squares)
    squares[0] = min(squares[0], start)
    if squares[0] >= start:
        _sweep_on(lengths, accelerating, squares)
        total[0] = _time(lengths, squares)


@kernel
def _sweep_back(
    lengths: Floats, braking: Floats, caps: Floats, end: float, squares: Floats
) -> None:
    """Find, from the end, the squared feeds from which braking suffices.

    Each station waits for the next one, so that four quarters of the path, side by side, take
    half the time. A quarter takes the cap at its end for the squared feed there; where that is
    lower, the stations before are lowered again until one does not change.
    """
    quarter = len(lengths) // 4 if len(braking) == 1 else 0
    four = end
    squares[len(lengths)] = four
    for row in range(len(lengths) - 1, 4 * quarter - 1, -1):
        four = min(caps[row], four + 2.0 * braking[min(row, len(braking) - 1)] * lengths[row])
        squares[row] = four
    gain = 2.0 * braking[0]
    one, two, three = caps[quarter], caps[2 * quarter], caps[3 * quarter]
    for row in range(quarter - 1, -1, -1):
        one = min(caps[row], one + gain * lengths[row])
        squares[row] = one
        two = min(caps[row + quarter], two + gain * lengths[row + quarter])
        squares[row + quarter] = two
        three = min(caps[row + 2 * quarter], three + gain * lengths[row + 2 * quarter])
        squares[row + 2 * quarter] = three
        four = min(caps[row + 3 * quarter], four + gain * lengths[row + 3 * quarter])
        squares[row + 3 * quarter] = four
    for part in range(3, 0, -1):
        row = part * quarter - 1
        while row >= 0:
            lower = min(squares[row], squares[row + 1] + gain * lengths[row])
            if lower == squares[row]:
                break
            squares[row] = lower
            row -= 1


@kernel
def _sweep_on(lengths: Floats, accelerating: Floats, squares: Floats) -> None:
    """Lower squared feeds, from the start, to those that can be reached, by quarters too."""
    quarter = len(lengths) // 4 if len(accelerating) == 1 else 0
    gain = 2.0 * accelerating[0]
    one, two = squares[0], squares[quarter]
    three, four = squares[2 * quarter], squares[3 * quarter]
    for row in range(quarter):
        one = min(squares[row + 1], one + gain * lengths[row])
        squares[row + 1] = one
        at = row + quarter
        two = min(squares[at + 1], two + gain * lengths[at])
        squares[at + 1] = two
        at += quarter
        three = min(squares[at + 1], three + gain * lengths[at])
        squares[at + 1] = three
        at += quarter
        four = min(squares[at + 1], four + gain * lengths[at])
        squares[at + 1] = four
    for part in range(1, 4):
        row = part * quarter
        while row < 4 * quarter:
            lower = min(squares[row + 1], squares[row] + gain * lengths[row])
            if lower == squares[row + 1]:
                break
            squares[row + 1] = lower
            row += 1
    square = squares[4 * quarter]
    for row in range(4 * quarter, len(lengths)):
        reach = 2.0 * accelerating[min(row, len(accelerating) - 1)] * lengths[row]
        square = min(squares[row + 1], square + reach)
        squares[row + 1] = square


@kernel
def _time(lengths: Floats, squares: Floats) -> float:
    """Time of all intervals, added up in blocks to keep digits."""
    total, row = 0.0, 0
    while row < len(lengths):
        last = min(row + 1024, len(lengths))
        total += 2.0 * _block_time(lengths, squares, row, last)
        row = last
    return total


@reordered
def _block_time(lengths: Floats, squares: Floats, first: int, last: int) -> float:
    """Half the time of some intervals; two of them share a division."""
    block, feed = 0.0, sqrt(squares[first])
    for row in range(first, last - 1, 2):
        middle, after = sqrt(squares[row + 1]), sqrt(squares[row + 2])
        one, two = feed + middle, middle + after
        block += (lengths[row] * two + lengths[row + 1] * one) / (one * two)
        feed = after
    if (last - first) % 2:
        block += lengths[last - 1] / (sqrt(squares[last - 1]) + sqrt(squares[last]))
    return block


Geometry = tuple[Floats, Floats, Floats, Floats]
"""Tangent and curvature at the start, tangent and curvature at the end of each interval."""

Room = tuple[float, float, float, float, float, float, float, float]
"""Upper and lower line of ``p·a + r·b ≤ s`` and ``≥ s``: value of a, p, r, s of each."""


@entry
def reach_along(
    lengths: Floats, acceleration: Floats, geometry: Geometry, squares: Floats, total: Floats
) -> None:
    """Lower squared feeds to what the axes can follow, and add up the time.

    Parameters
    ----------
    lengths : (N−1,) array, mm
    acceleration : (3,) array, mm/s²
    geometry : tuple of (N−1, 3) arrays
    squares : (N,) array, mm²/s²
        Caps, lowered in place; from the end alone if the first of them falls.
    total : (1,) array, s
        Time.
    """
    start = squares[0]
    _reach_back(lengths, acceleration, geometry, squares)
    if squares[0] >= start:
        _reach_on(lengths, acceleration, geometry, squares)
        total[0] = _time(lengths, squares)


@kernel
def _reach_back(
    lengths: Floats, acceleration: Floats, geometry: Geometry, squares: Floats
) -> None:
    """Lower squared feeds, from the end, to those from which the rest can be travelled."""
    along = 0.0
    for row in range(len(lengths) - 1, -1, -1):
        length, cap, after = lengths[row], squares[row], squares[row + 1]
        if _is_straight(geometry, row):
            if along == 0.0 or not _is_parallel(geometry[0], row, row + 1):
                along = _along_line(acceleration, geometry[0], row)
            squares[row] = min(cap, after + 2.0 * length * along)
        else:
            along = 0.0
            if cap <= after and _has_room(acceleration, geometry, row, length, cap, 0.0):
                squares[row] = cap
                continue
            squares[row] = _controllable(acceleration, geometry, row, length, cap, after)


@kernel
def _reach_on(
    lengths: Floats, acceleration: Floats, geometry: Geometry, squares: Floats
) -> None:
    """Raise the feed as fast as the axes can, from the start, within what is controllable."""
    along = 0.0
    for row in range(len(lengths)):
        length, square, greatest = lengths[row], squares[row], squares[row + 1]
        if _is_straight(geometry, row):
            if along == 0.0 or not _is_parallel(geometry[0], row, row - 1):
                along = _along_line(acceleration, geometry[0], row)
            squares[row + 1] = min(square + 2.0 * length * along, greatest)
            continue
        along = 0.0
        rise = (greatest - square) / (2.0 * length)
        if _has_room(acceleration, geometry, row, length, square, rise):
            squares[row + 1] = greatest
            continue
        high, high_a, _, _, low, low_a, _, _ = _room(
            acceleration, geometry, row, length, square, greatest
        )
        # At a vertex rounding may leave no room. The line with the greater share in a decides:
        # what this misses of the other one is rounding in units of its limit.
        chosen = low if high < low and low_a > high_a else high
        squares[row + 1] = min(max(square + 2.0 * length * chosen, 0.0), greatest)


@kernel
def _is_straight(geometry: Geometry, row: int) -> bool:
    """True if an interval lies on a line."""
    start_tangent, start_curvature, end_tangent, end_curvature = geometry
    bend = 0.0
    for axis in range(3):
        bend += abs(start_curvature[row, axis]) + abs(end_curvature[row, axis])
        bend += abs(end_tangent[row, axis] - start_tangent[row, axis])
    return bend == 0.0


@kernel
def _is_parallel(tangent: Floats, row: int, other: int) -> bool:
    """True if two intervals begin in the same direction."""
    turn = 0.0
    for axis in range(3):
        turn += abs(tangent[row, axis] - tangent[other, axis])
    return turn == 0.0


@kernel
def _along_line(acceleration: Floats, tangent: Floats, row: int) -> float:
    """Acceleration along a line at which the first axis reaches its limit."""
    along = inf
    for axis in range(3):
        if tangent[row, axis] != 0.0:
            along = min(along, acceleration[axis] / abs(tangent[row, axis]))
    return along


@kernel
def _controllable(
    acceleration: Floats,
    geometry: Geometry,
    row: int,
    length: float,
    cap: float,
    after: float,
) -> float:
    """Greatest b at the start of an interval from which b at its end may be at most ``after``.

    The room for the acceleration, upper minus lower line, is concave in b and not negative at
    b = 0. Newton's method from above meets its root from above and ends after a few lines.
    """
    square = _without_inertia(acceleration, geometry, row, length, cap)
    while True:
        high, high_a, high_b, high_s, low, low_a, low_b, low_s = _room(
            acceleration, geometry, row, length, square, after
        )
        if high >= low:
            return square
        lower = (high_s * low_a - low_s * high_a) / (high_b * low_a - low_b * high_a)
        if not lower < square:
            return square
        square = max(lower, 0.0)


@kernel
def _without_inertia(
    acceleration: Floats, geometry: Geometry, row: int, length: float, cap: float
) -> float:
    """Lower a cap where an axis feels the curvature only, ``|q''·b| ≤ A``."""
    start_tangent, start_curvature, end_tangent, end_curvature = geometry
    for axis in range(3):
        if start_tangent[row, axis] == 0.0 and start_curvature[row, axis] != 0.0:
            cap = min(cap, acceleration[axis] / abs(start_curvature[row, axis]))
        bend = end_curvature[row, axis]
        if end_tangent[row, axis] + 2.0 * length * bend == 0.0 and bend != 0.0:
            cap = min(cap, acceleration[axis] / abs(bend))
    return cap


@kernel
def _has_room(
    acceleration: Floats, geometry: Geometry, row: int, length: float, square: float, a: float
) -> bool:
    """True if no axis is at its limit at an acceleration a; most stations need no more."""
    start_tangent, start_curvature, end_tangent, end_curvature = geometry
    last = square + 2.0 * length * a
    for axis in range(3):
        first = start_tangent[row, axis] * a + start_curvature[row, axis] * square
        second = end_tangent[row, axis] * a + end_curvature[row, axis] * last
        if abs(first) > acceleration[axis] or abs(second) > acceleration[axis]:
            return False
    return True


@kernel
def _room(
    acceleration: Floats,
    geometry: Geometry,
    row: int,
    length: float,
    square: float,
    after: float,
) -> Room:
    """Least upper and greatest lower line of the acceleration a at a squared feed b.

    At the end of the interval b is ``b + 2·Δs·a``, so that ``q'·a + q''·b`` there reads
    ``(q' + 2·Δs·q'')·a + q''·b``. The squared feed at the end lies within [0, after].
    """
    start_tangent, start_curvature, end_tangent, end_curvature = geometry
    twice = 2.0 * length
    high, high_a, high_b, high_s = (after - square) / twice, twice, 1.0, after
    low, low_a, low_b, low_s = -square / twice, twice, 1.0, 0.0
    for part in range(6):
        axis = part % 3
        if part < 3:
            bend = start_curvature[row, axis]
            share = start_tangent[row, axis]
        else:
            bend = end_curvature[row, axis]
            share = end_tangent[row, axis] + twice * bend
        if share < 0.0:
            share, bend = -share, -bend
        if share > 0.0:
            most, inverse, pull = acceleration[axis], 1.0 / share, bend * square
            upper = (most - pull) * inverse
            lower = (-most - pull) * inverse
            if upper < high:
                high, high_a, high_b, high_s = upper, share, bend, most
            if lower > low:
                low, low_a, low_b, low_s = lower, share, bend, -most
    return high, high_a, high_b, high_s, low, low_a, low_b, low_s
