"""Approach to a pass and retract from it (ISO 14649-11).

Plunges descend to the level of a pass: along the tool's axis, down a ramp along the pass
itself, down a helix, or to and fro. Air strategies descend beside the pass and meet it along
an arc or a straight line. A strategy that does not fit is replaced, with a finding.
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
"""Steepest angle of a ramp, degrees; steeper ones are plunges."""

MOST_TURNS = 500
"""Greatest number of laps or legs of a ramp."""

HELIX_TRIES = 4
"""Number of times that a helix radius is halved until the helix fits."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Heights:
    """Heights of the approach in the setup, mm, from the highest to the lowest."""

    travel: float
    """Height above all material, at which the tool travels sideways in rapid."""
    retract: float
    """Retract plane of the operation, down to which the tool moves in rapid."""
    above: float
    """Height z just above the material of this level, mm."""
    level: float
    """Height z of the pass, mm."""


def enter(
    course: PathBuilder,
    job: ToolPathTask,
    cut: MillingPass,
    *,
    heights: Heights,
    room: CentreArea,
    approach: Ref[Entity] | None,
) -> MillingPass:
    """Move the tool to the start of a pass; return the part of the pass still to be cut."""
    strategy = job.program.get(approach) if approach is not None else None
    if isinstance(strategy, AlongPath):
        text = "approach along an explicit path is not supported: the tool moves straight down"
        course.find(job.warning(text, approach))
    if isinstance(strategy, (ApRetractAngle, ApRetractTangent)):
        way = _lead(strategy, cut, room)
        if way:
            _down(course, way[0].start, heights)
            trace(course, way, z=heights.level, end_z=heights.level, type=MoveType.APPROACH)
            return cut
        course.find(
            job.note(f"no room for {strategy.express_name()}: moving straight down", approach)
        )
    if isinstance(strategy, (PlungeRamp, PlungeHelix, PlungeZigzag)):
        angle = strategy.angle
        if angle is not None and 0.0 < angle <= STEEPEST_DEG:
            return _slanted(course, job, cut, strategy, heights=heights, room=room)
        course.find(
            job.note(
                f"an angle of {angle}° is not a valid ramp: moving straight down", approach
            )
        )
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
    """Retract the tool from the end of a pass to the travel height."""
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
                job.note(f"no room for {strategy.express_name()}: moving straight up", retract)
            )
    elif isinstance(strategy, AlongPath):
        text = "retract along an explicit path is not supported: the tool moves straight up"
        course.find(job.warning(text, retract))
    x, y, _ = course.at
    course.rapid((x, y, heights.travel), MoveType.RETRACT)


def trace(course: PathBuilder, chain: Chain, *, z: float, end_z: float, type: MoveType) -> None:
    """Follow a chain, rising or descending evenly along its length."""
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
    """Move sideways at the travel height, then down to just above the material."""
    x, y = at.real, at.imag
    course.rapid((x, y, max(course.at[2], heights.travel)))
    course.rapid((x, y, heights.travel))
    if heights.retract < heights.travel:
        course.descend((x, y, heights.retract), MoveType.APPROACH)
    course.line((x, y, min(heights.above, heights.retract)), MoveType.NO_CONTACT)


def _down(course: PathBuilder, at: complex, heights: Heights) -> None:
    """Move straight down to the level of the pass."""
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
    """Descend at an angle: on a helix, around a loop, or to and fro."""
    length = (heights.above - heights.level) / tan(rad_from_deg(strategy.angle))
    if isinstance(strategy, PlungeHelix):
        if _helix(course, cut, heights, room, radius=strategy.radius, length=length):
            return cut
        course.find(job.note("no room for the helix: ramping along the pass", None, "approach"))
    total = chain_length(cut.chain)
    limit = total
    if isinstance(strategy, PlungeZigzag) and strategy.width and strategy.width > 0.0:
        limit = min(total, strategy.width)
    if length > MOST_TURNS * limit:
        text = f"ramp of {length:.4g} mm on a {limit:.4g} mm pass is too long: straight down"
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
    """Ramp down along a loop; return the loop from where the level is reached."""
    laps, rest = divmod(length, chain_length(cut.chain))
    head, tail = divided(cut.chain, rest)
    _over(course, cut.start, heights)
    way = (*cut.chain * int(laps), *head)
    trace(course, way, z=heights.above, end_z=heights.level, type=MoveType.APPROACH)
    return MillingPass((*tail, *head), is_closed=True)


def _zigzag(
    course: PathBuilder, cut: MillingPass, heights: Heights, length: float, limit: float
) -> None:
    """Ramp to and fro along the beginning of the pass, ending at its start on the level."""
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
    """Descend a helix to the start of the pass, on its free side; return whether it fits."""
    found = _helix_centre(cut, room, radius)
    if found is None:
        return False
    centre, size = found
    # With the free side on the left, a counter-clockwise helix keeps the pass's cut mode.
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
    """Centre and radius of a circle through the start of a pass that stays in the room."""
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
    """Lead-in to the start of a pass from its free side; empty if there is no room."""
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
