"""The way of a tool through a run, thinned to what a picture of it can show.

The path is a curve over time: position, feed and force together. Points are ranked as Douglas
and Peucker [1]_ do it: between two points that stay, the one that lies farthest from the
straight line *at the same moment* comes next, so that corners and changes of feed or force stay
and straight cuts at an even feed need their ends only. All stretches are cut in the same round,
so that a long run takes some dozens of passes over arrays. A very long one is thinned piece by
piece, and then once more as a whole, so that memory stays bounded. How far the thinned path is
off is not promised but measured, and told with it.

References
----------
.. [1] D. H. Douglas, T. K. Peucker, "Algorithms for the reduction of the number of points
   required to represent a digitized line or its caricature", Cartographica 10 (1973) 112–122,
   doi:10.3138/FM57-6770-U75U-7727. Distances here are taken at the same moment (as in
   N. Meratnia, R. A. de By, EDBT 2004, doi:10.1007/978-3-540-24741-8_44), which are never
   less than those to the line.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from service.live.series import Series
from simulator.motion.segments import Floats, Ints

COLUMNS = (
    "time_s", "x_mm", "y_mm", "z_mm", "feed_actual_mm_min", "cutting_force_n", "path_mode",
    "workingstep",
)  # fmt: skip
"""of a run's rows that a path needs"""

RAPID = 1.0
"""of ``path_mode``, see :class:`simulator.machine.samples.PathMode`"""

FINE_LENGTH = 0.0001
"""share of the path's size that is not seen: a tenth of a pixel, so that one may zoom in"""

FINE_COLOUR = 0.02
"""share of the greatest feed (force) that is not seen as another colour"""

FEWEST = 20
"""points that hold ends and extremes"""

MOST_ROUNDS = 40
"""in which the farthest point is looked for; later stretches are cut in their middle, so that
no shape of path takes long"""

