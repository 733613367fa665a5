"""One feed for each block, or for each part of a block that is split.

Controls take one feed per block. A block may be split where its greatest permitted feed
changes; its parts must not be too short, and no part runs faster than the control takes
blocks. The parts are chosen exactly, by dynamic programming over the places of the block.

Units: mm, mm/s, s.
"""

from dataclasses import dataclass

import numpy as np

from optimiser.along_path.caps import NAMES
from optimiser.along_path.runs import Commands
from optimiser.along_path.stretch import PathStretch
from simulator.kernels.kernel import entry
from simulator.motion.segments import Bools, Floats, Ints
from stepnc_model.post.block_feeds import BlockPart

SLACK = 2e-3
"""Relative excess over its cap up to which a programmed feed may be kept: engagements of a path
that is cut finer differ by less."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PieceRules:
    """Rules for splitting blocks and for keeping programmed feeds."""

    least_length: float = 0.5
    """Least length of a part of a split block, mm."""
    least_gain: float = 0.005
    """Time that each further part of a block must save, s."""
    kept_loss: float = 0.02
    """Greatest loss for which the programmed feed of a block is kept, over its time."""
    block_time: float = 0.0
    """Time that the control takes for a block, s."""
    least_change: float = 0.02
    """Least change of the feed within a block that is worth a part, over the lesser feed."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FeedPieces:
    """Parts of blocks with one feed each, in the order of the path."""

    block: Ints
    """Number of the block, (P,)."""
    begin: Floats
    """Length of the block before the part, (P,), mm."""
    length: Floats
    """Length of the part, (P,), mm."""
    weight: Floats
    """Time of the part at a feed of 1 in its unit, (P,)."""
    rate: Floats
    """Feed in the unit of the block, (P,): mm/s, or mm per revolution."""
    name: Ints
    """Number of the limit that gives it, (P,)."""
    programmed: Floats
    """Programmed feed in the unit of the block, (P,)."""
    is_per_revolution: Bools
    """Whether the feed is per revolution, (P,)."""
    run: Ints
    """Number of the run of feed moves between two rapids, (P,)."""
    last_run: Ints
    """Number of the last run of a part that has several, as a drilling cycle has, (P,)."""

    def __len__(self) -> int:
        return len(self.block)


class Executions:
    """Executions of blocks, one after another, and the parts of each at given feeds."""

    def __init__(self, pieces: FeedPieces, rates: Floats) -> None:
        self._pieces, self._rates = pieces, rates
        self.starts = np.flatnonzero(np.diff(pieces.block, prepend=-1))
        """First piece of each execution."""
        self._beyond = np.append(self.starts[1:], len(pieces))
        # Worked out for all blocks at once, as most have a single piece.
        self._is_last = np.append(np.diff(rates) != 0.0, True)
        self._is_last[self._beyond - 1] = True
        self._ends = pieces.begin + pieces.length

    def parts(self, row: int) -> tuple[BlockPart, ...]:
        """Parts of an execution; neighbours of equal feed are one."""
        pieces, first = self._pieces, int(self.starts[row])
        last = int(self._beyond[row]) - 1
        ends = first + np.flatnonzero(self._is_last[first : last + 1])
        return tuple(
            BlockPart(
                end=1.0 if end == last else float(self._ends[end] / self._ends[last]),
                rate=float(self._rates[end]),
                is_per_revolution=bool(pieces.is_per_revolution[first]),
                reason=NAMES[pieces.name[end]].words,
            )
            for end in ends.tolist()
        )


def pieces_of(stretch: PathStretch, commands: Commands, rules: PieceRules) -> FeedPieces:
    """Parts of the free blocks of a stretch, each with its greatest feed.

    A programmed feed that is permitted and costs little is kept, so that the plan of an
    optimised program changes nothing.
    """
    segments = stretch.segments
    ends, at = _cut_at_ends(commands.ends, rules.least_length)
    lengths = np.diff(ends, prepend=0.0)
    is_fed = (stretch.is_free & ~segments.is_rapid)[commands.segment[at]] & (lengths > 0.0)
    at, length = at[is_fed], lengths[is_fed]
    segment = commands.segment[at]
    per_revolution = stretch.per_revolution[segment]
    is_per_revolution = ~np.isnan(per_revolution)
    unit = np.where(is_per_revolution, stretch.spindle[segment], 1.0)
    weight, rate = length / unit, commands.caps.feed[at] / unit
    programmed = np.where(is_per_revolution, per_revolution, segments.speed[segment])
    block = segments.block[segment]
    first = _changes(block)
    group, chosen = np.zeros(len(at), dtype=np.int64), np.zeros(len(at))
    can_split = stretch.can_split[segment].astype(np.float64)
    _choose(
        np.append(first, len(at)),
        np.stack((length, weight, rate, programmed, can_split), axis=1),
        np.array([rules.least_length, rules.least_gain, rules.kept_loss, rules.block_time]),
        (np.zeros(len(at) + 1), np.zeros(len(at) + 1, dtype=np.int64)),
        group,
        chosen,
    )
    starts = _changes(group)
    group = np.repeat(np.arange(len(starts)), np.diff(np.append(starts, len(at))))
    before = np.concatenate(([0.0], np.cumsum(length)))
    of_block = np.searchsorted(first, starts, side="right") - 1
    run = commands.run[at]
    return FeedPieces(
        block=block[starts],
        begin=before[starts] - before[first[of_block]],
        length=_sums(length, starts),
        weight=_sums(weight, starts),
        rate=chosen[starts],
        name=commands.caps.name[at][_least_rows(rate, starts, group)],
        programmed=programmed[starts],
        is_per_revolution=is_per_revolution[starts],
        run=run[starts],
        last_run=run[np.append(starts[1:], len(at))[: len(starts)] - 1],
    )


