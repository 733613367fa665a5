"""Milling features as areas and flanks (ISO 14649-10).

A feature lies in its own coordinates, its depth plane below their origin. Pockets are cleared
to their boundary, bosses stand as islands, faces are swept and run over; outside profiles,
bosses and steps are cut along.
"""

from collections.abc import Iterator
from dataclasses import replace
from math import atan, sqrt

from stepnc_model.entities.bottoms import (
    GeneralPocketBottomCondition,
    RadiusedPocketBottomCondition,
)
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import (
    Boss,
    ClosedPocket,
    CompoundFeature,
    GeneralOutsideProfile,
    MachiningFeature,
    OpenPocket,
    PlanarFace,
    Pocket,
    RoundHole,
    ShapeProfile,
    Slot,
    Step,
    TransitionFeature,
)
from stepnc_model.entities.measures import TolerancedLengthMeasure
from stepnc_model.entities.profiles import (
    AngleTaper,
    ClosedProfile,
    DiameterTaper,
)
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.area import Area, Flank, Inset, Wall, leaning, upright
from stepnc_model.toolpath.contour import (
    Chain,
    Loop,
    circle,
    clockwise,
    counter_clockwise,
    line,
    polygon,
    reversed_chain,
    shape,
)
from stepnc_model.toolpath.frame import Frame, frame_of, point_of
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.offset import rounded
from stepnc_model.toolpath.outline import (
    closed_outline,
    course,
    open_outline,
    parameter,
    require_upright,
    size,
)
from stepnc_model.toolpath.slot import slot_area
from stepnc_model.units import rad_from_deg

RUN_OUT = 2.0
"""mm beyond a tool's own diameter by which an open side is run over"""

CHORD = 1e-3
"""mm of tolerance where an outline is looked at as a polygon"""


def shapes(job: Job, ref: Ref[Entity], frame: Frame) -> Iterator[Area | Flank]:
    """What a feature asks to be removed.

    Parameters
    ----------
    job : Job
    ref : Ref
        The feature, no pattern.
    frame : Frame
        Its place in the setup.

    Raises
    ------
    PathError
        When it lacks a size, its boundary is none, or its kind cannot be milled.
    """
    feature = job.program.get(ref)
    require_upright(job, frame, ref)
    if isinstance(feature, CompoundFeature):
        for element in feature.elements:
            part = job.program.get(element)
            if not isinstance(part, TransitionFeature):
                placement = getattr(part, "feature_placement", None)
                yield from shapes(job, element, frame.inner(frame_of(job.program, placement)))
        return
    if not isinstance(feature, MachiningFeature):
        raise job.fault("a feature of this kind cannot be milled", ref)
    bottom = floor_of(job, ref, feature, frame)
    yield _shape(job, ref, feature, frame, bottom)


def floor_of(job: Job, ref: Ref[Entity], feature: MachiningFeature, frame: Frame) -> float:
    """Height of a feature's depth plane in the setup, mm."""
    plane = getattr(feature, "depth", None)
    if plane is None:
        raise job.fault("has no depth", ref, "depth")
    below = frame_of(job.program, job.program.get(plane).position).origin[2]
    depth = abs(below)
    if depth <= 0.0:
        raise job.fault(f"depth {depth:g} mm removes nothing", ref, "depth")
    bottom = frame.origin[2] - depth
    if job.stock is not None and bottom < job.stock.low[2] - 1e-6:
        raise job.fault(
            f"its floor at z = {bottom:g} mm lies below the workpiece, "
            f"which ends at z = {job.stock.low[2]:g} mm",
            ref,
            "depth",
        )
    return bottom


def _shape(
    job: Job, ref: Ref[Entity], feature: MachiningFeature, frame: Frame, bottom: float
) -> Area | Flank:
    """Area or flank of one feature."""
    if isinstance(feature, PlanarFace):
        return _face(job, ref, feature, frame, bottom)
    if isinstance(feature, ClosedPocket):
        outline = closed_outline(job, feature.feature_boundary, frame)
        return _pocket(job, ref, feature, frame, bottom=bottom, outline=outline)
    if isinstance(feature, OpenPocket):
        chain = open_outline(job, feature.open_boundary, frame)
        box = _box(job, ref, chain)
        outline = counter_clockwise((*chain, *box))
        area = _pocket(job, ref, feature, frame, bottom=bottom, outline=outline)
        solid = counter_clockwise((*chain, line(chain[-1].end, chain[0].start)))
        return replace(area, solid=solid, outside=(box[1],))
    if isinstance(feature, Slot):
        return slot_area(job, ref, feature, frame, bottom)
    if isinstance(feature, RoundHole):
        return _hole(job, ref, feature, frame, bottom)
    if isinstance(feature, Step):
        return _step(job, ref, feature, frame, bottom)
    if isinstance(feature, (GeneralOutsideProfile, Boss, ShapeProfile)):
        return _outside(job, ref, feature, frame, bottom)
    raise job.fault("a feature of this kind cannot be milled", ref)


