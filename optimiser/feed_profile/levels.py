"""Few feeds for many stretches: piecewise-constant feeds of least time.

A path is given as n consecutive stretches, each with a length and a cap on its feed. At most K
distinct feeds may be used, each stretch stays within its cap, and the total time ``Σ L / v`` is
least. The best feeds are caps themselves, as any feed can rise to the least cap of those that
use it.

**Any order of feeds** (no shortest block, no least change): sorted by cap, the stretches of one
feed are neighbours and their feed is the cap of the first. With the running length P the time
of the stretches i to j is ``(P_j − P_i) / cap_i``: lines in P_j whose slope falls with i, so
that each step of the dynamic program over K is the lower envelope of lines, [1]_, and the
optimum costs O(n·K) after sorting. It is exact.

**Blocks.** A block is a run of stretches with one feed; a control needs a least time for each,
and a feed that hardly changes is not worth a word. With a shortest block or a least change, the
feeds of the stretches are found exactly for given feeds, by a dynamic program over the path in
O(n·K²): the least cap within a block bounds its feed. Which K feeds to give it is a search,
by turns with the first program over the blocks found and by exchanges of single feeds, so that
the result need not be the optimum. :attr:`Levels.bound` is the time of K feeds in any order of
them; no choice takes less.

Units mm, s.

References
----------
.. [1] A. Grønlund et al., "Fast exact k-means, k-medians and Bregman divergence clustering in
   1D", arXiv:1701.07204 (2017), sections 2.2 and 2.4: dynamic programs over sorted values with
   a concave cost.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.kernels.kernel import entry, kernel

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CANDIDATES = 24
"""Number of feeds among which single feeds are exchanged."""

EXCHANGE_WORK = 60_000
"""Largest product of stretches and feeds for which single feeds are exchanged."""

ROUNDS = 6
"""Largest number of turns of a search."""

ROUNDING = 1e-12
"""Relative rounding error that a length or a change may show."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BlockRule:
    """Rule of a control for the blocks of a feed.

    Raises
    ------
    ValueError
        If a value is negative or not finite.
    """

    shortest: float = 0.0
    """Least length of a block, mm; a path that is shorter is one block."""
    change: float = 0.0
    """Least relative change between neighbouring feeds, the higher one over the lower − 1."""

    def __post_init__(self) -> None:
        for name, unit in (("shortest", " mm"), ("change", "")):
            value = getattr(self, name)
            if not 0.0 <= value < np.inf:
                raise ValueError(f"{name} of {value:g}{unit} must not be negative, but finite")


