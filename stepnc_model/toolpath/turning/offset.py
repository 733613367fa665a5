"""Offsets in a half plane, exact in lines and arcs: what a round nose and its edges can reach.

The centre of a nose that touches a profile runs on the profile grown by the radius: the
boundary of the Minkowski sum with a disc. It is the upper envelope of the pieces moved along
their normals and of circles about the corners; trimmed corners follow of themselves.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import cos, dist, inf, pi, sin, tan

from stepnc_model.toolpath.turning.profile import (
    ProfilePiece,
    RadiusProfile,
    Spot,
    half_circle,
    highest,
    lowest,
)

EVEN = 1e-9
"""mm by which a radius must be more than another one"""

UPRIGHT_ANGLE = 0.5 * pi - 1e-6
"""rad; an edge as steep or steeper leaves no wall behind"""


@dataclass(frozen=True, slots=True, kw_only=True)
class InsertFlanks:
    """Angles by which the edges of an insert rise from its nose, rad from the u axis."""

    ahead: float = 0.5 * pi
    """towards −u"""
    behind: float = 0.5 * pi
    """towards +u"""


def grown(profile: RadiusProfile, radius: float) -> RadiusProfile:
    """Centre of a disc that rolls over a profile."""
    if radius <= EVEN:
        return profile
    return highest(_rolled(profile.chain(), radius, 1))


def cut(stock: RadiusProfile, path: Sequence[ProfilePiece], radius: float) -> RadiusProfile:
    """Stock after the centre of a nose ran along a path."""
    swept = lowest(_rolled(path, radius, -1))
    left = lowest([*stock.pieces, *swept.pieces])
    return left.within(stock.low, stock.high)


def lowered(stock: RadiusProfile, surface: RadiusProfile) -> RadiusProfile:
    """Stock after everything above a surface was removed."""
    left = lowest([*stock.pieces, *surface.pieces])
    return left.within(stock.low, stock.high)


def reachable(profile: RadiusProfile, edges: InsertFlanks) -> RadiusProfile:
    """A profile without what the edges of the insert cannot come to."""
    rays: list[ProfilePiece] = []
    for angle, towards in ((edges.behind, -1), (edges.ahead, 1)):
        if angle < UPRIGHT_ANGLE:
            rays += _rays(profile, angle, towards)
    return highest([*profile.pieces, *rays]) if rays else profile


def excess(profile: RadiusProfile, pieces: Iterable[ProfilePiece]) -> float:
    """By how much a profile lies above pieces at most, mm."""
    worst = 0.0
    for piece in pieces:
        for i in range(1, 16):
            u, v = piece.point(i / 16.0)
            worst = max(worst, profile.within(u - EVEN * 10, u + EVEN * 10).at(u) - v)
    return worst


def thickness(stock: RadiusProfile, surface: RadiusProfile) -> float:
    """Greatest distance from a surface out to the stock over it, mm."""
    chain = surface.chain()
    worst = 0.0
    cuts = {u for p in (*stock.pieces, *surface.pieces) for u in (p.low, p.high)}
    cuts |= {0.5 * (p.low + p.high) for p in (*stock.pieces, *surface.pieces)}
    for u in sorted(cuts):
        v = stock.at(u)
        if surface.low <= u <= surface.high and -inf < surface.at(u) < v:
            worst = max(worst, min(piece.distance((u, v)) for piece in chain))
    return worst


def _rolled(chain: Sequence[ProfilePiece], radius: float, side: int) -> Iterator[ProfilePiece]:
    """Pieces moved by a radius to the upper or lower side, and circles about the corners."""
    for piece in chain:
        moved = _moved(piece, radius, side)
        if moved is not None:
            yield moved
    corners: list[Spot] = [chain[0].start] if chain else []
    corners += [piece.end for piece in chain]
    for corner in corners:
        yield half_circle(corner, radius, side)


def _moved(piece: ProfilePiece, radius: float, side: int) -> ProfilePiece | None:
    """One piece along its normal, or nothing where it folds."""
    if piece.is_upright:
        return None
    if piece.centre is None:
        length = dist(piece.start, piece.end)
        a, b = piece.end[0] - piece.start[0], piece.end[1] - piece.start[1]
        way = side * radius / length * (1.0 if a > 0.0 else -1.0)
        return ProfilePiece(
            start=(piece.start[0] - b * way, piece.start[1] + a * way),
            end=(piece.end[0] - b * way, piece.end[1] + a * way),
        )
    size = piece.radius + radius * side * piece.side
    if size <= EVEN:
        return None
    ratio = size / piece.radius
    (a, b), (c, d), (e, f) = piece.start, piece.end, piece.centre
    return ProfilePiece(
        start=(e + (a - e) * ratio, f + (b - f) * ratio),
        end=(e + (c - e) * ratio, f + (d - f) * ratio),
        centre=piece.centre,
        side=piece.side,
        radius=size,
    )


def _rays(profile: RadiusProfile, angle: float, towards: int) -> Iterator[ProfilePiece]:
    """Lines that fall at an angle from whatever stands in the way of an edge."""
    slope = tan(angle)
    floor = profile.bottom(profile.low, profile.high)
    limit = profile.low if towards < 0 else profile.high
    for u, v in _obstacles(profile, angle, towards):
        room = abs(limit - u)
        reach = min(room, (v - floor) / slope) if slope > 0.0 else room
        if reach > EVEN:
            yield ProfilePiece(start=(u, v), end=(u + towards * reach, v - slope * reach))


def _obstacles(profile: RadiusProfile, angle: float, towards: int) -> Iterator[Spot]:
    """Corners, and where an arc is as steep as the edge."""
    for piece in profile.pieces:
        yield piece.start
        yield piece.end
        if piece.centre is not None and piece.side > 0:
            u = piece.centre[0] + towards * piece.radius * sin(angle)
            if piece.low < u < piece.high:
                yield u, piece.centre[1] + piece.radius * cos(angle)
