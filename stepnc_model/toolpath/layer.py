"""One level of an area: its passes in their order."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from stepnc_model.toolpath.area import Area
from stepnc_model.toolpath.arrays import Edges, distances
from stepnc_model.toolpath.contour import (
    TINY,
    Chain,
    Edge,
    Loop,
    chain_length,
    line,
    moved,
    reversed_chain,
    vertices,
)
from stepnc_model.toolpath.contour import area as contour_area
from stepnc_model.toolpath.cover import Pass, area_of, rings, swept
from stepnc_model.toolpath.cutter import Cutter
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.offset import erode, offset
from stepnc_model.toolpath.strokes import (
    Stroke,
    rows_at,
    scan,
    singles,
    zigzags,
)
from stepnc_model.toolpath.way import Covering, Way

RUN_OUT = 2.0
"""mm by which a face is run over where no overcut length is given"""

JUST_FITS = 1e-3
"""mm; a slot narrower than the tool by no more than this is as wide as the tool"""

LEFT_OVER = 0.01
"""mm² that strokes may leave at the wall before a pass along it is added"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Level:
    """One height, and the cutter that comes there."""

    z: float
    above: float
    """z of the material over this level"""
    cutter: Cutter
    allowance: float
    """mm left on the walls"""

    @property
    def distance(self) -> float:
        """Of the cutter's centre from the walls, mm."""
        return self.cutter.radius + self.allowance

    def touching(self, solid: Loop | None) -> tuple[Loop, ...]:
        """Boundary of where the cutter touches some material."""
        return offset(solid, -self.cutter.radius) if solid is not None else ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Layer:
    """Passes at one height, and where the cutter's centre may be between them."""

    z: float
    above: float
    """z of the material over this level"""
    passes: tuple[Pass, ...]
    loops: tuple[Loop, ...] = ()
    """boundary of where the centre may be; none where nothing is in the way"""
    solid: tuple[Loop, ...] = ()
    """boundary of where the cutter touches material; none where it does everywhere"""
    side: complex = 1j
    """free side of the passes, i for the left of the way"""


def clear(job: Job, area: Area, level: Level, way: Way) -> Layer | None:
    """Passes that clear a level; None when the cutter does not fit in."""
    if area.face is not None:
        return _face(job, area, level, way)
    boundaries = area.boundaries(level.z, level.cutter)
    loops = erode(boundaries, level.distance)
    if not loops:
        passes = _narrow(area, level, boundaries)
        if not passes:
            return None
        return Layer(
            z=level.z, above=level.above, passes=passes, solid=level.touching(area.solid)
        )
    passes = _covered(area, level, loops, way)
    side = 1j if way.is_counter_clockwise else -1j
    return Layer(
        z=level.z,
        above=level.above,
        passes=passes,
        loops=loops,
        solid=level.touching(area.solid),
        side=side,
    )


def wall_passes(area: Area, level: Level, way: Way) -> Layer | None:
    """Passes along the walls of a level; None when the cutter does not fit in."""
    boundaries = area.boundaries(level.z, level.cutter)
    if not boundaries:
        return None
    loops = erode(boundaries, level.distance)
    chains = [piece for loop in loops for piece in _along_walls(area, loop, boundaries)]
    if not way.has_wall_on_right:
        chains = [Pass(reversed_chain(each.chain), each.is_closed) for each in chains]
    if not chains:
        return None
    side = 1j if way.has_wall_on_right else -1j
    return Layer(
        z=level.z,
        above=level.above,
        passes=tuple(chains),
        loops=loops,
        solid=level.touching(area.solid),
        side=side,
    )


