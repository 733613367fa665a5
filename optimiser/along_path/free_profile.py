"""Continuous feed profile along a path: the fastest that caps and axes permit.

A control takes one feed per block, and its filter keeps feeds from changing at once. The free
profile knows neither: it is the exact optimum within the same caps and the accelerations of the
axes, from rest to rest between rapids, and so tells what blocks and filter cost. It carries the
certificate of :mod:`optimiser.feed_profile.certificate`.

Units: mm, mm/s, s.
"""

from dataclasses import dataclass
from functools import reduce
from itertools import pairwise

import numpy as np

from optimiser.along_path.caps import NAMES, Caps
from optimiser.along_path.runs import MachineFeeds, own_caps, written_caps
from optimiser.along_path.stretch import PathStretch, PlaceCaps
from optimiser.feed_profile.certificate import LimitExcess, certify
from optimiser.feed_profile.path_grid import PathEnds, PathGrid, path_grid, problem_on
from optimiser.feed_profile.profile import NamedCaps, ProfileProblem
from optimiser.feed_profile.sweep import sweep_axes
from simulator.motion.control import corner_squares
from simulator.motion.segments import Floats, Segments

STEP, JERK_STEP = 0.1, 1.0
"""Greatest distance between two stations, mm; with limited jerk, which takes much longer."""

MOST_STATIONS = 200_000
"""Number of stations of a run above which they lie farther apart."""

SUDDEN = 1e9
"""Acceleration of an axis whose limit is not known, mm/s²."""

CORNER = "corner at its tolerance"
"""Name of the caps at corners, where a circle touches both directions."""

STANDING = 1e-6
"""Squared feed below which a corner is a stop, mm²/s²."""

