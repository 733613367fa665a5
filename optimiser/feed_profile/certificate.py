"""Certificate of a feed profile: how near it is to the optimum, and what limits it where.

Everything is computed anew from the profile and the problem, without a function of what made
the profile. The bound on the time is that of a machine without inertia,
``Σ 2·Δs / (√cᵢ + √cᵢ₊₁)`` with the least caps c, as b is linear within an interval and lies
nowhere above its caps.

The jerk along the path is ``da/dt = (b''/2)·v``, because ``a = b'/2`` ([1]_, section II). At a
station b'' is that of the three stations around it. In an interval that begins or ends at rest
the jerk is the constant one that reaches b from rest over its length: ``J = (2·√b)³ / (6·Δs)²``
by ``Δs = J·t³/6`` and ``√b = J·t²/2``. Units mm, s.

References
----------
.. [1] D. Verscheure et al., "Time-optimal path tracking for robots: a convex optimization
   approach", IEEE Trans. Autom. Control 54 (2009) 2318-2327, doi:10.1109/TAC.2009.2028959.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from optimiser.feed_profile.profile import (
    AxisLimit,
    Floats,
    Ints,
    NamedCaps,
    PathProfile,
    ProfileProblem,
    TangentialLimit,
)

ACTIVE = 1e-5
"""Relative distance from its bound below which a limit is active; solvers stay 1e-6 away."""

AXES = ("X", "Y", "Z")

JERK = "jerk"
"""Name of the limit of the jerk along the path."""

NO_LIMIT = "no limit"
"""Name for where no limit is active."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitExcess:
    """Largest excess of a profile over one limit."""

    limit: str
    excess: float
    """Value over bound − 1; negative if the limit holds everywhere with a margin."""
    station: int
    """Index of the station, or of the start of the interval."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitShare:
    """Share of a path on which one limit is active."""

    limit: str
    length: float
    """Share of the length, 0 to 1."""
    time: float
    """Share of the time, 0 to 1."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileCertificate:
    """Certificate of a profile: its excess over limits."""

    time: float
    """Time of the profile, s."""
    bound: float
    """Lower bound of the time of any profile within the caps, s."""
    excesses: tuple[LimitExcess, ...]
    """Excess over each limit; first those of the caps in the order of their names."""
    shares: tuple[LimitShare, ...]
    """Shares of the limits that are active anywhere, the largest share of time first."""

    @property
    def gap(self) -> float:
        """Greatest share of the bound that a better profile could save."""
        return self.time / self.bound - 1.0

    @property
    def worst(self) -> LimitExcess:
        """Limit that the profile exceeds most, or comes nearest to."""
        return max(self.excesses, key=lambda each: each.excess)


@dataclass(frozen=True, slots=True, eq=False)
class _Use:
    """Ratio of value to bound of one limit, at stations (N,) or in intervals (N−1,)."""

    limit: str
    ratio: Floats


def certify(
    problem: ProfileProblem,
    profile: PathProfile,
    *,
    caps: NamedCaps,
    limit: TangentialLimit | AxisLimit,
    jerk: float | None = None,
) -> ProfileCertificate:
    """Check a profile against every limit, and tell which of them are active where.

    Parameters
    ----------
    problem : ProfileProblem
        N stations.
    caps : NamedCaps
        Caps at the N stations by name.
    limit : TangentialLimit or AxisLimit
    jerk : float, optional, mm/s³
        Limit of the jerk along the path.

    Returns
    -------
    ProfileCertificate

    Raises
    ------
    ValueError
        If profile or caps have another number of stations than the problem.
    """
    squares = profile.squares
    if squares.shape != problem.caps.shape or caps.squares.shape[1:] != problem.caps.shape:
        message = f"profile {squares.shape} and caps {caps.squares.shape}"
        raise ValueError(f"{message} do not fit {len(problem)} stations")
    times = _times(problem.lengths, squares)
    if jerk is not None:
        times += _ramps(problem.lengths, squares, jerk)
    of_caps = [
        _Use(name, _ratio(squares, row))
        for name, row in zip(caps.names, caps.squares, strict=True)
    ]
    accelerations = list(_accelerations(problem.lengths, squares, limit))
    jerks = [] if jerk is None else [_Use(JERK, _jerks(problem.lengths, squares) / jerk)]
    ends = list(_ends(problem, squares))
    return ProfileCertificate(
        time=float(times.sum()),
        bound=float(_times(problem.lengths, _ceiling(problem, caps)).sum()),
        excesses=tuple(map(_excess, of_caps + ends + accelerations + jerks)),
        shares=_shares((problem.lengths, times), (of_caps, accelerations, jerks)),
    )


def _times(lengths: Floats, squares: Floats) -> Floats:
    """Time of each interval, (N−1,), s: length over mean speed."""
    speed = squares**0.5
    times: Floats = lengths / (0.5 * (speed[1:] + speed[:-1]))
    return times


def _ceiling(problem: ProfileProblem, caps: NamedCaps) -> Floats:
    """Greatest squared feed that any cap or end permits, (N,)."""
    top: Floats = np.minimum(problem.caps, caps.squares.min(axis=0))
    top[0], top[-1] = min(top[0], problem.start), min(top[-1], problem.end)
    return top


