"""Plane contours of lines and exact arcs, as complex numbers x + iy, mm.

A loop is closed and bounds the area on its left: outer boundaries run counter-clockwise,
islands clockwise. Arcs turn through π at most; longer arcs are halved on input.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from math import ceil, pi

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import Polygon

from stepnc_model.toolpath.arc import chord_angle

Floats = NDArray[np.float64]
Points = NDArray[np.complex128]

TINY = 1e-9
"""Distance below which two points are the same, mm."""

REMEMBERED = 256
"""Number of cached results per function of contours: levels of a pocket are alike."""


@dataclass(frozen=True, slots=True)
class ContourEdge:
    """Line, or an arc if it has a centre, of a plane contour."""

    start: complex
    end: complex
    centre: complex | None = None
    turn: float = 0.0
    """Angle of the arc, rad, positive counter-clockwise."""

    @property
    def length(self) -> float:
        """Length of the edge, mm."""
        if self.centre is None:
            return abs(self.end - self.start)
        return abs(self.turn) * abs(self.start - self.centre)

    def at(self, part: float) -> complex:
        """Point at a fraction of the length, 0 to 1."""
        if self.centre is None:
            return self.start + part * (self.end - self.start)
        return self.centre + (self.start - self.centre) * _turned(part * self.turn)

    def along(self, part: float) -> complex:
        """Unit tangent vector at a fraction of the length."""
        if self.centre is None:
            way = self.end - self.start
            return way / abs(way)
        outward = self.at(part) - self.centre
        return outward / abs(outward) * (1j if self.turn > 0.0 else -1j)

    def between(self, low: float, high: float) -> "ContourEdge":
        """Piece between two fractions of the length; ends of the edge are kept exactly."""
        return ContourEdge(
            start=self.start if low <= 0.0 else self.at(low),
            end=self.end if high >= 1.0 else self.at(high),
            centre=self.centre,
            turn=self.turn * (high - low),
        )

    def reversed(self) -> "ContourEdge":
        """Edge traversed in the opposite direction."""
        return ContourEdge(start=self.end, end=self.start, centre=self.centre, turn=-self.turn)


Chain = tuple[ContourEdge, ...]
"""Chain of edges, each starting where the previous one ends."""

Loop = Chain
"""Closed chain of edges."""


def line(start: complex, end: complex) -> ContourEdge:
    """Straight edge between two points."""
    return ContourEdge(start, end)


def circle(centre: complex, radius: float) -> Loop:
    """Counter-clockwise circle as two half circles."""
    right, left = centre + radius, centre - radius
    return (ContourEdge(right, left, centre, pi), ContourEdge(left, right, centre, pi))


def polygon(points: Sequence[complex]) -> Loop:
    """Closed loop of straight edges through the points."""
    ends = [*points[1:], points[0]]
    return tuple(line(a, b) for a, b in zip(points, ends, strict=True) if abs(a - b) > TINY)


def halved(chain: Iterable[ContourEdge]) -> Chain:
    """Split arcs of a chain so that none is longer than half a turn."""
    found: list[ContourEdge] = []
    for edge in chain:
        count = max(1, ceil(abs(edge.turn) / pi - TINY))
        parts = [i / count for i in range(count + 1)]
        found += [edge.between(a, b) for a, b in pairwise(parts)]
    return tuple(found)


def reversed_chain(chain: Chain) -> Chain:
    """Chain traversed in the opposite direction."""
    return tuple(edge.reversed() for edge in reversed(chain))


def chain_length(chain: Iterable[ContourEdge]) -> float:
    """Length of a chain, mm."""
    return sum(edge.length for edge in chain)


def divided(chain: Chain, length: float) -> tuple[Chain, Chain]:
    """Split a chain after a length in mm into its first part and the rest."""
    for index, edge in enumerate(chain):
        if length < edge.length:
            part = max(length, 0.0) / edge.length
            cut = (edge.between(0.0, part), edge.between(part, 1.0))
            head, tail = (tuple(each for each in (one,) if each.length > TINY) for one in cut)
            return (*chain[:index], *head), (*tail, *chain[index + 1 :])
        length -= edge.length
    return chain, ()


def stretched(chain: Chain, before: float, after: float) -> Chain:
    """Extend a chain straight at its start and end, or shorten it where negative, mm."""
    total = chain_length(chain)
    if max(-before, 0.0) + max(-after, 0.0) >= total - TINY:
        return ()
    kept = divided(divided(chain, total + min(after, 0.0))[0], -min(before, 0.0))[1]
    first, last = kept[0], kept[-1]
    if before > TINY:
        kept = (line(first.start - before * first.along(0.0), first.start), *kept)
    if after > TINY:
        kept = (*kept, line(last.end, last.end + after * last.along(1.0)))
    return kept


def area(loop: Loop) -> float:
    """Area on the left of a loop, mm²; negative if clockwise (Green's theorem)."""
    total = 0.0
    for edge in loop:
        total += 0.5 * (edge.start.conjugate() * edge.end).imag
        if edge.centre is not None:
            radius = abs(edge.start - edge.centre)
            total += 0.5 * radius**2 * (edge.turn - np.sin(edge.turn))
    return float(total)


def counter_clockwise(loop: Loop) -> Loop:
    """Loop in counter-clockwise direction."""
    return loop if area(loop) >= 0.0 else reversed_chain(loop)


def clockwise(loop: Loop) -> Loop:
    """Loop in clockwise direction, as the boundary of an island."""
    return reversed_chain(counter_clockwise(loop))


def vertices(chain: Chain, *, tolerance: float) -> list[complex]:
    """Points along a chain with chords within a tolerance in mm, without its last end."""
    points: list[complex] = []
    for edge in chain:
        count = 1
        if edge.centre is not None:
            step = chord_angle(abs(edge.start - edge.centre), tolerance)
            count = max(1, ceil(abs(edge.turn) / step))
        points += [edge.at(i / count) for i in range(count)]
    return points


def shape(loop: Loop, *, tolerance: float) -> Polygon:
    """Area of a loop as a polygon, with chords within a tolerance in mm."""
    return _shape(tuple(loop), tolerance)


@lru_cache(maxsize=REMEMBERED)
def _shape(loop: Loop, tolerance: float) -> Polygon:
    """Polygon of a loop, cached; implementation of ``shape``."""
    points = np.array(vertices(loop, tolerance=tolerance), dtype=complex)
    return shapely.polygons(np.column_stack((points.real, points.imag)))


def moved(chain: Chain, *, by: complex = 0j, turned: complex = 1 + 0j) -> Chain:
    """Rotate a chain about the origin by a unit complex number, then translate it."""
    return tuple(
        replace(
            edge,
            start=edge.start * turned + by,
            end=edge.end * turned + by,
            centre=None if edge.centre is None else edge.centre * turned + by,
        )
        for edge in chain
    )


def rotated_to(loop: Loop, near: complex) -> Loop:
    """Loop that starts at its point nearest to a given point."""
    index, part = nearest(loop, near)
    edge = loop[index]
    if part * edge.length < TINY:
        return (*loop[index:], *loop[:index])
    if (1.0 - part) * edge.length < TINY:
        return (*loop[index + 1 :], *loop[: index + 1])
    return (edge.between(part, 1.0), *loop[index + 1 :], *loop[:index], edge.between(0.0, part))


def nearest(chain: Chain, point: complex) -> tuple[int, float]:
    """Edge index and fraction of its length where a chain is nearest to a point."""
    parts = [_foot(edge, point) for edge in chain]
    distances = [abs(edge.at(part) - point) for edge, part in zip(chain, parts, strict=True)]
    index = min(range(len(chain)), key=distances.__getitem__)
    return index, parts[index]


def _foot(edge: ContourEdge, point: complex) -> float:
    """Fraction of an edge's length nearest to a point."""
    if edge.centre is None:
        way = edge.end - edge.start
        return min(1.0, max(0.0, ((point - edge.start) / way).real))
    spoke = (point - edge.centre) / (edge.start - edge.centre)
    if abs(spoke) < TINY:
        return 0.0
    turned = float(np.angle(spoke)) * (1.0 if edge.turn > 0.0 else -1.0)
    part = (turned % (2.0 * pi)) / abs(edge.turn)
    if part <= 1.0:
        return part
    return 0.0 if abs(point - edge.start) <= abs(point - edge.end) else 1.0


def _turned(angle: float) -> complex:
    return complex(np.cos(angle), np.sin(angle))
