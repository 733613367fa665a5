"""Stretch of a path with what its tool meets, and the greatest feed at each place of it.

A place where the tool meets nothing is air only if it would meet nothing in a stock that is
larger all around by a margin, because blanks vary; otherwise it has the limits of the chip that
the larger stock would give. The first part of each way into the material has a reduced chip.

Units: mm, mm/s, rev/s, rad.
"""

from dataclasses import dataclass, replace

import numpy as np

from optimiser.along_path.caps import (
    CapName,
    Caps,
    CutBounds,
    StationCaps,
    capped,
    station_caps,
    unbounded,
)
from optimiser.cut import CutKind
from optimiser.depth_limits import DEEPER
from simulator.motion.path_limits import CENTRIPETAL_SHARE, block_lengths, least
from simulator.motion.segments import AxisLimits, Bools, Floats, Ints, Segments
from simulator.removal.stations import StationKind, Stations

ENTRY_SHARE = 0.5
"""Permitted chip on the way into the material over the permitted chip beyond (customary)."""

ENTRY_LENGTH = 0.1
"""Length of the way into the material over the tool diameter."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PathStretch:
    """Consecutive moves of one tool, from rest to rest, with what the tool meets.

    ``block`` of the segments numbers the blocks of the program, each of which has one feed.
    """

    segments: Segments
    """N segments at the programmed feeds."""
    spindle: Floats
    """Magnitude of the spindle speed, (N,), rev/s."""
    per_revolution: Floats
    """Programmed feed per revolution, (N,), mm; NaN for a feed per time."""
    is_free: Bools
    """Whether the feed of a segment may be chosen, (N,)."""
    can_split: Bools
    """Whether the block of a segment may be split, (N,)."""
    met: Stations
    """What the tool meets in the stock."""
    near: Stations | None = None
    """What the tool would meet in a stock that is larger by the margin; None: not known."""
    bounds: CutBounds | None = None
    """Tool and permitted loads; None: nothing is known, and no feed may be chosen."""
    workingstep: str = ""
    rise: Floats | None = None
    """Greatest feed by the permitted rise over the programmed one, (N,), mm/s; None: any."""
    plunge: Floats | None = None
    """Greatest feed of straight plunges, (N,), mm/s, infinite elsewhere; None: not bounded."""
    is_kept: Bools | None = None
    """Whether a block keeps its feed in all its executions, (N,); None: none does."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlaceCaps:
    """Greatest feeds along a stretch, from limits that hold at each place for itself."""

    ends: Floats
    """End of each place from the start of the stretch, (K,), mm, ascending."""
    segment: Ints
    """Segment of each place, (K,)."""
    caps: Caps
    """Greatest feed, (K,); infinite in air."""
    is_cut: Bools
    """Whether the tool removes material, (K,)."""


def segment_caps(segments: Segments, limits: AxisLimits, *, greatest: float | None) -> Caps:
    """Greatest feed on each segment that axes and control allow, (N,).

    Parameters
    ----------
    segments : Segments
    limits : AxisLimits
    greatest : float or None, mm/s
        Greatest feed of the machine.
    """
    share = _greatest_shares(segments)
    found = capped(least(limits.feed, share), CapName.AXIS_SPEED)
    if greatest is not None:
        found = found.least(capped(np.full(len(segments), greatest), CapName.FEED_MECHANISM))
    if limits.block_time > 0.0:
        longest = block_lengths(segments) / limits.block_time
        found = found.least(capped(longest, CapName.BLOCK_TIME))
    bend = curvatures(segments)
    is_normal = np.arange(3) == segments.normal[:, None]
    grip = np.where(is_normal, np.inf, limits.acceleration).min(axis=1)
    is_bent = bend > 0.0
    squares = np.full(len(segments), np.inf)
    np.divide(CENTRIPETAL_SHARE * grip, bend, out=squares, where=is_bent)
    return found.least(capped(np.sqrt(squares), CapName.CURVATURE))


def curvatures(segments: Segments) -> Floats:
    """Curvature of each segment, (N,), 1/mm; 0 for lines."""
    length = np.where(segments.length > 0.0, segments.length, 1.0)
    curvature: Floats = segments.radius * (segments.turn / length) ** 2
    return curvature


def _greatest_shares(segments: Segments) -> Floats:
    """Greatest movement of each axis per length of path, (N, 3)."""
    length = np.where(segments.length > 0.0, segments.length, 1.0)[:, None]
    share = np.abs(segments.end - segments.start) / length
    in_plane = segments.radius * np.abs(segments.turn) / length[:, 0]
    is_in_plane = np.arange(3) != segments.normal[:, None]
    is_arc = segments.turn[:, None] != 0.0
    shares: Floats = np.where(is_arc & is_in_plane, in_plane[:, None], share)
    return shares


