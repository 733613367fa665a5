"""How the tool comes down to a pass and how it leaves it (ISO 14649-11 approach and retract).

Plunges go down to the level of a pass: along the tool's axis, down a ramp along the pass
itself, down a helix, or to and fro. Air strategies come down beside the pass and meet it along
an arc or a straight line. What does not fit is replaced by what does, and said.
"""

from cmath import rect
from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, pi, tan

from stepnc_model.entities.approach import (
    AlongPath,
    ApRetractAngle,
    ApRetractTangent,
    PlungeHelix,
    PlungeRamp,
    PlungeZigzag,
)
from stepnc_model.entities.entity import Entity
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.contour import (
    TINY,
    Chain,
    Edge,
    Loop,
    chain_length,
    line,
    nearest,
    reversed_chain,
)
from stepnc_model.toolpath.course import Course
from stepnc_model.toolpath.cover import Pass
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.path import MoveType, Point
from stepnc_model.toolpath.strokes import contains_point
from stepnc_model.units import rad_from_deg

STEEPEST_DEG = 89.0
"""degrees; a steeper ramp is a plunge"""

HELIX_TRIES = 4
"""times that the radius of a helix that does not fit is halved"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Heights:
    """Heights in the setup, mm, from the highest to the lowest."""

    travel: float
    """above all material: the tool moves sideways in rapid"""
    retract: float
    """the retract plane of the operation; down to here in rapid"""
    above: float
    """just above the material of this level"""
    level: float
    """of the pass"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Room:
    """Where the tool's centre may be around a pass."""

    loops: Sequence[Loop]
    """boundary; none where there is nothing to run into"""
    side: complex
    """i when the free side is on the left of the way, -i when it is on the right"""

    def holds(self, chain: Chain) -> bool:
        """Whether a way stays within."""
        if not self.loops:
            return True
        points = [edge.at(i / 8.0) for edge in chain for i in range(9)]
        return all(contains_point(point, self.loops) for point in points)


def enter(
    course: Course,
    job: Job,
    cut: Pass,
    *,
    heights: Heights,
    room: Room,
    approach: Ref[Entity] | None,
) -> Pass:
    """Bring the tool to the start of a pass; what is left of the pass to be cut."""
    strategy = job.program.get(approach) if approach is not None else None
    if isinstance(strategy, AlongPath):
        text = "an approach along paths of its own is not made: the tool comes straight down"
        course.find(job.warning(text, approach))
    if isinstance(strategy, (ApRetractAngle, ApRetractTangent)):
        way = _lead(strategy, cut, room)
        if way:
            _down(course, way[0].start, heights)
            trace(course, way, z=heights.level, end_z=heights.level, type=MoveType.APPROACH)
            return cut
        course.find(job.note(f"no room for {strategy.express_name()}: straight down", approach))
    drop = heights.above - heights.level
    if isinstance(strategy, PlungeRamp) and _is_ramp(strategy.angle):
        return _ramp(course, cut, heights, drop / tan(rad_from_deg(strategy.angle)))
    if isinstance(strategy, PlungeZigzag) and _is_ramp(strategy.angle):
        width = strategy.width if strategy.width and strategy.width > 0.0 else None
        _zigzag(course, cut, heights, drop / tan(rad_from_deg(strategy.angle)), width)
        return cut
    if isinstance(strategy, PlungeHelix) and _is_ramp(strategy.angle):
        if _helix(course, cut, heights, room, strategy):
            return cut
        course.find(job.note("no room for the helix: a ramp along the pass", approach))
        return _ramp(course, cut, heights, drop / tan(rad_from_deg(strategy.angle)))
    _down(course, cut.start, heights)
    return cut


def leave(
    course: Course,
    job: Job,
    cut: Pass,
    *,
    heights: Heights,
    room: Room,
    retract: Ref[Entity] | None,
) -> None:
    """Take the tool from the end of a pass to the height of travel."""
    strategy = job.program.get(retract) if retract is not None else None
    if isinstance(strategy, (ApRetractAngle, ApRetractTangent)):
        back = Pass(reversed_chain(cut.chain), cut.is_closed)
        mirrored = Room(loops=room.loops, side=-room.side)
        way = reversed_chain(_lead(strategy, back, mirrored))
        if way:
            z = heights.level
            trace(course, way, z=z, end_z=z, type=MoveType.RETRACT)
    x, y, _ = course.at
    course.rapid((x, y, heights.travel), MoveType.RETRACT)


def trace(course: Course, chain: Chain, *, z: float, end_z: float, type: MoveType) -> None:
    """Follow a chain, rising or sinking evenly along its length."""
    total = chain_length(chain)
    done = 0.0
    for edge in chain:
        done += edge.length
        height = end_z if edge is chain[-1] else z + (end_z - z) * done / total
        end: Point = (edge.end.real, edge.end.imag, height)
        if edge.centre is None:
            course.line(end, type)
        else:
            centre = (edge.centre.real, edge.centre.imag, height)
            course.arc(end, type, centre=centre, turn=edge.turn)


def _is_ramp(angle: float | None) -> bool:
    return angle is not None and 0.0 < angle < STEEPEST_DEG


