"""Path of the tool beside a contour that is cut with cutter radius compensation (G41, G42).

The commanded contour is offset by the radius of the tool. At an outside corner the tool rolls
around the point on an arc; at an inside corner it goes to the intersection of both offset
elements. Compensation begins with a straight move: LinuxCNC ends it square to this move, other
controls square to the contour that follows. The first move after G40 leads back to the
commanded path. In LinuxCNC compensation may also begin with an arc, which gets another centre
on the line from its end to the commanded one. A contour that a control would refuse is left as
commanded, such as one with an inside arc or corner that is too small for the tool.

Units mm, rad.

References
----------
.. [1] LinuxCNC, "Tool Compensation" and its interpreter's canonical output, which the tests
   compare.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import copysign, dist, hypot, isnan, pi

import numpy as np

from stepnc_model.nc.moves import (
    ARC_NUMBERS,
    PLANES,
    FeedMode,
    ModalSetting,
    MoveFlag,
    MoveKind,
    NcMoves,
)
from stepnc_model.toolpath.arc import Flat, angle_between, circles_meet, line_meets_circle
from stepnc_model.toolpath.path import Point

CLOSE = 1e-6
"""Length below which an element has none, mm."""

STRAIGHT_ON = 1e-4
"""Turn below which a contour goes straight on, rad: ends are rounded to 0.0001 mm or so."""

RadiusOf = Callable[[ModalSetting], float | None]
"""Function from a setting with compensation to the radius of the tool, mm; None if unknown."""


class _NoPath(Exception):
    """A contour that the tool cannot follow."""


@dataclass(slots=True)
class _Element:
    """Line or arc of a contour and its offset, in the plane of the compensation. Mutable."""

    row: int
    is_rapid: bool
    p: Flat
    """Commanded end."""
    low: float
    """Coordinate along the normal at the start, mm."""
    high: float
    """The same at the end."""
    leaves: Flat
    """Direction at the commanded start."""
    arrives: Flat
    """Direction at the commanded end."""
    start: Flat
    """Start of the offset element."""
    end: Flat
    """End of the offset element."""
    centre: Flat | None = None
    turn: float = 0.0
    radius: float = 0.0
    """Radius of an offset arc."""

    @property
    def is_moving(self) -> bool:
        """True if it moves in the plane."""
        return self.arrives != (0.0, 0.0)


STILL = {MoveKind.DWELL, MoveKind.SWITCH}
"""Kinds of rows that stay where the tool is."""


def _still(row: int, at: Flat, low: float, high: float, *, is_rapid: bool) -> _Element:
    """Element that does not move in the plane."""
    nowhere = (0.0, 0.0)
    return _Element(row, is_rapid, at, low, high, nowhere, nowhere, at, at)


def tool_moves(moves: NcMoves, radius_of: RadiusOf, *, is_square: bool) -> NcMoves:
    """Executed moves with compensated contours as the tool follows them.

    Moves on such a path have the flag ``BESIDE`` instead of ``COMPENSATED``. Each arc around a
    corner belongs to the block that follows it.

    Parameters
    ----------
    moves : NcMoves
    radius_of : callable
        Radius of the tool for a setting with compensation.
    is_square : bool
        Whether compensation begins square to its first move, as LinuxCNC does.
    """
    is_on = (moves.flags & int(MoveFlag.COMPENSATED)) != 0
    if not is_on.any():
        return moves
    rows: list[np.ndarray] = []
    arcs: list[Sequence[float]] = []
    kept = 0
    for first, last in _runs(moves, is_on):
        try:
            run = _Run(moves, first, last, radius_of, is_square=is_square)
            found = list(run.rows(len(moves.arcs) + len(arcs)))
        except _NoPath:
            continue
        rows.append(moves.rows[kept:first])
        rows.append(np.array([row for row, _ in found], dtype=moves.rows.dtype))
        arcs += [numbers for _, numbers in found if numbers is not None]
        kept = run.beyond
    if not rows:
        return moves
    more = np.array(arcs, dtype=np.float64).reshape(-1, ARC_NUMBERS)
    return replace(
        moves,
        rows=np.concatenate((*rows, moves.rows[kept:])),
        arcs=np.concatenate((moves.arcs, more)),
    )


def _runs(moves: NcMoves, is_on: np.ndarray) -> Iterator[tuple[int, int]]:
    """First row of each compensated contour, and the row after its last element."""
    sides = np.array([0 if each.side is None else 1 for each in moves.settings])
    has_side = is_on & (sides[moves.rows["setting"]] != 0)
    edges = np.flatnonzero(np.diff(has_side.astype(np.int8), prepend=0, append=0))
    yield from zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)


class _Run:
    """One compensated contour, from G41 or G42 to the move that leaves it."""

    def __init__(
        self,
        moves: NcMoves,
        first: int,
        last: int,
        radius_of: RadiusOf,
        *,
        is_square: bool,
    ) -> None:
        self._moves, self._first, self._last = moves, first, last
        self._is_square = is_square
        self.beyond = last
        """Row after the last one that changes."""
        settings = {moves.settings[int(each)] for each in moves.rows["setting"][first:last]}
        sides = {each.side for each in settings}
        radii = {radius_of(each) for each in settings}
        if len(sides) != 1 or len(radii) != 1:
            raise _NoPath
        side, radius = sides.pop(), radii.pop()
        if side is None or radius is None or isnan(radius):
            raise _NoPath
        if any(each.mode is FeedMode.INVERSE_TIME for each in settings):
            raise _NoPath
        self._shift = radius * side.sign
        self._plane = side.plane
        self._u, self._v, self._w = side.plane.axes

    def rows(self, arc: int) -> Iterator[tuple[tuple[object, ...], Sequence[float] | None]]:
        """Yield the rows of the tool's path, each with the numbers of its arc."""
        elements = list(self._elements())
        moving = [each for each in elements if each.is_moving]
        self._begin(moving)
        corners = self._joined(moving)
        at = self._flat(self._moves.rows["start"][self._first])
        for each in elements:
            corner = corners.get(each.row)
            if corner is not None and not each.is_rapid:
                middle, turn = corner
                numbers = self._arc(middle, turn)
                yield self._row(each, at, each.start, arc, is_corner=True), numbers
                arc += 1
                at = each.start
            end = each.end if each.is_moving else at
            if each.centre is None:
                yield self._row(each, at, end, -1), None
            else:
                yield self._row(each, at, end, arc), self._arc(each.centre, each.turn)
                arc += 1
            at = end
        yield from ((row, None) for row in self._left(at))

    def _left(self, at: Flat) -> Iterator[tuple[object, ...]]:
        """Rows after the contour, up to the one that leads back to the commanded path."""
        moves = self._moves
        while self.beyond < len(moves):
            row = self.beyond
            start, end = (self._flat(moves.rows[name][row]) for name in ("start", "end"))
            kind = MoveKind(int(moves.kind[row]))
            if kind not in {MoveKind.RAPID, MoveKind.LINE, *STILL}:
                break
            self.beyond += 1
            low, high = (float(moves.rows[name][row][self._w]) for name in ("start", "end"))
            # LinuxCNC goes back with any move, others with one in the plane; a move without
            # any length has the axes of the plane in its block.
            is_back = kind not in STILL and (
                self._is_square or dist(start, end) > CLOSE or abs(high - low) <= CLOSE
            )
            there = end if is_back or isnan(sum(end)) else at
            yield self._row(_still(row, there, low, high, is_rapid=False), at, there, -1)
            if there is end:
                break

    def _elements(self) -> Iterator[_Element]:
        """Elements of the contour with their offsets."""
        moves = self._moves
        for row in range(self._first, self._last):
            kind = MoveKind(int(moves.kind[row]))
            if kind in {MoveKind.UNKNOWN, MoveKind.THREAD} or not self._is_here(row):
                raise _NoPath
            start, end = moves.rows["start"][row], moves.rows["end"][row]
            low, high = float(start[self._w]), float(end[self._w])
            p0, p1 = self._flat(start), self._flat(end)
            is_rapid = kind is MoveKind.RAPID
            if kind is MoveKind.ARC:
                yield self._offset_arc(row, p0, p1, (low, high))
                continue
            length = dist(p0, p1)
            if kind in STILL or length <= CLOSE:
                yield _still(row, p1, low, high, is_rapid=is_rapid)
                continue
            way = (p1[0] - p0[0]) / length, (p1[1] - p0[1]) / length
            ends = self._aside(p0, way), self._aside(p1, way)
            yield _Element(row, is_rapid, p1, low, high, way, way, *ends)

    def _is_here(self, row: int) -> bool:
        """True if a row has known ends, in the plane of the compensation."""
        rows, arcs = self._moves.rows, self._moves.arcs
        if isnan(float(rows["start"][row].sum() + rows["end"][row].sum())):
            return False
        arc = int(rows["arc"][row])
        return arc < 0 or PLANES[int(arcs[arc][4])] is self._plane

    def _offset_arc(self, row: int, p0: Flat, p1: Flat, heights: Flat) -> _Element:
        numbers = self._moves.arcs[int(self._moves.rows["arc"][row])]
        centre, turn = self._flat(numbers), float(numbers[3])
        radius = dist(p0, centre) - copysign(1.0, turn) * self._shift
        if isnan(turn) or radius <= CLOSE:
            raise _NoPath
        sense = copysign(1.0, turn)
        leaves, arrives = _tangent(centre, p0, sense), _tangent(centre, p1, sense)
        return _Element(
            row=row,
            is_rapid=False,
            p=p1,
            low=heights[0],
            high=heights[1],
            leaves=leaves,
            arrives=arrives,
            start=self._aside(p0, leaves),
            end=self._aside(p1, arrives),
            centre=centre,
            turn=turn,
            radius=radius,
        )

    def _begin(self, moving: list[_Element]) -> None:
        """Bring the first element to the place where compensation begins.

        A contour that does not begin with a line longer than the radius, or an arc, is refused.
        """
        if not moving:
            raise _NoPath
        first = self._flat(self._moves.rows["start"][self._first])
        entry = moving[0]
        length = dist(entry.p, first)
        if self._is_square:
            if entry.centre is not None:
                _begin_arc(entry, first)
            elif length <= abs(self._shift):
                raise _NoPath
        elif entry.centre is not None:
            raise _NoPath
        elif len(moving) > 1:
            entry.end = self._aside(entry.p, moving[1].leaves)

    def _joined(self, moving: list[_Element]) -> dict[int, tuple[Flat, float]]:
        """Join the offset elements; arcs around outside corners by the row that follows."""
        corners: dict[int, tuple[Flat, float]] = {}
        for index, (one, other) in enumerate(pairwise(moving)):
            if index == 0 and not self._is_square:
                continue
            turn = angle_between((0.0, 0.0), one.arrives, other.leaves)
            if abs(turn) <= STRAIGHT_ON:
                other.start = one.end
            elif turn * self._shift < 0.0:
                corners[other.row] = one.p, turn
            else:
                _cut_short(one, other)
        for index, each in enumerate(moving):
            if index and not _goes_forward(each):
                raise _NoPath
        return corners

    def _aside(self, point: Flat, way: Flat) -> Flat:
        """Point beside a point of the contour, where the tool goes."""
        return point[0] - self._shift * way[1], point[1] + self._shift * way[0]

    def _flat(self, point: Sequence[float]) -> Flat:
        return float(point[self._u]), float(point[self._v])

    def _space(self, point: Flat, height: float) -> Point:
        found = [0.0, 0.0, 0.0]
        found[self._u], found[self._v], found[self._w] = point[0], point[1], height
        return found[0], found[1], found[2]

    def _arc(self, centre: Flat, turn: float) -> Sequence[float]:
        return (*self._space(centre, 0.0), turn, float(PLANES.index(self._plane)))

    def _row(
        self, each: _Element, start: Flat, end: Flat, arc: int, *, is_corner: bool = False
    ) -> tuple[object, ...]:
        """Row of the table for an element, or for the arc before it."""
        names = self._moves.rows.dtype.names or ()
        row = dict(zip(names, self._moves.rows[each.row].item(), strict=True))
        row["start"] = self._space(start, each.low)
        row["end"] = self._space(end, each.low if is_corner else each.high)
        row["flags"] = row["flags"] & ~int(MoveFlag.COMPENSATED) | int(MoveFlag.BESIDE)
        if is_corner:
            row["kind"] = int(MoveKind.ARC)
        row["arc"] = arc
        return tuple(row[name] for name in names)


