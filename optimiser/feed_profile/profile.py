"""The problem of the fastest feed along a path, its limits, and the profile that answers it.

The path is cut at N stations into N−1 intervals. The unknown is b = v² at each station, the
squared feed; between two stations b is linear in the arc length, so that the tangential
acceleration is constant, ``a = Δb / (2·Δs)``, and the time of an interval is
``2·Δs / (√bᵢ + √bᵢ₊₁)``, [1]_. Any limit on the feed is a cap on b at a station. Limits on
acceleration are either those of the path (:class:`TangentialLimit`) or those of the three axes
(:class:`AxisLimit`).

This module holds values only; nothing in it knows machining.
:mod:`optimiser.feed_profile.sweep` solves, :mod:`optimiser.feed_profile.certificate` checks,
:mod:`optimiser.feed_profile.profile_program` judges. Units mm, s.

Examples
--------
A line of 10 mm, capped at 20 mm/s, from rest to rest with 200 mm/s²:

>>> from optimiser.feed_profile.sweep import sweep
>>> problem = ProfileProblem(lengths=np.full(10, 1.0), caps=np.full(11, 20.0**2))
>>> profile = sweep(problem, tangential_limit(200.0))
>>> round(profile.time, 6)
0.6
>>> profile.feeds.round(3)[:4].tolist()
[0.0, 20.0, 20.0, 20.0]

References
----------
.. [1] D. Verscheure et al., "Time-optimal path tracking for robots: a convex optimization
   approach", IEEE Trans. Autom. Control 54 (2009) 2318-2327, doi:10.1109/TAC.2009.2028959.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from optimiser.errors import Infeasible

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NOWHERE = np.empty(0, dtype=np.int64)
"""No stations."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProfileProblem:
    """Path of N stations with the caps on its squared feed.

    Raises
    ------
    ValueError
        If a length is not positive and finite, a cap is negative or not finite, shapes differ,
        or both stations of an interval are stops.
    Infeasible
        If a cap of 0 forbids motion at a station that is no stop, or the squared feed at the
        start exceeds its cap.
    """

    lengths: Floats
    """Lengths Δs of the intervals, (N−1,), mm."""
    caps: Floats
    """Least cap on b = v² at each station, (N,), mm²/s²."""
    start: float = 0.0
    """b at the first station, mm²/s²: the path is entered at exactly this feed."""
    end: float = 0.0
    """Greatest b at the last station, mm²/s²."""
    stops: Ints = field(default_factory=NOWHERE.copy)
    """Indices of stations between the ends where the path may stop."""

    def __post_init__(self) -> None:
        lengths, caps = self.lengths, self.caps
        if lengths.ndim != 1 or len(lengths) < 1 or caps.shape != (len(lengths) + 1,):
            message = "lengths must have shape (N-1,) and caps (N,) with N of at least 2"
            raise ValueError(f"{message}, got {lengths.shape} and {caps.shape}")
        _require_positive(lengths, "interval {}: length {:g} mm")
        _require_not_negative(caps, "station {}: cap {:g} mm²/s²")
        for name in ("start", "end"):
            value = getattr(self, name)
            if not 0.0 <= value < np.inf:
                raise ValueError(f"{name} of {value:g} mm²/s² must not be negative, but finite")
        if self.start > caps[0]:
            raise too_fast_at_start(self.start, float(caps[0]), limit="cap")
        self._require_motion()

    def __len__(self) -> int:
        return len(self.caps)

    @property
    def stations(self) -> Floats:
        """Arc length from the start of the path to each station, (N,), mm."""
        return np.append(0.0, np.cumsum(self.lengths))

    def bounds(self) -> Floats:
        """Caps with those of both ends, (N,), mm²/s²; a new array."""
        bounds = self.caps.copy()
        bounds[0] = min(bounds[0], self.start)
        bounds[-1] = min(bounds[-1], self.end)
        return bounds

    def _require_motion(self) -> None:
        """Refuse stations at rest that are no stops, and intervals between two of them."""
        if len(self) > 2 and self.caps.min() > 0.0 and not len(self.stops):
            return
        stops = self.stops
        if len(stops) and not (stops.min() >= 0 and stops.max() < len(self)):
            raise ValueError(f"stops must lie between station 0 and {len(self) - 1}")
        is_at_rest = self.caps == 0.0
        is_at_rest[0] |= self.start == 0.0
        is_at_rest[-1] |= self.end == 0.0
        still = np.flatnonzero(is_at_rest)
        for station in np.setdiff1d(still, np.append(stops, (0, len(self) - 1))):
            raise Infeasible(
                f"station {station} ({self.stations[station]:.6g} mm): a cap of 0 mm/s forbids "
                "motion, and the path does not stop there",
                limits=("cap",),
                station=int(station),
            )
        for first in still[:-1][np.diff(still) == 1]:
            message = f"stations {first} and {first + 1} are both at rest"
            raise ValueError(f"{message}: put a station between them")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NamedCaps:
    """Caps on the squared feed at N stations, each with the name of its limit.

    Raises
    ------
    ValueError
        If names and caps differ in number, or there is none.
    """

    names: tuple[str, ...]
    squares: Floats
    """Caps on b, (K, N) for K names, mm²/s²; infinite where a limit does not apply."""

    def __post_init__(self) -> None:
        if self.squares.ndim != 2 or not 0 < len(self.names) == len(self.squares):
            message = f"{len(self.names)} names and caps of shape {self.squares.shape}"
            raise ValueError(f"each name needs a row of caps: {message}")

    @property
    def least(self) -> Floats:
        """Least cap at each station, (N,), mm²/s²."""
        least: Floats = self.squares.min(axis=0)
        return least

    @property
    def which(self) -> Ints:
        """Index of the name of the least cap at each station, (N,)."""
        which: Ints = self.squares.argmin(axis=0)
        return which


