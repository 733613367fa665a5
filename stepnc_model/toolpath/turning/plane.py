"""The half plane of a lathe, seen along the passes, and the programmed point of the tool.

Turning sees the spindle axis as u and the radius as v; facing sees them the other way round.
Passes run towards −u and material lies below.

Paths are made for the centre of the nose. What is programmed is the imaginary tool tip, the
corner of the square around the nose, as ``feedrate_reference`` TCP and the setting lengths
``functional_length`` and ``f_dimension`` mean it: for a right-hand outside tool the centre less
one nose radius in x and in z (tip position 3 of Fanuc and LinuxCNC), for a left-hand one the
centre less one radius in x and plus one in z (position 4), for a neutral one the centre less
one radius in x (position 8). :class:`HalfPlane` is the one place where this is done.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.toolpath.path import Arc, Plane, Point
from stepnc_model.toolpath.turning.piece import Piece, Spot, arc_pieces
from stepnc_model.toolpath.turning.profile import Profile, highest


@dataclass(frozen=True, slots=True, kw_only=True)
class HalfPlane:
    """How u and v lie on the lathe, and where the tip is from the centre of the nose."""

    is_across: bool = False
    """u is the radius and v the axis: facing"""
    tip_x: float = 0.0
    tip_z: float = 0.0

    def point(self, centre: Spot) -> Point:
        """Programmed point of a nose centre."""
        z, x = reversed(centre) if self.is_across else centre
        return x + self.tip_x, 0.0, z + self.tip_z

    def spot(self, point: Point) -> Spot:
        """Nose centre of a programmed point."""
        x, z = point[0] - self.tip_x, point[2] - self.tip_z
        return (x, z) if self.is_across else (z, x)

    def arc(self, piece: Piece) -> Arc | None:
        """Arc of a piece."""
        if piece.centre is None:
            return None
        turn = -piece.turn if self.is_across else piece.turn
        return Arc(centre=self.point(piece.centre), turn=turn, plane=Plane.ZX)

    def seen(self, pieces: Iterable[Piece]) -> tuple[Piece, ...]:
        """Pieces of z and x as this half plane sees them, or the other way round."""
        pieces = tuple(pieces)
        return tuple(_swapped(pieces)) if self.is_across else pieces

    def material(self, profile: Profile) -> Profile:
        """What a profile of radii over z looks like from outside."""
        if not self.is_across or not profile.pieces:
            return profile
        chain = profile.chain()
        (z, x), (end_z, end_x) = chain[0].start, chain[-1].end
        walls = (
            Piece(start=(z, 0.0), end=(z, x)),
            Piece(start=(end_z, end_x), end=(end_z, 0.0)),
        )
        return highest(_swapped((walls[0], *chain, walls[1])))


def tip_of(hand: HandOfToolType | None, radius: float) -> Spot:
    """Distance in x and in z from the centre of the nose to the programmed tip, mm."""
    towards_z = {HandOfToolType.LEFT: 1.0, HandOfToolType.NEUTRAL: 0.0}
    return -radius, towards_z.get(hand, -1.0) * radius if hand else -radius


def _swapped(pieces: Iterable[Piece]) -> Iterator[Piece]:
    """Pieces with their coordinates exchanged, cut anew."""
    for piece in pieces:
        start, end = (piece.start[1], piece.start[0]), (piece.end[1], piece.end[0])
        if piece.centre is None:
            yield Piece(start=start, end=end)
            continue
        centre = (piece.centre[1], piece.centre[0])
        yield from arc_pieces(start, end, centre=centre, turn=-piece.turn)
