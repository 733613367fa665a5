"""Fastest feed commands along a stretch that a control turns into permitted feeds.

A run is the part of a stretch between two rapids. The control chooses its filter by the
greatest feed of the run: a faster feed in air smooths more, so that slow feeds must reach
farther and corners must be slower. The greatest feed of each run is therefore chosen by trial,
by the time that results.

Units: mm, mm/s, s.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from optimiser.along_path.caps import NUMBER, CapName, Caps, capped, raised_to, unbounded
from optimiser.along_path.envelope import lower_envelope
from optimiser.along_path.stretch import (
    PathStretch,
    PlaceCaps,
    segment_caps,
)
from simulator.motion.path_limits import corners
from simulator.motion.segments import AxisLimits, ControlModel, Floats, Ints
from simulator.motion.smoothing import Smoothing, smoothing_of

TRIALS, ROUNDS = 16, 2
"""Number of intervals between the greatest feeds that are tried for each run, and how often
they are tried, the second time more finely around the best."""

CERTAIN = 1.0 - 1e-9
"""Share of a bound on a time that no rounding of sums exceeds."""

SLOWEST = 1e-3
"""Least of the greatest feeds that are tried, over the greatest."""

LEAST_TURN = 1e-3
"""Sine of half the turn below which a junction is no corner: 0.1°."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineFeeds:
    """Feeds that machine and control allow along a path."""

    control: ControlModel
    limits: AxisLimits
    greatest: float | None = None
    """Greatest feed of the machine, mm/s; None: that of the axes."""
    tolerance: float = 0.05
    """Rounding of corners and arcs by the control that is always permitted, mm.

    More is permitted where the programmed feeds already round more.
    """


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Commands:
    """Greatest feeds that may be commanded along a stretch, place by place."""

    ends: Floats
    """End of each place from the start of the stretch, (K,), mm, ascending."""
    segment: Ints
    """Segment of each place, (K,)."""
    caps: Caps
    """Greatest feed that may be commanded, (K,); infinite on rapids."""
    run: Ints
    """Number of the run of each place, (K,); -1 on rapids."""
    greatest_locked: Floats
    """Greatest feed of each run that may not be chosen, (R,), mm/s; 0: none."""
    programmed_window: float
    """Time in which the control's filter settles after all runs as programmed, s."""


def own_caps(stretch: PathStretch, machine: MachineFeeds) -> Caps:
    """Greatest feeds that axes and control allow on each segment, (N,).

    A segment whose feed may not be chosen has the programmed feed; a rapid has none.
    """
    segments = stretch.segments
    own = segment_caps(segments, machine.limits, greatest=machine.greatest)
    is_fed = ~segments.is_rapid
    feed = np.where(stretch.is_free, own.feed, np.where(is_fed, segments.speed, np.inf))
    is_locked = is_fed & ~stretch.is_free
    return Caps(feed=feed, name=np.where(is_locked, NUMBER[CapName.LOCKED], own.name))


def written_caps(stretch: PathStretch) -> Caps:
    """Greatest feeds that may be written for each segment, (N,).

    They bound the words of the program and not what the tool does: a control that rounds the
    corner to a faster move passes them, as it does at the programmed feeds.
    """
    found = unbounded(len(stretch.segments))
    for feed, name in (
        (stretch.unraised, CapName.AS_PROGRAMMED),
        (stretch.rise, CapName.RISE),
        (stretch.plunge, CapName.STRAIGHT),
    ):
        if feed is not None:
            found = found.least(capped(np.where(stretch.is_free, feed, np.inf), name))
    if stretch.is_kept is None:
        return found
    kept = np.where(stretch.is_kept & stretch.is_free, stretch.segments.speed, np.inf)
    return capped(kept, CapName.NO_STOCK).least(found)


def commands_of(stretch: PathStretch, places: PlaceCaps, machine: MachineFeeds) -> Commands:
    """Greatest feed commands along a stretch.

    Parameters
    ----------
    places : PlaceCaps
        Process limits along it.
    """
    segments = stretch.segments
    offsets = np.concatenate(([0.0], np.cumsum(segments.length)))
    caps = places.caps.least(own_caps(stretch, machine).at(places.segment))
    found: list[_Smoothed] = []
    runs: list[Ints] = []
    locked: list[float] = []
    given = 0.0
    changes = np.flatnonzero(np.diff(segments.is_rapid.astype(np.int8))) + 1
    for first, last in pairwise([0, *changes.tolist(), len(segments)]):
        rows = slice(*np.searchsorted(places.segment, [first, last]).tolist())
        if rows.start == rows.stop:
            continue
        if segments.is_rapid[first]:
            found.append(_Smoothed(ends=places.ends[rows], caps=caps.at(rows), time=0.0))
            runs.append(np.full(len(found[-1].ends), -1))
            continue
        within = caps.at(rows)
        run = _FeedRun(
            stretch, slice(first, last), offsets[first : last + 1],
            ends=places.ends[rows], caps=within, machine=machine,
            floor=None if places.floor is None else places.floor[rows],
        )  # fmt: skip
        found.append(run.fastest())
        runs.append(np.full(len(found[-1].ends), len(locked)))
        locked.append(run.greatest_locked)
        given += run.smoothing.window
    found = found or [_Smoothed(ends=np.zeros(0), caps=unbounded(0), time=0.0)]
    ends = np.concatenate([part.ends for part in found])
    middle = ends - 0.5 * np.diff(ends, prepend=0.0)
    return Commands(
        ends=ends,
        segment=np.searchsorted(offsets[1:], middle),
        caps=Caps(
            feed=np.concatenate([part.caps.feed for part in found]),
            name=np.concatenate([part.caps.name for part in found]),
        ),
        run=np.concatenate(runs or [np.zeros(0, dtype=np.int64)]),
        greatest_locked=np.array(locked),
        programmed_window=given,
    )


