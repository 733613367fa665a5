"""Exact offsets of contours with lines and arcs, as traced by the centre of a disc.

The region is the intersection of the areas left of each loop, so islands may overlap each
other or the wall. Its erosion by d is bounded by points whose distance from the nearest edge is
exactly d. Such points lie on the offset of an edge, or on the arc about a vertex where the
region is not convex. All these curves are split where they meet, and pieces whose midpoint is
closer than d to any edge are dropped: the rest are the rings. Nothing is approximated by
chords, and an offset of an offset is never taken. The first half of the module computes
crossings of many edges at once and distances of points from them.

References
----------
.. [1] X.-Z. Liu et al., "An offset algorithm for polyline curves", Computers in Industry 58
   (2007) 240-254: raw offset, intersection, and pruning by distance.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from math import pi

import numpy as np
import shapely
from numpy.typing import NDArray

from stepnc_model.toolpath.milling.contour import (
    REMEMBERED,
    TINY,
    Chain,
    ContourEdge,
    Floats,
    Loop,
    Points,
    area,
    chain_length,
    halved,
    reversed_chain,
    shape,
)

ON = 1e-9
"""Tolerance of the bounding boxes when looking for crossings, mm."""


@dataclass(frozen=True, slots=True)
class ContourEdges:
    """Contour edges as columns, each (N,)."""

    start: Points
    end: Points
    centre: Points
    """Centres of arcs; 0 for lines, (N,)."""
    radius: Floats
    """Radii of arcs, mm; 0 for lines, (N,)."""
    turn: Floats
    """Angles of arcs, rad; 0 for lines, (N,)."""

    @classmethod
    def of(cls, edges: Sequence[ContourEdge]) -> "ContourEdges":
        """Build the columns from a list of edges."""
        start = np.array([edge.start for edge in edges], dtype=complex)
        centre = np.array(
            [0j if edge.centre is None else edge.centre for edge in edges], dtype=complex
        )
        turn = np.array([edge.turn for edge in edges], dtype=float)
        return cls(
            start=start,
            end=np.array([edge.end for edge in edges], dtype=complex),
            centre=centre,
            radius=np.where(turn == 0.0, 0.0, np.abs(start - centre)),
            turn=turn,
        )

    def pick(self, index: NDArray[np.intp]) -> "ContourEdges":
        """Select contour edges by their indices."""
        return ContourEdges(
            self.start[index],
            self.end[index],
            self.centre[index],
            self.radius[index],
            self.turn[index],
        )

    def boxes(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Bounding boxes: least x, least y, greatest x, greatest y; not tight for arcs."""
        middle = self.start + 0.5 * (self.end - self.start)
        arc = self.turn != 0.0
        spoke = np.where(arc, self.start - self.centre, 0.0)
        middle = np.where(arc, self.centre + spoke * np.exp(0.5j * self.turn), middle)
        # The sagitta bounds how far an arc up to half a turn bulges beyond its three points.
        bulge = np.abs(middle - 0.5 * (self.start + self.end))
        xs = np.stack([self.start.real, self.end.real, middle.real])
        ys = np.stack([self.start.imag, self.end.imag, middle.imag])
        return (
            xs.min(0) - bulge,
            ys.min(0) - bulge,
            xs.max(0) + bulge,
            ys.max(0) + bulge,
        )


def distances(points: Points, edges: ContourEdges) -> Floats:
    """Distance of each point from the nearest edge, mm, (M,)."""
    found = np.full(len(points), np.inf)
    is_line = edges.turn == 0.0
    lines, arcs = edges.pick(np.flatnonzero(is_line)), edges.pick(np.flatnonzero(~is_line))
    if len(lines.start):
        way = lines.end - lines.start
        part = ((points[:, None] - lines.start) / way).real
        foot = lines.start + np.clip(part, 0.0, 1.0) * way
        found = np.minimum(found, np.abs(points[:, None] - foot).min(1))
    if len(arcs.start):
        spoke = (points[:, None] - arcs.centre) / (arcs.start - arcs.centre)
        part = _part(spoke, arcs.turn)
        to_arc = np.abs(np.abs(spoke) - 1.0) * arcs.radius
        ends = np.minimum(
            np.abs(points[:, None] - arcs.start), np.abs(points[:, None] - arcs.end)
        )
        found = np.minimum(found, np.where(part <= 1.0, to_arc, ends).min(1))
    return found


