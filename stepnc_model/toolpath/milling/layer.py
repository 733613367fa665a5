"""One level of an area: its passes in their order."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from stepnc_model.toolpath.curve import JOINED
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.milling.area import Area, upright
from stepnc_model.toolpath.milling.arrays import Edges, distances
from stepnc_model.toolpath.milling.contour import (
    TINY,
    Chain,
    Edge,
    Loop,
    chain_length,
    moved,
    reversed_chain,
    stretched,
    vertices,
)
from stepnc_model.toolpath.milling.contour import area as contour_area
from stepnc_model.toolpath.milling.cover import Pass, area_of, rings, swept
from stepnc_model.toolpath.milling.cutter import Cutter, run_out
from stepnc_model.toolpath.milling.offset import erode, offset
from stepnc_model.toolpath.milling.room import Room, nowhere, within
from stepnc_model.toolpath.milling.spiral import spirals
from stepnc_model.toolpath.milling.strokes import Stroke, rows_at, scan, singles, zigzags
from stepnc_model.toolpath.milling.way import Covering, Way

JUST_FITS = 1e-3
"""mm; a slot narrower than the tool by no more than this is as wide as the tool"""

LEFT_OVER = 0.01
"""mm² that strokes may leave at the wall before a pass along it is added"""


MOST_ROWS = 10_000
"""strokes over one face; more is a slip of the pen"""


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
    room: Room
    loops: tuple[Loop, ...] = ()
    """boundary of where the centre may be, when it is known"""
    solid: tuple[Loop, ...] = ()
    """boundary of where the cutter touches material; none where it does everywhere"""
    is_from_outside: bool = False
    """every pass begins and ends beside the part, straight down and up"""


def clear(job: Job, area: Area, level: Level, way: Way) -> Layer | None:
    """Passes that clear a level; None when the cutter does not fit in."""
    if area.face is not None:
        return _face(job, area, level, way)
    boundaries = area.boundaries(level.z, level.cutter)
    loops = erode(boundaries, level.distance)
    if loops:
        passes = _covered(area, level, boundaries, loops, way)
    else:
        passes = _narrow(area, level, boundaries)
    return _layer(area, level, passes, loops, is_left=way.is_counter_clockwise)


def wall_passes(area: Area, level: Level, way: Way) -> Layer | None:
    """Passes along the walls of a level; None when the cutter does not fit in."""
    boundaries = area.boundaries(level.z, level.cutter)
    loops = erode(boundaries, level.distance)
    if loops:
        passes = tuple(each for loop in loops for each in _along_walls(area, loop, boundaries))
    else:
        passes = _narrow(area, level, boundaries)
    if not way.has_wall_on_right:
        passes = tuple(Pass(reversed_chain(cut.chain), cut.is_closed) for cut in passes)
    return _layer(area, level, passes, loops, is_left=way.has_wall_on_right)


def _layer(
    area: Area,
    level: Level,
    passes: tuple[Pass, ...],
    loops: tuple[Loop, ...],
    *,
    is_left: bool,
) -> Layer | None:
    """The passes with the room around them, free on their left or on their right."""
    if not passes:
        return None
    return Layer(
        z=level.z,
        above=level.above,
        passes=passes,
        room=Room(clearance=within(loops) if loops else nowhere, side=1j if is_left else -1j),
        loops=loops,
        solid=level.touching(area.solid),
    )


def _covered(
    area: Area,
    level: Level,
    boundaries: tuple[Loop, ...],
    loops: tuple[Loop, ...],
    way: Way,
) -> tuple[Pass, ...]:
    """Passes of an area with walls, as the strategy wants them."""
    radius = level.cutter.radius
    walls = tuple(_turned(Pass(loop, is_closed=True), way) for loop in loops)
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
    boundaries: tuple[Loop, ...], level: Level, loops: tuple[Loop, ...], way: Way
) -> tuple[Pass, ...]:
    """Rings within rings, in the order and the sense of the strategy."""
    radius = level.cutter.radius
    found = rings(boundaries, distance=level.distance, radius=radius, step=way.step)
    ordered = [_turned(each, way) for each in (found if way.is_inside_out else found[::-1])]
    if way.covering is Covering.SPIRAL:
        return spirals(ordered, loops, step=way.step)
    return tuple(ordered)


def _turned(cut: Pass, way: Way) -> Pass:
    """A pass that runs around its area as the strategy wants it."""
    if way.is_counter_clockwise or not cut.is_closed:
        return cut
    return Pass(reversed_chain(cut.chain), is_closed=True)


def _strokes(loops: Sequence[Loop], way: Way) -> tuple[Pass, ...]:
    """Strokes over an area."""
    return _joined(scan(loops, along=way.along, step=way.step), loops, way)


def _joined(rows: list[list[Stroke]], loops: Sequence[Loop], way: Way) -> tuple[Pass, ...]:
    """Rows in the order of the strategy, one way or to and fro."""
    ordered = rows if way.steps_left else rows[::-1]
    if not way.is_lifted:
        return zigzags(ordered, loops)
    passes = singles(ordered)
    if way.covering is Covering.ONE_WAY:
        return passes
    return tuple(
        each if index % 2 == 0 else Pass(reversed_chain(each.chain), is_closed=False)
        for index, each in enumerate(passes)
    )


def _face(job: Job, area: Area, level: Level, way: Way) -> Layer | None:
    """Passes over a face, the tool running over its edge."""
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
        passes = (*passes, *(_turned(Pass(loop, is_closed=True), way) for loop in around))
    return _layer(area, level, passes, loops, is_left=way.is_counter_clockwise)


def _rows(job: Job, face: Loop, way: Way, radius: float) -> list[float]:
    """Places of the strokes across a face: full steps, overhanging equally on both sides."""
    turned = moved(face, turned=way.along.conjugate())
    heights = [point.imag for point in vertices(turned, tolerance=1e-3)]
    low, high = min(heights), max(heights)
    count = max(1, ceil((high - low - 2.0 * radius) / way.step - TINY) + 1)
    if count > MOST_ROWS:
        raise job.fault(
            f"steps of {way.step:g} mm make {count} strokes: {MOST_ROWS} at most",
            job.step.operation_ref,
        )
    first = 0.5 * (low + high) - 0.5 * (count - 1) * way.step
    return [first + index * way.step for index in range(count)]


def _narrow(area: Area, level: Level, boundaries: tuple[Loop, ...]) -> tuple[Pass, ...]:
    """One pass where the cutter just fits; none where it does not."""
    loops = erode(boundaries, level.distance - JUST_FITS)
    if not loops:
        return ()
    middle = _middle(area, level, boundaries)
    return middle or tuple(Pass(loop, is_closed=True) for loop in loops)


def _middle(area: Area, level: Level, boundaries: tuple[Loop, ...]) -> tuple[Pass, ...]:
    """The centre line of a slot, run out at open ends and short of the walls at others."""
    middle = area.middle
    if middle is None:
        return ()
    if abs(middle[-1].end - middle[0].start) < JOINED:
        return (Pass(middle, is_closed=True),)
    short = level.distance + _inset(boundaries, area)
    first, last = (
        end - short - rise(level.z - area.bottom)
        for end, rise in zip(area.ends, area.rises or (upright, upright), strict=True)
    )
    chain = stretched(middle, first, last)
    return (Pass(chain, is_closed=False),) if chain else ()


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