OWN = [
    NUMBER[name]
    for name in (
        CapName.AIR, CapName.AXIS_SPEED, CapName.FEED_MECHANISM, CapName.BLOCK_TIME,
        CapName.CORNER, CapName.CURVATURE, CapName.LOCKED,
    )
]  # fmt: skip
"""Numbers of the limits of machine and control, whose places are exact."""

WRITTEN = [
    NUMBER[name]
    for name in (CapName.AS_PROGRAMMED, CapName.RISE, CapName.STRAIGHT, CapName.NO_STOCK)
]
"""Numbers of the limits on what may be written."""


CLEARANCE = 0.05
"""Distance by which a process limit may be displaced, over the tool diameter.

Engagement is known for stretches of at least this length, and a path that is split has other
stretches (:data:`simulator.removal.engage.LEAST_SHARE`).
"""

TURNING_CLEARANCE = 0.5
"""The same in turning, where cells and pieces at constant surface speed decide, mm."""


def clearance_of(stretch: PathStretch) -> float:
    """Distance by which the places of process limits may be displaced, mm."""
    if stretch.bounds is None:
        return 0.0
    cut = stretch.bounds.cut
    return TURNING_CLEARANCE if cut.kind.is_turned else CLEARANCE * cut.diameter


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Smoothed:
    """Commands along a run with one filter."""

    ends: Floats
    caps: Caps
    time: float
    """Time of the run with the settling of the filter, s."""