def crossings(edges: Sequence[ContourEdge]) -> list[list[float]]:
    """Fractions of each edge's length where another edge crosses or touches it."""
    return _edge_crossings(len(edges), *_pairs(ContourEdges.of(edges), None))


def crossings_with(
    edges: Sequence[ContourEdge], others: Sequence[ContourEdge]
) -> list[list[float]]:
    """Fractions of each edge's length where an edge of a second set crosses or touches it."""
    return _edge_crossings(len(edges), *_pairs(ContourEdges.of(edges), ContourEdges.of(others)))


def _edge_crossings(count: int, index: NDArray[np.intp], parts: Floats) -> list[list[float]]:
    """Crossing fractions grouped by edge, in rising order."""
    order = np.lexsort((parts, index))
    bounds = np.searchsorted(index[order], np.arange(count + 1))
    values = parts[order].tolist()
    return [values[a:b] for a, b in pairwise(bounds)]


def _pairs(edges: ContourEdges, others: ContourEdges | None) -> tuple[NDArray[np.intp], Floats]:
    """Edge index and fraction of every crossing, of both edges if there is only one set."""
    second = edges if others is None else others
    ax0, ay0, ax1, ay1 = edges.boxes()
    bx0, by0, bx1, by1 = second.boxes()
    near = (
        (ax0[:, None] <= bx1 + ON)
        & (bx0 <= ax1[:, None] + ON)
        & (ay0[:, None] <= by1 + ON)
        & (by0 <= ay1[:, None] + ON)
    )
    if others is None:
        near = np.triu(near, 1)
    i, j = np.nonzero(near)
    a, b = edges.pick(i), second.pick(j)
    hits = _meet(a, b)
    owners, parts = [], []
    for where in hits:
        pa, pb = _part_of(a, where), _part_of(b, where)
        good = np.isfinite(pa) & np.isfinite(pb)
        owners.append(i[good])
        parts.append(pa[good])
        if others is None:
            owners.append(j[good])
            parts.append(pb[good])
    return np.concatenate(owners), np.concatenate(parts)


def _meet(a: ContourEdges, b: ContourEdges) -> tuple[Points, Points]:
    """Intersections of the lines or circles of paired edges: two points each, or NaN."""
    first = np.full(len(a.start), np.nan + 0j)
    second = first.copy()
    a_line, b_line = a.turn == 0.0, b.turn == 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        pick = np.flatnonzero(a_line & b_line)
        first[pick] = _line_line(a.pick(pick), b.pick(pick))
        for lines, arcs, chosen in ((a, b, a_line & ~b_line), (b, a, ~a_line & b_line)):
            pick = np.flatnonzero(chosen)
            first[pick], second[pick] = _line_circle(lines.pick(pick), arcs.pick(pick))
        pick = np.flatnonzero(~a_line & ~b_line)
        first[pick], second[pick] = _circle_circle(a.pick(pick), b.pick(pick))
    return first, second


def _line_line(a: ContourEdges, b: ContourEdges) -> Points:
    """Intersections of paired lines; NaN for parallel lines."""
    u, v = a.end - a.start, b.end - b.start
    cross = (u.conj() * v).imag
    flat = np.abs(cross) <= 1e-12 * np.abs(u) * np.abs(v)
    part = ((b.start - a.start).conj() * v).imag / np.where(flat, np.nan, cross)
    return a.start + part * u


def _line_circle(lines: ContourEdges, arcs: ContourEdges) -> tuple[Points, Points]:
    """Intersections of lines and circles; a near-tangent line counts as touching."""
    way = (lines.end - lines.start) / np.abs(lines.end - lines.start)
    from_centre = (lines.start - arcs.centre) / way
    half = _half_chord(arcs.radius, from_centre.imag)
    foot = lines.start - from_centre.real * way
    return foot + half * way, foot - half * way