def without_small_changes(pieces: FeedPieces, change: float) -> Floats:
    """Feeds in which neighbouring parts of a block differ by at least a share, (P,).

    Parts that differ by less both get the lesser feed.
    """
    rate = pieces.rate.copy()
    is_one_block = np.diff(pieces.block) == 0
    while True:
        low = np.minimum(rate[1:], rate[:-1])
        high = np.maximum(rate[1:], rate[:-1])
        rows = np.flatnonzero(is_one_block & (high > low) & (high < (1.0 + change) * low))
        if not len(rows):
            return rate
        np.minimum.at(rate, rows, low[rows])
        np.minimum.at(rate, rows + 1, low[rows])


def _cut_at_ends(ends: Floats, least: float) -> tuple[Floats, Ints]:
    """Places with parts of the least length cut off at both ends, and the place of each.

    A part that must be longer than its place can then take from the neighbours no more than it
    needs.
    """
    begins = np.concatenate(([0.0], ends[:-1]))
    is_long = ends - begins > 2.0 * least
    inner = np.concatenate((begins[is_long] + least, ends[is_long] - least))
    cut = np.sort(np.concatenate((ends, inner)))
    return cut, np.searchsorted(ends, cut)


def _changes(values: Ints) -> Ints:
    """Rows at which a value differs from the one before; the first row too."""
    if not len(values):
        return np.zeros(0, dtype=np.int64)
    return np.flatnonzero(np.concatenate(([True], values[1:] != values[:-1])))


def _sums(values: Floats, starts: Ints) -> Floats:
    """Sums of groups of rows."""
    sums: Floats = np.add.reduceat(values, starts) if len(starts) else np.zeros(0)
    return sums


def _least_rows(rate: Floats, starts: Ints, group: Ints) -> Ints:
    """Row of the least rate of each group."""
    order = np.lexsort((rate, group))
    return order[starts]


LENGTH, WEIGHT, RATE, PROGRAMMED, CAN_SPLIT = range(5)
LEAST_LENGTH, LEAST_GAIN, KEPT_LOSS, BLOCK_TIME = range(4)


@entry
def _choose(
    first: Ints,
    atoms: Floats,
    rules: Floats,
    desk: tuple[Floats, Ints],
    group: Ints,
    chosen: Floats,
) -> None:
    """Number the groups of the atoms of each block, and give the rate of each atom's group."""
    cost, back = desk
    number = 0
    for block in range(len(first) - 1):
        low, high = first[block], first[block + 1]
        whole_weight, whole_rate = 0.0, np.inf
        for row in range(low, high):
            whole_weight += atoms[row, WEIGHT]
            whole_rate = min(whole_rate, atoms[row, RATE])
        cost[low], back[low] = 0.0, low
        for end in range(low + 1, high + 1):
            cost[end], back[end] = np.inf, low
            length, weight, least = 0.0, 0.0, np.inf
            for begin in range(end - 1, low - 1, -1):
                length += atoms[begin, LENGTH]
                weight += atoms[begin, WEIGHT]
                least = min(least, atoms[begin, RATE])
                is_whole = begin == low and end == high
                if not is_whole and (
                    atoms[low, CAN_SPLIT] == 0.0 or length < rules[LEAST_LENGTH]
                ):
                    continue
                time = max(weight / least, rules[BLOCK_TIME]) + rules[LEAST_GAIN]
                if cost[begin] + time < cost[end]:
                    cost[end], back[end] = cost[begin] + time, begin
                if weight / least > cost[end]:
                    break
        given = atoms[low, PROGRAMMED]
        best = cost[high] - rules[LEAST_GAIN]
        is_kept = given <= (1.0 + SLACK) * whole_rate
        is_kept = is_kept and whole_weight / given <= (1.0 + rules[KEPT_LOSS]) * best
        end = high
        while end > low:
            begin = low if is_kept else back[end]
            least = np.inf
            for row in range(begin, end):
                least = min(least, atoms[row, RATE])
            for row in range(begin, end):
                group[row] = number
                chosen[row] = given if is_kept else least
            number += 1
            end = begin