def _begin_arc(entry: _Element, first: Flat) -> None:
    """Give an arc with which compensation begins the centre that leads to its offset end."""
    (x, y), centre = entry.end, entry.centre
    if centre is None:
        raise _NoPath
    way = dist(centre, entry.end)
    u, v = (centre[0] - x) / way, (centre[1] - y) / way
    dx, dy = x - first[0], y - first[1]
    along = 2.0 * (dx * u + dy * v)
    if abs(along) <= CLOSE:
        raise _NoPath
    far = -(dx * dx + dy * dy) / along
    if far <= CLOSE:
        raise _NoPath
    sense = copysign(1.0, entry.turn)
    entry.centre, entry.radius = (x + far * u, y + far * v), far
    entry.turn = sense * ((sense * angle_between(entry.centre, first, (x, y))) % (2.0 * pi))
    entry.start, entry.leaves = first, _tangent(entry.centre, first, sense)


def _tangent(centre: Flat, point: Flat, sense: float) -> Flat:
    """Direction of an arc at one of its points."""
    x, y = point[0] - centre[0], point[1] - centre[1]
    size = hypot(x, y)
    if size <= CLOSE:
        raise _NoPath
    return -sense * y / size, sense * x / size


def _cut_short(one: _Element, other: _Element) -> None:
    """End an element and begin the next where their offsets meet, nearest to the corner."""
    places = list(_meetings(one, other))
    if not places:
        raise _NoPath
    place = min(places, key=lambda each: dist(each, one.p))
    for each, name in ((one, "end"), (other, "start")):
        if each.centre is not None:
            turned = angle_between(each.centre, getattr(each, name), place)
            each.turn += turned if name == "end" else -turned
        setattr(each, name, place)