def too_fast_at_start(start: float, greatest: float, *, limit: str) -> Infeasible:
    """Error of a path that is entered faster than a limit permits; both are b, mm²/s²."""
    entry, most = start**0.5, greatest**0.5
    return Infeasible(
        f"station 0: the path is entered at {entry:.6g} mm/s, {entry - most:.3g} mm/s above "
        f"the {most:.6g} mm/s that the {limit} permits",
        limits=(limit,),
        station=0,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TangentialLimit:
    """Limits on the acceleration along the path.

    Raises
    ------
    ValueError
        If a limit is not positive and finite.
    """

    accelerating: Floats
    """Greatest acceleration, (1,) or (N−1,) by interval, mm/s²."""
    braking: Floats
    """Greatest deceleration, (1,) or (N−1,), mm/s²."""

    def __post_init__(self) -> None:
        for name in ("accelerating", "braking"):
            _require_positive(getattr(self, name), name + " in interval {}: {:g} mm/s²")


def tangential_limit(acceleration: float) -> TangentialLimit:
    """One acceleration, mm/s², for speeding up and for braking on the whole path."""
    value = np.array([float(acceleration)])
    return TangentialLimit(accelerating=value, braking=value)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AxisLimit:
    """Limits on the acceleration of three axes, ``|q'·a + q''·b| ≤ A``.

    q' is the unit tangent and q'' the curvature vector of the path. Both are given at both ends
    of each interval: where the curvature jumps at a station, the limits of either side hold
    there. :func:`smooth_limit` makes the same of a path without jumps, and
    :mod:`optimiser.feed_profile.path_grid` of lines, arcs and helices.

    Raises
    ------
    ValueError
        If a limit is not positive and finite, or shapes differ.
    """

    acceleration: Floats
    """Greatest acceleration A of the axes, (3,), mm/s²."""
    start_tangent: Floats
    """q' at the start of each interval, (N−1, 3)."""
    end_tangent: Floats
    """q' at the end of each interval, (N−1, 3)."""
    start_curvature: Floats
    """q'' at the start of each interval, (N−1, 3), 1/mm."""
    end_curvature: Floats
    """q'' at the end of each interval, (N−1, 3), 1/mm."""

    def __post_init__(self) -> None:
        if self.acceleration.shape != (3,):
            raise ValueError("the acceleration of the axes must have shape (3,)")
        _require_positive(self.acceleration, "axis {}: acceleration {:g} mm/s²")
        shape = (len(self.start_tangent), 3)
        for name in ("start_tangent", "end_tangent", "start_curvature", "end_curvature"):
            value = getattr(self, name)
            if value.shape != shape:
                raise ValueError(f"{name} must have shape {shape}, got {value.shape}")
            if not (value.min() > -np.inf and value.max() < np.inf):
                row = int(np.flatnonzero(~np.isfinite(value).all(axis=1))[0])
                raise ValueError(f"interval {row}: {name} {value[row]} must be finite")


def smooth_limit(acceleration: Floats, *, tangent: Floats, curvature: Floats) -> AxisLimit:
    """Limits of the axes on a path whose tangent and curvature have one value at each station.

    Parameters
    ----------
    acceleration : (3,) array, mm/s²
    tangent : (N, 3) array
        Unit tangent q'.
    curvature : (N, 3) array, 1/mm
        Curvature vector q''.
    """
    return AxisLimit(
        acceleration=acceleration,
        start_tangent=tangent[:-1],
        end_tangent=tangent[1:],
        start_curvature=curvature[:-1],
        end_curvature=curvature[1:],
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PathProfile:
    """Feed along a path of N stations."""

    squares: Floats
    """b = v², (N,), mm²/s²."""
    time: float
    """Time of the whole path, s."""

    @property
    def feeds(self) -> Floats:
        """Feed v at each station, (N,), mm/s."""
        return np.sqrt(self.squares)


def interval_times(lengths: Floats, squares: Floats) -> Floats:
    """Time of each interval, (N−1,), s."""
    feeds = np.sqrt(squares)
    times: Floats = 2.0 * lengths / (feeds[:-1] + feeds[1:])
    return times


def profile_of(lengths: Floats, squares: Floats) -> PathProfile:
    """Profile of squared feeds, (N,), mm²/s², with its time."""
    return PathProfile(squares=squares, time=float(interval_times(lengths, squares).sum()))


def _require_positive(values: Floats, message: str) -> None:
    """Refuse the first value that is not positive and finite; NaN is neither."""
    if not (values.min() > 0.0 and values.max() < np.inf):
        row = int(np.flatnonzero(~((values > 0.0) & (values < np.inf)))[0])
        raise ValueError(message.format(row, values[row]) + " must be positive and finite")


def _require_not_negative(values: Floats, message: str) -> None:
    """Refuse the first value that is negative, infinite or NaN."""
    if not (values.min() >= 0.0 and values.max() < np.inf):
        row = int(np.flatnonzero(~((values >= 0.0) & (values < np.inf)))[0])
        raise ValueError(message.format(row, values[row]) + " must not be negative, but finite")
