"""Ordered passes at one level of a milling area, and the room for the cutter's centre."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, inf

import numpy as np
import shapely

from stepnc_model.toolpath.curve import JOINED
from stepnc_model.toolpath.milling.contour import (
    REMEMBERED,
    TINY,
    Chain,
    ContourEdge,
    Loop,
    chain_length,
    moved,
    reversed_chain,
    stretched,
    vertices,
)
from stepnc_model.toolpath.milling.contour import area as contour_area
from stepnc_model.toolpath.milling.cover import (
    Area,
    MillingPass,
    area_of,
    rings,
    swept,
    upright,
)
from stepnc_model.toolpath.milling.offset import ContourEdges, distances, erode, offset
from stepnc_model.toolpath.milling.strategy import (
    Covering,
    EndMillShape,
    ResolvedStrategy,
    run_out,
)
from stepnc_model.toolpath.milling.strokes import (
    Stroke,
    rows_at,
    scan,
    singles,
    spirals,
    zigzags,
)
from stepnc_model.toolpath.task import ToolPathTask

CHORD = 1e-4
"""Chord tolerance for testing whether a point lies in an area, mm."""

HAIR = CHORD
"""Distance from the boundary, mm, within which a point counts as on it."""

SHORTEST = 0.02
"""Path length, mm, below which the clearance test is not refined further."""

Clearance = Callable[[complex], float]
"""Distance of a point from the boundary of the allowed area, mm; negative outside."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CentreArea:
    """Area in which the cutter's centre may move."""

    clearance: Clearance
    side: complex = 1j
    """Side of the path that is free: i for the left, -i for the right."""

    def holds(self, chain: Chain) -> bool:
        """True if a path of the cutter's centre stays within the area."""
        return all(self._holds(edge) for edge in chain)

    def _holds(self, edge: ContourEdge) -> bool:
        """True if an edge stays inside, by bisection with the clearance at midpoints."""
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
        """True if a circle lies within the area."""
        return self.clearance(centre) >= radius - HAIR


def nowhere(_point: complex) -> float:
    """Clearance function without any room: the cutter is as wide as its slot."""
    return -inf


def within(loops: Sequence[Loop]) -> Clearance:
    """Clearance function of the area on the left of loops."""
    return _within(tuple(loops))


@lru_cache(maxsize=REMEMBERED)
def _within(loops: tuple[Loop, ...]) -> Clearance:
    """Clearance function, cached; implementation of ``within``."""
    edges = ContourEdges.of([edge for loop in loops for edge in loop])
    area = area_of(loops, tolerance=CHORD)
    shapely.prepare(area)

    def clearance(point: complex) -> float:
        gap = float(distances(np.array([point]), edges)[0])
        is_inside = gap <= HAIR or shapely.contains_xy(area, point.real, point.imag)
        return gap if is_inside else -gap

    return clearance


def clearance_from_wall(wall: Chain, distance: float) -> Clearance:
    """Clearance function of the region at least a distance away from a wall."""
    edges = ContourEdges.of(wall)
    return lambda point: float(distances(np.array([point]), edges)[0]) - distance


JUST_FITS = 1e-3
"""Amount, mm, by which a slot may be narrower than the tool and still count as equal."""

LEFT_OVER = 0.01
"""Area that strokes may leave at the wall before a pass along it is added, mm²."""


MOST_ROWS = 10_000
"""Greatest number of strokes over one face."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CutLevel:
    """Level of a milling area and the cutter that reaches it."""

    z: float
    above: float
    """Height z of the material above this level, mm."""
    cutter: EndMillShape
    allowance: float
    """Allowance left on the walls, mm."""

    @property
    def distance(self) -> float:
        """Distance of the cutter's centre from the walls, mm."""
        return self.cutter.radius + self.allowance

    def touching(self, solid: Loop | None) -> tuple[Loop, ...]:
        """Boundary of the region where the cutter touches the given material."""
        return offset(solid, -self.cutter.radius) if solid is not None else ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Layer:
    """Passes at one height, and the room for the cutter's centre between them."""

    z: float
    above: float
    """Height z of the material above this level, mm."""
    passes: tuple[MillingPass, ...]
    room: CentreArea
    loops: tuple[Loop, ...] = ()
    """Boundary of the area for the cutter's centre, where known."""
    solid: tuple[Loop, ...] = ()
    """Boundary of the region where the cutter meets material; empty if it does everywhere."""
    is_from_outside: bool = False
    """Whether every pass begins and ends beside the part, straight down and up."""


