"""Ways to an explicit cut and from it that a few parameters tell (ISO 14649-10).

* ``ap_lift_path_angle``: from the fixed point straight to the bend, ``benddist`` before the
  cut, and from there down onto its tangent at ``angle`` to it;
* ``ap_lift_path_tangent``: from the fixed point straight onto an arc of ``radius`` that runs
  into the tangent of the cut, in the plane of both.

A lift is an approach run backwards. So the two are read here: the standard draws them, and
says no more.
"""

from itertools import pairwise
from math import atan2, cos, dist, pi, sin, sqrt

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.toolpaths import (
    ApLiftPathAngle,
    ApLiftPathTangent,
    ApproachLiftPath,
)
from stepnc_model.errors import PathError
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program
from stepnc_model.toolpath.curve import Bend, Segment
from stepnc_model.toolpath.frame import Frame, direction_of, point_of
from stepnc_model.toolpath.path import Point
from stepnc_model.units import rad_from_deg

SAME = 1e-9
"""mm"""

LEAST_RISE = 1e-3
"""of a unit vector along z, below which a direction leads to no security plane"""


def approach_segments(
    program: Program, ref: Ref[ApproachLiftPath], *, frame: Frame, cut: Segment
) -> tuple[Segment, ...]:
    """Way from the fixed point to the start of a cut.

    Parameters
    ----------
    program : Program
    ref : Ref
    frame : Frame
        That the fixed point is given in.
    cut : Segment
        First one of the cut, in the setup.

    Raises
    ------
    PathError
        When no such way exists.
    """
    start, tangent = cut.start, _tangent(cut)
    path = program.get(ref)
    fix = frame.point(point_of(program, path.fix_point))
    if isinstance(path, ApLiftPathAngle):
        angle = rad_from_deg(path.angle)
        along = _minus(_times(tangent, cos(angle)), (0.0, 0.0, sin(angle)))
        bend = _minus(start, _times(along, path.benddist))
        points = [fix, bend, start]
        return tuple(Segment(start=a, end=b) for a, b in pairwise(points) if dist(a, b) > SAME)
    if isinstance(path, ApLiftPathTangent):
        return _onto_arc(program, ref, path.radius, fix, start=start, tangent=tangent)
    raise _fault(program, ref, "an approach of this kind cannot be followed")


def lift_segments(
    program: Program, ref: Ref[ApproachLiftPath], *, frame: Frame, cut: Segment
) -> tuple[Segment, ...]:
    """Way from the end of a cut, by its last segment, to the fixed point."""
    back = approach_segments(program, ref, frame=frame, cut=cut.reversed())
    return tuple(segment.reversed() for segment in reversed(back))


def point_on_plane(
    program: Program, at: Point, direction: Ref[Entity] | None, *, frame: Frame, height: float
) -> Point:
    """Point of the security plane that a direction leads to, straight up where none is given.

    Raises
    ------
    PathError
        When the direction does not lead up to it.
    """
    if direction is None:
        return at[0], at[1], height
    along = frame.direction(direction_of(program, direction))
    if abs(along[2]) < LEAST_RISE:
        raise _fault(program, direction, "leads to no security plane: it is level")
    part = (height - at[2]) / along[2]
    return at[0] + part * along[0], at[1] + part * along[1], height


def _tangent(segment: Segment) -> Point:
    """Unit vector along the start of a segment; the rise of a helix is left out."""
    bend = segment.bend
    if bend is None:
        return _unit(_minus(segment.end, segment.start))
    towards = _cross(bend.normal, _minus(segment.start, bend.centre))
    return _unit(towards if bend.turn > 0.0 else _times(towards, -1.0))


def _onto_arc(
    program: Program,
    ref: Ref[Entity],
    radius: float,
    fix: Point,
    *,
    start: Point,
    tangent: Point,
) -> tuple[Segment, ...]:
    """Line from a point and arc that meet tangentially, and meet the cut tangentially."""
    away = _minus(fix, start)
    forward = _dot(away, tangent)
    aside = _minus(away, _times(tangent, forward))
    height = sqrt(_dot(aside, aside))
    if not radius > 0.0 or height < SAME:
        message = "the fixed point lies on the tangent of the cut: no arc leads there"
        raise _fault(program, ref, message)
    across = _times(aside, 1.0 / height)
    # In the plane of tangent (u) and across (v) the centre is (0, radius).
    u, v = forward, height - radius
    reach = u * u + v * v - radius * radius
    if reach < 0.0:
        message = f"the fixed point lies within the arc of radius {radius:g} mm"
        raise _fault(program, ref, message)
    at = atan2(v, u) + atan2(sqrt(reach), radius)
    turn = (-0.5 * pi - at) % (2.0 * pi)
    centre = _plus(start, _times(across, radius))
    touch = _plus(
        centre,
        _plus(_times(tangent, radius * cos(at)), _times(across, radius * sin(at))),
    )
    bend = Bend(centre=centre, normal=_cross(tangent, across), turn=turn)
    line = Segment(start=fix, end=touch)
    arc = Segment(start=touch, end=start, bend=bend)
    return (line, arc) if dist(fix, touch) > SAME else (arc,)


def _minus(one: Point, other: Point) -> Point:
    return one[0] - other[0], one[1] - other[1], one[2] - other[2]


def _plus(one: Point, other: Point) -> Point:
    return one[0] + other[0], one[1] + other[1], one[2] + other[2]


def _times(vector: Point, factor: float) -> Point:
    return vector[0] * factor, vector[1] * factor, vector[2] * factor


def _dot(one: Point, other: Point) -> float:
    return sum(a * b for a, b in zip(one, other, strict=True))


def _cross(one: Point, other: Point) -> Point:
    return (
        one[1] * other[2] - one[2] * other[1],
        one[2] * other[0] - one[0] * other[2],
        one[0] * other[1] - one[1] * other[0],
    )


def _unit(vector: Point) -> Point:
    return _times(vector, 1.0 / dist(vector, (0.0, 0.0, 0.0)))


def _fault(program: Program, ref: Ref[Entity], message: str) -> PathError:
    return PathError(message, entity=program.label(ref), line=program.line(ref))
