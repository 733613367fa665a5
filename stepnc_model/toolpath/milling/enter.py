"""Approach to a pass and retract from it (ISO 14649-11).

Plunges go down to the level of a pass: along the tool's axis, down a ramp along the pass
itself, down a helix, or to and fro. Air strategies come down beside the pass and meet it along
an arc or a straight line. What does not fit is replaced by what does, and said.
"""

from cmath import rect
from dataclasses import dataclass, replace
from math import ceil, pi, tan

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.milling import (
    AlongPath,
    ApRetractAngle,
    ApRetractTangent,
    PlungeHelix,
    PlungeRamp,
    PlungeZigzag,
)
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.milling.contour import (
    TINY,
    Chain,
    ContourEdge,
    chain_length,
    divided,
    line,
    reversed_chain,
)
from stepnc_model.toolpath.milling.cover import MillingPass
from stepnc_model.toolpath.milling.layer import CentreArea
from stepnc_model.toolpath.path import MoveType, Point
from stepnc_model.toolpath.task import PathBuilder, ToolPathTask
from stepnc_model.units import rad_from_deg

STEEPEST_DEG = 89.0
"""degrees; a steeper ramp is a plunge"""

MOST_TURNS = 500
"""laps or legs of a ramp; more lie on too short a piece of the pass"""

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
    """Level of the pass"""


def enter(
    course: PathBuilder,
    job: ToolPathTask,
    cut: MillingPass,
    *,
    heights: Heights,
    room: CentreArea,
    approach: Ref[Entity] | None,
) -> MillingPass:
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
    if isinstance(strategy, (PlungeRamp, PlungeHelix, PlungeZigzag)):
        angle = strategy.angle
        if angle is not None and 0.0 < angle <= STEEPEST_DEG:
            return _slanted(course, job, cut, strategy, heights=heights, room=room)
        course.find(job.note(f"an angle of {angle}° is no ramp: straight down", approach))
    _down(course, cut.start, heights)
    return cut


def leave(
    course: PathBuilder,
    job: ToolPathTask,
    cut: MillingPass,
    *,
    heights: Heights,
    room: CentreArea,
    retract: Ref[Entity] | None,
) -> None:
    """Take the tool from the end of a pass to the height of travel."""
    strategy = job.program.get(retract) if retract is not None else None
    if isinstance(strategy, (ApRetractAngle, ApRetractTangent)):
        back = MillingPass(reversed_chain(cut.chain), cut.is_closed)
        mirrored = replace(room, side=-room.side)
        way = reversed_chain(_lead(strategy, back, mirrored))
        if way:
            z = heights.level
            trace(course, way, z=z, end_z=z, type=MoveType.RETRACT)
        else:
            course.find(
                job.note(f"no room for {strategy.express_name()}: straight up", retract)
            )
    elif isinstance(strategy, AlongPath):
        text = "a retract along paths of its own is not made: the tool goes straight up"
        course.find(job.warning(text, retract))
    x, y, _ = course.at
    course.rapid((x, y, heights.travel), MoveType.RETRACT)


def trace(course: PathBuilder, chain: Chain, *, z: float, end_z: float, type: MoveType) -> None:
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


def _over(course: PathBuilder, at: complex, heights: Heights) -> None:
    """Sideways at the height of travel, then down to just above the material."""
    x, y = at.real, at.imag
    course.rapid((x, y, max(course.at[2], heights.travel)))
    course.rapid((x, y, heights.travel))
    if heights.retract < heights.travel:
        course.descend((x, y, heights.retract), MoveType.APPROACH)
    course.line((x, y, min(heights.above, heights.retract)), MoveType.NO_CONTACT)


def _down(course: PathBuilder, at: complex, heights: Heights) -> None:
    """Straight down to the level of the pass."""
    _over(course, at, heights)
    course.line((at.real, at.imag, heights.level), MoveType.APPROACH)