ANY_BLOCK = BlockRule()
"""No rule for blocks."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Levels:
    """Piecewise-constant feeds of n stretches."""

    feeds: Floats
    """Feed of each stretch, (n,), mm/s."""
    values: Floats
    """Distinct feeds, ascending, mm/s."""
    time: float
    """Time of all stretches at their feeds, s."""
    free_time: float
    """Time of all stretches at their caps, s."""
    bound: float
    """Least time of as many feeds without a rule for blocks, s; no choice takes less."""

    @property
    def gap(self) -> float:
        """Share of the free time that the choice of few feeds adds."""
        return self.time / self.free_time - 1.0

    @property
    def block_starts(self) -> Ints:
        """Index of the first stretch of each block."""
        return np.append(0, np.flatnonzero(np.diff(self.feeds)) + 1)


def best_levels(
    lengths: Floats, caps: Floats, *, count: int, rule: BlockRule = ANY_BLOCK
) -> Levels:
    """Find at most ``count`` distinct feeds of stretches, of least time.

    Parameters
    ----------
    lengths : (n,) array, mm
        Lengths of consecutive stretches.
    caps : (n,) array, mm/s
        Greatest feed of each stretch.
    count : int
        Largest number of distinct feeds.

    Returns
    -------
    Levels

    Raises
    ------
    ValueError
        If there is no stretch, shapes differ, a length or cap is not positive and finite, or
        the count is below 1.

    Examples
    --------
    >>> lengths, caps = np.array([5.0, 5.0, 1.0, 9.0]), np.array([10.0, 11.0, 20.0, 30.0])
    >>> found = best_levels(lengths, caps, count=2)
    >>> found.feeds.tolist()
    [10.0, 10.0, 10.0, 30.0]
    >>> round(found.gap, 4)
    0.0732
    """
    _require(lengths, caps, count)
    lengths = np.ascontiguousarray(lengths, dtype=np.float64)
    caps = np.ascontiguousarray(caps, dtype=np.float64)
    values = _any_order(lengths, caps, count)
    feeds = values[np.searchsorted(values, caps, side="right") - 1]
    bound = float(np.sum(lengths / feeds))
    if rule.shortest > 0.0 or rule.change > 0.0:
        feeds = _in_blocks(lengths, caps, values, count=count, rule=rule)
    return Levels(
        feeds=feeds,
        values=np.unique(feeds),
        time=float(np.sum(lengths / feeds)),
        free_time=float(np.sum(lengths / caps)),
        bound=bound,
    )


def _require(lengths: Floats, caps: Floats, count: int) -> None:
    """Refuse what is no row of stretches."""
    if lengths.ndim != 1 or not len(lengths) or lengths.shape != caps.shape:
        message = f"got {lengths.shape} and {caps.shape}"
        raise ValueError(f"lengths and caps must have the same shape (n,), n > 0: {message}")
    if count < 1:
        raise ValueError(f"count of {count} feeds must be at least 1")
    for name, unit, each in (("length", "mm", lengths), ("cap", "mm/s", caps)):
        if not (each.min() > 0.0 and each.max() < np.inf):
            row = int(np.flatnonzero(~((each > 0.0) & (each < np.inf)))[0])
            message = f"{name} {each[row]:g} {unit} must be positive and finite"
            raise ValueError(f"stretch {row}: {message}")


def _any_order(lengths: Floats, caps: Floats, count: int) -> Floats:
    """Best feeds without a rule for blocks, ascending."""
    sorted_caps, group = np.unique(caps, return_inverse=True)
    size = len(sorted_caps)
    if size <= count:
        return sorted_caps
    reached = np.append(0.0, np.cumsum(np.bincount(group, weights=lengths)))
    best = np.empty((2, size + 1))
    first = np.zeros((count, size + 1), dtype=np.int64)
    envelope(sorted_caps, reached, best, first, np.zeros(size + 1, dtype=np.int64))
    chosen, last = [], size
    for level in range(count - 1, -1, -1):
        last = int(first[level, last])
        chosen.append(last)
        if last == 0:
            break
    return sorted_caps[chosen[::-1]]


@entry
def envelope(caps: Floats, reached: Floats, best: Floats, first: Ints, hull: Ints) -> None:
    """Fill the dynamic program over the number of feeds, by envelopes of lines.

    ``best[k, j]`` is the least time of the first j caps with k+1 feeds, of which two rows are
    kept, and ``first[k, j]`` the index of the cap that is the last feed. ``hull`` is room for
    the lines on the envelope.
    """
    size = len(caps)
    for column in range(size + 1):
        best[0, column] = reached[column] / caps[0]
    best[0, 0] = 0.0
    for level in range(1, len(first)):
        old, new = (level - 1) % 2, level % 2
        head, tail = 0, 0
        best[new, 0] = 0.0
        for column in range(1, size + 1):
            line = column - 1
            slope = 1.0 / caps[line]
            height = best[old, line] - reached[line] * slope
            while tail - head >= 2:
                last, before = hull[tail - 1], hull[tail - 2]
                slope_1, slope_0 = 1.0 / caps[last], 1.0 / caps[before]
                height_1 = best[old, last] - reached[last] * slope_1
                height_0 = best[old, before] - reached[before] * slope_0
                if (height - height_0) * (slope_0 - slope_1) > (height_1 - height_0) * (
                    slope_0 - slope
                ):
                    break
                tail -= 1
            hull[tail] = line
            tail += 1
            at = reached[column]
            while tail - head >= 2:
                here, there = hull[head], hull[head + 1]
                now = best[old, here] + (at - reached[here]) / caps[here]
                then = best[old, there] + (at - reached[there]) / caps[there]
                if now <= then:
                    break
                head += 1
            here = hull[head]
            best[new, column] = best[old, here] + (at - reached[here]) / caps[here]
            first[level, column] = here


def _in_blocks(
    lengths: Floats, caps: Floats, values: Floats, *, count: int, rule: BlockRule
) -> Floats:
    """Feeds of stretches by a search for the levels that suit the rule for blocks best."""
    search = _Search(lengths, caps, rule)
    candidates = _any_order(lengths, caps, max(count, CANDIDATES))
    shaped = _assigned(lengths, caps, candidates, BlockRule(shortest=rule.shortest))
    search.try_levels(values)
    search.try_levels(_levels_of_blocks(lengths, caps, shaped, count))
    for _ in range(ROUNDS):
        if not search.try_levels(_levels_of_blocks(lengths, caps, search.feeds, count)):
            break
    if len(lengths) * count <= EXCHANGE_WORK:
        for _ in range(ROUNDS):
            before = search.time
            for each in _exchanges(np.unique(search.feeds), candidates, count):
                search.try_levels(each)
            if not search.time < before:
                break
    return search.feeds


def _exchanges(levels: Floats, candidates: Floats, count: int) -> Iterator[Floats]:
    """Sets of levels in which one is exchanged for another, or to which one is added."""
    lowest, higher = levels[:1], levels[1:]
    others = np.setdiff1d(candidates, levels)
    for other in others:
        if len(levels) < count:
            yield np.sort(np.append(levels, other))
        for index in range(len(higher)):
            kept = np.delete(higher, index)
            yield np.sort(np.concatenate((lowest, kept, [other])))


class _Search:
    """Best feeds of stretches so far."""

    def __init__(self, lengths: Floats, caps: Floats, rule: BlockRule) -> None:
        self.lengths, self.caps, self.rule = lengths, caps, rule
        self.feeds = np.full(len(caps), caps.min())
        self.time = float(np.sum(lengths / self.feeds))

    def try_levels(self, levels: Floats) -> bool:
        """Keep the best assignment of levels, and tell whether it takes less time."""
        feeds = _assigned(self.lengths, self.caps, levels, self.rule)
        time = float(np.sum(self.lengths / feeds))
        if not time < self.time * (1.0 - ROUNDING):
            return False
        self.feeds, self.time = feeds, time
        return True


def _levels_of_blocks(lengths: Floats, caps: Floats, feeds: Floats, count: int) -> Floats:
    """Best levels when the blocks of some feeds stay whole."""
    starts = np.append(0, np.flatnonzero(np.diff(feeds)) + 1)
    return _any_order(
        np.add.reduceat(lengths, starts), np.minimum.reduceat(caps, starts), count
    )


def _assigned(lengths: Floats, caps: Floats, levels: Floats, rule: BlockRule) -> Floats:
    """Feeds of least time among given levels, ascending, that keep the rule for blocks."""
    reached = np.append(0.0, np.cumsum(lengths))
    size, count = len(lengths), len(levels)
    start = np.zeros((size + 1, count), dtype=np.int64)
    previous = np.zeros((size + 1, count), dtype=np.int64)
    numbers = np.array((min(rule.shortest, reached[-1]) * (1.0 - ROUNDING), rule.change))
    table = np.empty((size + 1, count))
    assign(reached, caps, levels, numbers, (table, start, previous), np.empty((3, count)))
    feeds = np.empty(size)
    row, level = size, int(table[size].argmin())
    while row > 0:
        begin = int(start[row, level])
        feeds[begin:row] = levels[level]
        level, row = int(previous[begin, level]), begin
    return feeds


@entry
def assign(
    reached: Floats,
    caps: Floats,
    levels: Floats,
    numbers: Floats,
    tables: tuple[Floats, Ints, Ints],
    work: Floats,
) -> None:
    """Fill the dynamic program over the path for given levels.

    A block of level u from stretch i to j costs ``(P_j − P_i) / u`` whatever lies between, so
    that the best start of a block that ends at j is a running least value, which a stretch
    whose cap is below u empties.

    Parameters
    ----------
    reached : (n+1,) array, mm
        Length up to each stretch.
    caps : (n,) array, mm/s
    levels : (K,) array, mm/s
    numbers : (2,) array
        Shortest block, mm, and least change.
    tables : tuple of (n+1, K) arrays
        Least time of the first j stretches if the last block has level u; index of the first
        stretch of that block; level of the block before one of level u that starts at j.
    work : (3, K) array
        Room: least value, its start, and next start to consider.
    """
    time, start, previous = tables
    change = numbers[1]
    for level in range(len(levels)):
        work[0, level], work[1, level], work[2, level] = np.inf, 0.0, 0.0
    for row in range(len(caps) + 1):
        for level in range(len(levels)):
            time[row, level] = np.inf
            if row == 0:
                continue
            if caps[row - 1] < levels[level]:
                work[0, level], work[2, level] = np.inf, float(row)
                continue
            _consider_starts(reached, levels, numbers, tables, work, (row, level))
            time[row, level] = work[0, level] + reached[row] / levels[level]
            start[row, level] = int(work[1, level])
        for level in range(len(levels)):
            best = np.inf
            previous[row, level] = level
            for other in range(len(levels)):
                if time[row, other] < best and _differs(levels[other], levels[level], change):
                    best = time[row, other]
                    previous[row, level] = other


@kernel
def _consider_starts(
    reached: Floats,
    levels: Floats,
    numbers: Floats,
    tables: tuple[Floats, Ints, Ints],
    work: Floats,
    at: tuple[int, int],
) -> None:
    """Keep the best start of a block that ends at a stretch and is long enough."""
    time, _, previous = tables
    row, level = at
    begin = int(work[2, level])
    while begin < row and reached[row] - reached[begin] >= numbers[0]:
        before = 0.0
        if begin > 0:
            last = previous[begin, level]
            is_change = _differs(levels[last], levels[level], numbers[1])
            before = time[begin, last] if is_change else np.inf
        value = before - reached[begin] / levels[level]
        if value < work[0, level]:
            work[0, level], work[1, level] = value, float(begin)
        begin += 1
    work[2, level] = float(begin)


@kernel
def _differs(one: float, other: float, change: float) -> bool:
    """True if two neighbouring feeds may follow each other."""
    high, low = max(one, other), min(one, other)
    return high > low and high >= low * (1.0 + change) * (1.0 - 1e-12)
