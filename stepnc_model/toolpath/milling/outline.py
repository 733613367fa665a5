"""Profiles, travel paths and slots of ISO 14649-10 as plane contours in the setup, mm.

Rectangles are centred at the origin of their placement, with the length along x. A polygon has
a corner on the x axis. Angles are in degrees.

A slot is an open profile swept along a course of travel through the middle of the profile.
The tool runs out of an open end; a radiused end is a half circle about the end of the course,
beyond it; a flat end stops at the end of the course. A Woodruff end does so at the top and
descends to the floor along the arc that a disc leaves. The width of a profile is measured at
the top; wall angles are from the vertical.
"""

from cmath import rect
from collections.abc import Sequence
from itertools import pairwise
from math import cos, pi, tan

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import Slot
from stepnc_model.entities.profiles import (
    CircularClosedProfile,
    ClosedProfile,
    CompleteCircularPath,
    FlatSlotEndType,
    GeneralClosedProfile,
    GeneralPath,
    GeneralProfile,
    LinearPath,
    LoopSlotEndType,
    NgonClosedProfile,
    OpenSlotEndType,
    PartialCircularPath,
    PartialCircularProfile,
    RadiusedSlotEndType,
    RectangularClosedProfile,
    RoundedUProfile,
    SquareUProfile,
    TeeProfile,
    VeeProfile,
    WoodruffSlotEndType,
)
from stepnc_model.part21.values import Ref
from stepnc_model.programs.outline import MOST, size, vee_angle
from stepnc_model.toolpath.curve import JOINED, Segment, move_of, segments_of
from stepnc_model.toolpath.frame import Frame, direction_of, frame_of
from stepnc_model.toolpath.milling.contour import (
    TINY,
    Chain,
    ContourEdge,
    Loop,
    chain_length,
    circle,
    clockwise,
    counter_clockwise,
    halved,
    line,
    polygon,
    reversed_chain,
    shape,
    stretched,
)
from stepnc_model.toolpath.milling.cover import (
    Area,
    Inset,
    LeaningWall,
    TeeSlotUndercut,
    Wall,
    chord,
    upright,
)
from stepnc_model.toolpath.milling.offset import erode, offset_left, rounded
from stepnc_model.toolpath.milling.strategy import run_out
from stepnc_model.toolpath.path import ArcPlane, MoveType, Point
from stepnc_model.toolpath.task import ToolPathTask
from stepnc_model.units import rad_from_deg

FLATTEST_DEG = 89.0
"""Greatest wall angle from the vertical, degrees."""

CHORD = 1e-3
"""Chord tolerance for polygons of an outline, mm."""


def slope_of(job: ToolPathTask, slope: float | None, ref: Ref[Entity]) -> float:
    """Wall angle from the vertical, degrees; 0 if not given."""
    value = slope or 0.0
    if not 0.0 <= value < FLATTEST_DEG:
        raise job.fault(
            f"a wall at {value:g}°: the slope must be at least 0° and below {FLATTEST_DEG:g}°, "
            "wider above than below",
            ref,
        )
    return float(value)


def require_simple(job: ToolPathTask, loop: Loop, ref: Ref[Entity]) -> None:
    """Raise an error if a boundary crosses itself."""
    if not shape(loop, tolerance=CHORD).is_valid:
        raise job.fault("the feature's boundary crosses itself", ref)


def require_upright(job: ToolPathTask, frame: Frame, ref: Ref[Entity]) -> None:
    """Raise an error if a feature's z axis does not point towards the tool."""
    if not frame.is_upright:
        x, y, z = frame.z
        raise job.fault(
            f"the feature's axis ({x:.4g}, {y:.4g}, {z:.4g}) is not parallel to the tool: "
            "use a setup that turns the feature upright",
            ref,
            "feature_placement",
        )


