"""Offsets of contours with exact arcs: what a disc whose centre keeps inside can trace.

The region is the common part of what lies on the left of each loop, so islands may overlap each
other or the wall. Its erosion by d is bounded by points whose distance from the nearest edge is
exactly d. Such points lie on the offset of an edge, or on the arc about a vertex where the
region is not convex. All of those curves are split where they meet, and the pieces whose middle
is nearer than d to any edge are dropped: what is left are the rings. Nothing is approximated
by chords, and an offset of an offset is never taken.

References
----------
.. [1] X.-Z. Liu et al., "An offset algorithm for polyline curves", Computers in Industry 58
   (2007) 240-254: raw offset, intersection, and pruning by distance.
"""

from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from itertools import pairwise

import numpy as np
import shapely

from stepnc_model.toolpath.milling.arrays import Edges, crossings, distances
from stepnc_model.toolpath.milling.contour import (
    REMEMBERED,
    TINY,
    Chain,
    Edge,
    Loop,
    area,
    chain_length,
    halved,
    reversed_chain,
    shape,
)

SLACK = 1e-7
"""mm by which a piece may be nearer than the offset asks for"""

SHORTEST = 1e-7
"""mm; shorter pieces are rounding"""

JOIN = 1e-4
"""mm between pieces that are one chain"""

SMOOTH = 1e-9
"""rad; a smaller bend at a vertex is none"""

FLAT = 1e-4
"""mm; a loop that is thinner than this bounds nothing"""


def erode(loops: Sequence[Loop], distance: float) -> tuple[Loop, ...]:
    """Boundary of where the centre of a disc may be, its radius the distance.

    Parameters
    ----------
    loops : sequence of Loop
        The region lies on the left of each; they may cross one another.
    distance : float, mm
        Positive.

    Returns
    -------
    tuple of Loop
        The region lies on their left: outer rings counter-clockwise, rings around islands
        clockwise. Empty when the disc is too large.
    """
    return _eroded(tuple(loops), distance)


@lru_cache(maxsize=REMEMBERED)
def _eroded(loops: tuple[Loop, ...], distance: float) -> tuple[Loop, ...]:
    """The same of loops that can be remembered."""
    sources = [edge for loop in loops for edge in halved(loop)]
    candidates = [
        edge for loop in loops for edge in _parallels(halved(loop), distance, is_closed=True)
    ]
    pieces, middles = _apart(candidates, sources, distance)
    if len(loops) > 1 and pieces:
        # The middles keep the distance: chords may be as coarse as a part of it.
        inside = contains(loops, middles, tolerance=0.2 * distance)
        pieces = [piece for piece, good in zip(pieces, inside, strict=True) if good]
    return _stitched(pieces)


def dilate(loops: Sequence[Loop], distance: float) -> tuple[Loop, ...]:
    """Boundary of all discs about points inside the loops, which have no holes."""
    outside = [reversed_chain(loop) for loop in loops]
    return tuple(reversed_chain(loop) for loop in erode(outside, distance))


def offset(loop: Loop, distance: float) -> tuple[Loop, ...]:
    """One outline without holes, smaller by a distance, or larger where it is negative."""
    if distance > 0.0:
        return erode([loop], distance)
    return dilate([loop], -distance) if distance < 0.0 else (loop,)


def rounded(loop: Loop, radius: float) -> tuple[Loop, ...]:
    """The outline with its inner corners rounded: all that a disc inside it can cover."""
    inner = erode([loop], radius)
    return dilate(inner, radius) if inner else ()


def beside(chain: Chain, distance: float) -> tuple[Chain, ...]:
    """Chains at a distance to the left of one that has two ends, from its start to its end."""
    sources = halved(chain)
    candidates = _parallels(sources, distance, is_closed=False)
    return _chained(_apart(candidates, sources, distance)[0])


def contains(
    loops: Sequence[Loop], points: Iterable[complex], *, tolerance: float
) -> list[bool]:
    """Whether points lie on the left of every loop; arcs by chords within a tolerance in mm."""
    found = np.array(list(points), dtype=complex)
    inside = np.ones(len(found), dtype=bool)
    for loop in loops:
        polygon = shape(loop, tolerance=tolerance)
        inside &= shapely.contains_xy(polygon, found.real, found.imag) == (area(loop) > 0.0)
    return [bool(each) for each in inside]


def _apart(
    candidates: Sequence[Edge], sources: Sequence[Edge], distance: float
) -> tuple[list[Edge], list[complex]]:
    """Pieces of the candidates that keep the distance from the sources, with their middles."""
    pieces = [
        piece
        for edge, parts in zip(candidates, crossings(candidates), strict=True)
        for piece in _split(edge, parts)
    ]
    if not pieces:
        return [], []
    middles = np.array([piece.at(0.5) for piece in pieces], dtype=complex)
    keep = np.flatnonzero(distances(middles, Edges.of(sources)) >= distance - SLACK)
    return [pieces[index] for index in keep], middles[keep].tolist()