def _circle_circle(a: ContourEdges, b: ContourEdges) -> tuple[Points, Points]:
    """Intersections of paired circles; NaN for concentric circles."""
    between = b.centre - a.centre
    gap = np.abs(between)
    gap = np.where(gap < 1e-9, np.nan, gap)
    along = (gap**2 + a.radius**2 - b.radius**2) / (2.0 * gap)
    half = _half_chord(a.radius, along)
    way = between / gap
    return a.centre + (along + 1j * half) * way, a.centre + (along - 1j * half) * way


def _half_chord(radius: Floats, distance: Floats) -> Floats:
    """Half the chord of a circle at a distance from its centre, mm."""
    square = radius**2 - distance**2
    touch = np.abs(square) <= 1e-9 * np.maximum(radius, 1e-3)
    chord: Floats = np.where(touch, 0.0, np.sqrt(np.where(square < 0.0, np.nan, square)))
    return chord


def _part_of(edges: ContourEdges, where: Points) -> Floats:
    """Fraction of each edge's length at a point on its line or circle; NaN beyond its ends."""
    with np.errstate(divide="ignore", invalid="ignore"):
        on_line = ((where - edges.start) / (edges.end - edges.start)).real
        spoke = (where - edges.centre) / (edges.start - edges.centre)
        part = np.where(edges.turn == 0.0, on_line, _part(spoke, edges.turn))
        length = np.where(
            edges.turn == 0.0,
            np.abs(edges.end - edges.start),
            edges.radius * np.abs(edges.turn),
        )
        slack = 1e-7 / np.maximum(length, 1e-7)
        # Just before the start, an arc's fraction is almost a whole turn.
        whole = np.where(edges.turn == 0.0, np.inf, 2.0 * pi / np.abs(edges.turn))
        part = np.where(part > whole - slack, 0.0, part)
    inside = (part >= -slack) & (part <= 1.0 + slack)
    return np.where(inside, np.clip(part, 0.0, 1.0), np.nan)


def _part(spoke: Points, turn: Floats) -> Floats:
    """Fraction of an arc's angle at a spoke relative to its start; above 1 beyond the arc."""
    sign = np.where(turn < 0.0, -1.0, 1.0)
    size = np.where(turn == 0.0, 1.0, np.abs(turn))
    angle: Floats = (np.angle(spoke) * sign) % (2.0 * pi) / size
    return angle


SLACK = 1e-7
"""Tolerance by which a piece may be closer than the offset distance, mm."""

SHORTEST = 1e-7
"""Length below which a piece is a rounding error, mm."""

JOIN = 1e-4
"""Greatest gap between the ends of pieces that are joined to a chain, mm."""

SMOOTH = 1e-9
"""Bend at a vertex that counts as smooth, rad."""

FLAT = 1e-4
"""Thickness below which a loop bounds nothing, mm."""


def erode(loops: Sequence[Loop], distance: float) -> tuple[Loop, ...]:
    """Boundary of the possible centres of a disc inside a region.

    Parameters
    ----------
    loops : sequence of Loop
        The region lies on the left of each loop; loops may cross one another.
    distance : float, mm
        Radius of the disc, positive.

    Returns
    -------
    tuple of Loop
        The result lies on their left: outer rings counter-clockwise, rings around islands
        clockwise. Empty if the disc is too large.
    """
    return _eroded(tuple(loops), distance)


@lru_cache(maxsize=REMEMBERED)
def _eroded(loops: tuple[Loop, ...], distance: float) -> tuple[Loop, ...]:
    """Eroded loops, cached; implementation of ``erode``."""
    sources = [edge for loop in loops for edge in halved(loop)]
    candidates = [
        edge for loop in loops for edge in _parallels(halved(loop), distance, is_closed=True)
    ]
    pieces, middles = _apart(candidates, sources, distance)
    if len(loops) > 1 and pieces:
        # The midpoints keep the distance: chords may be as coarse as a fraction of it.
        inside = contains(loops, middles, tolerance=0.2 * distance)
        pieces = [piece for piece, good in zip(pieces, inside, strict=True) if good]
    return _stitched(pieces)