PIECE = 250_000
"""rows that are thinned at once: some hundred MB on the way"""

Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TravelledPath:
    """Path of a tool, N points ascending in time."""

    time: Floats
    """Time, (N,) s"""
    position: Floats
    """Position, (N, 3) mm"""
    feed: Floats
    """Feed, (N,) mm/min, along the path"""
    force: Floats
    """Force, (N,) N"""
    is_rapid: Flags
    """(N,) whether the move that ends here is a rapid one"""
    workingstep: Ints
    """Workingstep, (N,) counted from 1; 0: none"""

    def __len__(self) -> int:
        return len(self.time)

    def at(self, kept: Ints) -> "TravelledPath":
        """Some of its points."""
        return TravelledPath(
            time=self.time[kept],
            position=self.position[kept],
            feed=self.feed[kept],
            force=self.force[kept],
            is_rapid=self.is_rapid[kept],
            workingstep=self.workingstep[kept],
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Deviation:
    """Distance of points that were left out from the thinned path, at the same moment."""

    length: float
    """Length, mm"""
    feed: float
    """mm/min, outside of rapid moves"""
    force: float
    """Force, N"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ThinnedPath:
    """A thinned path, and how true it is."""

    path: TravelledPath
    deviation: Deviation
    rows: int
    """that it stands for"""


def shown_path(series: Series, points: int) -> ThinnedPath:
    """The path in the rows of a run, at most so many points of it.

    Raises
    ------
    NotFound
        When the rows have no such columns.
    ValueError
        When ``points`` is too small.
    """
    pieces = [
        (first, min(first + PIECE, len(series))) for first in range(0, len(series), PIECE)
    ]
    if len(pieces) < 2:
        whole = path_of(series)
        path = whole.at(thinned(whole, points))
        return ThinnedPath(path=path, deviation=_deviation(whole, path), rows=len(series))
    parts = (path_of(series, begin=begin, end=end) for begin, end in pieces)
    rough = _joined([part.at(thinned(part, points)) for part in parts])
    path = rough.at(thinned(rough, points))
    off = [_deviation(path_of(series, begin=begin, end=end), path) for begin, end in pieces]
    return ThinnedPath(path=path, deviation=_greatest(off), rows=len(series))


def path_of(series: Series, *, begin: int = 0, end: int | None = None) -> TravelledPath:
    """The path in rows of a run, from one on and up to another.

    Raises
    ------
    NotFound
        When the rows have no such columns.
    """
    rows = np.asarray(series.values[begin:end, series.places(COLUMNS)], dtype=np.float64)
    return TravelledPath(
        time=rows[:, 0],
        position=rows[:, 1:4],
        feed=rows[:, 4],
        force=rows[:, 5],
        is_rapid=rows[:, 6] == RAPID,
        workingstep=np.nan_to_num(rows[:, 7]).astype(np.int64),
    )


def thinned(path: TravelledPath, points: int) -> Ints:
    """Indices of the points to keep: at most so many, ascending; ends and extremes always.

    Fewer are kept when more would not be seen, see :data:`FINE_LENGTH`, :data:`FINE_COLOUR`.

    Parameters
    ----------
    path : TravelledPath
        N points.
    points : int
        At least :data:`FEWEST`.

    Returns
    -------
    (M,) array
        Numbers of points, M ≤ points.

    Raises
    ------
    ValueError
        When ``points`` is too small.
    """
    if points < FEWEST:
        raise ValueError(f"{points} points: at least {FEWEST} hold ends and extremes")
    if len(path) <= 2:
        return np.arange(len(path))
    rank = _ranks(path.time, _scaled(path), np.union1d(_musts(path), _changes(path)))
    rank[_musts(path)] = np.inf
    worth = np.flatnonzero(rank > 1.0)
    if len(worth) > points:
        # Stable: of equals the earlier stays.
        worth = np.sort(worth[np.argsort(-rank[worth], kind="stable")[:points]])
    return worth


def deviation(path: TravelledPath, kept: Ints) -> Deviation:
    """Distances of the points between those that were kept."""
    return _deviation(path, path.at(kept))


def _deviation(path: TravelledPath, shown: TravelledPath) -> Deviation:
    """Distances of the points of a path from one that stands for it."""
    if len(shown) < 2:
        return Deviation(length=0.0, feed=0.0, force=0.0)
    values, kept = _values(path), _values(shown)
    between = np.column_stack([np.interp(path.time, shown.time, column) for column in kept.T])
    off = np.abs(values - between)
    cuts = ~path.is_rapid
    return Deviation(
        length=float(np.linalg.norm(off[:, :3], axis=1).max()),
        feed=float(off[cuts, 3].max(initial=0.0)),
        force=float(off[:, 4].max()),
    )


def _values(path: TravelledPath) -> Floats:
    """(N, 5) position, feed and force; 0 where they are missing."""
    return np.nan_to_num(np.column_stack([path.position, path.feed, path.force]))


def _joined(parts: Sequence[TravelledPath]) -> TravelledPath:
    """One path of those that follow each other."""
    return TravelledPath(**{
        name: np.concatenate([getattr(part, name) for part in parts])
        for name in TravelledPath.__slots__
    })


def _greatest(found: Sequence[Deviation]) -> Deviation:
    """The greatest of each."""
    return Deviation(
        length=max(each.length for each in found),
        feed=max(each.feed for each in found),
        force=max(each.force for each in found),
    )


def _musts(path: TravelledPath) -> Ints:
    """Both ends, and where each axis, feed and force are least and greatest."""
    cut_feed = np.where(path.is_rapid, 0.0, np.nan_to_num(path.feed))
    columns = (*np.nan_to_num(path.position).T, cut_feed, np.nan_to_num(path.force))
    extremes = [find(column) for column in columns for find in (np.argmin, np.argmax)]
    return np.unique(np.array([0, len(path) - 1, *extremes], dtype=np.int64))


def _changes(path: TravelledPath) -> Ints:
    """Both sides of where a rapid move or a workingstep begins or ends."""
    is_other = np.diff(path.is_rapid.astype(np.int64)) != 0
    before = np.flatnonzero(is_other | (np.diff(path.workingstep) != 0))
    return np.union1d(before, before + 1)


def _scaled(path: TravelledPath) -> Floats:
    """(N, 5) position, feed and force in units of what is just not seen.

    Feeds of rapid moves, which are not told by colour, count as the greatest feed of a cut.
    """
    position = np.nan_to_num(path.position)
    feed, force = np.nan_to_num(path.feed), np.nan_to_num(path.force)
    size = float(np.ptp(position, axis=0).max())
    most = float(feed[~path.is_rapid].max(initial=0.0))
    feed = np.minimum(feed, most)
    scales = (size * FINE_LENGTH,) * 3 + (most * FINE_COLOUR, force.max() * FINE_COLOUR)
    columns = (*position.T, feed, force)
    return np.column_stack([
        column / scale if scale > 0.0 else np.zeros(len(path))
        for column, scale in zip(columns, scales, strict=True)
    ])


def _ranks(time: Floats, values: Floats, fixed: Ints) -> Floats:
    """(N,) how far each point is off the line in which it is missing first; fixed ones far.

    No point ranks higher than the one between whose neighbours it came, so that the highest
    ranks are a thinned path for any number of them.
    """
    rank = np.zeros(len(time))
    starts, ends = fixed[:-1], fixed[1:]
    cap = np.full(len(starts), np.inf)
    rounds = 0
    greatest = 2.0
    while True:
        inner = ends - starts - 1
        is_open = inner > 0
        starts, ends, cap, inner = starts[is_open], ends[is_open], cap[is_open], inner[is_open]
        if not len(starts):
            break
        offsets = np.cumsum(inner) - inner
        owner = np.repeat(np.arange(len(starts)), inner)
        at = starts[owner] + 1 + np.arange(len(owner)) - offsets[owner]
        off = _off(time, values, at=at, start=starts[owner], end=ends[owner])
        worst = np.maximum.reduceat(off, offsets)
        hits = np.flatnonzero(off == worst[owner])
        place = at[hits[np.unique(owner[hits], return_index=True)[1]]]
        if rounds >= MOST_ROUNDS:
            place = (starts + ends) // 2
        found = np.minimum(worst, cap)
        greatest = max(greatest, float(found.max()))
        goes_on = worst > 1.0
        starts, ends, place, found = (
            each[goes_on] for each in (starts, ends, place, found)
        )  # fmt: skip
        rank[place] = found
        starts, ends = np.concatenate([starts, place]), np.concatenate([place, ends])
        cap = np.concatenate([found, found])
        rounds += 1
    rank[fixed] = 2.0 * greatest
    return rank


def _off(time: Floats, values: Floats, *, at: Ints, start: Ints, end: Ints) -> Floats:
    """Distances of points from the straight line between two others, at the same moment."""
    span = time[end] - time[start]
    share = np.divide(time[at] - time[start], span, out=np.zeros(len(at)), where=span > 0.0)
    line = values[start] + share[:, None] * (values[end] - values[start])
    off = np.abs(values[at] - line)
    length = np.linalg.norm(off[:, :3], axis=1)
    farthest: Floats = np.maximum(length, off[:, 3:].max(axis=1))
    return farthest