def closed_outline(job: ToolPathTask, ref: Ref[ClosedProfile], frame: Frame) -> Loop:
    """Boundary of a closed profile, as a counter-clockwise loop.

    Raises
    ------
    PathError
        If the profile does not close, crosses itself or is of an unknown kind.
    """
    profile = job.program.get(ref)
    placed = frame.inner(frame_of(job.program, profile.placement))
    require_upright(job, placed, ref)
    if isinstance(profile, RectangularClosedProfile):
        half_x = 0.5 * size(job.program, profile.profile_length, ref)
        half_y = 0.5 * size(job.program, profile.profile_width, ref)
        corners = [(-half_x, -half_y), (half_x, -half_y), (half_x, half_y), (-half_x, half_y)]
        return polygon([_on_plane(placed, corner) for corner in corners])
    if isinstance(profile, CircularClosedProfile):
        return circle(
            _on_plane(placed, (0.0, 0.0)), 0.5 * size(job.program, profile.diameter, ref)
        )
    if isinstance(profile, NgonClosedProfile):
        return _ngon(job, ref, profile, placed)
    if isinstance(profile, GeneralClosedProfile):
        chain = _chain(job, profile.closed_profile_shape, placed)
        gap = abs(chain[-1].end - chain[0].start)
        if gap > JOINED:
            raise job.fault(f"the profile does not close: gap of {gap:.4g} mm", ref)
        return counter_clockwise(halved(_joined([*chain, line(chain[-1].end, chain[0].start)])))
    raise job.fault("is not a closed profile", ref)


def open_outline(job: ToolPathTask, ref: Ref[Entity], frame: Frame) -> Chain:
    """Curve of an open profile that lies in the plane."""
    profile = job.program.get(ref)
    placed = frame.inner(frame_of(job.program, getattr(profile, "placement", None)))
    require_upright(job, placed, ref)
    if isinstance(profile, GeneralProfile):
        return _chain(job, profile.its_profile, placed)
    if isinstance(profile, PartialCircularProfile):
        radius = size(job.program, profile.radius, ref)
        return _arc(placed, radius, rad_from_deg(profile.sweep_angle))
    raise job.fault("this kind of open boundary is not supported", ref)


def course(job: ToolPathTask, ref: Ref[Entity], frame: Frame) -> Chain:
    """Course of travel along which a profile is swept, as a chain."""
    path = job.program.get(ref)
    placed = frame.inner(frame_of(job.program, getattr(path, "placement", None)))
    if isinstance(path, LinearPath):
        require_upright(job, frame, ref)
        return (_straight(job, path, placed, ref),)
    require_upright(job, placed, ref)
    if isinstance(path, CompleteCircularPath):
        return circle(_on_plane(placed, (0.0, 0.0)), size(job.program, path.radius, ref))
    if isinstance(path, PartialCircularPath):
        return _arc(placed, size(job.program, path.radius, ref), rad_from_deg(path.sweep_angle))
    if isinstance(path, GeneralPath):
        return _chain(job, path.swept_path, placed)
    raise job.fault("is not a course of travel", ref)


def _straight(
    job: ToolPathTask, path: LinearPath, placed: Frame, ref: Ref[Entity]
) -> ContourEdge:
    """Straight course of travel; only its direction must lie in the plane of the feature.

    Files are known whose placement turns the axis away from the tool.
    """
    length = size(job.program, path.distance, ref)
    x, y, z = direction_of(job.program, path.its_direction)
    begin = placed.origin
    end = placed.point((length * x, length * y, length * z))
    if abs(end[2] - begin[2]) > TINY * max(1.0, length):
        raise job.fault("the course of travel leaves its plane", ref, "its_direction")
    return line(complex(begin[0], begin[1]), complex(end[0], end[1]))


def chain_of(segments: tuple[Segment, ...]) -> Chain:
    """Segments projected along z, as a chain."""
    edges: list[ContourEdge] = []
    for segment in segments:
        at = segment.start
        for move in move_of(segment, MoveType.CONTACT, None):
            start, end = complex(at[0], at[1]), complex(move.end[0], move.end[1])
            if move.arc is not None and move.arc.plane is ArcPlane.XY:
                centre = complex(move.arc.centre[0], move.arc.centre[1])
                edges.append(ContourEdge(start, end, centre, move.arc.turn))
            elif abs(end - start) > TINY:
                edges.append(line(start, end))
            at = move.end
    return _joined(edges)


