"""Fastest feed commands along a stretch that a control turns into permitted feeds.

A run is the part of a stretch between two rapids. The control chooses its filter by the greatest
feed of the run: a faster feed in air smooths more, so that slow feeds must reach farther and
corners must be slower. The greatest feed of each run is therefore chosen by trial, by the time
that results.

Units: mm, mm/s, s.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from optimiser.along_path.caps import NUMBER, CapName, Caps, capped
from optimiser.along_path.envelope import lower_envelope
from optimiser.along_path.stretch import (
    PathStretch,
    PlaceCaps,
    curvatures,
    locked,
    segment_caps,
)
from simulator.motion.path_limits import corners
from simulator.motion.segments import AxisLimits, ControlModel, Floats, Ints, Segments
from simulator.motion.smoothing import Smoothing, smoothing_of

TRIALS = 16
"""Number of greatest feeds that are tried for each run."""

SLOWEST = 1e-3
"""Least of the greatest feeds that are tried, over the greatest."""

LEAST_TURN = 1e-3
"""Sine of half the turn below which a junction is no corner: 0.1°."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineFeeds:
    """What machine and control allow along a path."""

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
    windows: Floats
    """Filter window of the run of each place, (K,), s; 0 on rapids."""


def commands_of(stretch: PathStretch, places: PlaceCaps, machine: MachineFeeds) -> Commands:
    """Greatest feed commands along a stretch.

    Parameters
    ----------
    stretch : PathStretch
    places : PlaceCaps
        Process limits along it.
    machine : MachineFeeds
    """
    segments = stretch.segments
    offsets = np.concatenate(([0.0], np.cumsum(segments.length)))
    own = segment_caps(segments, machine.limits, greatest=machine.greatest)
    own = Caps(
        feed=np.where(stretch.is_free, own.feed, np.inf), name=own.name
    ).least(locked(stretch))
    caps = places.caps.least(Caps(feed=own.feed[places.segment], name=own.name[places.segment]))
    parts: list[tuple[Floats, Ints, Caps, Floats]] = []
    changes = np.flatnonzero(np.diff(segments.is_rapid.astype(np.int8))) + 1
    for first, last in pairwise([0, *changes.tolist(), len(segments)]):
        rows = slice(*np.searchsorted(places.segment, [first, last]).tolist())
        if rows.start == rows.stop:
            continue
        ends, found, window = places.ends[rows], Caps(feed=caps.feed[rows], name=caps.name[rows]), 0.0
        if not segments.is_rapid[first]:
            run = _Run(segments[first:last], offsets[first:last + 1], ends, found, machine)
            ends, found, window = run.fastest()
        middle = ends - 0.5 * np.diff(ends, prepend=offsets[first])
        segment = np.searchsorted(offsets[1:], middle)
        parts.append((ends, segment, found, np.full(len(ends), window)))
    return Commands(
        ends=np.concatenate([part[0] for part in parts]),
        segment=np.concatenate([part[1] for part in parts]),
        caps=Caps(
            feed=np.concatenate([part[2].feed for part in parts]),
            name=np.concatenate([part[2].name for part in parts]),
        ),
        windows=np.concatenate([part[3] for part in parts]),
    )


class _Run:
    """Feed moves between two rapids, with what bounds their feeds."""

    def __init__(
        self,
        segments: Segments,
        offsets: Floats,
        ends: Floats,
        caps: Caps,
        machine: MachineFeeds,
    ) -> None:
        self.segments, self.offsets, self.machine = segments, offsets, machine
        self.ends, self.caps = ends, caps
        self.begins = np.concatenate((offsets[:1], ends[:-1]))
        moving = segments[segments.length > 0.0]
        before, after = corners(moving)
        sine = 0.5 * np.linalg.norm(after - before, axis=1)
        bent = np.flatnonzero(sine > LEAST_TURN)
        self.corner_places = (offsets[1:][segments.length > 0.0])[:-1][bent]
        self.corner_sines = sine[bent]
        self.bends = curvatures(segments)
        # A plan rounds no corner more than the program does, or than the tolerance.
        given = smoothing_of(machine.control, machine.limits, float(segments.speed.max()))
        slower = np.minimum(moving.speed[1:], moving.speed[:-1])[bent]
        rounding = given.corner_gain * slower * self.corner_sines
        self.corner_tolerance = np.maximum(rounding, machine.tolerance)
        shrinking = given.arc_gain * segments.speed**2 * self.bends
        self.arc_tolerance = np.maximum(shrinking, machine.tolerance)

    def fastest(self) -> tuple[Floats, Caps, float]:
        """Commands of the greatest feed that gives the least time, with the filter window."""
        known = self.caps.feed[np.isfinite(self.caps.feed)]
        top = float(known.max(initial=float(self.segments.speed.max())))
        is_locked = self.caps.name == NUMBER[CapName.LOCKED]
        low = max(float(known.min(initial=top)), SLOWEST * top)
        low = max(low, float(self.caps.feed[is_locked].max(initial=0.0)))
        best: tuple[Floats, Caps, float] | None = None
        least = np.inf
        for greatest in dict.fromkeys(np.geomspace(top, low, TRIALS).tolist()):
            smoothing = smoothing_of(self.machine.control, self.machine.limits, greatest)
            ends, caps = self._smoothed(greatest, smoothing)
            lengths = np.diff(ends, prepend=self.offsets[0])
            time = float((lengths / caps.feed).sum()) + smoothing.window
            if time < least:
                least, best = time, (ends, caps, smoothing.window)
            if smoothing.window == 0.0:
                break
        if best is None:
            raise ValueError("a run needs a feed above 0")
        return best

    def _smoothed(self, greatest: float, smoothing: Smoothing) -> tuple[Floats, Caps]:
        """Commands up to a greatest feed that keep all caps behind the control's filter."""
        caps = self.caps.least(capped(np.full(len(self.ends), greatest), CapName.AIR))
        if smoothing.window == 0.0:
            return self.ends, caps
        corner = _over(self.corner_tolerance, smoothing.corner_gain * self.corner_sines)
        arcs = np.sqrt(_over(self.arc_tolerance, smoothing.arc_gain * self.bends))
        first, last = float(self.offsets[0]), float(self.offsets[-1])
        begin = np.concatenate((self.begins, self.corner_places, self.offsets[:-1]))
        end = np.concatenate((self.ends, self.corner_places, self.offsets[1:]))
        feed = np.concatenate((caps.feed, corner, arcs))
        name = np.concatenate((
            caps.name,
            np.full(len(corner), NUMBER[CapName.CORNER]),
            np.full(len(arcs), NUMBER[CapName.CURVATURE]),
        ))
        bound = np.flatnonzero(np.isfinite(feed))
        feed, name = feed[bound], name[bound]
        reach = smoothing.reach * np.minimum(feed, greatest)
        found = lower_envelope(
            np.clip(begin[bound] - reach, first, last),
            np.clip(end[bound] + reach, first, last),
            feed,
        )
        return found.ends, Caps(feed=feed[found.which], name=name[found.which])


def _over(value: Floats, divisor: Floats) -> Floats:
    """Quotient of two arrays; infinite where the divisor is 0."""
    quotient = np.full(len(divisor), np.inf)
    np.divide(value, divisor, out=quotient, where=divisor > 0.0)
    return quotient