def _face(job: Job, ref: Ref[Entity], feature: PlanarFace, frame: Frame, bottom: float) -> Area:
    """Rectangle of travel and profile, or the boundary given, around its bosses."""
    if feature.face_boundary is not None:
        face = closed_outline(job, feature.face_boundary, frame)
    else:
        face = _swept(job, feature, frame)
    return Area(
        ref=ref,
        walls=tuple(_islands(job, ref, feature.its_boss, frame, bottom)),
        top=frame.origin[2],
        bottom=bottom,
        face=face,
        solid=face,
    )


def _swept(job: Job, feature: PlanarFace, frame: Frame) -> Loop:
    """Travel times profile; the profile lies across the travel, towards +x, or +y along x."""
    travel = course(job, feature.course_of_travel, frame)
    start, along = travel[0].start, travel[0].end - travel[0].start
    width = parameter(job, job.program.get(feature.removal_boundary).profile_length)
    across = -1j * along / abs(along)
    sign = across.real if abs(across.real) > 1e-9 else across.imag
    across = across * width * (1.0 if sign > 0.0 else -1.0)
    return counter_clockwise(
        polygon([start, start + along, start + along + across, start + across])
    )


def _pocket(
    job: Job,
    ref: Ref[Entity],
    feature: Pocket,
    frame: Frame,
    *,
    bottom: float,
    outline: Loop,
) -> Area:
    """Boundary with rounded corners, islands, and the edge along the floor."""
    top = frame.origin[2]
    if not shape(outline, tolerance=CHORD).is_valid:
        raise job.fault("its boundary crosses itself", ref)
    outlines = _with_corners(job, ref, feature.orthogonal_radius, outline)
    fillet = _given(job, feature.planar_radius)
    inset = leaning(depth=top - bottom, slope_deg=feature.slope, fillet=fillet)
    islands = list(_islands(job, ref, feature.its_boss, frame, bottom))
    _require_apart(job, feature.its_boss, outlines, islands, feature)
    condition = job.program.get(feature.bottom_condition) if feature.bottom_condition else None
    if isinstance(condition, GeneralPocketBottomCondition):
        raise job.fault("a floor of any shape cannot be milled yet", ref, "bottom_condition")
    return Area(
        ref=ref,
        walls=(*(Wall(loop=loop, inset=inset) for loop in outlines), *islands),
        top=top,
        bottom=bottom,
        dish=_dish(job, condition, frame, bottom)
        if isinstance(condition, RadiusedPocketBottomCondition)
        else None,
    )


def _with_corners(
    job: Job,
    ref: Ref[Entity],
    radius_ref: Ref[TolerancedLengthMeasure] | None,
    outline: Loop,
) -> tuple[Loop, ...]:
    """The outline with its sharp corners rounded as the feature asks."""
    radius = _given(job, radius_ref)
    if radius <= 0.0:
        return (outline,)
    loops = rounded(outline, radius)
    if len(loops) != 1:
        raise job.fault(
            f"corners of {radius:g} mm do not fit in its boundary", ref, "orthogonal_radius"
        )
    return loops


def _dish(
    job: Job, condition: RadiusedPocketBottomCondition, frame: Frame, bottom: float
) -> "_Dish":
    """Floor that is part of a sphere, its lowest point on the depth plane at least."""
    centre = frame.point(point_of(job.program, condition.floor_radius_center))
    radius = size(job, condition.floor_radius, condition.floor_radius_center)
    return _Dish(complex(centre[0], centre[1]), max(centre[2], bottom + radius), radius)


class _Dish:
    """Sphere of a floor; called with a z it gives the circle that lies there."""

    def __init__(self, centre: complex, height: float, radius: float) -> None:
        self._centre, self._height, self._radius = centre, height, radius

    def __call__(self, z: float) -> Loop:
        below = min(max(self._height - z, 0.0), self._radius)
        return circle(self._centre, max(sqrt(self._radius**2 - below**2), 1e-6))


def _box(job: Job, ref: Ref[Entity], chain: Chain) -> Chain:
    """From the end of an open pocket's wall to its start, by a box in front of the opening."""
    start, end = chain[0].start, chain[-1].end
    opening = start - end
    if abs(opening) < 1e-6:
        raise job.fault("its boundary closes: an open pocket has an opening", ref)
    overcut = getattr(job.step.operation, "overcut_length", None) or 0.0
    reach = job.tool.diameter + overcut + RUN_OUT
    middle = shape((*chain, line(end, start)), tolerance=CHORD).representative_point()
    outward = 1j * opening / abs(opening)
    inside = complex(middle.x, middle.y) - 0.5 * (start + end)
    if (outward.conjugate() * inside).real > 0.0:
        outward = -outward
    before, after = start + reach * outward, end + reach * outward
    return (line(end, after), line(after, before), line(before, start))