def _chain(job: ToolPathTask, ref: Ref[Entity], frame: Frame) -> Chain:
    """Curve of the file in setup coordinates, projected along z."""
    segments = segments_of(job.program, ref)
    chain = halved(chain_of(tuple(segment.within(frame) for segment in segments)))
    if not chain:
        raise job.fault("the curve has no length", ref)
    for edge in chain:
        if not max(abs(edge.start), abs(edge.end)) < MOST:
            raise job.fault(f"a point at {edge.end:g} mm is too far away: check units", ref)
    return chain


def _joined(edges: list[ContourEdge]) -> Chain:
    """Join edges so that each starts exactly where the previous one ends."""
    found = [edge for edge in edges if edge.length > TINY]
    starts = [found[0].start, *(edge.end for edge in found[:-1])] if found else []
    return tuple(
        ContourEdge(start, edge.end, edge.centre, edge.turn)
        for start, edge in zip(starts, found, strict=True)
    )


def _ngon(
    job: ToolPathTask, ref: Ref[Entity], profile: NgonClosedProfile, frame: Frame
) -> Loop:
    """Regular polygon, given by its circumscribed circle or its width across flats."""
    sides = profile.number_of_sides
    if sides is None or not 3 <= sides <= 1000:
        raise job.fault(
            f"{sides} sides: a polygon must have at least 3", ref, "number_of_sides"
        )
    radius = 0.5 * size(job.program, profile.diameter, ref)
    if not profile.circumscribed_or_across_flats:
        radius /= cos(pi / sides)
    corners = [rect(radius, 2.0 * pi * index / sides) for index in range(sides)]
    return polygon([_on_plane(frame, (at.real, at.imag)) for at in corners])


def _arc(frame: Frame, radius: float, sweep: float) -> Chain:
    """Arc about the origin of a frame, starting at its x axis."""
    start, centre = _on_plane(frame, (radius, 0.0)), _on_plane(frame, (0.0, 0.0))
    end = centre + (start - centre) * rect(1.0, sweep)
    return halved([ContourEdge(start, end, centre, sweep)])


def _on_plane(frame: Frame, at: tuple[float, float]) -> complex:
    """Point of a frame, projected along z."""
    point: Point = frame.point((at[0], at[1], 0.0))
    return complex(point[0], point[1])


ROUNDEST = 1e-3
"""Margin by which a corner radius stays below half the width, mm."""


def slot_area(
    job: ToolPathTask, ref: Ref[Entity], slot: Slot, frame: Frame, bottom: float
) -> Area:
    """Area to be removed for a slot.

    Raises
    ------
    PathError
        If the slot has no width, or turns more sharply than half its width.
    """
    top = frame.origin[2]
    middle = course(job, slot.course_of_travel, frame)
    half, inset = _section(job, slot.swept_shape, top - bottom)
    ends = [job.program.get(end) for end in slot.end_conditions]
    outside: Chain = ()
    beyond = (0.0, 0.0)
    rises: tuple[Inset, Inset] = (upright, upright)
    stops: list[Wall] = []
    if abs(middle[-1].end - middle[0].start) < JOINED:
        loops = _ring(middle, half)
    elif any(isinstance(end, LoopSlotEndType) for end in ends):
        gap = abs(middle[-1].end - middle[0].start)
        raise job.fault(f"the slot's course does not close: gap of {gap:.4g} mm", ref)
    else:
        # A single end condition applies to both ends.
        pair = [*ends, *ends][:2] if ends else [OpenSlotEndType(), OpenSlotEndType()]
        first, last = (_beyond(job, end, half) for end in pair)
        beyond = (first, last)
        loops, outside = _band(job, ref, middle, half, pair)
        before, after = (_rise(job, end, top - bottom) for end in pair)
        rises = (before, after)
        ways = (reversed_chain(middle), middle)
        stops = [
            Wall(loop=_stop(way), inset=rise)
            for way, rise in zip(ways, rises, strict=True)
            if rise is not upright
        ]
    if not loops:
        raise job.fault(f"the course curves more tightly than the half width {half:g} mm", ref)
    return Area(
        ref=ref,
        walls=(*(Wall(loop=loop, inset=inset) for loop in loops), *stops),
        top=top,
        bottom=bottom,
        solid=_solid(middle, half) if outside else None,
        outside=outside,
        middle=middle,
        ends=beyond,
        rises=rises,
        bar=_bar(job, slot.swept_shape, is_open=len(outside) > 1),
    )