def _goes_forward(each: _Element) -> bool:
    """True if an offset element still leads the way of the commanded one."""
    if each.centre is not None:
        x, y = each.start[0] - each.centre[0], each.start[1] - each.centre[1]
        # A turn beyond its other end has changed its sense.
        way = _tangent(each.centre, each.start, copysign(1.0, each.turn))
        return hypot(x, y) > CLOSE and way[0] * each.leaves[0] + way[1] * each.leaves[1] > 0.0
    x, y = each.end[0] - each.start[0], each.end[1] - each.start[1]
    return x * each.arrives[0] + y * each.arrives[1] >= -CLOSE


def _meetings(one: _Element, other: _Element) -> Iterator[Flat]:
    """Points where two offset lines or circles meet."""
    if one.centre is None and other.centre is None:
        (a, b), (c, d) = one.arrives, other.leaves
        cross = a * d - b * c
        x, y = other.start[0] - one.end[0], other.start[1] - one.end[1]
        along = (x * d - y * c) / cross
        yield one.end[0] + along * a, one.end[1] + along * b
    elif one.centre is not None and other.centre is not None:
        if dist(one.centre, other.centre) <= CLOSE:
            return
        yield from circles_meet(one.centre, one.radius, other.centre, other.radius)
    else:
        line, arc = (one, other) if one.centre is None else (other, one)
        if arc.centre is not None:
            yield from line_meets_circle(line.end, line.arrives, arc.centre, arc.radius)