def place_caps(stretch: PathStretch) -> PlaceCaps:
    """Process limits along a stretch.

    Raises
    ------
    ValueError
        When an engagement is not a number; with its place.
    """
    offsets = np.concatenate(([0.0], np.cumsum(stretch.segments.length)))
    met = _Along(stretch.met, offsets)
    near = met if stretch.near is None else _Along(stretch.near, offsets)
    ends = np.unique(np.concatenate((offsets[1:], met.ends, near.ends)))
    ends = ends[ends > 0.0]
    bounds = stretch.bounds
    if bounds is None:
        nothing = np.zeros(len(ends), dtype=np.bool_)
        caps = unbounded(len(ends))
        return PlaceCaps(ends=ends, segment=_segments(ends, offsets), caps=caps, is_cut=nothing)
    begins = _entries(ends, met.is_cut(ends))
    way_in = ENTRY_LENGTH * bounds.cut.diameter if bounds.cut.kind is CutKind.MILLING else 0.0
    ends = np.union1d(ends, np.minimum(begins + way_in, offsets[-1]))
    row, is_cut = met.rows(ends), met.is_cut(ends)
    found = _caps_of(stretch, stretch.met, bounds)
    caps, chip = found.caps.at(row), found.chip[row]
    if stretch.near is not None:
        around = _caps_of(stretch, stretch.near, bounds).caps.at(near.rows(ends))
        caps = Caps(
            feed=np.where(is_cut, caps.feed, around.feed),
            name=np.where(is_cut, caps.name, around.name),
        )
    middle = _middles(ends)
    since = middle - np.append(-np.inf, begins)[np.searchsorted(begins, middle)]
    is_drilled = (stretch.met.kind == StationKind.DRILLING)[row]
    is_entry = is_cut & (since < way_in) & ~is_drilled
    entry = np.where(is_entry, np.maximum(ENTRY_SHARE * chip, bounds.least), np.inf)
    caps = caps.least(capped(entry, CapName.ENTRY))
    return PlaceCaps(ends=ends, segment=_segments(ends, offsets), caps=caps, is_cut=is_cut)


class _Along:
    """Stations of a stretch by their distance from its start."""

    def __init__(self, stations: Stations, offsets: Floats) -> None:
        ends = offsets[stations.segment] + stations.station
        # A sum of lengths may pass the end of the stretch by a rounding error.
        self.ends: Floats = np.minimum(np.maximum.accumulate(ends), offsets[-1])
        self._cuts = stations.peak_section > 0.0

    def rows(self, ends: Floats) -> Ints:
        """Stations of the places with given ends."""
        rows: Ints = np.searchsorted(self.ends, _middles(ends))
        return np.minimum(rows, len(self.ends) - 1)

    def is_cut(self, ends: Floats) -> Bools:
        """Whether material is removed at the places with given ends."""
        cuts: Bools = self._cuts[self.rows(ends)]
        return cuts


def _middles(ends: Floats) -> Floats:
    middles: Floats = ends - 0.5 * np.diff(ends, prepend=0.0)
    return middles


def _segments(ends: Floats, offsets: Floats) -> Ints:
    """Segments of the places with given ends."""
    segments: Ints = np.searchsorted(offsets[1:], _middles(ends))
    return segments


def _entries(ends: Floats, is_cut: Bools) -> Floats:
    """Distances at which cuts begin, mm."""
    begins = is_cut & ~np.concatenate(([False], is_cut[:-1]))
    return np.concatenate(([0.0], ends[:-1]))[begins]


def met_caps(stretch: PathStretch) -> Caps:
    """Process limits at the stations of a stretch, without a reduced chip on the way in, (M,).

    Raises
    ------
    ValueError
        When an engagement is not a number; with its place.
    """
    if stretch.bounds is None:
        return unbounded(len(stretch.met))
    return _caps_of(stretch, stretch.met, stretch.bounds).caps


def _caps_of(stretch: PathStretch, stations: Stations, bounds: CutBounds) -> StationCaps:
    """Process limits at the stations of a stretch."""
    bad = np.flatnonzero(~np.isfinite(stations.peak_section * stations.chip_ratio))
    if len(bad):
        row = int(bad[0])
        block = int(stretch.segments.block[stations.segment[row]])
        raise ValueError(f"block {block}: the engagement at station {row} is not a number")
    segment = stations.segment
    direction = stretch.segments.direction(segment, stations.station)
    found = station_caps(
        stations, bounds, spindle=stretch.spindle[segment], descent=-direction[:, 2]
    )
    caps, given = found.caps, stretch.segments.speed[segment]
    if bounds.deepest is not None:
        is_deep = stations.axial_depth > DEEPER * bounds.deepest
        caps = caps.least(capped(np.where(is_deep, given, np.inf), CapName.SHOULDER))
    if bounds.keeps_programmed:
        kept = np.where(stations.peak_section > 0.0, given, np.inf)
        caps = caps.least(capped(kept, CapName.LOCKED))
    return replace(found, caps=caps)
