"""Exact offsets of lines and arcs in a half plane: the reach of a round nose and its edges.

The centre of a nose that touches a profile runs on the profile grown by the nose radius: the
boundary of the Minkowski sum with a disc. It is the upper envelope of the pieces moved along
their normals and of circles about the corners; corners are trimmed automatically.
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
"""Smallest difference between two radii that counts, mm."""

UPRIGHT_ANGLE = 0.5 * pi - 1e-6
"""Edge angle, rad, from which an edge counts as upright and leaves no material behind."""


@dataclass(frozen=True, slots=True, kw_only=True)
class InsertFlanks:
    """Angles by which the edges of an insert rise from its nose, from the u axis, rad."""

    ahead: float = 0.5 * pi
    """Rise angle of the insert edge on the −u side, rad."""
    behind: float = 0.5 * pi
    """Rise angle of the insert edge on the +u side, rad."""


def grown(profile: RadiusProfile, radius: float) -> RadiusProfile:
    """Path of the centre of a disc of this radius that rolls over a profile."""
    if radius <= EVEN:
        return profile
    return highest(_rolled(profile.chain(), radius, 1))


def cut(stock: RadiusProfile, path: Sequence[ProfilePiece], radius: float) -> RadiusProfile:
    """Remaining stock after the centre of a nose has run along a path."""
    swept = lowest(_rolled(path, radius, -1))
    left = lowest([*stock.pieces, *swept.pieces])
    return left.within(stock.low, stock.high)


def lowered(stock: RadiusProfile, surface: RadiusProfile) -> RadiusProfile:
    """Remaining stock after everything above a surface has been removed."""
    left = lowest([*stock.pieces, *surface.pieces])
    return left.within(stock.low, stock.high)


def reachable(profile: RadiusProfile, edges: InsertFlanks) -> RadiusProfile:
    """Profile that remains because the edges of the insert cannot reach below it."""
    rays: list[ProfilePiece] = []
    for angle, towards in ((edges.behind, -1), (edges.ahead, 1)):
        if angle < UPRIGHT_ANGLE:
            rays += _rays(profile, angle, towards)
    return highest([*profile.pieces, *rays]) if rays else profile


def excess(profile: RadiusProfile, pieces: Iterable[ProfilePiece]) -> float:
    """Greatest height of a profile above the given pieces, mm."""
    worst = 0.0
    for piece in pieces:
        for i in range(1, 16):
            u, v = piece.point(i / 16.0)
            worst = max(worst, profile.within(u - EVEN * 10, u + EVEN * 10).at(u) - v)
    return worst


def thickness(stock: RadiusProfile, surface: RadiusProfile) -> float:
    """Greatest thickness of the stock over a surface, mm."""
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
    """Move pieces by a radius to the upper or lower side and add circles about the corners."""
    for piece in chain:
        moved = _moved(piece, radius, side)
        if moved is not None:
            yield moved
    corners: list[Spot] = [chain[0].start] if chain else []
    corners += [piece.end for piece in chain]
    for corner in corners:
        yield half_circle(corner, radius, side)


def _moved(piece: ProfilePiece, radius: float, side: int) -> ProfilePiece | None:
    """Offset a line or arc along its normal; None where the offset vanishes."""
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
    """Lines that fall at an angle from each obstacle of an insert edge."""
    slope = tan(angle)
    floor = profile.bottom(profile.low, profile.high)
    limit = profile.low if towards < 0 else profile.high
    for u, v in _obstacles(profile, angle, towards):
        room = abs(limit - u)
        reach = min(room, (v - floor) / slope) if slope > 0.0 else room
        if reach > EVEN:
            yield ProfilePiece(start=(u, v), end=(u + towards * reach, v - slope * reach))


def _obstacles(profile: RadiusProfile, angle: float, towards: int) -> Iterator[Spot]:
    """Corners, and the points where an arc is as steep as the insert edge."""
    for piece in profile.pieces:
        yield piece.start
        yield piece.end
        if piece.centre is not None and piece.side > 0:
            u = piece.centre[0] + towards * piece.radius * sin(angle)
            if piece.low < u < piece.high:
                yield u, piece.centre[1] + piece.radius * cos(angle)