def _slanted(
    course: PathBuilder,
    job: ToolPathTask,
    cut: MillingPass,
    strategy: PlungeRamp | PlungeHelix | PlungeZigzag,
    *,
    heights: Heights,
    room: CentreArea,
) -> MillingPass:
    """Down at an angle: a helix, round and round a loop, or to and fro."""
    length = (heights.above - heights.level) / tan(rad_from_deg(strategy.angle))
    if isinstance(strategy, PlungeHelix):
        if _helix(course, cut, heights, room, radius=strategy.radius, length=length):
            return cut
        course.find(job.note("no room for the helix: a ramp along the pass", None, "approach"))
    total = chain_length(cut.chain)
    limit = total
    if isinstance(strategy, PlungeZigzag) and strategy.width and strategy.width > 0.0:
        limit = min(total, strategy.width)
    if length > MOST_TURNS * limit:
        text = f"a ramp of {length:.4g} mm on {limit:.4g} mm of the pass: straight down"
        course.find(job.note(text, None, "approach"))
        _down(course, cut.start, heights)
        return cut
    if cut.is_closed and not isinstance(strategy, PlungeZigzag):
        return _around(course, cut, heights, length)
    _zigzag(course, cut, heights, length, limit)
    return cut


def _around(
    course: PathBuilder, cut: MillingPass, heights: Heights, length: float
) -> MillingPass:
    """Down along a loop; the loop from where the level is reached."""
    laps, rest = divmod(length, chain_length(cut.chain))
    head, tail = divided(cut.chain, rest)
    _over(course, cut.start, heights)
    way = (*cut.chain * int(laps), *head)
    trace(course, way, z=heights.above, end_z=heights.level, type=MoveType.APPROACH)
    return MillingPass((*tail, *head), is_closed=True)


def _zigzag(
    course: PathBuilder, cut: MillingPass, heights: Heights, length: float, limit: float
) -> None:
    """Move to and fro along the beginning of the pass, back at its start on the level."""
    count = max(1, ceil(0.5 * length / limit - TINY))
    way, _ = divided(cut.chain, 0.5 * length / count)
    legs = (way, reversed_chain(way)) * count
    _over(course, cut.start, heights)
    for index, leg in enumerate(legs):
        z, end_z = (
            heights.above + (heights.level - heights.above) * place / len(legs)
            for place in (index, index + 1)
        )
        trace(course, leg, z=z, end_z=end_z, type=MoveType.APPROACH)
    course.line((cut.start.real, cut.start.imag, heights.level), MoveType.APPROACH)


def _helix(
    course: PathBuilder,
    cut: MillingPass,
    heights: Heights,
    room: CentreArea,
    *,
    radius: float | None,
    length: float,
) -> bool:
    """Down a helix to the start of the pass, on its free side; whether it fits."""
    found = _helix_centre(cut, room, radius)
    if found is None:
        return False
    centre, size = found
    # With the free side on the left a counter-clockwise helix cuts as the pass does.
    turn = length / size * (1.0 if room.side.imag > 0.0 else -1.0)
    _over(course, centre + (cut.start - centre) * rect(1.0, -turn), heights)
    course.arc(
        (cut.start.real, cut.start.imag, heights.level),
        MoveType.APPROACH,
        centre=(centre.real, centre.imag, heights.level),
        turn=turn,
    )
    return True


def _helix_centre(
    cut: MillingPass, room: CentreArea, radius: float | None
) -> tuple[complex, float] | None:
    """Centre and radius of a circle through the start that stays in the room."""
    size = radius or 0.0
    along = cut.chain[0].along(0.0)
    for _ in range(HELIX_TRIES):
        if size <= TINY:
            return None
        for turned in (0.5 * pi, 0.25 * pi, 0.75 * pi, 0.0, pi):
            aside = along * rect(1.0, turned if room.side.imag > 0.0 else -turned)
            centre = cut.start + size * aside
            if room.holds_circle(centre, size):
                return centre, size
        size *= 0.5
    return None


def _lead(
    strategy: ApRetractAngle | ApRetractTangent, cut: MillingPass, room: CentreArea
) -> Chain:
    """Way onto the start of a pass from its free side; empty when there is no room."""
    at, along = cut.start, cut.chain[0].along(0.0)
    if isinstance(strategy, ApRetractTangent):
        radius = strategy.radius or 0.0
        if radius <= TINY:
            return ()
        centre = at + room.side * along * radius
        turn = 0.5 * pi if room.side.imag > 0.0 else -0.5 * pi
        way: Chain = (ContourEdge(centre + (at - centre) * rect(1.0, -turn), at, centre, turn),)
    else:
        length = strategy.travel_length or 0.0
        if length <= TINY:
            return ()
        angle = rad_from_deg(strategy.angle or 0.0)
        back = -along * rect(1.0, -angle if room.side.imag > 0.0 else angle)
        way = (line(at + length * back, at),)
    return way if room.holds(way) else ()
