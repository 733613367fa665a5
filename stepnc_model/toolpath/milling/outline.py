"""Profiles and courses of travel of ISO 14649-10 as plane contours in the setup, mm.

Rectangles lie about the origin of their placement, the length along x. A polygon has a corner
on x. Angles are in degrees.
"""

from cmath import rect
from math import cos, pi

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.measures import NumericParameter, TolerancedLengthMeasure
from stepnc_model.entities.profiles import (
    CircularClosedProfile,
    ClosedProfile,
    CompleteCircularPath,
    GeneralClosedProfile,
    GeneralPath,
    GeneralProfile,
    LinearPath,
    NgonClosedProfile,
    PartialCircularPath,
    PartialCircularProfile,
    RectangularClosedProfile,
)
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.curve import JOINED, Segment, move_of, segments_of
from stepnc_model.toolpath.frame import Frame, direction_of, frame_of
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.milling.contour import (
    TINY,
    Chain,
    Edge,
    Loop,
    circle,
    counter_clockwise,
    halved,
    line,
    polygon,
    shape,
)
from stepnc_model.toolpath.path import MoveType, Plane, Point
from stepnc_model.units import rad_from_deg

MOST = 1e6
"""mm; nothing longer is a length of a part, nothing lies further away"""

FLATTEST_DEG = 89.0
"""degrees from the vertical"""

CHORD = 1e-3
"""mm of tolerance where an outline is looked at as a polygon"""


def size(job: Job, ref: Ref[TolerancedLengthMeasure] | None, owner: Ref[Entity]) -> float:
    """Theoretical size of a toleranced length that an entity cannot do without, mm."""
    if ref is None:
        raise job.fault("lacks a size", owner)
    value = job.program.get(ref).theoretical_size
    if value is None or not 0.0 < value < MOST:
        raise job.fault(f"size {value} mm: it must be positive", ref, "theoretical_size")
    return float(value)


def parameter(job: Job, ref: Ref[NumericParameter]) -> float:
    """Value of a numeric parameter, mm."""
    value = job.program.get(ref).its_parameter_value
    if value is None or not 0.0 < value < MOST:
        raise job.fault(f"{value} mm: it must be positive", ref, "its_parameter_value")
    return float(value)


def given(job: Job, ref: Ref[TolerancedLengthMeasure] | None) -> float:
    """A size that may be absent or 0, mm."""
    value = (job.program.get(ref).theoretical_size or 0.0) if ref is not None else 0.0
    if ref is not None and not 0.0 <= value < MOST:
        raise job.fault(f"size {value:g} mm: it must not be negative", ref, "theoretical_size")
    return float(value)


def slope_of(job: Job, slope: float | None, ref: Ref[Entity]) -> float:
    """Lean of a wall in degrees from the vertical; 0 where none is given."""
    value = slope or 0.0
    if not 0.0 <= value < FLATTEST_DEG:
        raise job.fault(
            f"a wall at {value:g}°: it leans by at least 0° and less than {FLATTEST_DEG:g}°, "
            "wider above than below",
            ref,
        )
    return float(value)


def require_simple(job: Job, loop: Loop, ref: Ref[Entity]) -> None:
    """Refuse a boundary that crosses itself."""
    if not shape(loop, tolerance=CHORD).is_valid:
        raise job.fault("its boundary crosses itself", ref)


def require_upright(job: Job, frame: Frame, ref: Ref[Entity]) -> None:
    """Refuse a feature whose z axis does not point against the tool."""
    if not frame.is_upright:
        x, y, z = frame.z
        raise job.fault(
            f"its axis ({x:.4g}, {y:.4g}, {z:.4g}) does not lie along the tool: "
            "only setups that bring it upright can be made",
            ref,
            "feature_placement",
        )


def closed_outline(job: Job, ref: Ref[ClosedProfile], frame: Frame) -> Loop:
    """Boundary of a closed profile, counter-clockwise.

    Raises
    ------
    PathError
        When it does not close, crosses itself, or its kind is unknown.
    """
    profile = job.program.get(ref)
    placed = frame.inner(frame_of(job.program, profile.placement))
    require_upright(job, placed, ref)
    if isinstance(profile, RectangularClosedProfile):
        half_x = 0.5 * size(job, profile.profile_length, ref)
        half_y = 0.5 * size(job, profile.profile_width, ref)
        corners = [(-half_x, -half_y), (half_x, -half_y), (half_x, half_y), (-half_x, half_y)]
        return polygon([_on_plane(placed, corner) for corner in corners])
    if isinstance(profile, CircularClosedProfile):
        return circle(_on_plane(placed, (0.0, 0.0)), 0.5 * size(job, profile.diameter, ref))
    if isinstance(profile, NgonClosedProfile):
        return _ngon(job, ref, profile, placed)
    if isinstance(profile, GeneralClosedProfile):
        chain = _chain(job, profile.closed_profile_shape, placed)
        gap = abs(chain[-1].end - chain[0].start)
        if gap > JOINED:
            raise job.fault(f"does not close: a gap of {gap:.4g} mm", ref)
        return counter_clockwise(halved(_joined([*chain, line(chain[-1].end, chain[0].start)])))
    raise job.fault("is no closed profile", ref)


