"""Stretch of a path with what its tool meets, and the greatest feed at each place of it.

A place where the tool meets nothing is air only if it would meet nothing in a stock that is
larger all around by a margin, because blanks vary; otherwise it has the limits of the chip that
the larger stock would give. The first part of each way into the material has a reduced chip.

Units: mm, mm/s, rev/s, rad.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from optimiser.along_path.caps import (
    CapName,
    Caps,
    CutBounds,
    StationCaps,
    capped,
    raised_to,
    station_caps,
    unbounded,
)
from optimiser.bounds.limits import DEEPER
from optimiser.cuts.cut import CutKind
from simulator.motion.path_limits import (
    CENTRIPETAL_SHARE,
    block_lengths,
    least,
    slower_in_plane,
)
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
    unraised: Floats | None = None
    """Programmed feed of a tool whose feeds may only fall, (N,), mm/s; None: they may rise."""
    is_kept: Bools | None = None
    """Whether a block keeps its feed in all its executions, (N,); None: none does."""
    programmed: Floats | None = None
    """Feed as programmed, before any plan, (N,), mm/s, infinite on rapids; None: that of the
    segments."""


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
    floor: Floats | None = None
    """Feed below which no process limit goes, as it rests on a guess, (K,), mm/s; None: any."""


def segment_caps(segments: Segments, limits: AxisLimits, *, greatest: float | None) -> Caps:
    """Greatest feed on each segment that axes and control allow, (N,).

    Parameters
    ----------
    greatest : float or None, mm/s
        Greatest feed of the machine.
    """
    share = segments.greatest_shares
    found = capped(least(limits.feed, share), CapName.AXIS_SPEED)
    if greatest is not None:
        found = found.least(capped(np.full(len(segments), greatest), CapName.FEED_MECHANISM))
    if limits.block_time > 0.0:
        longest = block_lengths(segments) / limits.block_time
        found = found.least(capped(longest, CapName.BLOCK_TIME))
    bend, squares = segments.bend, np.full(len(segments), np.inf)
    grip = slower_in_plane(segments, limits.acceleration)
    np.divide(CENTRIPETAL_SHARE * grip, bend, out=squares, where=bend > 0.0)
    return found.least(capped(np.sqrt(squares), CapName.CURVATURE))


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
    segment = _segments(ends, offsets)
    if found.floor is None:
        return PlaceCaps(ends=ends, segment=segment, caps=caps, is_cut=is_cut)
    programmed, floor = _programmed(stretch)[segment], found.floor[row]
    if bounds.is_stock_guessed:
        blocks = stretch.segments.block[segment]
        kept = np.where(
            is_cut, np.inf, _without_stock(caps, blocks, is_cut, programmed, bounds)
        )
        caps = caps.least(capped(kept, CapName.GUESSED))
    caps = raised_to(caps, floor, CapName.GUESSED)
    return PlaceCaps(ends=ends, segment=segment, caps=caps, is_cut=is_cut, floor=floor)


def _without_stock(
    caps: Caps, blocks: Ints, is_cut: Bools, programmed: Floats, bounds: CutBounds
) -> Floats:
    """Greatest feed of places where a guessed stock leaves no material, (K,), mm/s.

    It is the programmed one. A drill meets the same load wherever the material begins: its
    block has the feed that holds where it meets some.
    """
    if bounds.cut.kind is not CutKind.DRILLING:
        return programmed
    known, of = np.unique(blocks, return_inverse=True)
    least = np.full(len(known), np.inf)
    np.minimum.at(least, of[is_cut], caps.feed[is_cut])
    met: Floats = least[of]
    return np.where(np.isfinite(met), met, programmed)


def _programmed(stretch: PathStretch) -> Floats:
    """Feed of each segment as programmed, (N,), mm/s; infinite on rapids."""
    if stretch.programmed is not None:
        return stretch.programmed
    return np.where(stretch.segments.is_rapid, np.inf, stretch.segments.speed)


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
        """True if material is removed at the places with given ends."""
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


def met_caps(stretch: PathStretch) -> StationCaps:
    """Process limits at the stations of a stretch, without a reduced chip on the way in, (M,).

    Raises
    ------
    ValueError
        When an engagement is not a number; with its place.
    """
    if stretch.bounds is None:
        free = unbounded(len(stretch.met))
        return StationCaps(caps=free, chip=free.feed, most=free.feed)
    return _caps_of(stretch, stretch.met, stretch.bounds)


def _caps_of(stretch: PathStretch, stations: Stations, bounds: CutBounds) -> StationCaps:
    """Process limits at the stations of a stretch."""
    bad = np.flatnonzero(~np.isfinite(stations.peak_section * stations.chip_ratio))
    if len(bad):
        row = int(bad[0])
        block = int(stretch.segments.block[stations.segment[row]])
        raise ValueError(f"block {block}: the engagement at station {row} is not a number")
    segment = stations.segment
    direction = stretch.segments.direction(segment, stations.station)
    spindle, descent = stretch.spindle[segment], -direction[:, 2]
    found = station_caps(stations, bounds, spindle=spindle, descent=descent)
    if bounds.is_guessed:
        others = [
            station_caps(stations, each, spindle=spindle, descent=descent)
            for each in bounds.plausible
        ]
        found = _plausible(found, others)
    caps, given = found.caps, stretch.segments.speed[segment]
    if bounds.deepest is not None:
        is_deep = stations.axial_depth > DEEPER * bounds.deepest
        caps = caps.least(capped(np.where(is_deep, given, np.inf), CapName.SHOULDER))
    if bounds.keeps_programmed:
        kept = np.where(stations.peak_section > 0.0, given, np.inf)
        caps = caps.least(capped(kept, CapName.LOCKED))
    if not bounds.is_guessed:
        return replace(found, caps=caps)
    # A feed falls to what the most favourable value permits, and not at all for a guessed
    # stock, which may not be there.
    floor = _programmed(stretch)[segment]
    if not bounds.is_stock_guessed:
        floor = np.minimum(floor, found.most)
    floor = np.where(np.isfinite(floor), floor, 0.0)
    return replace(found, caps=raised_to(caps, floor, CapName.GUESSED), floor=floor)


def _plausible(own: StationCaps, others: Sequence[StationCaps]) -> StationCaps:
    """Caps that hold for all values of what is guessed."""
    found = own
    for each in others:
        found = found.least(each)
    return found
