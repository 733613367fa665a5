"""Feed profile with a limit on the jerk along the path, by a sequence of linear programs.

With ``a = b'/2`` the jerk along the path is ``b''·√b / 2``, so that a limit J reads
``|b''| ≤ 2·J / √b``. The right side is convex in b, and its tangent at a profile b̄ lies below
it: ``J·(3 − b/b̄) / √b̄``. Each linear program with the tangent therefore finds only profiles
that keep the limit itself, and b̄ is one of them once it keeps the limit. The programs begin at
the fastest profile without a limit of the jerk; from the second on, a search along the line
between the old profile and the new one makes sure that the time never rises. The result is not
proven optimal: another sequence may end elsewhere.

At a distance s from a stop b cannot exceed what constant jerk reaches from rest:
``s = J·t³/6`` and ``√b = J·t²/2`` give ``b = (6·s)^(4/3)·J^(2/3) / 4``. In the interval beside
a stop the acceleration has to rise from 0 first, and its time is that of this motion.

Clarabel, an interior-point solver, takes up to 2000 stations at once. The path is cut at its
stops, and a longer stretch into windows that overlap: each is planned to end at rest, only its
first half is kept, and the next begins with the last two stations kept. Bounds are tightened by
the tolerance of the solver, and the whole profile is checked by
:func:`optimiser.feed_profile.certificate.certify`, which shares no code with this module. Units
mm, s.
"""

from dataclasses import dataclass

import cvxpy as cp
import numpy as np

from optimiser.errors import SolverFailed
from optimiser.feed_profile.certificate import certify
from optimiser.feed_profile.profile import (
    AxisLimit,
    Floats,
    NamedCaps,
    PathProfile,
    ProfileProblem,
    TangentialLimit,
    interval_times,
    profile_of,
)
from optimiser.feed_profile.profile_program import (
    AccelerationLimit,
    acceleration_limits,
    fastest,
    run,
    scale_of,
    second_differences,
    time_slope,
)

WINDOW = 2000
"""Largest number of stations in one linear program."""

KEPT = 1000
"""Number of intervals that a window adds to a longer stretch."""

ROUNDS = 3
"""Number of linear programs of each window."""

TIGHTENED = 1e-6
"""Share by which bounds are tightened, above the tolerance of the solver."""

ALMOST_NOTHING = 1e-9
"""Share of a cap below which a squared feed counts as rest."""

SECTIONS = 30
"""Number of golden sections."""

GOLDEN = 0.5 * (5.0**0.5 - 1.0)

ALLOWED = 1e-9
"""Relative excess over any limit that the certificate may show."""


def jerk_limited_profile(
    problem: ProfileProblem, limit: AccelerationLimit, *, jerk: float
) -> PathProfile:
    """Fast profile within caps, accelerations and a limit of the jerk along the path.

    Parameters
    ----------
    problem : ProfileProblem
        It begins at rest.
    limit : TangentialLimit or AxisLimit
    jerk : float, mm/s³

    Returns
    -------
    PathProfile

    Raises
    ------
    ValueError
        If the jerk is not positive and finite, or the path does not begin and end at rest.
    SolverFailed
        If the solver finds nothing, or the certificate shows an excess over a limit.
    """
    if not 0.0 < jerk < np.inf:
        raise ValueError(f"jerk of {jerk:g} mm/s³ must be positive and finite")
    if problem.start > 0.0 or problem.end > 0.0:
        raise ValueError("a profile with limited jerk must begin and end at rest")
    squares = np.zeros(len(problem))
    rest = np.flatnonzero(problem.bounds() == 0.0)
    for first, last in zip(rest[:-1].tolist(), rest[1:].tolist(), strict=True):
        _fill(squares, problem, limit, jerk, (first, last))
    profile = profile_of(_timed_lengths(problem.lengths, squares, jerk), squares)
    caps = NamedCaps(names=("cap",), squares=problem.caps[None, :])
    worst = certify(problem, profile, caps=caps, limit=limit, jerk=jerk).worst
    if worst.excess > ALLOWED:
        message = f"exceeds {worst.limit} at station {worst.station} by {worst.excess:.2g}"
        raise SolverFailed(message, program="feed profile with limited jerk")
    return profile


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Window:
    """Part of a path that one linear program plans, to end at rest."""

    problem: ProfileProblem
    limit: AccelerationLimit
    jerk: float
    head: Floats
    """Squared feeds at its first stations, which stay."""


def _fill(
    squares: Floats,
    problem: ProfileProblem,
    limit: AccelerationLimit,
    jerk: float,
    stretch: tuple[int, int],
) -> None:
    """Write the profile between two stops, window by window."""
    at, last = stretch
    begin, fixed = at, 1
    while True:
        end = min(begin + WINDOW - 1, last)
        window = _window(problem, limit, jerk, (begin, end), squares[begin : begin + fixed])
        squares[begin : end + 1] = _planned(window, squares[begin : end + 1])
        if end == last:
            return
        begin, fixed = begin + KEPT, 2


