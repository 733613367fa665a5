"""Slots: an open profile swept along a course of travel (ISO 14649-10).

The course runs through the middle of the profile. An open end is run out of; a radiused end is
a half circle about the end of the course, beyond it; a flat end stops there. So does a Woodruff
end at the top, and runs down to the floor along the arc that a disc leaves. The width of a
profile is the one at the top; angles of walls are from the vertical.
"""

from collections.abc import Sequence
from itertools import pairwise
from math import pi, tan

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import Slot
from stepnc_model.entities.profiles import (
    FlatSlotEndType,
    GeneralProfile,
    LoopSlotEndType,
    OpenSlotEndType,
    PartialCircularProfile,
    RadiusedSlotEndType,
    RoundedUProfile,
    SquareUProfile,
    TeeProfile,
    VeeProfile,
    WoodruffSlotEndType,
)
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.curve import JOINED, segments_of
from stepnc_model.toolpath.frame import Frame
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.milling.area import Area, Bar, Inset, Wall, chord, rounding, upright
from stepnc_model.toolpath.milling.contour import (
    Chain,
    Edge,
    Loop,
    chain_length,
    clockwise,
    counter_clockwise,
    halved,
    line,
    polygon,
    reversed_chain,
    stretched,
)
from stepnc_model.toolpath.milling.cutter import run_out
from stepnc_model.toolpath.milling.offset import beside, erode, rounded
from stepnc_model.toolpath.milling.outline import course, size
from stepnc_model.units import rad_from_deg

ROUNDEST = 1e-3
"""mm by which the radius of a corner stays below half the width"""


