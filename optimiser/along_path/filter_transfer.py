"""Feeds that a control's filter carries over into a cut, judged by place on the path.

A feed that is too fast for its own place is found at once. Behind a filter the tool also meets
a place at the feeds that are commanded around it, half a window before and behind
(:mod:`simulator.motion.smoothing`). So the feed that may be commanded at a place is the least
of the limits whose reach covers it. This judges a given path, with the engagement as it was
found for these very moves, and gives slower feeds where they are needed. Feeds per revolution
are judged as such: the spindle changes its speed, and with it the feed per time and its limits.

Units: mm, mm/s, s.
"""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from optimiser.advice import LimitLoad
from optimiser.along_path.caps import NAMES, NUMBER, CapName, Caps, raised_to
from optimiser.along_path.envelope import lower_envelope
from optimiser.along_path.pieces import SLACK, FeedPieces, PieceRules, pieces_of
from optimiser.along_path.runs import Commands, MachineFeeds
from optimiser.along_path.stretch import PathStretch, met_caps
from simulator.motion.segments import Floats, Ints
from simulator.motion.smoothing import smoothing_of
from simulator.removal.stations import stretch_lengths


def permitted_commands(stretch: PathStretch, machine: MachineFeeds) -> Commands:
    """Greatest feeds that may be commanded along a stretch for the process's sake.

    The filter is that of the stretch's own feeds. Accelerations, corners and limits of the axes
    are not considered: they are the control's own affair.

    Raises
    ------
    ValueError
        When an engagement is not a number; with its place.
    """
    segments, met = stretch.segments, stretch.met
    offsets = np.concatenate(([0.0], np.cumsum(segments.length)))
    limits = met_caps(stretch)
    caps = limits.caps
    starts = np.flatnonzero(np.diff(segments.is_rapid, prepend=~segments.is_rapid[:1]))
    beyond = np.append(starts[1:], len(segments))
    run = np.searchsorted(starts, np.arange(len(segments)), side="right") - 1
    greatest = np.maximum.reduceat(np.where(segments.is_rapid, 0.0, segments.speed), starts)
    reach = _reaches(greatest, machine)
    is_own = ~np.isnan(stretch.per_revolution) | segments.is_rapid
    unit = np.where(np.logical_and.reduceat(is_own, starts)[run], stretch.spindle, 1.0)
    unit = np.where(unit > 0.0, unit, 1.0)
    at = np.flatnonzero(~segments.is_rapid[met.segment] & (caps.feed < np.inf))
    at = at[caps.feed[at] < greatest[run[met.segment[at]]]]
    of = run[met.segment[at]]
    end = offsets[met.segment[at]] + met.station[at]
    begin = end - stretch_lengths(met)[at]
    width = reach[of] * caps.feed[at]
    limit = caps.feed[at] / unit[met.segment[at]]
    if not offsets[-1] > 0.0:
        nothing = Caps(feed=np.zeros(0), name=np.zeros(0, dtype=np.int64))
        return _commands(np.zeros(0), np.zeros(0, dtype=np.int64), nothing, run)
    found = lower_envelope(
        np.append(np.maximum(begin - width, offsets[starts[of]]), 0.0),
        np.append(np.minimum(end + width, offsets[beyond[of]]), offsets[-1]),
        np.append(limit, np.inf),
    )
    ends = np.union1d(found.ends, offsets[1:][segments.length > 0.0])
    which = found.which[np.minimum(np.searchsorted(found.ends, ends), len(found.ends) - 1)]
    segment = np.searchsorted(offsets[1:], _middles(ends))
    least = Caps(
        feed=np.append(limit, np.inf)[which] * unit[segment],
        name=np.append(caps.name[at], NUMBER[CapName.AIR])[which],
    )
    if limits.floor is not None:
        # What rests on a guess lowers no feed, also not over the border of a place.
        stations = offsets[met.segment] + met.station
        row = np.minimum(np.searchsorted(stations, _middles(ends)), len(stations) - 1)
        least = raised_to(least, limits.floor[row], CapName.GUESSED)
    return _commands(ends, segment, least, run)