def clear(
    job: ToolPathTask, area: Area, level: CutLevel, way: ResolvedStrategy
) -> Layer | None:
    """Passes that clear a level; None if the cutter does not fit."""
    if area.face is not None:
        return _face(job, area, level, way)
    boundaries = area.boundaries(level.z, level.cutter)
    loops = erode(boundaries, level.distance)
    if loops:
        passes = _covered(area, level, boundaries, loops, way)
    else:
        passes = _narrow(area, level, boundaries)
    return _layer(area, level, passes, loops, is_left=way.is_counter_clockwise)


def wall_passes(area: Area, level: CutLevel, way: ResolvedStrategy) -> Layer | None:
    """Passes along the walls of a level; None if the cutter does not fit."""
    boundaries = area.boundaries(level.z, level.cutter)
    loops = erode(boundaries, level.distance)
    if loops:
        passes = tuple(each for loop in loops for each in _along_walls(area, loop, boundaries))
    else:
        passes = _narrow(area, level, boundaries)
    if not way.has_wall_on_right:
        passes = tuple(MillingPass(reversed_chain(cut.chain), cut.is_closed) for cut in passes)
    return _layer(area, level, passes, loops, is_left=way.has_wall_on_right)


def _layer(
    area: Area,
    level: CutLevel,
    passes: tuple[MillingPass, ...],
    loops: tuple[Loop, ...],
    *,
    is_left: bool,
) -> Layer | None:
    """Layer of passes with the room around them, free on their left or right."""
    if not passes:
        return None
    return Layer(
        z=level.z,
        above=level.above,
        passes=passes,
        room=CentreArea(
            clearance=within(loops) if loops else nowhere, side=1j if is_left else -1j
        ),
        loops=loops,
        solid=level.touching(area.solid),
    )


def _covered(
    area: Area,
    level: CutLevel,
    boundaries: tuple[Loop, ...],
    loops: tuple[Loop, ...],
    way: ResolvedStrategy,
) -> tuple[MillingPass, ...]:
    """Passes over an area with walls, in the pattern of the strategy."""
    radius = level.cutter.radius
    walls = tuple(_turned(MillingPass(loop, is_closed=True), way) for loop in loops)
    if way.covering in {Covering.DEFAULT, Covering.RINGS, Covering.SPIRAL}:
        return _rings(boundaries, level, loops, way)
    if way.covering is Covering.MIDDLE:
        return (*_middle(area, level, boundaries), *_rings(boundaries, level, loops, way))
    if way.covering is Covering.WALL_THEN_STROKES:
        passes = (*walls, *_strokes(erode(boundaries, level.distance + way.step), way))
        left = area_of(loops).difference(swept(passes, radius)).area
        return passes if left <= LEFT_OVER else (*walls, *_strokes(loops, way))
    strokes = _strokes(loops, way)
    if way.covering is Covering.STROKES_THEN_WALL:
        return (*strokes, *walls)
    reach = area_of(loops).buffer(radius, quad_segs=32)
    left = reach.difference(swept(strokes, radius)).area
    return strokes if left <= LEFT_OVER * len(loops) else (*strokes, *walls)


def _rings(
    boundaries: tuple[Loop, ...],
    level: CutLevel,
    loops: tuple[Loop, ...],
    way: ResolvedStrategy,
) -> tuple[MillingPass, ...]:
    """Contour-parallel rings, in the order and direction of the strategy."""
    radius = level.cutter.radius
    found = rings(boundaries, distance=level.distance, radius=radius, step=way.step)
    ordered = [_turned(each, way) for each in (found if way.is_inside_out else found[::-1])]
    if way.covering is Covering.SPIRAL:
        return spirals(ordered, loops, step=way.step)
    return tuple(ordered)


def _turned(cut: MillingPass, way: ResolvedStrategy) -> MillingPass:
    """Orient a closed pass in the direction of the strategy."""
    if way.is_counter_clockwise or not cut.is_closed:
        return cut
    return MillingPass(reversed_chain(cut.chain), is_closed=True)


def _strokes(loops: Sequence[Loop], way: ResolvedStrategy) -> tuple[MillingPass, ...]:
    """Strokes over an area in the order of the strategy."""
    return _joined(scan(loops, along=way.along, step=way.step), loops, way)


def _joined(
    rows: list[list[Stroke]], loops: Sequence[Loop], way: ResolvedStrategy
) -> tuple[MillingPass, ...]:
    """Rows of strokes in the order of the strategy, one way or to and fro."""
    ordered = rows if way.steps_left else rows[::-1]
    if not way.is_lifted:
        return zigzags(ordered, loops)
    passes = singles(ordered)
    if way.covering is Covering.ONE_WAY:
        return passes
    return tuple(
        each if index % 2 == 0 else MillingPass(reversed_chain(each.chain), is_closed=False)
        for index, each in enumerate(passes)
    )