def _covered(area: Area, level: Level, loops: tuple[Loop, ...], way: Way) -> tuple[Pass, ...]:
    """Passes of an area with walls, as the strategy wants them."""
    radius, distance = level.cutter.radius, level.distance
    boundaries = area.boundaries(level.z, level.cutter)
    walls = tuple(_turned(Pass(loop, is_closed=True), way) for loop in loops)
    if way.covering in {Covering.DEFAULT, Covering.RINGS, Covering.SPIRAL}:
        found = rings(boundaries, distance=distance, radius=radius, step=way.step)
        ordered = found if way.is_inside_out else found[::-1]
        return tuple(_turned(each, way) for each in ordered)
    if way.covering is Covering.MIDDLE:
        middle = _middle(area, level)
        found = rings(boundaries, distance=distance, radius=radius, step=way.step)
        return (*middle, *(_turned(each, way) for each in found))
    if way.covering is Covering.WALL_THEN_STROKES:
        inner = erode(boundaries, distance + way.step)
        passes = (*walls, *_strokes(inner, way))
        left = area_of(loops).difference(swept(passes, radius)).area
        return passes if left <= LEFT_OVER else (*walls, *_strokes(loops, way))
    strokes = _strokes(loops, way)
    if way.covering is Covering.STROKES_THEN_WALL:
        return (*strokes, *walls)
    reach = area_of(loops).buffer(radius, quad_segs=32)
    left = reach.difference(swept(strokes, radius)).area
    return strokes if left <= LEFT_OVER * len(loops) else (*strokes, *walls)


def _turned(cut: Pass, way: Way) -> Pass:
    """A pass that runs around its area as the strategy wants it."""
    if way.is_counter_clockwise or not cut.is_closed:
        return cut
    return Pass(reversed_chain(cut.chain), is_closed=True)


def _strokes(loops: Sequence[Loop], way: Way) -> tuple[Pass, ...]:
    """Strokes over an area."""
    rows = scan(loops, along=way.along, step=way.step)
    return _joined(rows, loops, way)


def _joined(rows: list[list[Stroke]], loops: Sequence[Loop], way: Way) -> tuple[Pass, ...]:
    """Rows in the order of the strategy, one way or to and fro."""
    ordered = rows if way.steps_left else rows[::-1]
    is_single = way.covering is Covering.ONE_WAY or way.is_lifted
    if not is_single:
        return zigzags(ordered, loops)
    passes = singles(ordered)
    if way.covering is Covering.ONE_WAY:
        return passes
    return tuple(
        each if index % 2 == 0 else Pass(reversed_chain(each.chain), is_closed=False)
        for index, each in enumerate(passes)
    )


def _face(job: Job, area: Area, level: Level, way: Way) -> Layer:
    """Passes over a face, the tool running over its edge."""
    face = area.face
    assert face is not None
    radius, distance = level.cutter.radius, level.distance
    overcut = getattr(job.step.operation, "overcut_length", None)
    beyond = radius + (RUN_OUT if overcut is None else overcut)
    islands = area.boundaries(level.z, level.cutter)
    if way.covering in {Covering.RINGS, Covering.SPIRAL}:
        walls = (*offset(face, -distance), *islands)
        found = rings(walls, distance=distance, radius=radius, step=way.step)
        ordered = found if way.is_inside_out else found[::-1]
        passes = tuple(_turned(each, way) for each in ordered)
        loops = erode(walls, distance)
        return Layer(
            z=level.z,
            above=level.above,
            passes=passes,
            loops=loops,
            solid=level.touching(area.solid),
        )
    loops = erode((*offset(face, -beyond - distance), *islands), distance)
    rows = rows_at(loops, _rows(face, way, radius), along=way.along)
    passes = _joined(rows, loops, way)
    if islands:
        around = [loop for loop in loops if contour_area(loop) < 0.0]
        passes = (*passes, *(_turned(Pass(loop, is_closed=True), way) for loop in around))
    return Layer(
        z=level.z,
        above=level.above,
        passes=passes,
        loops=loops,
        solid=level.touching(area.solid),
    )