def open_outline(job: Job, ref: Ref[Entity], frame: Frame) -> Chain:
    """Curve of an open profile that lies on the plane."""
    profile = job.program.get(ref)
    placed = frame.inner(frame_of(job.program, getattr(profile, "placement", None)))
    require_upright(job, placed, ref)
    if isinstance(profile, GeneralProfile):
        return _chain(job, profile.its_profile, placed)
    if isinstance(profile, PartialCircularProfile):
        radius = size(job, profile.radius, ref)
        return _arc(placed, radius, rad_from_deg(profile.sweep_angle))
    raise job.fault("an open boundary of this kind cannot be followed", ref)


def course(job: Job, ref: Ref[Entity], frame: Frame) -> Chain:
    """Curve along which a profile is swept."""
    path = job.program.get(ref)
    placed = frame.inner(frame_of(job.program, getattr(path, "placement", None)))
    require_upright(job, placed, ref)
    if isinstance(path, LinearPath):
        length = size(job, path.distance, ref)
        x, y, z = direction_of(job.program, path.its_direction)
        if abs(z) > TINY:
            raise job.fault("leads out of its plane", ref, "its_direction")
        ends = [(0.0, 0.0), (length * x, length * y)]
        return (line(*(_on_plane(placed, end) for end in ends)),)
    if isinstance(path, CompleteCircularPath):
        return circle(_on_plane(placed, (0.0, 0.0)), size(job, path.radius, ref))
    if isinstance(path, PartialCircularPath):
        return _arc(placed, size(job, path.radius, ref), rad_from_deg(path.sweep_angle))
    if isinstance(path, GeneralPath):
        return _chain(job, path.swept_path, placed)
    raise job.fault("is no course of travel", ref)


def chain_of(segments: tuple[Segment, ...]) -> Chain:
    """The segments seen along z."""
    edges: list[Edge] = []
    for segment in segments:
        at = segment.start
        for move in move_of(segment, MoveType.CONTACT, None):
            start, end = complex(at[0], at[1]), complex(move.end[0], move.end[1])
            if move.arc is not None and move.arc.plane is Plane.XY:
                centre = complex(move.arc.centre[0], move.arc.centre[1])
                edges.append(Edge(start, end, centre, move.arc.turn))
            elif abs(end - start) > TINY:
                edges.append(line(start, end))
            at = move.end
    return _joined(edges)


def _chain(job: Job, ref: Ref[Entity], frame: Frame) -> Chain:
    """A curve of the file in the setup, seen along z."""
    segments = segments_of(job.program, ref)
    chain = halved(chain_of(tuple(segment.within(frame) for segment in segments)))
    if not chain:
        raise job.fault("has no length", ref)
    for edge in chain:
        if not max(abs(edge.start), abs(edge.end)) < MOST:
            raise job.fault(f"a point at {edge.end:g} mm: no part is so large", ref)
    return chain


def _joined(edges: list[Edge]) -> Chain:
    """The edges with each starting exactly where the one before ends; the rest is rounding."""
    found = [edge for edge in edges if edge.length > TINY]
    starts = [found[0].start, *(edge.end for edge in found[:-1])] if found else []
    return tuple(
        Edge(start, edge.end, edge.centre, edge.turn)
        for start, edge in zip(starts, found, strict=True)
    )


def _ngon(job: Job, ref: Ref[Entity], profile: NgonClosedProfile, frame: Frame) -> Loop:
    """Regular polygon by its circumscribed circle or its width across flats."""
    sides = profile.number_of_sides
    if sides is None or not 3 <= sides <= 1000:
        raise job.fault(f"{sides} sides: a polygon has 3 at least", ref, "number_of_sides")
    radius = 0.5 * size(job, profile.diameter, ref)
    if not profile.circumscribed_or_across_flats:
        radius /= cos(pi / sides)
    corners = [rect(radius, 2.0 * pi * index / sides) for index in range(sides)]
    return polygon([_on_plane(frame, (at.real, at.imag)) for at in corners])


def _arc(frame: Frame, radius: float, sweep: float) -> Chain:
    """Arc about the origin of a frame, from its x axis."""
    start, centre = _on_plane(frame, (radius, 0.0)), _on_plane(frame, (0.0, 0.0))
    end = centre + (start - centre) * rect(1.0, sweep)
    return halved([Edge(start, end, centre, sweep)])


def _on_plane(frame: Frame, at: tuple[float, float]) -> complex:
    """A point of a frame seen along z."""
    point: Point = frame.point((at[0], at[1], 0.0))
    return complex(point[0], point[1])