def _parallels(chain: Chain, distance: float, *, is_closed: bool) -> list[Edge]:
    """Edges at a distance to the left, and arcs about the vertices that are not convex."""
    sides = (_parallel(edge, distance) for edge in chain)
    found = [side for side in sides if side is not None]
    for edge, following in pairwise((*chain, chain[0]) if is_closed else chain):
        bend = float(np.angle(following.along(0.0) / edge.along(1.0)))
        if bend < -SMOOTH:
            at = edge.end
            found.append(
                Edge(
                    start=at + 1j * distance * edge.along(1.0),
                    end=at + 1j * distance * following.along(0.0),
                    centre=at,
                    turn=bend,
                )
            )
    return found


def _parallel(edge: Edge, distance: float) -> Edge | None:
    """The edge at a distance to its left; None when an arc shrinks to nothing."""
    if edge.centre is None:
        aside = 1j * distance * edge.along(0.0)
        return Edge(edge.start + aside, edge.end + aside)
    radius = abs(edge.start - edge.centre)
    size = radius - distance if edge.turn > 0.0 else radius + distance
    if size <= SHORTEST:
        return None
    scale = size / radius
    return Edge(
        start=edge.centre + scale * (edge.start - edge.centre),
        end=edge.centre + scale * (edge.end - edge.centre),
        centre=edge.centre,
        turn=edge.turn,
    )


def _split(edge: Edge, parts: list[float]) -> list[Edge]:
    """The edge cut at some parts of its length."""
    least = SHORTEST / max(edge.length, SHORTEST)
    cuts = [0.0]
    for part in parts:
        if part - cuts[-1] > least and 1.0 - part > least:
            cuts.append(part)
    cuts.append(1.0)
    if edge.length < SHORTEST:
        return []
    return [edge.between(low, high) for low, high in pairwise(cuts)]


def _stitched(pieces: list[Edge]) -> tuple[Loop, ...]:
    """Loops of pieces whose ends meet; what does not close or bounds nothing is dropped."""
    loops: list[Loop] = []
    pieces = _pruned(pieces)
    for chain in _chains(pieces, range(len(pieces))):
        if abs(chain[-1].end - chain[0].start) <= JOIN:
            loop = _closed(chain)
            if abs(area(loop)) > FLAT * chain_length(loop):
                loops.append(loop)
    return tuple(loops)


def _pruned(pieces: list[Edge]) -> list[Edge]:
    """The pieces without those that lead nowhere.

    Where two edges are almost in line, the pieces behind their crossing are nearer than the
    distance by less than the slack: they stay, and a chain that follows one never closes.
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


def _chained(pieces: list[Edge]) -> tuple[Chain, ...]:
    """Chains of pieces whose ends meet, each from an end that no other piece leads to."""
    if not pieces:
        return ()
    ends = np.array([piece.end for piece in pieces], dtype=complex)
    firsts = [
        index for index, piece in enumerate(pieces) if np.abs(ends - piece.start).min() > JOIN
    ]
    return tuple(tuple(_merged(chain)) for chain in _chains(pieces, firsts))


def _chains(pieces: list[Edge], firsts: Iterable[int]) -> Iterator[list[Edge]]:
    """From each first piece on, whatever starts where the last one ends."""
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


def _closed(chain: list[Edge]) -> Loop:
    """The loop with each edge ending exactly where the next one starts."""
    merged = _merged(chain)
    ends = [*(edge.start for edge in merged[1:]), merged[0].start]
    return tuple(
        Edge(edge.start, end, edge.centre, edge.turn)
        for edge, end in zip(merged, ends, strict=True)
        # Where ends are brought together a piece of a few rounding errors may vanish.
        if edge.centre is not None or abs(end - edge.start) > TINY
    )


def _merged(chain: list[Edge]) -> list[Edge]:
    """The chain with edges that continue each other made one."""
    merged: list[Edge] = []
    for edge in chain:
        if merged and _continues(merged[-1], edge):
            last = merged.pop()
            merged.append(Edge(last.start, edge.end, last.centre, last.turn + edge.turn))
        else:
            merged.append(edge)
    return merged


def _continues(one: Edge, other: Edge) -> bool:
    """Whether two edges are parts of one line, or of one arc of half a turn at most."""
    if one.centre is None or other.centre is None:
        if one.centre is not other.centre:
            return False
        return abs(float(np.angle(other.along(0.0) / one.along(0.0)))) < SMOOTH
    return (
        abs(one.centre - other.centre) < SLACK
        and one.turn * other.turn > 0.0
        and abs(one.turn + other.turn) <= np.pi + SMOOTH
    )