def _rows(face: Loop, way: Way, radius: float) -> list[float]:
    """Places of the strokes across a face: full steps, overhanging equally on both sides."""
    turned = moved(face, turned=way.along.conjugate())
    heights = [point.imag for point in vertices(turned, tolerance=1e-3)]
    low, high = min(heights), max(heights)
    count = max(1, ceil((high - low - 2.0 * radius) / way.step - TINY) + 1)
    first = 0.5 * (low + high) - 0.5 * (count - 1) * way.step
    return [first + index * way.step for index in range(count)]


def _narrow(area: Area, level: Level, boundaries: Sequence[Loop]) -> tuple[Pass, ...]:
    """One pass where the cutter just fits; none where it does not."""
    loops = erode(boundaries, level.distance - JUST_FITS)
    if not loops:
        return ()
    middle = _middle(area, level)
    return middle or tuple(Pass(loop, is_closed=True) for loop in loops)


def _middle(area: Area, level: Level) -> tuple[Pass, ...]:
    """The centre line of a slot, run out at open ends and short of the walls at others."""
    middle = area.middle
    if middle is None:
        return ()
    if abs(middle[-1].end - middle[0].start) < 1e-6:
        return (Pass(middle, is_closed=True),)
    edges = [edge for wall in area.walls for edge in wall.loop]
    chain = list(middle)
    chain = _fitted(chain, edges, level)
    chain = list(
        reversed_chain(tuple(_fitted(list(reversed_chain(tuple(chain))), edges, level)))
    )
    return (Pass(tuple(chain), is_closed=False),)


def _fitted(chain: list[Edge], edges: list[Edge], level: Level) -> list[Edge]:
    """The chain with its start moved along it to where the cutter touches the end wall."""
    first = chain[0]
    ahead = -first.along(0.0)
    caps = [edge for edge in edges if abs((edge.at(0.5) - first.start) / ahead) > 0.0]
    # Distance from the start to what closes the slot there, straight ahead.
    gaps = [
        ((edge.at(0.5) - first.start) / ahead).real
        for edge in caps
        if abs(((edge.at(0.5) - first.start) / ahead).imag) < 1e-6 * max(level.distance, 1.0)
    ]
    gap = min((value for value in gaps if value > -TINY), default=0.0)
    shift = gap - level.distance
    if shift > TINY:
        return [line(first.start + shift * ahead, first.start), *chain]
    if shift < -TINY and -shift < first.length:
        return [first.between(-shift / first.length, 1.0), *chain[1:]]
    return chain


def _along_walls(area: Area, loop: Loop, boundaries: Sequence[Loop]) -> list[Pass]:
    """A ring without the parts of it that follow no wall, beyond an open side."""
    outside = area.outside
    if not outside:
        return [Pass(loop, is_closed=True)]
    middles = np.array([edge.at(0.5) for edge in loop], dtype=complex)
    walls = [edge for each in boundaries for edge in each]
    is_wall = (
        distances(middles, Edges.of(outside))
        > distances(middles, Edges.of(walls)) + _inset(boundaries, area) + 1e-6
    )
    if is_wall.all():
        return [Pass(loop, is_closed=True)]
    # Start behind a part that follows no wall, so that no chain is cut in two.
    first = int(np.flatnonzero(~is_wall)[-1]) + 1
    chains: list[list[Edge]] = [[]]
    for index in range(len(loop)):
        at = (first + index) % len(loop)
        if is_wall[at]:
            chains[-1].append(loop[at])
        elif chains[-1]:
            chains.append([])
    return [
        Pass(tuple(chain), is_closed=False)
        for chain in chains
        if chain and chain_length(chain) > 1e-3
    ]


def _inset(boundaries: Sequence[Loop], area: Area) -> float:
    """How far the first wall has moved in at this level, mm."""
    loop: Chain = area.walls[0].loop
    point = boundaries[0][0].at(0.5)
    return float(distances(np.array([point]), Edges.of(loop))[0])
