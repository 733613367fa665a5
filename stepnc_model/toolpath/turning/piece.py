"""Pieces of a curve in a half plane: lines and arcs that are functions of one coordinate.

A half plane has the coordinates u, along the passes, and v, out of the material. A piece runs
over an interval of u, to and fro; a line may also stand upright. Arcs lie on the upper or the
lower side of their circle, so that each has one v for each u.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import atan2, cos, dist, hypot, pi, sin, sqrt

Spot = tuple[float, float]
"""u, v in mm"""

UPRIGHT = 1e-9
"""mm of u below which a line stands upright"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Piece:
    """A line, or an arc when it has a centre."""

    start: Spot
    end: Spot
    centre: Spot | None = None
    side: int = 0
    """+1 on the upper side of its circle, −1 on the lower one"""
    radius: float = 0.0
    """mm, of the circle"""

    @property
    def low(self) -> float:
        """Least u."""
        return min(self.start[0], self.end[0])

    @property
    def high(self) -> float:
        """Greatest u."""
        return max(self.start[0], self.end[0])

    @property
    def is_upright(self) -> bool:
        """Whether it is a line along v."""
        return self.centre is None and self.high - self.low < UPRIGHT

    @property
    def turn(self) -> float:
        """Angle of the arc from start to end, rad, counter-clockwise positive; 0 of a line."""
        if self.centre is None:
            return 0.0
        first, second = (
            atan2(spot[1] - self.centre[1], spot[0] - self.centre[0])
            for spot in (self.start, self.end)
        )
        # Forwards in u the upper side is clockwise, and no piece turns by more than π.
        is_clockwise = (self.end[0] > self.start[0]) == (self.side > 0)
        size = (first - second if is_clockwise else second - first) % (2.0 * pi)
        size = size if size < pi + 1e-3 else 0.0
        return -size if is_clockwise else size

    def at(self, u: float) -> float:
        """Its v over one u within the interval."""
        if self.centre is not None:
            inside = self.radius**2 - (u - self.centre[0]) ** 2
            return self.centre[1] + self.side * sqrt(max(0.0, inside))
        (a, b), (c, d) = self.start, self.end
        return max(b, d) if self.is_upright else b + (d - b) * (u - a) / (c - a)

    def reversed(self) -> "Piece":
        """The same way back."""
        return self._between(self.end, self.start)

    def part(self, first: float, second: float) -> "Piece":
        """What lies between two values of u, in this order."""
        return self._between(self._spot(first), self._spot(second))

    def point(self, part: float) -> Spot:
        """Where it is after a part, 0 to 1, of its length."""
        (a, b), (c, d) = self.start, self.end
        if self.centre is None:
            return a + part * (c - a), b + part * (d - b)
        angle = atan2(b - self.centre[1], a - self.centre[0]) + part * self.turn
        return self.centre[0] + self.radius * cos(angle), self.centre[1] + self.radius * sin(
            angle
        )

    def tangent(self, spot: Spot) -> Spot:
        """Unit vector of its direction at one of its spots."""
        if self.centre is None:
            length = dist(self.start, self.end) or 1.0
            a, b = self.end[0] - self.start[0], self.end[1] - self.start[1]
            return a / length, b / length
        sign = 1.0 if self.turn > 0.0 else -1.0
        return (
            -sign * (spot[1] - self.centre[1]) / self.radius,
            sign * (spot[0] - self.centre[0]) / self.radius,
        )

    def distance(self, spot: Spot) -> float:
        """Least distance to a spot, mm."""
        ends = min(dist(spot, self.start), dist(spot, self.end))
        if self.centre is not None:
            u, v = spot[0] - self.centre[0], spot[1] - self.centre[1]
            size = hypot(u, v)
            foot = self.centre[0] + u * self.radius / size if size else self.low - 1.0
            is_over = self.low <= foot <= self.high and v * self.side >= 0.0
            return min(ends, abs(size - self.radius)) if is_over else ends
        a, b = self.end[0] - self.start[0], self.end[1] - self.start[1]
        square = a * a + b * b
        u, v = spot[0] - self.start[0], spot[1] - self.start[1]
        if not square or not 0.0 <= a * u + b * v <= square:
            return ends
        return min(ends, abs(a * v - b * u) / sqrt(square))

    def _spot(self, u: float) -> Spot:
        """Its own end where that is meant, so that joints stay closed."""
        for spot in (self.start, self.end):
            if u == spot[0] and not self.is_upright:
                return spot
        return u, self.at(u)

    def _between(self, start: Spot, end: Spot) -> "Piece":
        return Piece(
            start=start, end=end, centre=self.centre, side=self.side, radius=self.radius
        )