def _band(
    job: ToolPathTask, ref: Ref[Entity], middle: Chain, half: float, ends: Sequence[Entity]
) -> tuple[tuple[Loop, ...], Chain]:
    """Outline of a slot with two ends, and its edges beyond open ends."""
    before, after = (
        _beyond(job, end, half) if isinstance(end, OpenSlotEndType) else 0.0 for end in ends
    )
    way = stretched(middle, before, after)
    left = offset_left(way, half)
    right = offset_left(reversed_chain(way), half)
    if len(left) != 1 or len(right) != 1:
        return (), ()
    caps = (
        _cap(right[0][-1].end, left[0][0].start, way[0].start, ends[0]),
        _cap(left[0][-1].end, right[0][0].start, way[-1].end, ends[1]),
    )
    outside = tuple(
        edge
        for cap, end in zip(caps, ends, strict=True)
        if isinstance(end, OpenSlotEndType)
        for edge in cap
    )
    outline = counter_clockwise(halved((*right[0], *caps[0], *left[0], *caps[1])))
    radius = min(
        (_corner(job, end, half) for end in ends if isinstance(end, FlatSlotEndType)),
        default=0.0,
    )
    return (rounded(outline, radius) if radius > 0.0 else (outline,)), outside


def _beyond(job: ToolPathTask, end: Entity, half: float) -> float:
    """Extension of a slot beyond the end of its course, mm."""
    if isinstance(end, OpenSlotEndType):
        return job.tool.diameter + run_out(job)
    return half if isinstance(end, RadiusedSlotEndType) else 0.0


def _bar(job: ToolPathTask, ref: Ref[Entity], *, is_open: bool) -> TeeSlotUndercut | None:
    """Wide undercut of a tee slot; None for other profiles."""
    profile = job.program.get(ref)
    if not isinstance(profile, TeeProfile):
        return None
    return TeeSlotUndercut(
        width=size(job.program, profile.cross_bar_width, ref),
        depth=size(job.program, profile.cross_bar_depth, ref),
        is_open=is_open,
    )


def _rise(job: ToolPathTask, end: Entity, depth: float) -> Inset:
    """Inset of a slot end by height: upright, or the arc of a Woodruff end."""
    if not isinstance(end, WoodruffSlotEndType):
        return upright
    radius = size(job.program, end.radius, job.step.features[0])
    reach = chord(radius, depth)
    return lambda height: reach - chord(radius, min(height, depth))


def _stop(way: Chain) -> Loop:
    """Square behind the end of a course, much larger than the slot."""
    end, along = way[-1].end, way[-1].along(1.0)
    far = 4.0 * chain_length(way)
    right, left = end - 1j * far * along, end + 1j * far * along
    back = 2.0 * far * along
    return polygon([right, left, left - back, right - back])


def _corner(job: ToolPathTask, end: FlatSlotEndType, half: float) -> float:
    """Smaller corner radius of a flat slot end, mm, so that nothing is overcut."""
    radii = []
    for ref in (end.corner_radius1, end.corner_radius2):
        radius = (job.program.get(ref).theoretical_size or 0.0) if ref is not None else 0.0
        if not 0.0 <= radius <= half * (1.0 + 1e-9):
            raise job.fault(
                f"corner radius {radius:g} mm must lie between 0 and half the width of the "
                f"slot, {half:g} mm",
                ref,
                "theoretical_size",
            )
        radii.append(radius)
    # Just below half the width, so that a middle line remains after the inward offset.
    return min(*radii, half - ROUNDEST)


