"""Profiles in a half plane: v as a function of u, in lines and exact arcs, with steps.

A half plane has the coordinates u, along the passes, and v, out of the material. A piece covers
an interval of u in either direction; a line may also be upright. Arcs lie on the upper or the
lower side of their circle, so that each has one v for each u.

The upper envelope of pieces bounds material; the lower envelope is the material that remains.
Everything else follows: growing by a radius, cutting with a nose that runs along a path, and
the part of a profile that an edge can reach.

Turning sees the spindle axis as u and the radius as v; facing sees them the other way round.
Passes run towards −u and material lies below.

Paths are computed for the nose centre. The programmed point is the imaginary tool tip, the
corner of the square around the nose, as assumed by ``feedrate_reference`` TCP and the setting
lengths ``functional_length`` and ``f_dimension``: for a right-hand outside tool, centre minus
one nose radius in x and in z (tip position 3 of Fanuc and LinuxCNC), for a left-hand tool the
centre minus one radius in x and plus one in z (position 4), for a neutral tool the centre minus
one radius in x (position 8). Only :class:`HalfPlane` does this conversion.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import atan2, cos, dist, hypot, inf, pi, sin, sqrt

from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.toolpath.arc import circles_meet, line_meets_circle
from stepnc_model.toolpath.path import Arc, ArcPlane, Point

Spot = tuple[float, float]
"""Coordinates u, v of a point in a half plane, mm."""

UPRIGHT = 1e-9
"""Length in u below which a line counts as upright, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfilePiece:
    """Line, or an arc if it has a centre, in a half plane."""

    start: Spot
    end: Spot
    centre: Spot | None = None
    side: int = 0
    """Side of the arc's circle: +1 upper, −1 lower."""
    radius: float = 0.0
    """Radius of the arc's circle, mm."""

    @property
    def low(self) -> float:
        """Least coordinate u along the passes, mm."""
        return min(self.start[0], self.end[0])

    @property
    def high(self) -> float:
        """Greatest coordinate u along the passes, mm."""
        return max(self.start[0], self.end[0])

    @property
    def is_upright(self) -> bool:
        """True if the piece is a line perpendicular to the passes (along v)."""
        return self.centre is None and self.high - self.low < UPRIGHT

    @property
    def turn(self) -> float:
        """Angle of the arc from start to end, rad, counter-clockwise positive; 0 for a line."""
        if self.centre is None:
            return 0.0
        first, second = (
            atan2(spot[1] - self.centre[1], spot[0] - self.centre[0])
            for spot in (self.start, self.end)
        )
        # For rising u the upper side is clockwise, and no piece turns by more than π.
        is_clockwise = (self.end[0] > self.start[0]) == (self.side > 0)
        size = (first - second if is_clockwise else second - first) % (2.0 * pi)
        size = size if size < pi + 1e-3 else 0.0
        return -size if is_clockwise else size

    def at(self, u: float) -> float:
        """Height v of the piece at a position u within its interval, mm."""
        if self.centre is not None:
            inside = self.radius**2 - (u - self.centre[0]) ** 2
            return self.centre[1] + self.side * sqrt(max(0.0, inside))
        (a, b), (c, d) = self.start, self.end
        return max(b, d) if self.is_upright else b + (d - b) * (u - a) / (c - a)

    def reversed(self) -> "ProfilePiece":
        """Piece traversed in the opposite direction."""
        return self._between(self.end, self.start)

    def part(self, first: float, second: float) -> "ProfilePiece":
        """Part of the piece between two values of u, in this order."""
        return self._between(self._spot(first), self._spot(second))

    def point(self, part: float) -> Spot:
        """Point at a fraction, 0 to 1, of the piece's length."""
        (a, b), (c, d) = self.start, self.end
        if self.centre is None:
            return a + part * (c - a), b + part * (d - b)
        angle = atan2(b - self.centre[1], a - self.centre[0]) + part * self.turn
        return self.centre[0] + self.radius * cos(angle), self.centre[1] + self.radius * sin(
            angle
        )

    def tangent(self, spot: Spot) -> Spot:
        """Unit tangent vector at a spot on the piece."""
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
        """Least distance from the piece to a spot, mm."""
        ends = min(dist(spot, self.start), dist(spot, self.end))
        if self.centre is not None:
            u, v = spot[0] - self.centre[0], spot[1] - self.centre[1]
            size = hypot(u, v)
            foot = self.centre[0] + u * self.radius / size if size else self.low - 1.0
            is_above = self.low <= foot <= self.high and v * self.side >= 0.0
            return min(ends, abs(size - self.radius)) if is_above else ends
        a, b = self.end[0] - self.start[0], self.end[1] - self.start[1]
        square = a * a + b * b
        u, v = spot[0] - self.start[0], spot[1] - self.start[1]
        if not square or not 0.0 <= a * u + b * v <= square:
            return ends
        return min(ends, abs(a * v - b * u) / sqrt(square))

    def _spot(self, u: float) -> Spot:
        """Point at u, exactly the piece's end where u is an end, so that joints stay closed."""
        for spot in (self.start, self.end):
            if u == spot[0] and not self.is_upright:
                return spot
        return u, self.at(u)

    def _between(self, start: Spot, end: Spot) -> "ProfilePiece":
        return ProfilePiece(
            start=start, end=end, centre=self.centre, side=self.side, radius=self.radius
        )