def slot_area(job: Job, ref: Ref[Entity], slot: Slot, frame: Frame, bottom: float) -> Area:
    """Area of a slot.

    Raises
    ------
    PathError
        When it has no width, or turns more sharply than half its width.
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
        raise job.fault(f"its course does not close: a gap of {gap:.4g} mm", ref)
    else:
        # One end condition stands for both ends.
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
        raise job.fault(f"its course turns more sharply than its half width {half:g} mm", ref)
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
    job: Job, ref: Ref[Entity], middle: Chain, half: float, ends: Sequence[Entity]
) -> tuple[tuple[Loop, ...], Chain]:
    """Outline of a slot with two ends, and the edges of it that lie beyond open ends."""
    before, after = (
        _beyond(job, end, half) if isinstance(end, OpenSlotEndType) else 0.0 for end in ends
    )
    way = stretched(middle, before, after)
    left = beside(way, half)
    right = beside(reversed_chain(way), half)
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


def _beyond(job: Job, end: Entity, half: float) -> float:
    """How far a slot goes on beyond the end of its course, mm."""
    if isinstance(end, OpenSlotEndType):
        return job.tool.diameter + run_out(job)
    return half if isinstance(end, RadiusedSlotEndType) else 0.0


def _bar(job: Job, ref: Ref[Entity], *, is_open: bool) -> Bar | None:
    """The wide part of a tee slot."""
    profile = job.program.get(ref)
    if not isinstance(profile, TeeProfile):
        return None
    return Bar(
        width=size(job, profile.cross_bar_width, ref),
        depth=size(job, profile.cross_bar_depth, ref),
        is_open=is_open,
    )


def _rise(job: Job, end: Entity, depth: float) -> Inset:
    """How far an end stands in the slot: upright, or the arc of a Woodruff end."""
    if not isinstance(end, WoodruffSlotEndType):
        return upright
    radius = size(job, end.radius, job.step.features[0])
    reach = chord(radius, depth)
    return lambda height: reach - chord(radius, min(height, depth))


def _stop(way: Chain) -> Loop:
    """Everything behind the end of a course: a square far larger than the slot."""
    end, along = way[-1].end, way[-1].along(1.0)
    far = 4.0 * chain_length(way)
    right, left = end - 1j * far * along, end + 1j * far * along
    back = 2.0 * far * along
    return polygon([right, left, left - back, right - back])


def _corner(job: Job, end: FlatSlotEndType, half: float) -> float:
    """The smaller radius of the corners of a flat end: nothing is cut into."""
    radii = []
    for ref in (end.corner_radius1, end.corner_radius2):
        radius = (job.program.get(ref).theoretical_size or 0.0) if ref is not None else 0.0
        if not 0.0 <= radius <= half * (1.0 + 1e-9):
            raise job.fault(
                f"corner radius {radius:g} mm: it lies between 0 and half the width of the "
                f"slot, {half:g} mm",
                ref,
                "theoretical_size",
            )
        radii.append(radius)
    # Just below half the width, so that a middle line is left to round about.
    return min(*radii, half - ROUNDEST)


def _solid(middle: Chain, half: float) -> Loop:
    """The slot between the ends of its course."""
    left, right = beside(middle, half), beside(reversed_chain(middle), half)
    caps = (line(right[0][-1].end, left[0][0].start), line(left[0][-1].end, right[0][0].start))
    return counter_clockwise((*right[0], caps[0], *left[0], caps[1]))


def _cap(start: complex, end: complex, centre: complex, kind: Entity) -> Chain:
    """Line or half circle from one side of a slot to the other, around its end."""
    if isinstance(kind, RadiusedSlotEndType):
        # From the right side to the left one behind the start, and the other way round.
        return halved([Edge(start, end, centre, -pi)])
    return (line(start, end),)


def _ring(middle: Chain, half: float) -> tuple[Loop, ...]:
    """Outline of a slot that comes back to its start."""
    loop = counter_clockwise(middle)
    inner = erode([loop], half)
    outer = tuple(reversed_chain(each) for each in erode([reversed_chain(loop)], half))
    return (*outer, *(clockwise(each) for each in inner)) if outer else ()


def _section(job: Job, ref: Ref[Entity], depth: float) -> tuple[float, Inset]:
    """Half the width at the top, and the inset of the walls."""
    profile = job.program.get(ref)
    if isinstance(profile, (SquareUProfile, TeeProfile)):
        return 0.5 * size(job, profile.width, ref), _square(job, profile, depth)
    if isinstance(profile, RoundedUProfile):
        half = 0.5 * size(job, profile.width, ref)
        return half, lambda height: rounding(height, half)
    if isinstance(profile, VeeProfile):
        slope = tan(0.5 * _angle(profile.profile_angle))
        return depth * slope, lambda height: max(depth - height, 0.0) * slope
    if isinstance(profile, PartialCircularProfile):
        radius = size(job, profile.radius, ref)
        half = chord(radius, depth)
        return half, lambda height: half - chord(radius, min(height, depth))
    if isinstance(profile, GeneralProfile):
        return _general(job, ref, profile, depth)
    raise job.fault("a slot of this profile cannot be milled", ref)


def _square(job: Job, profile: SquareUProfile | TeeProfile, depth: float) -> Inset:
    """The steeper of the two walls counts on both sides: nothing is cut into."""
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
    return lambda height: max(depth - height, 0.0) * slope + rounding(height, radius)


def _angle(written: float | None) -> float:
    """Included angle in rad; no vee is as sharp as 3°, so small numbers are radians."""
    angle = written or 0.0
    return angle if angle < pi else rad_from_deg(angle)


def _general(
    job: Job, ref: Ref[Entity], profile: GeneralProfile, depth: float
) -> tuple[float, Inset]:
    """Any profile, drawn in the x, z plane about the middle; the narrower side counts twice."""
    points = []
    for segment in segments_of(job.program, profile.its_profile):
        points += [segment.start, segment.end]
    lowest = min(point[2] for point in points)
    sides = [
        [(abs(x), z - lowest) for x, _, z in points if sign * x >= 0.0] for sign in (1.0, -1.0)
    ]
    if any(len(side) < 2 for side in sides):
        raise job.fault("needs a wall on either side of its middle", ref)

    def half(height: float) -> float:
        return min(_width(sorted(side, key=lambda at: at[1]), height) for side in sides)

    widest = half(depth)
    return widest, lambda height: widest - half(min(height, depth))


def _width(side: Sequence[tuple[float, float]], height: float) -> float:
    """Half width of one side at a height, linear between its corners."""
    for (x0, z0), (x1, z1) in pairwise(side):
        if z0 <= height <= z1 and z1 > z0:
            return x0 + (x1 - x0) * (height - z0) / (z1 - z0)
    return side[-1][0] if height > side[-1][1] else max(x for x, z in side if z <= side[0][1])
