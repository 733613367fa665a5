"""Division of a move into pieces whose ends a control can read.

Ends are rounded to the resolution of the program; the last end stays as it is written. Each
piece of an arc is proven: about its rounded centre, or with its radius, it runs where the whole
arc runs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from math import copysign, isnan, pi

from stepnc_model.nc.moves import MoveKind, NcMove
from stepnc_model.nc.number_style import NumberStyle
from stepnc_model.toolpath.arc import (
    FULL,
    begun_turns,
    centre_of_radius,
    gap,
    on_circle,
    point_at,
    radius,
    turn_of,
)
from stepnc_model.toolpath.arc import length as length_of
from stepnc_model.toolpath.path import Point

SHORTEST = 5
"""Least length of a piece in steps of the resolution."""

SLACK = 4.0
"""Greatest deviation of a piece from its arc in steps of the resolution."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MovePiece:
    """Piece of a move, in units of the program."""

    end: tuple[Decimal, Decimal, Decimal]
    """End by axis, as absolute words count it."""
    start: tuple[Decimal, Decimal, Decimal]
    offset: tuple[Decimal, Decimal, Decimal]
    """Centre of the arc from the start of the piece, as I, J and K count it."""
    turn: float
    feed: float
    """Feed, mm/s."""
    length: float
    """Length, mm."""

    @property
    def turns(self) -> int:
        """Number of turns of an arc, the last one full or in part."""
        return begun_turns(self.turn)


@dataclass(frozen=True, slots=True, kw_only=True)
class WordScale:
    """Words of coordinates of a program: their units, and X as a diameter."""

    unit: float
    is_diameter: bool
    style: NumberStyle

    def word(self, value: float, axis: int) -> Decimal:
        """Coordinate in mm as a rounded word."""
        return self.style.rounded(value / self.factor(axis))

    def factor(self, axis: int) -> float:
        """Length of one unit of an axis word, mm."""
        return self.unit * (0.5 if axis == 0 and self.is_diameter else 1.0)

    @property
    def step(self) -> float:
        """Resolution of the program, mm."""
        return float(self.unit * 10.0**-self.style.places)


def divided(
    move: NcMove,
    ends: Sequence[float],
    feeds: Sequence[float],
    *,
    scale: WordScale,
    by_radius: bool,
) -> list[MovePiece]:
    """Divide a move; pieces that are too short join a neighbour, at the lower feed.

    Parameters
    ----------
    move : NcMove
        Line or arc with known ends.
    ends, feeds : sequence of float
        Fractions of the move, the last is 1, and feeds, mm/s.
    scale : WordScale
    by_radius : bool
        Whether the program gives arcs by their radius.

    Returns
    -------
    list of MovePiece
        One piece if the move cannot be divided.
    """
    fractions, speeds = _joined(move, ends, feeds, scale)
    while True:
        pieces = _pieces(move, fractions, speeds, scale)
        bad = next(
            (
                i
                for i, piece in enumerate(pieces)
                if not _is_sound(move, piece, scale, by_radius)
            ),
            None,
        )
        if bad is None or len(pieces) == 1:
            return pieces
        _join(fractions, speeds, bad)


def _joined(
    move: NcMove, ends: Sequence[float], feeds: Sequence[float], scale: WordScale
) -> tuple[list[float], list[float]]:
    """Fractions and feeds without pieces that are too short for the resolution."""
    length = length_of(move.start, move)
    least = SHORTEST * scale.step / length if length > 0.0 else 2.0
    fractions: list[float] = []
    speeds: list[float] = []
    for end, feed in zip(ends, feeds, strict=True):
        if speeds and speeds[-1] == feed:
            fractions[-1] = end
        else:
            fractions.append(end)
            speeds.append(feed)
    while len(fractions) > 1:
        sizes = [end - start for start, end in zip([0.0, *fractions], fractions, strict=False)]
        short = min(range(len(sizes)), key=sizes.__getitem__)
        if sizes[short] >= least:
            break
        _join(fractions, speeds, short)
    return fractions, speeds


def _join(fractions: list[float], speeds: list[float], index: int) -> None:
    """Join a piece to its neighbour, at the lower feed."""
    at = index if index + 1 < len(fractions) else index - 1
    speeds[at] = min(speeds[at], speeds[at + 1])
    del speeds[at + 1], fractions[at]


def _pieces(
    move: NcMove, fractions: Sequence[float], feeds: Sequence[float], scale: WordScale
) -> list[MovePiece]:
    length = length_of(move.start, move)
    pieces: list[MovePiece] = []
    start, before = move.start, 0.0
    for fraction, feed in zip(fractions, feeds, strict=True):
        is_last = fraction == fractions[-1]
        point = move.end if is_last else point_at(move.start, move, fraction)
        words = _words(point, scale)
        rounded = _rounded(move.end if is_last else words, scale, is_exact=is_last)
        arc = move.arc
        offset = (Decimal(0),) * 3 if arc is None else _offset(arc.centre, start, scale)
        pieces.append(
            MovePiece(
                end=words,
                start=_words(start, scale),
                offset=(offset[0], offset[1], offset[2]),
                turn=0.0 if arc is None else arc.turn * (fraction - before),
                feed=feed,
                length=length * (fraction - before),
            )
        )
        start, before = rounded, fraction
    return pieces


def _words(point: Point, scale: WordScale) -> tuple[Decimal, Decimal, Decimal]:
    return scale.word(point[0], 0), scale.word(point[1], 1), scale.word(point[2], 2)


def _rounded(words: Sequence[Decimal | float], scale: WordScale, *, is_exact: bool) -> Point:
    """Point in mm that words lead to."""
    x, y, z = (
        float(word) if is_exact else float(word) * scale.factor(axis)
        for axis, word in enumerate(words)
    )
    return x, y, z


def _offset(centre: Point, start: Point, scale: WordScale) -> tuple[Decimal, Decimal, Decimal]:
    """Centre from the start of a piece; I of a lathe is a radius."""
    x, y, z = (
        scale.style.rounded((c - s) / scale.unit) for c, s in zip(centre, start, strict=True)
    )
    return x, y, z


def _is_sound(move: NcMove, piece: MovePiece, scale: WordScale, by_radius: bool) -> bool:
    """True if a piece runs where the whole move runs, within the resolution."""
    arc = move.arc
    if move.kind is not MoveKind.ARC or arc is None:
        return piece.start != piece.end
    plane = arc.plane
    start = _rounded(piece.start, scale, is_exact=False)
    end = _rounded(piece.end, scale, is_exact=False)
    if gap(start, end, plane) < SHORTEST * scale.step:
        return False
    sense, size = copysign(1.0, piece.turn), radius(move.start, arc)
    if by_radius:
        if abs(arc.turn) > FULL or abs(abs(piece.turn) - pi) < 0.05 * pi:
            return False
        word = scale.unit * float(scale.style.rounded(size / scale.unit))
        signed = word if abs(piece.turn) <= pi else -word
        centre = centre_of_radius(start, end, radius=signed, plane=plane, sense=sense)
    else:
        x, y, z = (s + float(o) * scale.unit for s, o in zip(start, piece.offset, strict=True))
        centre = (x, y, z)
    turn = turn_of(start, end, centre, plane, sense=sense)
    if isnan(turn):
        return False
    turn += sense * (piece.turns - 1) * FULL
    slack = SLACK * scale.step
    if gap(start, centre, plane) * abs(turn - piece.turn) > slack:
        return False
    # The middle of the piece lies on the circle of the whole arc.
    middle = on_circle(start, start, centre, plane, 0.5 * turn)
    return abs(gap(middle, arc.centre, plane) - size) <= slack
