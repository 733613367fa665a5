"""Room around a pass: where the centre of the cutter may be on its way there and away."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import inf

import numpy as np
import shapely

from stepnc_model.toolpath.milling.arrays import Edges, distances
from stepnc_model.toolpath.milling.contour import REMEMBERED, Chain, Edge, Loop
from stepnc_model.toolpath.milling.cover import area_of

CHORD = 1e-4
"""mm of tolerance where a point is looked for in an area"""

HAIR = CHORD
"""mm; a point nearer to the boundary than this lies on it: chords cannot tell"""

SHORTEST = 0.02
"""mm; between points of a way so close it cannot come nearer by more than a hair"""

Clearance = Callable[[complex], float]
"""how far a point lies from the boundary of the room, mm; negative outside"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Room:
    """Where the centre of the cutter may be."""

    clearance: Clearance
    side: complex = 1j
    """i when the free side is on the left of the way, -i when it is on the right"""

    def holds(self, chain: Chain) -> bool:
        """Whether a way stays within."""
        return all(self._holds(edge) for edge in chain)

    def _holds(self, edge: Edge) -> bool:
        """The clearance changes by no more than the way: halves until that settles it."""
        parts = [(0.0, 1.0)]
        while parts:
            low, high = parts.pop()
            middle, size = 0.5 * (low + high), (high - low) * edge.length
            gap = self.clearance(edge.at(middle))
            if gap < -HAIR:
                return False
            if gap < 0.5 * size and size > SHORTEST:
                parts += [(low, middle), (middle, high)]
        return all(self.clearance(point) >= -HAIR for point in (edge.start, edge.end))

    def holds_circle(self, centre: complex, radius: float) -> bool:
        """Whether a circle lies within."""
        return self.clearance(centre) >= radius - HAIR


def nowhere(_point: complex) -> float:
    """No room beside the pass: the cutter is as wide as its slot."""
    return -inf


def within(loops: Sequence[Loop]) -> Clearance:
    """Room that lies on the left of loops."""
    return _within(tuple(loops))


@lru_cache(maxsize=REMEMBERED)
def _within(loops: tuple[Loop, ...]) -> Clearance:
    """The same of loops that can be remembered."""
    edges = Edges.of([edge for loop in loops for edge in loop])
    area = area_of(loops, tolerance=CHORD)
    shapely.prepare(area)

    def clearance(point: complex) -> float:
        gap = float(distances(np.array([point]), edges)[0])
        is_inside = gap <= HAIR or shapely.contains_xy(area, point.real, point.imag)
        return gap if is_inside else -gap

    return clearance


def beside(wall: Chain, distance: float) -> Clearance:
    """Room that keeps a distance from a wall."""
    edges = Edges.of(wall)
    return lambda point: float(distances(np.array([point]), edges)[0]) - distance