def _hole(job: Job, ref: Ref[Entity], feature: RoundHole, frame: Frame, bottom: float) -> Area:
    """Round hole, straight or tapered."""
    radius = 0.5 * size(job, feature.diameter, ref)
    top = frame.origin[2]
    centre = complex(frame.origin[0], frame.origin[1])
    inset: Inset = upright
    if feature.change_in_diameter is not None:
        taper = job.program.get(feature.change_in_diameter)
        angle = _taper_angle(job, ref, taper, radius=radius, depth=top - bottom)
        inset = leaning(depth=top - bottom, slope_deg=angle)
    wall = Wall(loop=circle(centre, radius), inset=inset)
    return Area(ref=ref, walls=(wall,), top=top, bottom=bottom)


def _taper_angle(
    job: Job,
    ref: Ref[Entity],
    taper: DiameterTaper | AngleTaper,
    *,
    radius: float,
    depth: float,
) -> float:
    """Lean of a tapered hole's wall in degrees."""
    if isinstance(taper, AngleTaper):
        return taper.angle
    final = 0.5 * size(job, taper.final_diameter, ref)
    if final > radius:
        raise job.fault("widens with depth: nothing can be milled from above", ref)
    return atan((radius - final) / depth) / rad_from_deg(1.0)


def _step(job: Job, ref: Ref[Entity], feature: Step, frame: Frame, bottom: float) -> Flank:
    """From the edge to the side of the stock on the right of its sense."""
    edge = course(job, feature.open_boundary, frame)
    chain = reversed_chain(edge)
    width = None
    if job.stock is not None:
        out = 1j * chain[0].along(0.0)
        sides = [
            complex(x, y)
            for x in (job.stock.low[0], job.stock.high[0])
            for y in (job.stock.low[1], job.stock.high[1])
        ]
        width = max((out.conjugate() * (side - edge[0].start)).real for side in sides)
    return Flank(
        ref=ref,
        chain=chain,
        is_closed=False,
        inset=upright,
        top=frame.origin[2],
        bottom=bottom,
        width=width if width and width > 0.0 else None,
    )


def _outside(
    job: Job,
    ref: Ref[Entity],
    feature: GeneralOutsideProfile | Boss | ShapeProfile,
    frame: Frame,
    bottom: float,
) -> Flank:
    """Outline with the part inside; an open one with the part on its left."""
    boundary = next(
        getattr(feature, name)
        for name in (
            "feature_boundary",
            "its_boundary",
            "profile_boundary",
            "closed_boundary",
            "open_boundary",
        )
        if hasattr(feature, name)
    )
    is_closed = isinstance(job.program.get(boundary), ClosedProfile)
    top = frame.origin[2]
    if is_closed:
        outline = closed_outline(job, boundary, frame)
        if not shape(outline, tolerance=CHORD).is_valid:
            raise job.fault("its boundary crosses itself", ref)
        chain = clockwise(outline)
    else:
        chain = reversed_chain(open_outline(job, boundary, frame))
    return Flank(
        ref=ref,
        chain=chain,
        is_closed=is_closed,
        inset=leaning(depth=top - bottom, slope_deg=getattr(feature, "slope", None)),
        top=top,
        bottom=bottom,
    )


def _islands(
    job: Job, owner: Ref[Entity], bosses: tuple[Ref[Boss], ...], frame: Frame, bottom: float
) -> Iterator[Wall]:
    """Bosses that reach above the floor; they are placed beside the feature, not within it."""
    # In a pattern the bosses of the base move along with it.
    copied = frame.inner(job.frame(owner).inverse())
    for ref in bosses or ():
        boss = job.program.get(ref)
        within = copied.inner(job.frame(ref))
        top = within.origin[2]
        if top <= bottom:
            continue
        loop = clockwise(closed_outline(job, boss.its_boundary, within))
        yield Wall(loop=loop, inset=leaning(depth=top - bottom, slope_deg=boss.slope))


def _require_apart(
    job: Job,
    bosses: tuple[Ref[Boss], ...],
    outlines: tuple[Loop, ...],
    islands: list[Wall],
    feature: Pocket,
) -> None:
    """Refuse an island that touches the wall of a closed pocket."""
    if isinstance(feature, OpenPocket):
        return
    outer = shape(outlines[0], tolerance=CHORD)
    for ref, wall in zip(bosses or (), islands, strict=False):
        island = shape(wall.loop, tolerance=CHORD)
        gap = outer.exterior.distance(island)
        if gap <= CHORD or not outer.covers(island):
            raise job.fault("touches the wall of its pocket", ref, "its_boundary")


def _given(job: Job, ref: Ref[TolerancedLengthMeasure] | None) -> float:
    """A size that may be absent, 0 then."""
    return float(job.program.get(ref).theoretical_size or 0.0) if ref is not None else 0.0
