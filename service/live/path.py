"""Path of the tool in a run, thinned to the points that a picture of it can show.

The path is a curve over time: position, feed and force together. Points are ranked by the
method of Douglas and Peucker [1]_: between two kept points, the point farthest from the
straight line *at the same time* comes next, so that corners and changes of feed or force are
kept, while straight cuts at constant feed need only their ends. All stretches are split in the
same round, so that a long run takes some dozens of passes over arrays. A very long path is
thinned piece by piece and then once more as a whole, so that memory stays bounded. The error of
the thinned path is measured afterwards and returned with it.

References
----------
.. [1] D. H. Douglas, T. K. Peucker, "Algorithms for the reduction of the number of points
   required to represent a digitized line or its caricature", Cartographica 10 (1973) 112–122,
   doi:10.3138/FM57-6770-U75U-7727. Distances here are taken at the same time (as in
   N. Meratnia, R. A. de By, EDBT 2004, doi:10.1007/978-3-540-24741-8_44); they are never
   less than the distances to the line.
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
"""Columns of a run's rows that a path needs."""

RAPID = 1.0
"""Value of ``path_mode`` for rapid moves, see :class:`simulator.machine.samples.PathMode`."""

FINE_LENGTH = 0.0001
"""Share of the path's size that is not visible: a tenth of a pixel, to allow zooming."""

FINE_COLOUR = 0.02
"""Share of the largest feed (force) that is not visible as another colour."""

FEWEST = 20
"""Fewest points of a thinned path, enough for ends and extremes."""

MOST_ROUNDS = 40
"""Largest number of rounds that look for the farthest point; later rounds split in the middle,
so that no shape of path takes long."""

PIECE = 250_000
"""Number of rows that are thinned at once, which takes some hundred MB."""

Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TravelledPath:
    """Path of a tool, N points ascending in time."""

    time: Floats
    """Time of each point, (N,), s."""
    position: Floats
    """Position of the tool, (N, 3), mm."""
    feed: Floats
    """Feed along the path, (N,), mm/min."""
    force: Floats
    """Cutting force, (N,), N."""
    is_rapid: Flags
    """Whether the move that ends at each point is a rapid, (N,)."""
    workingstep: Ints
    """Workingstep of each point, (N,), counted from 1; 0: none."""

    def __len__(self) -> int:
        return len(self.time)

    def at(self, kept: Ints) -> "TravelledPath":
        """Return the path through some of its points."""
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
    """Largest distance of omitted points from the thinned path, at the same time."""

    length: float
    """Error of the position, in mm."""
    feed: float
    """Error of the feed, in mm/min, except in rapid moves."""
    force: float
    """Error of the force, in N."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ThinnedPath:
    """Thinned path of a run, with its deviation from the original."""

    path: TravelledPath
    deviation: Deviation
    rows: int
    """Number of rows of the original path."""


def shown_path(series: Series, points: int) -> ThinnedPath:
    """Thin the path of a run to at most a number of points.

    Raises
    ------
    NotFound
        When the rows lack a needed column.
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
    """Return the path in a range of rows of a run.

    Raises
    ------
    NotFound
        When the rows lack a needed column.
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
    """Indices of the points to keep, ascending, including ends and extremes.

    Omits points that would not be visible, see :data:`FINE_LENGTH` and :data:`FINE_COLOUR`.

    Parameters
    ----------
    path : TravelledPath
        N points.
    points : int
        Most points to keep, at least :data:`FEWEST`.

    Returns
    -------
    (M,) array
        Indices of points, M ≤ points.

    Raises
    ------
    ValueError
        When ``points`` is too small.
    """
    if points < FEWEST:
        raise ValueError(f"{points} points: at least {FEWEST} are needed for ends and extremes")
    if len(path) <= 2:
        return np.arange(len(path))
    rank = _ranks(path.time, _scaled(path), np.union1d(_musts(path), _changes(path)))
    rank[_musts(path)] = np.inf
    worth = np.flatnonzero(rank > 1.0)
    if len(worth) > points:
        # The sort is stable: of points with equal rank, the earlier stays.
        worth = np.sort(worth[np.argsort(-rank[worth], kind="stable")[:points]])
    return worth


def deviation(path: TravelledPath, kept: Ints) -> Deviation:
    """Return the largest distance of a path's points from the kept ones."""
    return _deviation(path, path.at(kept))


def _deviation(path: TravelledPath, shown: TravelledPath) -> Deviation:
    """Return the largest distance of a path's points from a thinned path."""
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
    """Position, feed and force as an array, (N, 5); missing values become 0."""
    return np.nan_to_num(np.column_stack([path.position, path.feed, path.force]))


def _joined(parts: Sequence[TravelledPath]) -> TravelledPath:
    """Join consecutive paths into one."""
    return TravelledPath(**{
        name: np.concatenate([getattr(part, name) for part in parts])
        for name in TravelledPath.__slots__
    })


def _greatest(deviations: Sequence[Deviation]) -> Deviation:
    """Return the largest of each deviation."""
    return Deviation(
        length=max(each.length for each in deviations),
        feed=max(each.feed for each in deviations),
        force=max(each.force for each in deviations),
    )


def _musts(path: TravelledPath) -> Ints:
    """Indices of both ends, and of minima and maxima of each axis, feed and force."""
    cut_feed = np.where(path.is_rapid, 0.0, np.nan_to_num(path.feed))
    columns = (*np.nan_to_num(path.position).T, cut_feed, np.nan_to_num(path.force))
    extremes = [find(column) for column in columns for find in (np.argmin, np.argmax)]
    return np.unique(np.array([0, len(path) - 1, *extremes], dtype=np.int64))


def _changes(path: TravelledPath) -> Ints:
    """Indices on both sides of each change of rapid mode or workingstep."""
    is_other = np.diff(path.is_rapid.astype(np.int64)) != 0
    before = np.flatnonzero(is_other | (np.diff(path.workingstep) != 0))
    return np.union1d(before, before + 1)


def _scaled(path: TravelledPath) -> Floats:
    """Position, feed and force in units of their smallest visible difference, (N, 5).

    Rapid feeds, which no colour shows, count as the largest cutting feed.
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
    """Ranks of points by their distance from the line in which they are missing first, (N,).

    No point ranks higher than the one that split its stretch, so that the highest ranks form a
    thinned path for any number of points; fixed points rank highest.
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
    """Distances of points from the straight line between two others, at the same time."""
    span = time[end] - time[start]
    share = np.divide(time[at] - time[start], span, out=np.zeros(len(at)), where=span > 0.0)
    line = values[start] + share[:, None] * (values[end] - values[start])
    off = np.abs(values[at] - line)
    length = np.linalg.norm(off[:, :3], axis=1)
    farthest: Floats = np.maximum(length, off[:, 3:].max(axis=1))
    return farthest