GREATEST = 1e12
"""Squared feed that stands for no cap, mm²/s²."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SmoothestRuns:
    """Smoothest profiles of some runs, beside the fastest at the same stations."""

    time: float
    """Time of the smoothest profiles, s."""
    fastest_time: float
    """Time of the fastest profiles, s."""
    unevenness: float
    """Sum of squared changes of the acceleration over the distance between them, mm/s⁴."""
    fastest_unevenness: float
    """The same sum of the fastest profiles, mm/s⁴."""

    @property
    def ratio(self) -> float:
        """Unevenness over that of the fastest profiles; 1 where these are even."""
        return self.unevenness / self.fastest_unevenness if self.fastest_unevenness else 1.0

    def plus(self, other: "SmoothestRuns") -> "SmoothestRuns":
        """Runs of both."""
        return SmoothestRuns(
            time=self.time + other.time,
            fastest_time=self.fastest_time + other.fastest_time,
            unevenness=self.unevenness + other.unevenness,
            fastest_unevenness=self.fastest_unevenness + other.fastest_unevenness,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeTask:
    """Further profiles that are computed beside the fastest one."""

    has_jerk: bool = False
    """Whether the profile with limited jerk is computed."""
    smooth_share: float | None = None
    """Time that the smoothest profile may add, over the fastest time; None: not computed."""


FASTEST_ALONE = FreeTask()


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeProfile:
    """Times of the free profile over some runs."""

    time: float = 0.0
    """Time of the profile, s."""
    bound: float = 0.0
    """Lower bound of its time, s."""
    jerk_time: float | None = None
    """Time of the profile with limited jerk, s; None unless it was asked for."""
    smoothest: SmoothestRuns | None = None
    """Smoothest profile within a time budget; None unless it was asked for."""
    worst: LimitExcess | None = None
    """Greatest relative excess over a limit, recomputed from the profile."""

    def plus(self, other: "FreeProfile") -> "FreeProfile":
        """Profiles of both, one after the other."""
        known = [each for each in (self.worst, other.worst) if each is not None]
        jerk = [each for each in (self.jerk_time, other.jerk_time) if each is not None]
        smooth = [each for each in (self.smoothest, other.smoothest) if each is not None]
        return FreeProfile(
            time=self.time + other.time,
            bound=self.bound + other.bound,
            jerk_time=sum(jerk) if jerk else None,
            smoothest=reduce(SmoothestRuns.plus, smooth) if smooth else None,
            worst=max(known, key=lambda each: each.excess, default=None),
        )


def free_profile(
    stretch: PathStretch, places: PlaceCaps, machine: MachineFeeds, task: FreeTask
) -> FreeProfile:
    """Free profile of the feed moves of a stretch.

    Parameters
    ----------
    places : PlaceCaps
        Process limits along it.
    """
    segments = stretch.segments
    offsets = np.concatenate(([0.0], np.cumsum(segments.length)))
    caps = places.caps.least(
        own_caps(stretch, machine).least(written_caps(stretch)).at(places.segment)
    )
    found = FreeProfile()
    changes = np.flatnonzero(np.diff(segments.is_rapid.astype(np.int8))) + 1
    for first, last in pairwise([0, *changes.tolist(), len(segments)]):
        rows = np.arange(first, last)[segments.length[first:last] > 0.0]
        if segments.is_rapid[first] or not len(rows):
            continue
        run = _RunCaps(segments[rows], offsets[rows], places, caps, machine)
        found = found.plus(run.profile(task))
    return found


def _between_stops(grid: PathGrid) -> PathGrid:
    """Grid with a station in the middle of segments that have none between their ends."""
    count = np.bincount(grid.row, minlength=len(grid.segments))
    pieces = np.where(count[grid.row] == 1, 2, 1)
    row = np.repeat(np.arange(len(grid.row)), pieces)
    is_second = np.diff(row, prepend=-1) == 0
    is_first = np.append(is_second[1:], False)
    middle = 0.5 * (grid.begin + grid.finish)[row]
    return PathGrid(
        segments=grid.segments,
        row=grid.row[row],
        begin=np.where(is_second, middle, grid.begin[row]),
        finish=np.where(is_first, middle, grid.finish[row]),
    )


class _RunCaps:
    """Feed moves between two rapids, with the caps along them."""

    def __init__(
        self,
        segments: Segments,
        offsets: Floats,
        places: PlaceCaps,
        caps: Caps,
        machine: MachineFeeds,
    ) -> None:
        self.segments, self.offsets = segments, offsets
        self.places, self.caps, self.machine = places, caps, machine

    def profile(self, task: FreeTask) -> FreeProfile:
        """Free profile of the run."""
        fine = float(self.segments.length.sum()) / MOST_STATIONS
        grid, problem, named = self._problem(max(STEP, fine))
        limit = grid.axis_limit(self._acceleration())
        profile = sweep_axes(problem, limit)
        proof = certify(problem, profile, caps=named, limit=limit)
        jerk_time = self._jerk_time(max(JERK_STEP, fine)) if task.has_jerk else None
        share = task.smooth_share
        return FreeProfile(
            time=profile.time,
            bound=proof.bound,
            jerk_time=jerk_time,
            smoothest=None if share is None else self._smoothest(share),
            worst=proof.worst,
        )

    def _jerk_time(self, step: float) -> float:
        from optimiser.feed_profile.jerk_program import jerk_limited_profile  # noqa: PLC0415 (cvxpy)

        known = self.machine.limits.jerk[np.isfinite(self.machine.limits.jerk)]
        if not len(known):
            raise ValueError("the machine states no jerk of its axes")
        grid, problem, _ = self._problem(step)
        limit = grid.axis_limit(self._acceleration())
        return jerk_limited_profile(problem, limit, jerk=float(known.min())).time

    def _smoothest(self, share: float) -> SmoothestRuns:
        """Smoothest profile that takes at most a given share longer than the fastest one.

        A run of too many stations for the solver keeps its fastest profile.
        """
        from optimiser.feed_profile import profile_program as programs  # noqa: PLC0415 (cvxpy)

        most = programs.MOST_STATIONS
        fine = 2.0 * float(self.segments.length.sum()) / most
        grid, problem, _ = self._problem(max(JERK_STEP, fine))
        limit = grid.axis_limit(self._acceleration())
        fastest = sweep_axes(problem, limit)
        least = uneven = programs.unevenness(problem.lengths, fastest.squares)
        time = fastest.time
        if len(problem) <= most:
            found = programs.smoothest_profile(
                problem, limit, budget=(1.0 + share) * fastest.time
            )
            least, time = found.unevenness, found.profile.time
        return SmoothestRuns(
            time=time,
            fastest_time=fastest.time,
            unevenness=least,
            fastest_unevenness=uneven,
        )

    def _acceleration(self) -> Floats:
        limits = self.machine.limits.acceleration
        return np.where(np.isfinite(limits), limits, SUDDEN)

    def _problem(self, step: float) -> tuple[PathGrid, ProfileProblem, NamedCaps]:
        """Problem of the run at stations that are at most some distance apart."""
        grid = _between_stops(path_grid(self.segments, step=step))
        named = self._named(grid)
        stops = np.flatnonzero(named.least == 0.0)
        return grid, problem_on(grid, named.least, ends=PathEnds(stops=stops)), named

    def _named(self, grid: PathGrid) -> NamedCaps:
        """Caps on the squared feed at the stations of a grid, by name."""
        places, caps, last = self.places, self.caps, len(self.caps.feed) - 1
        ends = self.offsets[grid.row] + grid.finish
        low = np.searchsorted(places.ends, ends - grid.lengths, side="right")
        high = np.searchsorted(places.ends, ends, side="left")
        low, high = np.minimum(low, last), np.minimum(high, last)
        touched = np.stack((low, high + 1), axis=1).ravel()
        used = np.unique(caps.name[low.min() : high.max() + 1])
        squares = np.full((len(used) + 1, len(grid)), np.inf)
        for row, number in enumerate(used):
            feed = np.append(np.where(caps.name == number, caps.feed, np.inf), np.inf)
            least = np.minimum.reduceat(feed, touched)[::2] ** 2
            squares[row, :-1] = np.minimum(squares[row, :-1], least)
            squares[row, 1:] = np.minimum(squares[row, 1:], least)
        corner = corner_squares(
            grid.segments, self.machine.limits.acceleration, deviation=self.machine.tolerance
        )
        # A path that turns back stops, whatever is left by rounding.
        squares[-1, grid.boundaries] = np.where(corner < STANDING, 0.0, corner)
        names = (*(NAMES[number].words for number in used), CORNER)
        return NamedCaps(names=names, squares=np.minimum(squares, GREATEST))
