"""Builder of turning tool paths through the remaining stock of one workingstep.

Every feed removes material from the stock that is tracked here. No rapid comes closer to it
than ``RAPID_CLEARANCE``; where it would, the tool feeds instead. Moves run along the axes, so
that both are exact. Steps 5 and 6 of Shin et al. (2016), section 3.2.2.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import dist

from stepnc_model.toolpath.path import Feed, Move, MoveType
from stepnc_model.toolpath.task import PathBuilder
from stepnc_model.toolpath.turning.offset import cut, grown
from stepnc_model.toolpath.turning.profile import (
    HalfPlane,
    ProfilePiece,
    RadiusProfile,
    Spot,
    crossings,
)

RAPID_CLEARANCE = 1.0
"""Least distance between the tool and the stock in rapid moves, mm."""

WALL_CONTACT = 1e-5
"""Distance to a wall, mm, within which the tool touches it without cutting."""

TOUCH = 1e-6
"""Overlap of tool and stock that does not count as contact, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Feeds:
    """Feeds of the moves of one turning operation."""

    cutting: Feed
    lift: Feed
    stepover: Feed
    """Feed of moves through air to the next pass."""
    entering: Feed
    """Feed of moves to the next pass where they cut."""


class TurningPathBuilder:
    """Move a nose through the stock and classify the moves as contact or air."""

    def __init__(
        self,
        course: PathBuilder,
        plane: HalfPlane,
        stock: RadiusProfile,
        *,
        nose: float,
        feeds: Feeds,
    ) -> None:
        self.course = course
        self.plane = plane
        self.nose = nose
        self.feeds = feeds
        self.stock = stock
        self.at: Spot = plane.spot(course.at)
        """Position of the nose centre."""
        self.heading: Spot = (-1.0, 0.0)
        """Direction at the end of the last feed move, as a unit vector."""
        self.has_cut = False
        self._home = self.at
        self._measure()

    @property
    def rim(self) -> RadiusProfile:
        """Profile of the nose centre where the nose touches the stock."""
        return self._rim

    def travel(self, end: Spot) -> None:
        """Travel to a spot, in rapid where there is room."""
        self._travel(end, MoveType.RAPID if self.has_cut else MoveType.APPROACH)

    def home(self) -> None:
        """Return to the start of the path."""
        self._travel(self._home, MoveType.RETRACT)

    def feed(self, pieces: Sequence[ProfilePiece]) -> None:
        """Feed along pieces and remove the material in the way."""
        self._run(pieces, air=self.feeds.cutting, contact=self.feeds.cutting)

    def step(self, pieces: Sequence[ProfilePiece]) -> None:
        """Feed along pieces on the way to a pass, at the stepover feeds."""
        self._run(pieces, air=self.feeds.stepover, contact=self.feeds.entering)

    def rush(self, end: Spot, margin: float) -> None:
        """Move straight to a spot, in rapid where the stock is at least a margin away."""
        clear = grown(self.stock, self.nose + margin)
        for part, is_near in split(ProfilePiece(start=self.at, end=end), clear):
            if is_near:
                self._straight(part.end, MoveType.NO_CONTACT, self.feeds.stepover)
            else:
                self._straight(part.end, MoveType.RAPID, None)

    def meets(self, piece: ProfilePiece) -> bool:
        """True if the tool would cut along a piece; sliding along a wall does not count."""
        return any(self._is_in(part.point(0.5)) for part in _parts(piece, self._rim))

    def _is_in(self, spot: Spot) -> bool:
        u, v = spot
        return (
            v
            < min(self._rim.at(u - WALL_CONTACT), self._rim.at(u + WALL_CONTACT)) - WALL_CONTACT
        )

    def _run(self, pieces: Sequence[ProfilePiece], *, air: Feed, contact: Feed) -> None:
        for piece in pieces:
            for part, is_contact in split(piece, self._rim):
                kind = MoveType.CONTACT if is_contact else MoveType.NO_CONTACT
                self.has_cut = self.has_cut or is_contact
                self._emit(part, kind, contact if is_contact else air)
        if pieces:
            self.heading = pieces[-1].tangent(pieces[-1].end)
            left = cut(self.stock, pieces, self.nose)
            if left != self.stock:
                self.stock = left
                self._measure()

    def lift(self, direction: Spot, height: float) -> None:
        """Lift the tool off the surface by a height in a direction."""
        end = (self.at[0] + height * direction[0], self.at[1] + height * direction[1])
        self._straight(end, MoveType.NO_CONTACT, self.feeds.lift)

    def _measure(self) -> None:
        self._rim = grown(self.stock, self.nose)
        self._clear = grown(self.stock, self.nose + RAPID_CLEARANCE)

    def _travel(self, end: Spot, kind: MoveType) -> None:
        if dist(self.at, end) < TOUCH:
            return
        for spot in reversed(self._way_out(self.at)):
            self._straight(spot, MoveType.NO_CONTACT, self.feeds.stepover)
        way_in = self._way_out(end)
        for spot in self._corners(self.at, way_in[0] if way_in else end):
            self._straight(spot, kind, None)
        for start, spot in pairwise([*way_in, end]):
            self.step([ProfilePiece(start=start, end=spot)])

    def _way_out(self, spot: Spot) -> list[Spot]:
        """Point above or behind a spot where the tool has clearance; empty if not needed."""
        u, v = spot
        height = self._clear.at(u) - v
        if height <= TOUCH:
            return []
        back = next((low for low, _ in self._open(spot)), None)
        is_free = back is not None and self._rim.top(u + WALL_CONTACT, back) <= v + TOUCH
        if back is not None and is_free and back - u <= height:
            return [(back, v)]
        return [(u, self._clear.at(u))]

    def _open(self, spot: Spot) -> Iterator[tuple[float, float]]:
        """Intervals behind a spot where a rapid at its level has clearance."""
        for low, high in self._clear.below(spot[1] + TOUCH):
            if high > spot[0]:
                yield max(low, spot[0]), high
        if self._clear.high > spot[0]:
            yield self._clear.high + TOUCH, self._clear.high + 1.0

    def _corners(self, start: Spot, end: Spot) -> Iterator[Spot]:
        """Corners of a clear route between two spots, along one axis at a time."""
        low, high = min(start[0], end[0]), max(start[0], end[0])
        top = self._clear.top(low, high)
        if top <= start[1] + TOUCH:
            yield end[0], start[1]
        elif top <= end[1] + TOUCH:
            yield start[0], end[1]
        else:
            yield start[0], top
            yield end[0], top
        yield end

    def _straight(self, end: Spot, kind: MoveType, feed: Feed | None) -> None:
        if dist(self.at, end) >= TOUCH:
            self.course.add(Move(end=self.plane.point(end), type=kind, feed=feed))
            self.at = end

    def _emit(self, piece: ProfilePiece, kind: MoveType, feed: Feed) -> None:
        if piece.centre is None:
            self._straight(piece.end, kind, feed)
        elif dist(piece.start, piece.end) >= TOUCH:
            arc = self.plane.arc(piece)
            end = self.plane.point(piece.end)
            self.course.add(Move(end=end, type=kind, feed=feed, arc=arc))
            self.at = piece.end