def _solid(middle: Chain, half: float) -> Loop:
    """Outline of the slot between the ends of its course."""
    left, right = offset_left(middle, half), offset_left(reversed_chain(middle), half)
    caps = (line(right[0][-1].end, left[0][0].start), line(left[0][-1].end, right[0][0].start))
    return counter_clockwise((*right[0], caps[0], *left[0], caps[1]))


def _cap(start: complex, end: complex, centre: complex, kind: Entity) -> Chain:
    """End of a slot outline: a line or half circle from one side to the other."""
    if isinstance(kind, RadiusedSlotEndType):
        # From the right side to the left side at the start, and vice versa at the end.
        return halved([ContourEdge(start, end, centre, -pi)])
    return (line(start, end),)


def _ring(middle: Chain, half: float) -> tuple[Loop, ...]:
    """Outline of a slot with a closed course."""
    loop = counter_clockwise(middle)
    inner = erode([loop], half)
    outer = tuple(reversed_chain(each) for each in erode([reversed_chain(loop)], half))
    return (*outer, *(clockwise(each) for each in inner)) if outer else ()


def _section(job: ToolPathTask, ref: Ref[Entity], depth: float) -> tuple[float, Inset]:
    """Half the width of a slot profile at the top, and the inset of its walls by height."""
    profile = job.program.get(ref)
    if isinstance(profile, (SquareUProfile, TeeProfile)):
        return 0.5 * size(job.program, profile.width, ref), _square(job, profile, depth)
    if isinstance(profile, RoundedUProfile):
        half = 0.5 * size(job.program, profile.width, ref)
        return half, LeaningWall(depth=depth, slope=0.0, fillet=half)
    if isinstance(profile, VeeProfile):
        slope = tan(0.5 * vee_angle(profile.profile_angle))
        return depth * slope, LeaningWall(depth=depth, slope=slope, fillet=0.0)
    if isinstance(profile, PartialCircularProfile):
        radius = size(job.program, profile.radius, ref)
        half = chord(radius, depth)
        return half, lambda height: half - chord(radius, min(height, depth))
    if isinstance(profile, GeneralProfile):
        return _general(job, ref, profile, depth)
    raise job.fault("a slot with this kind of profile cannot be milled", ref)


def _square(job: ToolPathTask, profile: SquareUProfile | TeeProfile, depth: float) -> Inset:
    """Wall inset of a square or tee profile; the flatter wall is used for both sides."""
    angles = [profile.first_angle or 0.0, profile.second_angle or 0.0]
    slope = max(
        tan(rad_from_deg(min(angle, 90.0 - angle) if angle > 45.0 else angle))
        for angle in angles
    )
    radii = (
        [profile.first_radius, profile.second_radius]
        if isinstance(profile, SquareUProfile)
        else []
    )
    sizes = [job.program.get(radius).theoretical_size or 0.0 for radius in radii if radius]
    radius = max(sizes, default=0.0)
    return LeaningWall(depth=depth, slope=slope, fillet=radius)


def _general(
    job: ToolPathTask, ref: Ref[Entity], profile: GeneralProfile, depth: float
) -> tuple[float, Inset]:
    """Half width and inset of a general profile in the x-z plane; the narrower side counts."""
    points = []
    for segment in segments_of(job.program, profile.its_profile):
        points += [segment.start, segment.end]
    lowest = min(point[2] for point in points)
    sides = [
        [(abs(x), z - lowest) for x, _, z in points if sign * x >= 0.0] for sign in (1.0, -1.0)
    ]
    if any(len(side) < 2 for side in sides):
        raise job.fault("the profile needs a wall on each side of its middle", ref)

    def half(height: float) -> float:
        return min(_width(sorted(side, key=lambda at: at[1]), height) for side in sides)

    widest = half(depth)
    return widest, lambda height: widest - half(min(height, depth))


def _width(side: Sequence[tuple[float, float]], height: float) -> float:
    """Half width of one side of a profile at a height, interpolated between its corners."""
    for (x0, z0), (x1, z1) in pairwise(side):
        if z0 <= height <= z1 and z1 > z0:
            return x0 + (x1 - x0) * (height - z0) / (z1 - z0)
    return side[-1][0] if height > side[-1][1] else max(x for x, z in side if z <= side[0][1])