def _reaches(greatest: Floats, machine: MachineFeeds) -> Floats:
    """Reach of the filter over the feed for the greatest feed of each run, (R,), s."""

    @cache
    def reach(feed: float) -> float:
        smoothing = smoothing_of(machine.control, machine.limits, feed)
        return smoothing.reach if feed > 0.0 else 0.0

    return np.array([reach(feed) for feed in greatest.tolist()])


def _middles(ends: Floats) -> Floats:
    middles: Floats = ends - 0.5 * np.diff(ends, prepend=0.0)
    return middles


def _commands(ends: Floats, segment: Ints, caps: Caps, run: Ints) -> Commands:
    return Commands(
        ends=ends,
        segment=segment,
        caps=caps,
        run=run[segment],
        greatest_locked=np.zeros(0),
        programmed_window=0.0,
    )


def excess(stretch: PathStretch, machine: MachineFeeds) -> Floats:
    """Programmed feed over the greatest that the process permits, by segment, (N,).

    0 on rapids, where no limit of the process is below the greatest feed of the run, and where
    the feed may not be chosen.

    Raises
    ------
    ValueError
        When an engagement is not a number; with its place.
    """
    found = np.zeros(len(stretch.segments))
    if stretch.bounds is not None:
        commands = permitted_commands(stretch, machine)
        segment = commands.segment
        speed = np.where(stretch.is_free, stretch.segments.speed, 0.0)[segment]
        np.maximum.at(found, segment, speed / commands.caps.feed)
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class BrokenBound:
    """Feed that is above what the process permits."""

    block: int
    """Number of the block."""
    ratio: float
    """Feed over the permitted one."""
    name: CapName
    load: LimitLoad | None = None
    """Load of the limit there; None where only the feeds are compared."""

    @property
    def words(self) -> str:
        """Excess of the feed over the limit, in words."""
        return f"its feed is {self.ratio:.3g} times what {self.name.words} permits"


def most_broken(stretch: PathStretch, machine: MachineFeeds) -> BrokenBound | None:
    """Feed of a stretch that is farthest above what the process permits, chosen or not.

    None where no limit is known, or nothing is met.

    Raises
    ------
    ValueError
        When an engagement is not a number; with its place.
    """
    if stretch.bounds is None:
        return None
    commands = permitted_commands(stretch, machine)
    segments = stretch.segments
    speed = np.where(segments.is_rapid, 0.0, segments.speed)[commands.segment]
    ratio = speed / commands.caps.feed
    if not ratio.any():
        return None
    worst = int(ratio.argmax())
    return BrokenBound(
        block=int(segments.block[commands.segment[worst]]),
        ratio=float(ratio[worst]),
        name=NAMES[commands.caps.name[worst]],
    )


def slower_pieces(
    stretch: PathStretch, machine: MachineFeeds, rules: PieceRules
) -> FeedPieces | None:
    """Feeds for the blocks of a stretch that are too fast; None if there are none.

    A block that may be split is slower only where it must be; no part is faster than the block.

    Parameters
    ----------
    stretch : PathStretch
        Path at the feeds that are judged.

    Raises
    ------
    ValueError
        When an engagement is not a number; with its place.
    """
    if stretch.bounds is None:
        return None
    commands = permitted_commands(stretch, machine)
    segment, caps = commands.segment, commands.caps
    speed = stretch.segments.speed[segment]
    is_fast = stretch.is_free[segment] & (speed > (1.0 + SLACK) * caps.feed)
    if not is_fast.any():
        return None
    blocks = np.unique(stretch.segments.block[segment[is_fast]])
    slower = replace(
        stretch,
        is_free=stretch.is_free & np.isin(stretch.segments.block, blocks),
    )
    least = replace(caps, feed=np.minimum(caps.feed, speed))
    return pieces_of(slower, replace(commands, caps=least), rules)