def split(piece: ProfilePiece, rim: RadiusProfile) -> Iterator[tuple[ProfilePiece, bool]]:
    """Split a piece where it enters or leaves the stock; each part with whether it cuts."""
    for is_contact, parts in _runs(_parts(piece, rim), rim):
        yield parts[0] if len(parts) == 1 else _joined(parts), is_contact


def _parts(piece: ProfilePiece, rim: RadiusProfile) -> list[ProfilePiece]:
    """Cut a piece wherever it may enter or leave the stock."""
    if piece.is_upright:
        (u, first), (_, second) = piece.start, piece.end
        top = rim.at(u)
        if not min(first, second) + TOUCH < top < max(first, second) - TOUCH:
            return [piece]
        return [
            ProfilePiece(start=piece.start, end=(u, top)),
            ProfilePiece(start=(u, top), end=piece.end),
        ]
    cuts = {piece.low, piece.high}
    for other in rim.pieces:
        cuts.update(crossings(piece, other))
        cuts.update(end for end in (other.low, other.high) if piece.low < end < piece.high)
    order = sorted(cuts, reverse=piece.start[0] > piece.end[0])
    return [piece.part(a, b) for a, b in pairwise(order)] or [piece]


def _runs(
    parts: Iterable[ProfilePiece], rim: RadiusProfile
) -> Iterator[tuple[bool, list[ProfilePiece]]]:
    """Group neighbouring parts of a path by whether they cut."""
    run: list[ProfilePiece] = []
    was_contact = False
    for part in parts:
        u, v = part.point(0.5)
        is_contact = v < rim.at(u) - TOUCH
        if run and is_contact is not was_contact:
            yield was_contact, run
            run = []
        run.append(part)
        was_contact = is_contact
    if run:
        yield was_contact, run


def _joined(parts: Sequence[ProfilePiece]) -> ProfilePiece:
    first = parts[0]
    return ProfilePiece(
        start=first.start,
        end=parts[-1].end,
        centre=first.centre,
        side=first.side,
        radius=first.radius,
    )