def _over(course: Course, at: complex, heights: Heights) -> None:
    """Sideways at the height of travel, then down to just above the material."""
    x, y = at.real, at.imag
    course.rapid((x, y, heights.travel))
    if heights.retract < heights.travel:
        course.rapid((x, y, heights.retract), MoveType.APPROACH)
    course.line((x, y, min(heights.above, heights.retract)), MoveType.NO_CONTACT)


def _down(course: Course, at: complex, heights: Heights) -> None:
    """Straight down to the level of the pass."""
    _over(course, at, heights)
    course.line((at.real, at.imag, heights.level), MoveType.APPROACH)


def _ramp(course: Course, cut: Pass, heights: Heights, length: float) -> Pass:
    """Down along the pass: round and round a loop, to and fro on an open one."""
    if not cut.is_closed:
        _zigzag(course, cut, heights, length, None)
        return cut
    _over(course, cut.start, heights)
    way, rest = _lap(cut.chain, length)
    trace(course, way, z=heights.above, end_z=heights.level, type=MoveType.APPROACH)
    return Pass(rest, is_closed=True)


def _lap(loop: Loop, length: float) -> tuple[Chain, Loop]:
    """The first so many mm of going round a loop, and the loop from there on."""
    way: list[Edge] = []
    left, index = length, 0
    while True:
        edge = loop[index % len(loop)]
        if edge.length > left - TINY:
            part = min(1.0, left / edge.length)
            break
        way.append(edge)
        left -= edge.length
        index += 1
    at = index % len(loop)
    head, tail = loop[at].between(0.0, part), loop[at].between(part, 1.0)
    rest = [tail, *loop[at + 1 :], *loop[:at], head]
    return (*way, head), tuple(edge for edge in rest if edge.length > TINY)


def _zigzag(
    course: Course, cut: Pass, heights: Heights, length: float, width: float | None
) -> None:
    """To and fro along the first edge of the pass, back at its start on the level."""
    first = cut.chain[0]
    span = min(first.length, width or first.length, 0.5 * length)
    count = max(1, ceil(0.5 * length / span - TINY))
    way = first.between(0.0, span / first.length)
    drop = (heights.above - heights.level) / (2 * count)
    _over(course, cut.start, heights)
    z = heights.above
    for _ in range(count):
        for leg in ((way,), (way.reversed(),)):
            trace(course, leg, z=z, end_z=z - drop, type=MoveType.APPROACH)
            z -= drop
    course.line((cut.start.real, cut.start.imag, heights.level), MoveType.APPROACH)


def _helix(
    course: Course, cut: Pass, heights: Heights, room: Room, strategy: PlungeHelix
) -> bool:
    """Down a helix through the start of the pass, on its free side; whether it fits."""
    found = _helix_centre(cut, room, strategy.radius)
    if found is None:
        return False
    centre, radius = found
    pitch = 2.0 * pi * radius * tan(rad_from_deg(strategy.angle))
    turns = max(1, ceil((heights.above - heights.level) / pitch - TINY))
    _over(course, cut.start, heights)
    # With the free side on the left a counter-clockwise helix cuts as the pass does.
    turn = 2.0 * pi * turns * (1.0 if room.side.imag > 0.0 else -1.0)
    course.arc(
        (cut.start.real, cut.start.imag, heights.level),
        MoveType.APPROACH,
        centre=(centre.real, centre.imag, heights.level),
        turn=turn,
    )
    return True


def _helix_centre(cut: Pass, room: Room, radius: float | None) -> tuple[complex, float] | None:
    """Centre and radius of a circle through the start that stays in the room."""
    size = radius or 0.0
    along = cut.chain[0].along(0.0)
    for _ in range(HELIX_TRIES):
        if size <= TINY:
            return None
        for turned in (0.5 * pi, 0.25 * pi, 0.75 * pi, 0.0, pi):
            aside = along * rect(1.0, turned if room.side.imag > 0.0 else -turned)
            centre = cut.start + size * aside
            if _is_clear(centre, size, room):
                return centre, size
        size *= 0.5
    return None


def _is_clear(centre: complex, radius: float, room: Room) -> bool:
    """Whether a circle stays in the room; its ends may touch the boundary."""
    if not room.loops:
        return True
    if not contains_point(centre, room.loops):
        return False
    gaps = [
        abs(loop[index].at(part) - centre)
        for loop in room.loops
        for index, part in [nearest(loop, centre)]
    ]
    return min(gaps) >= radius - 1e-6


def _lead(strategy: ApRetractAngle | ApRetractTangent, cut: Pass, room: Room) -> Chain:
    """Way onto the start of a pass from its free side; empty when there is no room."""
    at, along = cut.start, cut.chain[0].along(0.0)
    if isinstance(strategy, ApRetractTangent):
        radius = strategy.radius or 0.0
        if radius <= TINY:
            return ()
        centre = at + room.side * along * radius
        turn = 0.5 * pi if room.side.imag > 0.0 else -0.5 * pi
        way: Chain = (Edge(centre + (at - centre) * rect(1.0, -turn), at, centre, turn),)
    else:
        length = strategy.travel_length or 0.0
        if length <= TINY:
            return ()
        angle = rad_from_deg(strategy.angle or 0.0)
        back = -along * rect(1.0, -angle if room.side.imag > 0.0 else angle)
        way = (line(at + length * back, at),)
    return way if room.holds(way) else ()