class _FeedRun:
    """Feed moves between two rapids, with what bounds their feeds."""

    def __init__(  # noqa: PLR0913 (a stretch with its places)
        self,
        stretch: PathStretch,
        rows: slice,
        offsets: Floats,
        *,
        ends: Floats,
        caps: Caps,
        machine: MachineFeeds,
        floor: Floats | None = None,
    ) -> None:
        segments = stretch.segments[rows]
        self.floor = floor
        self.clearance = clearance_of(stretch)
        self.least = 0.0 if stretch.bounds is None else stretch.bounds.least
        self.written = written_caps(stretch).at(rows)
        _, block = np.unique(segments.block, return_inverse=True)
        self.whole = np.where(stretch.can_split[rows], -1, block)
        """Block of each segment that stays in one piece, counted from 0; -1 for others."""
        self.segments, self.offsets, self.machine = segments, offsets, machine
        self.ends, self.caps = ends, caps
        self.begins = np.concatenate((offsets[:1], ends[:-1]))
        middles = 0.5 * (self.begins + ends)
        own = np.minimum(np.searchsorted(offsets[1:], middles), len(segments) - 1)
        self.within = caps.least(self.written.at(own))
        """Caps of the places with those of what may be written."""
        moving = segments[segments.length > 0.0]
        before, after = corners(moving)
        sine = 0.5 * np.linalg.norm(after - before, axis=1)
        bent = np.flatnonzero(sine > LEAST_TURN)
        self.corner_places = (offsets[1:][segments.length > 0.0])[:-1][bent]
        self.corner_sines = sine[bent]
        self.bends = segments.bend
        # A plan rounds no corner more than the program does, or than the tolerance.
        self.smoothing = smoothing_of(
            machine.control, machine.limits, float(segments.speed.max())
        )
        slower = np.minimum(moving.speed[1:], moving.speed[:-1])[bent]
        rounding = self.smoothing.corner_gain * slower * self.corner_sines
        self.corner_tolerance = np.maximum(rounding, machine.tolerance)
        shrinking = self.smoothing.arc_gain * segments.speed**2 * self.bends
        self.arc_tolerance = np.maximum(shrinking, machine.tolerance)

    def fastest(self) -> _Smoothed:
        """Commands of the greatest feed that gives the least time."""
        known = self.within.feed[np.isfinite(self.within.feed)]
        top = float(known.max(initial=float(self.segments.speed.max())))
        low = max(SLOWEST * top, self.greatest_locked)
        best = self._smoothed(top)
        if self.smoothing.window == 0.0:
            return best
        as_given = self._smoothed(float(self.segments.speed.max()))
        if as_given.time < best.time:
            best = as_given
        ratio = (top / low) ** (1.0 / TRIALS)
        for _ in range(ROUNDS):
            # Between two trials the time has no other minimum that matters.
            middle, best = self._best_near(best, top, low)
            top, low = min(top, middle * ratio), max(low, middle / ratio)
            ratio = (top / low) ** (1.0 / TRIALS)
        return best

    def _best_near(self, best: _Smoothed, top: float, low: float) -> tuple[float, _Smoothed]:
        """Greatest feed of least time among trials in a range, and its commands."""
        chosen = top
        for greatest in np.geomspace(top, low, TRIALS + 1).tolist():
            if CERTAIN * self._least_time(greatest) > best.time:
                continue
            tried = self._smoothed(greatest)
            if tried.time <= best.time:
                chosen, best = greatest, tried
        return chosen, best

    def _least_time(self, greatest: float) -> float:
        """Time that commands up to a greatest feed take at least, s: no cap reaches over."""
        feed = self.within.feed
        if self.floor is not None:
            feed = np.maximum(feed, self.floor)
        lengths = self.ends - self.begins
        window = smoothing_of(self.machine.control, self.machine.limits, greatest).window
        return float((lengths / np.minimum(feed, greatest)).sum()) + window

    @property
    def greatest_locked(self) -> float:
        """Greatest feed that may not be chosen, mm/s; 0: none."""
        is_locked = self.caps.name == NUMBER[CapName.LOCKED]
        return float(self.caps.feed[is_locked].max(initial=0.0))

    def _smoothed(self, greatest: float) -> _Smoothed:
        """Commands up to a greatest feed that keep all caps behind the control's filter."""
        smoothing = smoothing_of(self.machine.control, self.machine.limits, greatest)
        most = capped(np.full(len(self.ends), greatest), CapName.AIR)
        if smoothing.window == 0.0:
            return self._timed(self.ends, self.within.least(most), smoothing)
        caps = self.caps.least(most)
        corner = _over(self.corner_tolerance, smoothing.corner_gain * self.corner_sines)
        arcs = np.sqrt(_over(self.arc_tolerance, smoothing.arc_gain * self.bends))
        first, last = float(self.offsets[0]), float(self.offsets[-1])
        starts, stops = self.offsets[:-1], self.offsets[1:]
        # What may be written comes first: it gives its name where another cap is equal.
        begin = np.concatenate((starts, self.begins, self.corner_places, starts))
        end = np.concatenate((stops, self.ends, self.corner_places, stops))
        rounded = np.maximum(np.concatenate((corner, arcs)), self.least)
        feed = np.concatenate((self.written.feed, caps.feed, rounded))
        name = np.concatenate((
            self.written.name,
            caps.name,
            np.full(len(corner), NUMBER[CapName.CORNER]),
            np.full(len(arcs), NUMBER[CapName.CURVATURE]),
        ))
        bound = np.flatnonzero(np.isfinite(feed))
        feed, name = feed[bound], name[bound]
        clear = np.where(np.isin(name, OWN), 0.0, self.clearance)
        reach = smoothing.reach * np.minimum(feed, greatest) + clear
        reach[np.isin(name, WRITTEN)] = 0.0
        found = lower_envelope(
            np.clip(begin[bound] - reach, first, last),
            np.clip(end[bound] + reach, first, last),
            feed,
        )
        # A cap may reach over several segments; each place lies on one of them.
        ends = np.union1d(found.ends, self.offsets[1:][self.segments.length > 0.0])
        which = found.which[np.searchsorted(found.ends, ends)]
        found_caps = self._not_below(Caps(feed=feed[which], name=name[which]), ends)
        return self._timed(ends, found_caps, smoothing)

    def _not_below(self, caps: Caps, ends: Floats) -> Caps:
        """Caps without those that reach over from other places and rest on a guess."""
        if self.floor is None:
            return caps
        middles = ends - 0.5 * np.diff(ends, prepend=self.offsets[0])
        at = np.minimum(np.searchsorted(self.ends, middles), len(self.ends) - 1)
        is_process = ~np.isin(caps.name, [*OWN, *WRITTEN])
        return raised_to(caps, np.where(is_process, self.floor[at], 0.0), CapName.GUESSED)

    def _timed(self, ends: Floats, caps: Caps, smoothing: Smoothing) -> _Smoothed:
        lengths = np.diff(ends, prepend=self.offsets[0])
        feed = caps.feed
        if (self.whole >= 0).any():
            # A block in one piece has the least feed of its places.
            of = self.whole[np.searchsorted(self.offsets[1:], ends - 0.5 * lengths)]
            least = np.full(int(of.max()) + 2, np.inf)
            np.minimum.at(least, of, feed)
            feed = np.where(of >= 0, least[of], feed)
        time = float((lengths / feed).sum()) + smoothing.window
        return _Smoothed(ends=ends, caps=caps, time=time)


def _over(value: Floats, divisor: Floats) -> Floats:
    """Quotient of two arrays; infinite where the divisor is 0."""
    quotient = np.full(len(divisor), np.inf)
    np.divide(value, divisor, out=quotient, where=divisor > 0.0)
    return quotient