def dilate(loops: Sequence[Loop], distance: float) -> tuple[Loop, ...]:
    """Boundary of the union of discs centred inside loops without holes."""
    outside = [reversed_chain(loop) for loop in loops]
    return tuple(reversed_chain(loop) for loop in erode(outside, distance))


def offset(loop: Loop, distance: float) -> tuple[Loop, ...]:
    """Offset of one outline without holes: inwards if positive, outwards if negative, mm."""
    if distance > 0.0:
        return erode([loop], distance)
    return dilate([loop], -distance) if distance < 0.0 else (loop,)


def rounded(loop: Loop, radius: float) -> tuple[Loop, ...]:
    """Outline with its inner corners rounded: the area that a disc inside it can cover."""
    inner = erode([loop], radius)
    return dilate(inner, radius) if inner else ()


def offset_left(chain: Chain, distance: float) -> tuple[Chain, ...]:
    """Offset of an open chain to its left, as chains from its start to its end."""
    sources = halved(chain)
    candidates = _parallels(sources, distance, is_closed=False)
    return _chained(_apart(candidates, sources, distance)[0])


def contains(
    loops: Sequence[Loop], points: Iterable[complex], *, tolerance: float
) -> list[bool]:
    """True if points lie on the left of every loop, with arcs as chords within a tolerance."""
    found = np.array(list(points), dtype=complex)
    inside = np.ones(len(found), dtype=bool)
    for loop in loops:
        polygon = shape(loop, tolerance=tolerance)
        inside &= shapely.contains_xy(polygon, found.real, found.imag) == (area(loop) > 0.0)
    return [bool(each) for each in inside]


def _apart(
    candidates: Sequence[ContourEdge], sources: Sequence[ContourEdge], distance: float
) -> tuple[list[ContourEdge], list[complex]]:
    """Pieces of the candidates that keep the distance from the sources, with midpoints."""
    pieces = [
        piece
        for edge, parts in zip(candidates, crossings(candidates), strict=True)
        for piece in _split(edge, parts)
    ]
    if not pieces:
        return [], []
    middles = np.array([piece.at(0.5) for piece in pieces], dtype=complex)
    keep = np.flatnonzero(distances(middles, ContourEdges.of(sources)) >= distance - SLACK)
    return [pieces[index] for index in keep], middles[keep].tolist()


def _parallels(chain: Chain, distance: float, *, is_closed: bool) -> list[ContourEdge]:
    """Offset edges to the left, and arcs about the vertices that are not convex."""
    sides = (_parallel(edge, distance) for edge in chain)
    found = [side for side in sides if side is not None]
    for edge, following in pairwise((*chain, chain[0]) if is_closed else chain):
        bend = float(np.angle(following.along(0.0) / edge.along(1.0)))
        if bend < -SMOOTH:
            at = edge.end
            found.append(
                ContourEdge(
                    start=at + 1j * distance * edge.along(1.0),
                    end=at + 1j * distance * following.along(0.0),
                    centre=at,
                    turn=bend,
                )
            )
    return found


def _parallel(edge: ContourEdge, distance: float) -> ContourEdge | None:
    """Offset of an edge to its left; None if an arc shrinks to nothing."""
    if edge.centre is None:
        aside = 1j * distance * edge.along(0.0)
        return ContourEdge(edge.start + aside, edge.end + aside)
    radius = abs(edge.start - edge.centre)
    size = radius - distance if edge.turn > 0.0 else radius + distance
    if size <= SHORTEST:
        return None
    scale = size / radius
    return ContourEdge(
        start=edge.centre + scale * (edge.start - edge.centre),
        end=edge.centre + scale * (edge.end - edge.centre),
        centre=edge.centre,
        turn=edge.turn,
    )


def _split(edge: ContourEdge, parts: list[float]) -> list[ContourEdge]:
    """Cut an edge at given fractions of its length."""
    least = SHORTEST / max(edge.length, SHORTEST)
    cuts = [0.0]
    for part in parts:
        if part - cuts[-1] > least and 1.0 - part > least:
            cuts.append(part)
    cuts.append(1.0)
    if edge.length < SHORTEST:
        return []
    return [edge.between(low, high) for low, high in pairwise(cuts)]