def _face(
    job: ToolPathTask, area: Area, level: CutLevel, way: ResolvedStrategy
) -> Layer | None:
    """Passes over a face, with the tool running over its edge."""
    face = area.face
    assert face is not None
    radius, distance = level.cutter.radius, level.distance
    islands = area.boundaries(level.z, level.cutter)
    if way.covering in {Covering.RINGS, Covering.SPIRAL}:
        walls = (*offset(face, -distance), *islands)
        loops = erode(walls, distance)
        passes = _rings(walls, level, loops, way)
    else:
        walls = (*offset(face, -radius - run_out(job) - distance), *islands)
        loops = erode(walls, distance)
        passes = _joined(
            rows_at(loops, _rows(job, face, way, radius), along=way.along), loops, way
        )
        around = [loop for loop in loops if contour_area(loop) < 0.0]
        passes = (
            *passes,
            *(_turned(MillingPass(loop, is_closed=True), way) for loop in around),
        )
    return _layer(area, level, passes, loops, is_left=way.is_counter_clockwise)


def _rows(job: ToolPathTask, face: Loop, way: ResolvedStrategy, radius: float) -> list[float]:
    """Positions of the strokes across a face: full steps, overhanging equally on both sides."""
    turned = moved(face, turned=way.along.conjugate())
    heights = [point.imag for point in vertices(turned, tolerance=1e-3)]
    low, high = min(heights), max(heights)
    count = max(1, ceil((high - low - 2.0 * radius) / way.step - TINY) + 1)
    if count > MOST_ROWS:
        raise job.fault(
            f"steps of {way.step:g} mm need {count} strokes: at most {MOST_ROWS} are allowed",
            job.step.operation_ref,
        )
    first = 0.5 * (low + high) - 0.5 * (count - 1) * way.step
    return [first + index * way.step for index in range(count)]


def _narrow(
    area: Area, level: CutLevel, boundaries: tuple[Loop, ...]
) -> tuple[MillingPass, ...]:
    """One pass where the cutter just fits; empty where it does not."""
    loops = erode(boundaries, level.distance - JUST_FITS)
    if not loops:
        return ()
    middle = _middle(area, level, boundaries)
    return middle or tuple(MillingPass(loop, is_closed=True) for loop in loops)


def _middle(
    area: Area, level: CutLevel, boundaries: tuple[Loop, ...]
) -> tuple[MillingPass, ...]:
    """Centre line of a slot, extended at open ends and short of the walls at closed ends."""
    middle = area.middle
    if middle is None:
        return ()
    if abs(middle[-1].end - middle[0].start) < JOINED:
        return (MillingPass(middle, is_closed=True),)
    short = level.distance + _inset(boundaries, area)
    first, last = (
        end - short - rise(level.z - area.bottom)
        for end, rise in zip(area.ends, area.rises or (upright, upright), strict=True)
    )
    chain = stretched(middle, first, last)
    return (MillingPass(chain, is_closed=False),) if chain else ()


def _along_walls(area: Area, loop: Loop, boundaries: Sequence[Loop]) -> list[MillingPass]:
    """Parts of a ring that follow a wall, without those beyond an open side."""
    outside = area.outside
    if not outside:
        return [MillingPass(loop, is_closed=True)]
    middles = np.array([edge.at(0.5) for edge in loop], dtype=complex)
    walls = [edge for each in boundaries for edge in each]
    is_wall = (
        distances(middles, ContourEdges.of(outside))
        > distances(middles, ContourEdges.of(walls)) + _inset(boundaries, area) + 1e-6
    )
    if is_wall.all():
        return [MillingPass(loop, is_closed=True)]
    # Start behind a part that follows no wall, so that no chain is split in two.
    first = int(np.flatnonzero(~is_wall)[-1]) + 1
    chains: list[list[ContourEdge]] = [[]]
    for index in range(len(loop)):
        at = (first + index) % len(loop)
        if is_wall[at]:
            chains[-1].append(loop[at])
        elif chains[-1]:
            chains.append([])
    return [
        MillingPass(tuple(chain), is_closed=False)
        for chain in chains
        if chain and chain_length(chain) > 1e-3
    ]


def _inset(boundaries: Sequence[Loop], area: Area) -> float:
    """Inset of the first wall at this level, mm."""
    loop: Chain = area.walls[0].loop
    point = boundaries[0][0].at(0.5)
    return float(distances(np.array([point]), ContourEdges.of(loop))[0])