def arc_pieces(start: Spot, end: Spot, *, centre: Spot, turn: float) -> Iterator[ProfilePiece]:
    """Split an arc of any angle into pieces at the points where its circle is upright."""
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
        yield ProfilePiece(
            start=spots[i], end=spots[i + 1], centre=centre, side=side, radius=radius
        )


def half_circle(centre: Spot, radius: float, side: int) -> ProfilePiece:
    """Upper or lower half of a circle as a piece."""
    return ProfilePiece(
        start=(centre[0] - radius, centre[1]),
        end=(centre[0] + radius, centre[1]),
        centre=centre,
        side=side,
        radius=radius,
    )


def crossings(one: ProfilePiece, other: ProfilePiece) -> Iterator[float]:
    """Values of u where two pieces may cross: all crossings and perhaps some others."""
    low, high = max(one.low, other.low), min(one.high, other.high)
    if low >= high:
        return
    for u in _meetings(one, other):
        if low < u < high:
            yield u


def _meetings(one: ProfilePiece, other: ProfilePiece) -> tuple[float, ...]:
    """Intersections of the lines or circles that carry the pieces."""
    if one.centre is None and other.centre is None:
        return _line_line(one, other)
    if one.centre is None:
        return _line_circle(one, other)
    if other.centre is None:
        return _line_circle(other, one)
    return _circle_circle(one, other)


def _line_line(one: ProfilePiece, other: ProfilePiece) -> tuple[float, ...]:
    if one.is_upright or other.is_upright:
        return ()
    origin = one.start[0]
    slopes = [(p.end[1] - p.start[1]) / (p.end[0] - p.start[0]) for p in (one, other)]
    apart = slopes[0] - slopes[1]
    if not apart:
        return ()
    return (origin + (other.at(origin) - one.start[1]) / apart,)


def _line_circle(line: ProfilePiece, arc: ProfilePiece) -> tuple[float, ...]:
    if line.is_upright or arc.centre is None:
        return ()
    (a, b), (c, d) = line.start, line.end
    size = dist(line.start, line.end)
    way = (c - a) / size, (d - b) / size
    return tuple(u for u, _ in line_meets_circle(line.start, way, arc.centre, arc.radius))


def _circle_circle(one: ProfilePiece, other: ProfilePiece) -> tuple[float, ...]:
    if one.centre is None or other.centre is None:
        return ()
    return tuple(u for u, _ in circles_meet(one.centre, one.radius, other.centre, other.radius))


NARROW = 1e-9
"""Width in u below which an interval counts as empty, mm."""

JOINT = 1e-6
"""Difference in v between two pieces that does not count as a step, mm."""

