"""Profiles in a half plane: v as a function of u, in lines and exact arcs, with steps.

The upper envelope of pieces is what bounds material; the lower one is what is left of it.
Everything else follows: growing by a radius, cutting by a nose that runs along a path, and
the part of a profile that an edge can reach.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf

from stepnc_model.toolpath.turning.piece import Piece, Spot, crossings

NARROW = 1e-9
"""mm; an interval of u that is narrower holds nothing"""

JOINT = 1e-6
"""mm of v between two pieces that is no step"""

TIE = 1e-12
"""mm by which a piece must be better to end the one before it"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """Pieces in the order of u, none upright; a step of v between two of them is a wall."""

    pieces: tuple[Piece, ...] = ()

    @property
    def low(self) -> float:
        """Least u."""
        return self.pieces[0].low if self.pieces else inf

    @property
    def high(self) -> float:
        """Greatest u."""
        return self.pieces[-1].high if self.pieces else -inf

    def at(self, u: float) -> float:
        """Its v over one u, the higher one at a wall; −inf beside the profile."""
        return max((p.at(u) for p in self.pieces if p.low <= u <= p.high), default=-inf)

    def within(self, low: float, high: float) -> "Profile":
        """The part over an interval of u."""
        return Profile(
            pieces=tuple(
                piece.part(max(low, piece.low), min(high, piece.high))
                for piece in self.pieces
                if min(high, piece.high) - max(low, piece.low) > NARROW
            )
        )

    def top(self, low: float, high: float) -> float:
        """Greatest v over a closed interval of u; −inf beside the profile."""
        found = -inf
        for piece in self.pieces:
            first, second = max(low, piece.low), min(high, piece.high)
            if first <= second:
                found = max(found, piece.at(first), piece.at(second))
                if piece.centre and piece.side > 0 and first < piece.centre[0] < second:
                    found = max(found, piece.centre[1] + piece.radius)
        return found

    def bottom(self, low: float, high: float) -> float:
        """Least v over an interval of u; +inf beside the profile."""
        return -mirrored(self.within(low, high).pieces).top(low, high)

    def chain(self) -> tuple[Piece, ...]:
        """The pieces with the walls between them, joined, in the order of u."""
        joined: list[Piece] = []
        for each in self.pieces:
            piece = each
            if joined:
                last, start = joined[-1].end, piece.start
                if start[0] - last[0] > JOINT:
                    joined.append(Piece(start=last, end=start))
                elif abs(start[1] - last[1]) > JOINT:
                    wall_end = (last[0], start[1])
                    joined.append(Piece(start=last, end=wall_end))
                    last = wall_end
                if start[0] - last[0] <= JOINT:
                    piece = _from(piece, last)
            joined.append(piece)
        return tuple(joined)

    def below(self, level: float) -> list[tuple[float, float]]:
        """Intervals of u where the profile is at a level or below it; its gaps count too."""
        return _intervals(self, level, is_above=False)

    def above(self, level: float) -> list[tuple[float, float]]:
        """Intervals of u where the profile is above a level."""
        return _intervals(self, level, is_above=True)


def highest(pieces: Iterable[Piece]) -> Profile:
    """Upper envelope of pieces."""
    return _envelope(pieces, 1.0)


def lowest(pieces: Iterable[Piece]) -> Profile:
    """Lower envelope of pieces."""
    return _envelope(pieces, -1.0)


def mirrored(pieces: Iterable[Piece]) -> Profile:
    """Pieces of a profile turned upside down."""
    return Profile(pieces=tuple(map(_upside_down, pieces)))


def level_line(level: float, low: float, high: float) -> Piece:
    """A horizontal line."""
    return Piece(start=(low, level), end=(high, level))


def _upside_down(piece: Piece) -> Piece:
    return Piece(
        start=(piece.start[0], -piece.start[1]),
        end=(piece.end[0], -piece.end[1]),
        centre=(piece.centre[0], -piece.centre[1]) if piece.centre else None,
        side=-piece.side,
        radius=piece.radius,
    )


def _from(piece: Piece, start: Spot) -> Piece:
    """A piece that starts exactly where the last one ended."""
    return Piece(
        start=start, end=piece.end, centre=piece.centre, side=piece.side, radius=piece.radius
    )


def _intervals(profile: Profile, level: float, *, is_above: bool) -> list[tuple[float, float]]:
    """Where a profile is above a level, or not; joined where they touch."""
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


def _envelope(pieces: Iterable[Piece], sign: float) -> Profile:
    """The best piece over each interval between ends and crossings."""
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
    return Profile(pieces=tuple(forward[index].part(low, high) for index, low, high in runs))


def _is_wide(piece: Piece) -> bool:
    return piece.high - piece.low > NARROW


def _cells(forward: Sequence[Piece]) -> Iterator[tuple[float, float, list[int]]]:
    """Intervals between neighbouring cuts, each with the pieces over it."""
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
    """Cuts without those that lie on top of the one before."""
    found: list[float] = []
    for cut in cuts:
        if not found or cut - found[-1] > NARROW:
            found.append(cut)
    return found