def _ramps(lengths: Floats, squares: Floats, jerk: float) -> Floats:
    """Time by which each interval takes longer as the acceleration rises from rest, s.

    Half of ``a/J``, but at most what the whole interval with constant jerk takes more,
    ``3·Δs/√b`` instead of ``2·Δs/√b``.
    """
    rest = np.flatnonzero((squares[:-1] == 0.0) | (squares[1:] == 0.0))
    square, length = squares[rest] + squares[rest + 1], lengths[rest]
    longer = np.zeros(len(lengths))
    acceleration = 0.5 * square / length
    longer[rest] = np.minimum(0.5 * acceleration / jerk, length / square**0.5)
    return longer


def _ratio(value: Floats, bound: Floats) -> Floats:
    """Value over bound; where the bound is 0, 0 for a value of 0 and infinite otherwise."""
    ratio: Floats = np.where(value == 0.0, 0.0, np.inf)
    np.divide(value, bound, out=ratio, where=bound > 0.0)
    return ratio


def _accelerations(
    lengths: Floats, squares: Floats, limit: TangentialLimit | AxisLimit
) -> Iterator[_Use]:
    """Use of the limits of acceleration in each interval."""
    along = (squares[1:] - squares[:-1]) / (2.0 * lengths)
    if isinstance(limit, TangentialLimit):
        yield _Use("accelerating", along / limit.accelerating)
        yield _Use("braking", -along / limit.braking)
        return
    for axis, name in enumerate(AXES):
        first = limit.start_tangent[:, axis] * along
        first += limit.start_curvature[:, axis] * squares[:-1]
        last = limit.end_tangent[:, axis] * along
        last += limit.end_curvature[:, axis] * squares[1:]
        greater = np.maximum(np.abs(first), np.abs(last))
        yield _Use(f"{name} acceleration", greater / limit.acceleration[axis])


def _jerks(lengths: Floats, squares: Floats) -> Floats:
    """Jerk along the path at each station, (N,), mm/s³."""
    jerk = np.zeros(len(squares))
    slope = np.diff(squares) / lengths
    bend = np.abs(np.diff(slope)) / (0.5 * (lengths[1:] + lengths[:-1]))
    jerk[1:-1] = 0.5 * bend * squares[1:-1] ** 0.5
    from_rest = (2.0 * squares**0.5) ** 3
    start = np.where(squares[:-1] == 0.0, from_rest[1:] / (6.0 * lengths) ** 2, 0.0)
    end = np.where(squares[1:] == 0.0, from_rest[:-1] / (6.0 * lengths) ** 2, 0.0)
    jerk[1:] = np.maximum(jerk[1:], start)
    jerk[:-1] = np.maximum(jerk[:-1], end)
    return jerk


def _ends(problem: ProfileProblem, squares: Floats) -> Iterator[_Use]:
    """Use of the squared feeds at both ends, and whether the path stops where it has to."""
    yield _Use("start", _ratio(squares[:1], np.array([problem.start])))
    yield _Use("end", _ratio(squares[-1:], np.array([problem.end])))
    yield _Use("least cap", _ratio(squares, problem.caps))


def _excess(use: _Use) -> LimitExcess:
    """Greatest excess over one limit."""
    station = int(use.ratio.argmax())
    return LimitExcess(limit=use.limit, excess=float(use.ratio[station] - 1.0), station=station)


def _shares(
    weights: tuple[Floats, Floats], uses: tuple[list[_Use], list[_Use], list[_Use]]
) -> tuple[LimitShare, ...]:
    """Shares of length and time of each limit.

    Half of an interval belongs to either of its stations. It goes to the cap that is active at
    the station, or else to the acceleration that is active in the interval, or to the jerk.
    """
    of_caps, accelerations, jerks = uses
    names = [each.limit for each in of_caps + accelerations + jerks] + [NO_LIMIT]
    none = len(names) - 1
    station = _most_used(of_caps, first=0, none=none)
    interval = _most_used(accelerations, first=len(of_caps), none=none)
    jerky = _most_used(jerks, first=none - len(jerks), none=none) if jerks else None
    sums = np.zeros((2, len(names)))
    for part in (slice(None, -1), slice(1, None)):
        which = np.where(station[part] == none, interval, station[part])
        if jerky is not None:
            which = np.where(which == none, jerky[part], which)
        for row, weight in enumerate(weights):
            sums[row] += np.bincount(which, weights=0.5 * weight, minlength=len(names))
    length, time = sums / sums.sum(axis=1, keepdims=True)
    found = [
        LimitShare(limit=name, length=float(length[row]), time=float(time[row]))
        for row, name in enumerate(names)
        if length[row] > 0.0
    ]
    return tuple(sorted(found, key=lambda each: -each.time))


def _most_used(uses: list[_Use], *, first: int, none: int) -> Ints:
    """Number of the limit that is used most, or that of none, at each station or interval."""
    most = np.full(len(uses[0].ratio), 1.0 - ACTIVE)
    which = np.full(len(most), none)
    for row, use in enumerate(uses, start=first):
        is_more = use.ratio > most
        which[is_more], most[is_more] = row, use.ratio[is_more]
    return which