TIE = 1e-12
"""Advantage in v, mm, from which another piece replaces the current envelope piece."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RadiusProfile:
    """Pieces ordered by u, none upright; a step of v between two pieces is a wall."""

    pieces: tuple[ProfilePiece, ...] = ()

    @property
    def low(self) -> float:
        """Least coordinate u along the passes, mm."""
        return self.pieces[0].low if self.pieces else inf

    @property
    def high(self) -> float:
        """Greatest coordinate u along the passes, mm."""
        return self.pieces[-1].high if self.pieces else -inf

    def at(self, u: float) -> float:
        """Height v of the profile at a position u, the higher one at a wall; −inf outside."""
        return max((p.at(u) for p in self.pieces if p.low <= u <= p.high), default=-inf)

    def within(self, low: float, high: float) -> "RadiusProfile":
        """Part of the profile over an interval of u."""
        return RadiusProfile(
            pieces=tuple(
                piece.part(max(low, piece.low), min(high, piece.high))
                for piece in self.pieces
                if min(high, piece.high) - max(low, piece.low) > NARROW
            )
        )

    def top(self, low: float, high: float) -> float:
        """Greatest v over a closed interval of u; −inf outside the profile."""
        found = -inf
        for piece in self.pieces:
            first, second = max(low, piece.low), min(high, piece.high)
            if first <= second:
                found = max(found, piece.at(first), piece.at(second))
                if piece.centre and piece.side > 0 and first < piece.centre[0] < second:
                    found = max(found, piece.centre[1] + piece.radius)
        return found

    def bottom(self, low: float, high: float) -> float:
        """Least v over an interval of u; +inf outside the profile."""
        return -mirrored(self.within(low, high).pieces).top(low, high)

    def chain(self) -> tuple[ProfilePiece, ...]:
        """Joined pieces including the walls between them, in the order of u."""
        joined: list[ProfilePiece] = []
        for each in self.pieces:
            piece = each
            if joined:
                last, start = joined[-1].end, piece.start
                if start[0] - last[0] > JOINT:
                    joined.append(ProfilePiece(start=last, end=start))
                elif abs(start[1] - last[1]) > JOINT:
                    wall_end = (last[0], start[1])
                    joined.append(ProfilePiece(start=last, end=wall_end))
                    last = wall_end
                if start[0] - last[0] <= JOINT:
                    piece = _from(piece, last)
            joined.append(piece)
        return tuple(joined)

    def below(self, level: float) -> list[tuple[float, float]]:
        """Intervals of u where the profile is at or below a level."""
        return _intervals(self, level, is_above=False)

    def above(self, level: float) -> list[tuple[float, float]]:
        """Intervals of u where the profile is above a level."""
        return _intervals(self, level, is_above=True)


def highest(pieces: Iterable[ProfilePiece]) -> RadiusProfile:
    """Upper envelope of lines and arcs, as a profile."""
    return _envelope(pieces, 1.0)


def lowest(pieces: Iterable[ProfilePiece]) -> RadiusProfile:
    """Lower envelope of lines and arcs, as a profile."""
    return _envelope(pieces, -1.0)


def mirrored(pieces: Iterable[ProfilePiece]) -> RadiusProfile:
    """Profile mirrored in v, with its pieces upside down."""
    return RadiusProfile(pieces=tuple(map(_upside_down, pieces)))


def level_line(level: float, low: float, high: float) -> ProfilePiece:
    """Horizontal line at a level, from low to high u."""
    return ProfilePiece(start=(low, level), end=(high, level))


def _upside_down(piece: ProfilePiece) -> ProfilePiece:
    return ProfilePiece(
        start=(piece.start[0], -piece.start[1]),
        end=(piece.end[0], -piece.end[1]),
        centre=(piece.centre[0], -piece.centre[1]) if piece.centre else None,
        side=-piece.side,
        radius=piece.radius,
    )


def _from(piece: ProfilePiece, start: Spot) -> ProfilePiece:
    """Copy of a piece that starts exactly at a given point."""
    return ProfilePiece(
        start=start, end=piece.end, centre=piece.centre, side=piece.side, radius=piece.radius
    )


def _intervals(
    profile: RadiusProfile, level: float, *, is_above: bool
) -> list[tuple[float, float]]:
    """Intervals where a profile is above a level, or not above it; merged where they touch."""
    line = level_line(level, profile.low, profile.high)
    found: list[tuple[float, float]] = []
    for piece in profile.pieces:
        cuts = sorted({piece.low, piece.high, *crossings(piece, line)})
        for low, high in pairwise(cuts):
            if (piece.at(0.5 * (low + high)) > level) is not is_above:
                continue
            if found and low - found[-1][1] <= NARROW:
                found[-1] = (found[-1][0], high)
            else:
                found.append((low, high))
    return [(low, high) for low, high in found if high - low > NARROW]


def _envelope(pieces: Iterable[ProfilePiece], sign: float) -> RadiusProfile:
    """Envelope of pieces: upper for sign 1, lower for sign −1."""
    forward = sorted(
        (p if p.start[0] <= p.end[0] else p.reversed() for p in pieces if _is_wide(p)),
        key=lambda piece: piece.low,
    )
    runs: list[tuple[int, float, float]] = []
    for low, high, active in _cells(forward):
        middle = 0.5 * (low + high)
        values = [(sign * forward[index].at(middle), index) for index in active]
        best = max(values)
        if runs and runs[-1][2] == low:
            last = runs[-1][0]
            if any(index == last and value >= best[0] - TIE for value, index in values):
                runs[-1] = (last, runs[-1][1], high)
                continue
        runs.append((best[1], low, high))
    return RadiusProfile(
        pieces=tuple(forward[index].part(low, high) for index, low, high in runs)
    )


def _is_wide(piece: ProfilePiece) -> bool:
    return piece.high - piece.low > NARROW


def _cells(forward: Sequence[ProfilePiece]) -> Iterator[tuple[float, float, list[int]]]:
    """Intervals between neighbouring cuts, each with the indices of the pieces over it."""
    cuts = {end for piece in forward for end in (piece.low, piece.high)}
    for index, piece in enumerate(forward):
        for other in forward[index + 1 :]:
            if other.low >= piece.high:
                break
            cuts.update(crossings(piece, other))
    active: list[int] = []
    upcoming = 0
    for low, high in pairwise(_spread(sorted(cuts))):
        middle = 0.5 * (low + high)
        while upcoming < len(forward) and forward[upcoming].low <= middle:
            active.append(upcoming)
            upcoming += 1
        active = [index for index in active if forward[index].high >= middle]
        if active:
            yield low, high, active


def _spread(cuts: Sequence[float]) -> list[float]:
    """Remove positions that coincide with the previous one from a sorted list."""
    found: list[float] = []
    for cut in cuts:
        if not found or cut - found[-1] > NARROW:
            found.append(cut)
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class HalfPlane:
    """Orientation of u and v on the lathe, and the tip offset from the nose centre."""

    is_across: bool = False
    """Whether u is the radius and v the axis, as in facing."""
    tip_x: float = 0.0
    tip_z: float = 0.0

    def point(self, centre: Spot) -> Point:
        """Convert the position of the nose centre to the programmed tool tip."""
        z, x = reversed(centre) if self.is_across else centre
        return x + self.tip_x, 0.0, z + self.tip_z

    def spot(self, point: Point) -> Spot:
        """Convert the programmed tool tip to the position of the nose centre."""
        x, z = point[0] - self.tip_x, point[2] - self.tip_z
        return (x, z) if self.is_across else (z, x)

    def arc(self, piece: ProfilePiece) -> Arc | None:
        """Arc of a piece in programmed coordinates; None for a line."""
        if piece.centre is None:
            return None
        turn = -piece.turn if self.is_across else piece.turn
        return Arc(centre=self.point(piece.centre), turn=turn, plane=ArcPlane.ZX)

    def seen(self, pieces: Iterable[ProfilePiece]) -> tuple[ProfilePiece, ...]:
        """Convert pieces between z, x and the coordinates of this half plane."""
        pieces = tuple(pieces)
        return tuple(_swapped(pieces)) if self.is_across else pieces

    def material(self, profile: RadiusProfile) -> RadiusProfile:
        """Convert a profile of radius over z to this half plane, seen from outside."""
        if not self.is_across or not profile.pieces:
            return profile
        chain = profile.chain()
        (z, x), (end_z, end_x) = chain[0].start, chain[-1].end
        walls = (
            ProfilePiece(start=(z, 0.0), end=(z, x)),
            ProfilePiece(start=(end_z, end_x), end=(end_z, 0.0)),
        )
        return highest(_swapped((walls[0], *chain, walls[1])))


def tip_of(hand: HandOfToolType | None, radius: float) -> Spot:
    """Offset in x and z from the nose centre to the programmed tip, mm."""
    towards_z = {HandOfToolType.LEFT: 1.0, HandOfToolType.NEUTRAL: 0.0}
    return -radius, towards_z.get(hand, -1.0) * radius if hand else -radius


def _swapped(pieces: Iterable[ProfilePiece]) -> Iterator[ProfilePiece]:
    """Exchange the coordinates of pieces, splitting arcs anew."""
    for piece in pieces:
        start, end = (piece.start[1], piece.start[0]), (piece.end[1], piece.end[0])
        if piece.centre is None:
            yield ProfilePiece(start=start, end=end)
            continue
        centre = (piece.centre[1], piece.centre[0])
        yield from arc_pieces(start, end, centre=centre, turn=-piece.turn)
