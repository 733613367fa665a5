"""Stations along lines, arcs and helices, with tangent and curvature on both sides of each.

A station lies on every boundary between two segments, where tangent and curvature may jump, and
at every quadrant of an arc: there one axis moves not at all along the path but feels all of its
curvature (a zero-inertia point), so that its limit caps the feed rather than the acceleration.
Next to a quadrant the limit is steep, and the stations lie closer. Tangents and curvatures are
those of the segments themselves, not differences of points. Units mm, s, rad.
"""

from dataclasses import dataclass, field
from math import pi

import numpy as np

from optimiser.errors import Infeasible
from optimiser.feed_profile.profile import NOWHERE, AxisLimit, Floats, Ints, ProfileProblem
from simulator.motion.segments import Segments

GREATEST_TURN = 0.01
"""Greatest angle of an arc between two stations, rad: between them the acceleration of an axis
may exceed what both keep by about its square over 8, 1e-5."""

HALVINGS = 3
"""Number of times that the interval beside a quadrant is halved towards it."""

TURNS_BACK = 1e-6
"""Angle, rad, by which a path that turns back may differ from a straight angle."""

NEGLIGIBLE = 1e-12
"""Share of an axis in the tangent that is rounding error."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PathGrid:
    """N stations of a path; each interval between two of them lies on one segment."""

    segments: Segments
    row: Ints
    """Segment of each interval, (N−1,)."""
    begin: Floats
    """Distance along its segment at which each interval begins, (N−1,), mm."""
    finish: Floats
    """Distance along its segment at which each interval ends, (N−1,), mm."""

    def __len__(self) -> int:
        return len(self.row) + 1

    @property
    def lengths(self) -> Floats:
        """Length of each interval, (N−1,), mm."""
        return self.finish - self.begin

    @property
    def boundaries(self) -> Ints:
        """Index of the station at which each segment but the first begins."""
        return np.flatnonzero(np.diff(self.row)) + 1

    @property
    def turns(self) -> Floats:
        """Angle by which the tangent turns at each station, (N,), rad; 0 within segments."""
        angle = np.zeros(len(self))
        at = self.boundaries
        before = self.segments.direction(self.row[at - 1], self.finish[at - 1])
        after = self.segments.direction(self.row[at], self.begin[at])
        away = np.linalg.norm(after - before, axis=1)
        angle[at] = 2.0 * np.arctan2(away, np.linalg.norm(after + before, axis=1))
        return angle

    def axis_limit(self, acceleration: Floats) -> AxisLimit:
        """Limits of the acceleration, (3,), mm/s², of the axes on this path."""
        look = self.segments
        return AxisLimit(
            acceleration=acceleration,
            start_tangent=_rounded(look.direction(self.row, self.begin)),
            end_tangent=_rounded(look.direction(self.row, self.finish)),
            start_curvature=look.curvature(self.row, self.begin),
            end_curvature=look.curvature(self.row, self.finish),
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PathEnds:
    """Squared feeds at both ends of a path, and where it stops between them."""

    start: float = 0.0
    """b at the first station, mm²/s²."""
    end: float = 0.0
    """Greatest b at the last station, mm²/s²."""
    stops: Ints = field(default_factory=NOWHERE.copy)
    """Indices of stations at which the path stops."""


FROM_REST = PathEnds()
"""A path from rest to rest without a stop."""


def path_grid(
    segments: Segments, *, step: float, greatest_turn: float = GREATEST_TURN
) -> PathGrid:
    """Cut a path into intervals.

    Parameters
    ----------
    segments : Segments
        At least one; each has a length.
    step : float, mm
        Greatest distance between two stations.
    greatest_turn : float, rad
        Greatest angle of an arc between two stations.

    Returns
    -------
    PathGrid

    Raises
    ------
    ValueError
        If a segment has no length, as between two equal points, or a step is not positive.

    Examples
    --------
    >>> from simulator.motion.segments import lines
    >>> grid = path_grid(lines([(0, 0, 0), (3, 0, 0), (3, 4, 0)], speed=1.0), step=1.0)
    >>> len(grid), grid.boundaries.tolist(), grid.turns[3].round(4).item()
    (8, [3], 1.5708)
    """
    for name, value, unit in (("step", step, "mm"), ("greatest turn", greatest_turn, "rad")):
        if not 0.0 < value < np.inf:
            raise ValueError(f"{name} of {value:g} {unit} must be positive and finite")
    if not len(segments):
        raise ValueError("a path needs at least one segment, got 0")
    empty = np.flatnonzero(segments.length <= 0.0)
    if len(empty):
        point = ", ".join(f"{each:g}" for each in segments.start[empty[0]])
        raise ValueError(f"segment {empty[0]} from ({point}) mm has no length")
    row, begin, finish = _spans(segments)
    rate = np.abs(segments.turn / segments.length)[row]
    length = finish - begin
    pieces = np.maximum(
        np.ceil(np.maximum(length / step, length * rate / greatest_turn) * (1.0 - 1e-9)), 1.0
    ).astype(np.int64)
    if len(segments) == len(row) == 1 and pieces[0] == 1:
        pieces[0] = 2  # from rest to rest, a path needs a station between its ends
    span = np.repeat(np.arange(len(row)), pieces)
    index = np.arange(len(span)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    part = (length / pieces)[span]
    first = begin[span] + index * part
    last = np.where(index + 1 == pieces[span], finish[span], first + part)
    rows, first, last = _refined(segments, row[span], first, last)
    return PathGrid(segments=segments, row=rows, begin=first, finish=last)


def problem_on(grid: PathGrid, caps: Floats, *, ends: PathEnds = FROM_REST) -> ProfileProblem:
    """Problem of the fastest feed on a grid.

    Parameters
    ----------
    grid : PathGrid
        N stations.
    caps : (N,) array, mm²/s²
        Least cap on the squared feed at each station.
    ends : PathEnds
        Caps at its stops become 0.

    Returns
    -------
    ProfileProblem

    Raises
    ------
    Infeasible
        If the path turns back where it does not stop.
    """
    caps = caps.copy()
    caps[ends.stops] = 0.0
    back = (grid.turns > pi - TURNS_BACK) & (caps > 0.0)
    if back.any():
        station = int(np.flatnonzero(back)[0])
        at = float(grid.lengths[:station].sum())
        raise Infeasible(
            f"station {station} ({at:.6g} mm): the path turns back, which takes a stop; its "
            f"cap is {caps[station] ** 0.5:.6g} mm/s instead of 0",
            limits=("turn",),
            station=station,
        )
    return ProfileProblem(
        lengths=grid.lengths, caps=caps, start=ends.start, end=ends.end, stops=ends.stops
    )


def _rounded(tangent: Floats) -> Floats:
    """Tangents without rounding errors where an axis does not move."""
    tangent[np.abs(tangent) < NEGLIGIBLE] = 0.0
    return tangent


def _spans(segments: Segments) -> tuple[Ints, Floats, Floats]:
    """Rows, begins and ends of what lies between boundaries and quadrants."""
    length, rows = segments.length, np.arange(len(segments))
    angle = segments.start_angle
    low, high = (
        np.minimum(angle, angle + segments.turn),
        np.maximum(angle, angle + segments.turn),
    )
    first = np.floor(low / (0.5 * pi) + 1e-9).astype(np.int64) + 1
    count = np.maximum(np.ceil(high / (0.5 * pi) - 1e-9).astype(np.int64) - first, 0)
    count[segments.turn == 0.0] = 0
    arc = np.repeat(rows, count)
    quadrant = first[arc] + np.arange(len(arc)) - np.repeat(np.cumsum(count) - count, count)
    share = (quadrant * 0.5 * pi - angle[arc]) / segments.turn[arc]
    row = np.concatenate((rows, arc))
    begin = np.concatenate((np.zeros(len(rows)), share * length[arc]))
    order = np.lexsort((begin, row))
    row, begin = row[order], begin[order]
    finish = length[row]
    goes_on = np.append(row[1:] == row[:-1], False)
    finish[goes_on] = begin[1:][goes_on[:-1]]
    return row, begin, finish


def _refined(
    segments: Segments, row: Ints, begin: Floats, finish: Floats
) -> tuple[Ints, Floats, Floats]:
    """Halve the intervals that begin or end at a quadrant, towards it."""
    arcs = np.flatnonzero(segments.turn[row])
    if not len(arcs):
        return row, begin, finish
    extra_rows, extra = [], []
    for ends, others in ((begin, finish), (finish, begin)):
        tangent = np.abs(segments.direction(row[arcs], ends[arcs]))
        curved = np.abs(segments.curvature(row[arcs], ends[arcs])) > NEGLIGIBLE
        at = arcs[((tangent < 1e-9) & curved).any(axis=1)]
        for halving in range(1, HALVINGS + 1):
            extra_rows.append(row[at])
            extra.append(ends[at] + (others[at] - ends[at]) * 0.5**halving)
    rows = np.concatenate((row, *extra_rows))
    begins = np.concatenate((begin, *extra))
    order = np.lexsort((begins, rows))
    rows, begins = rows[order], begins[order]
    finishes = segments.length[rows]
    goes_on = np.append(rows[1:] == rows[:-1], False)
    finishes[goes_on] = begins[1:][goes_on[:-1]]
    keep = finishes > begins
    return rows[keep], begins[keep], finishes[keep]