def arc_pieces(start: Spot, end: Spot, *, centre: Spot, turn: float) -> Iterator[Piece]:
    """An arc of any turn as pieces, cut where its circle stands upright."""
    radius = 0.5 * (dist(start, centre) + dist(end, centre))
    first = atan2(start[1] - centre[1], start[0] - centre[0])
    step = pi if turn > 0.0 else -pi
    # Angles where the circle stands upright, strictly between the ends.
    whole = int(first // pi) + (1 if turn > 0.0 else 0)
    cuts = [pi * (whole + (i if turn > 0.0 else -i)) for i in range(4)]
    cuts = [at for at in cuts if 1e-9 < (at - first) / step * pi < abs(turn) - 1e-9]
    angles = [first, *cuts, first + turn]
    spots = [start, *((centre[0] + radius * cos(at), centre[1]) for at in cuts), end]
    for i in range(len(spots) - 1):
        side = 1 if sin(0.5 * (angles[i] + angles[i + 1])) > 0.0 else -1
        yield Piece(start=spots[i], end=spots[i + 1], centre=centre, side=side, radius=radius)


def half_circle(centre: Spot, radius: float, side: int) -> Piece:
    """The upper or the lower half of a circle."""
    return Piece(
        start=(centre[0] - radius, centre[1]),
        end=(centre[0] + radius, centre[1]),
        centre=centre,
        side=side,
        radius=radius,
    )


def crossings(one: Piece, other: Piece) -> Iterator[float]:
    """Values of u where two pieces may cross: all of them, and perhaps some more."""
    low, high = max(one.low, other.low), min(one.high, other.high)
    if low >= high:
        return
    for u in _meetings(one, other):
        if low < u < high:
            yield u


def _meetings(one: Piece, other: Piece) -> tuple[float, ...]:
    """Where the lines or circles that carry the pieces meet."""
    if one.centre is None and other.centre is None:
        return _line_line(one, other)
    if one.centre is None:
        return _line_circle(one, other)
    if other.centre is None:
        return _line_circle(other, one)
    return _circle_circle(one, other)


def _line_line(one: Piece, other: Piece) -> tuple[float, ...]:
    if one.is_upright or other.is_upright:
        return ()
    origin = one.start[0]
    slopes = [(p.end[1] - p.start[1]) / (p.end[0] - p.start[0]) for p in (one, other)]
    apart = slopes[0] - slopes[1]
    if not apart:
        return ()
    return (origin + (other.at(origin) - one.start[1]) / apart,)


def _line_circle(line: Piece, arc: Piece) -> tuple[float, ...]:
    if line.is_upright or arc.centre is None:
        return ()
    (a, b), (c, d) = line.start, line.end
    length = hypot(c - a, d - b)
    p, q = (c - a) / length, (d - b) / length
    u, v = a - arc.centre[0], b - arc.centre[1]
    along = -(u * p + v * q)
    inside = arc.radius**2 - (p * v - q * u) ** 2
    if inside < 0.0:
        return ()
    return a + (along - sqrt(inside)) * p, a + (along + sqrt(inside)) * p


def _circle_circle(one: Piece, other: Piece) -> tuple[float, ...]:
    if one.centre is None or other.centre is None:
        return ()
    u, v = other.centre[0] - one.centre[0], other.centre[1] - one.centre[1]
    apart = hypot(u, v)
    if apart < UPRIGHT:
        return ()
    along = (apart**2 + one.radius**2 - other.radius**2) / (2.0 * apart)
    inside = one.radius**2 - along**2
    if inside < 0.0:
        return ()
    beside = sqrt(inside)
    foot = one.centre[0] + along * u / apart
    return foot - beside * v / apart, foot + beside * v / apart