def _window(
    problem: ProfileProblem,
    limit: AccelerationLimit,
    jerk: float,
    ends: tuple[int, int],
    head: Floats,
) -> _Window:
    """Part of a problem from one station to another, with tightened bounds."""
    first, last = ends
    part, rest = slice(first, last), 1.0 - TIGHTENED
    lengths, caps = problem.lengths[part], problem.caps[first : last + 1] * rest
    if head[0] == 0.0:
        caps = np.minimum(caps, _from_rest(np.append(0.0, np.cumsum(lengths)), rest * jerk))
    to_end = np.append(np.cumsum(lengths[::-1])[::-1], 0.0)
    caps = np.minimum(caps, _from_rest(to_end, rest * jerk))
    caps[0], caps[-1] = head[0], 0.0
    caps[: len(head)] = np.maximum(caps[: len(head)], head)
    return _Window(
        problem=ProfileProblem(lengths=lengths, caps=caps, start=float(head[0])),
        limit=_part(limit, part, rest),
        jerk=jerk * rest,
        head=head.copy(),
    )


def _from_rest(distance: Floats, jerk: float) -> Floats:
    """Greatest squared feed at a distance from rest, mm²/s²."""
    squares: Floats = 0.25 * (6.0 * distance) ** (4 / 3) * jerk ** (2 / 3)
    return squares


def _timed_lengths(lengths: Floats, squares: Floats, jerk: float) -> Floats:
    """Lengths, (N−1,), mm, whose times at constant acceleration are those of the motion.

    Beside a stop the acceleration rises from 0, which takes ``a/J`` with ``a = b / (2·Δs)`` and
    costs half of that; with constant jerk over the whole interval it costs ``Δs/√b``.
    """
    later = np.maximum(squares[:-1], squares[1:])
    ramp = np.minimum(1.0, later**1.5 / (4.0 * jerk * lengths**2))
    is_rest = (squares[:-1] == 0.0) | (squares[1:] == 0.0)
    return np.where(is_rest, (1.0 + 0.5 * ramp) * lengths, lengths)


def _part(limit: AccelerationLimit, part: slice, share: float) -> AccelerationLimit:
    """Limits of some intervals, reduced to a share."""
    if isinstance(limit, AxisLimit):
        return AxisLimit(
            acceleration=limit.acceleration * share,
            start_tangent=limit.start_tangent[part],
            end_tangent=limit.end_tangent[part],
            start_curvature=limit.start_curvature[part],
            end_curvature=limit.end_curvature[part],
        )
    each = (limit.accelerating, limit.braking)
    first, second = (values[part] if len(values) > 1 else values for values in each)
    return TangentialLimit(accelerating=first * share, braking=second * share)


def _planned(window: _Window, before: Floats) -> Floats:
    """Squared feeds of a window; those planned before are a second place to begin at."""
    quickest = fastest(window.problem, window.limit).squares
    try:
        return _sequence(window, quickest)
    except SolverFailed:
        known = before > ALMOST_NOTHING * window.problem.caps
        if len(window.head) < 2 or not known[2:].any():
            raise
        return _sequence(window, np.where(known, before, quickest))


def _sequence(window: _Window, reference: Floats) -> Floats:
    """Squared feeds after some linear programs, each about the result of the one before."""
    lengths = window.problem.lengths
    at = _linear(window, reference)
    for _ in range(ROUNDS - 1):
        further = _linear(window, at)
        at = _best_between(lengths, at, further)
    return at


def _linear(window: _Window, about: Floats) -> Floats:
    """Squared feeds of least time to first order, with the jerk limited about a profile."""
    problem = window.problem
    lengths, scale = problem.lengths, scale_of(problem)
    # In units of the profile it is about the variables are of order one.
    about = np.maximum(about, ALMOST_NOTHING * scale.square)
    ratio = cp.Variable(len(problem))
    unit = about / scale.square
    square = cp.multiply(unit, ratio)
    kept = len(window.head)
    bend = second_differences(lengths / scale.length) @ square
    unit_jerk = scale.square**1.5 / scale.length**2
    bend = cp.multiply(np.sqrt(unit[1:-1]) * (unit_jerk / window.jerk), bend)
    weight = time_slope(lengths, about) * about / _seconds(lengths, about)
    program = cp.Problem(
        cp.Minimize(weight @ ratio),
        [
            ratio >= 0.0,
            square <= problem.caps / scale.square,
            ratio[:kept] == window.head / about[:kept],
            ratio[-1] == 0.0,
            bend <= 3.0 - ratio[1:-1],
            bend >= ratio[1:-1] - 3.0,
            *acceleration_limits(lengths, window.limit, square, scale),
        ],
    )
    run(program, cp.CLARABEL)
    squares: Floats = np.clip(ratio.value, 0.0, None) * about
    squares[:kept], squares[-1] = window.head, 0.0
    return squares


def _best_between(lengths: Floats, one: Floats, other: Floats) -> Floats:
    """Mean of two profiles that takes the least time, by golden sections."""
    low, high = 0.0, 1.0
    for _ in range(SECTIONS):
        first, second = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        if _seconds(lengths, (1.0 - first) * one + first * other) <= _seconds(
            lengths, (1.0 - second) * one + second * other
        ):
            high = second
        else:
            low = first
    share = 0.5 * (low + high)
    between = (1.0 - share) * one + share * other
    return min((one, between, other), key=lambda each: _seconds(lengths, each))


def _seconds(lengths: Floats, squares: Floats) -> float:
    """Time of a window, s."""
    return float(interval_times(lengths, squares).sum())