def _stitched(pieces: list[ContourEdge]) -> tuple[Loop, ...]:
    """Closed loops of pieces whose ends meet; open chains and empty loops are dropped."""
    loops: list[Loop] = []
    pieces = _pruned(pieces)
    for chain in _chains(pieces, range(len(pieces))):
        if abs(chain[-1].end - chain[0].start) <= JOIN:
            loop = _closed(chain)
            if abs(area(loop)) > FLAT * chain_length(loop):
                loops.append(loop)
    return tuple(loops)


def _pruned(pieces: list[ContourEdge]) -> list[ContourEdge]:
    """Remove pieces that are dead ends and cannot belong to a closed loop.

    Where two edges are almost collinear, pieces behind their crossing are closer than the
    distance by less than the slack: they remain, and a chain that follows one never closes.
    """
    starts = np.array([piece.start for piece in pieces], dtype=complex)
    ends = np.array([piece.end for piece in pieces], dtype=complex)
    follows = np.abs(ends[:, None] - starts) <= JOIN
    keep = np.ones(len(pieces), dtype=bool)
    while True:
        leads = (follows & keep).any(1) & (follows & keep[:, None]).any(0) & keep
        if (leads == keep).all():
            return [pieces[index] for index in np.flatnonzero(keep)]
        keep = leads


def _chained(pieces: list[ContourEdge]) -> tuple[Chain, ...]:
    """Chains of pieces whose ends meet, each from a piece that no other piece leads to."""
    if not pieces:
        return ()
    ends = np.array([piece.end for piece in pieces], dtype=complex)
    firsts = [
        index for index, piece in enumerate(pieces) if np.abs(ends - piece.start).min() > JOIN
    ]
    return tuple(tuple(_merged(chain)) for chain in _chains(pieces, firsts))


def _chains(pieces: list[ContourEdge], firsts: Iterable[int]) -> Iterator[list[ContourEdge]]:
    """Follow pieces end to start from each first piece."""
    starts = np.array([piece.start for piece in pieces], dtype=complex)
    is_free = np.ones(len(pieces), dtype=bool)
    for first in firsts:
        if not is_free[first]:
            continue
        is_free[first] = False
        chain, at = [pieces[first]], pieces[first].end
        while abs(at - starts[first]) > JOIN:
            gaps = np.where(is_free, np.abs(starts - at), np.inf)
            following = int(np.argmin(gaps))
            if gaps[following] > JOIN:
                break
            is_free[following] = False
            chain.append(pieces[following])
            at = pieces[following].end
        yield chain


def _closed(chain: list[ContourEdge]) -> Loop:
    """Loop in which each edge ends exactly where the next one starts."""
    merged = _merged(chain)
    ends = [*(edge.start for edge in merged[1:]), merged[0].start]
    return tuple(
        ContourEdge(edge.start, end, edge.centre, edge.turn)
        for edge, end in zip(merged, ends, strict=True)
        # Where ends are joined, a piece of a few rounding errors may vanish.
        if edge.centre is not None or abs(end - edge.start) > TINY
    )


def _merged(chain: list[ContourEdge]) -> list[ContourEdge]:
    """Chain in which edges that continue each other are merged."""
    merged: list[ContourEdge] = []
    for edge in chain:
        if merged and _continues(merged[-1], edge):
            last = merged.pop()
            merged.append(ContourEdge(last.start, edge.end, last.centre, last.turn + edge.turn))
        else:
            merged.append(edge)
    return merged


def _continues(one: ContourEdge, other: ContourEdge) -> bool:
    """True if two edges are parts of one line, or of one arc of half a turn at most."""
    if one.centre is None or other.centre is None:
        if one.centre is not other.centre:
            return False
        return abs(float(np.angle(other.along(0.0) / one.along(0.0)))) < SMOOTH
    return (
        abs(one.centre - other.centre) < SLACK
        and one.turn * other.turn > 0.0
        and abs(one.turn + other.turn) <= np.pi + SMOOTH
    )
