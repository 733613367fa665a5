"""Conversion of milling features to areas and flanks (ISO 14649-10).

A feature is given in its own coordinates, with its depth plane below their origin. Pockets are
cleared to their boundary, bosses remain as islands, faces are swept and run over; outside
profiles, bosses and steps are cut along. The tool runs out of an open side of a pocket.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import atan, pi, sqrt, tan

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import (
    Boss,
    ClosedPocket,
    CompoundFeature,
    GeneralOutsideProfile,
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
    ConicalHoleBottom,
    DiameterTaper,
    FlatWithRadiusHoleBottom,
    GeneralPocketBottomCondition,
    HoleBottomCondition,
    RadiusedPocketBottomCondition,
    SphericalHoleBottom,
)
from stepnc_model.part21.values import Ref
from stepnc_model.programs.outline import (
    boundary_of,
    known_depth,
    parameter,
    size,
    size_or_zero,
    vee_angle,
)
from stepnc_model.toolpath.frame import Frame, frame_of, point_of
from stepnc_model.toolpath.milling.contour import (
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
from stepnc_model.toolpath.milling.cover import (
    Area,
    Flank,
    Inset,
    Wall,
    chord,
    leaning,
    upright,
)
from stepnc_model.toolpath.milling.offset import rounded
from stepnc_model.toolpath.milling.outline import (
    closed_outline,
    course,
    open_outline,
    require_simple,
    require_upright,
    slope_of,
    slot_area,
)
from stepnc_model.toolpath.milling.strategy import run_out
from stepnc_model.toolpath.task import ToolPathTask
from stepnc_model.units import rad_from_deg


def step_flank(
    job: ToolPathTask, ref: Ref[Entity], feature: Step, frame: Frame, bottom: float
) -> Flank:
    """Flank of a step: from its edge to the side of the stock on the right of its direction."""
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


def outside_flank(
    job: ToolPathTask,
    ref: Ref[Entity],
    feature: GeneralOutsideProfile | Boss | ShapeProfile,
    frame: Frame,
    bottom: float,
) -> Flank:
    """Flank of an outside profile or boss; an open outline has the part on its left."""
    boundary = boundary_of(feature)
    if boundary is None:
        raise job.fault("the feature has no boundary", ref)
    is_closed = isinstance(job.program.get(boundary), ClosedProfile)
    top = frame.origin[2]
    if is_closed:
        outline = closed_outline(job, boundary, frame)
        require_simple(job, outline, ref)
        chain = clockwise(outline)
    else:
        chain = reversed_chain(open_outline(job, boundary, frame))
    slope = slope_of(job, getattr(feature, "slope", None), ref)
    return Flank(
        ref=ref,
        chain=chain,
        is_closed=is_closed,
        inset=leaning(depth=top - bottom, slope_deg=slope),
        top=top,
        bottom=bottom,
    )


CHORD = 1e-3
"""Chord tolerance for polygons of an outline, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Island:
    """Boss that rises above the floor, with its wall."""

    ref: Ref[Boss]
    wall: Wall


def closed_pocket(
    job: ToolPathTask, ref: Ref[Entity], feature: ClosedPocket, frame: Frame, bottom: float
) -> Area:
    """Area of a closed pocket.

    Raises
    ------
    PathError
        If the boundary crosses itself, or an island touches it.
    """
    outline = closed_outline(job, feature.feature_boundary, frame)
    require_simple(job, outline, ref)
    area, found = _pocket(job, ref, feature, frame, bottom=bottom, outline=outline)
    _require_apart(job, area.walls[0].loop, found)
    return area


def open_pocket(
    job: ToolPathTask, ref: Ref[Entity], feature: OpenPocket, frame: Frame, bottom: float
) -> Area:
    """Area of a pocket with an open side.

    Raises
    ------
    PathError
        If the boundary closes or crosses itself.
    """
    chain = open_outline(job, feature.open_boundary, frame)
    if abs(chain[0].start - chain[-1].end) < 1e-6:
        raise job.fault("the boundary is closed: an open pocket needs an opening", ref)
    solid = counter_clockwise((*chain, line(chain[-1].end, chain[0].start)))
    require_simple(job, solid, ref)
    box = _box(job, chain)
    outline = counter_clockwise((*chain, *box))
    require_simple(job, outline, ref)
    area, _ = _pocket(job, ref, feature, frame, bottom=bottom, outline=outline)
    return replace(area, solid=solid, outside=(box[1],))


def islands(
    job: ToolPathTask,
    owner: Ref[Entity],
    bosses: tuple[Ref[Boss], ...],
    frame: Frame,
    bottom: float,
) -> Iterator[Island]:
    """Bosses that rise above the floor; they are placed beside the feature, not within it."""
    # In a pattern or a compound feature the bosses move along with their feature.
    placement = getattr(job.program.get(owner), "feature_placement", None)
    beside = frame.inner(frame_of(job.program, placement).inverse())
    for ref in bosses or ():
        boss = job.program.get(ref)
        within = beside.inner(frame_of(job.program, boss.feature_placement))
        top = within.origin[2]
        if top <= bottom:
            continue
        loop = clockwise(closed_outline(job, boss.its_boundary, within))
        slope = slope_of(job, boss.slope, ref)
        inset = leaning(depth=top - bottom, slope_deg=slope)
        yield Island(ref=ref, wall=Wall(loop=loop, inset=inset, top=top))


def _pocket(
    job: ToolPathTask,
    ref: Ref[Entity],
    feature: Pocket,
    frame: Frame,
    *,
    bottom: float,
    outline: Loop,
) -> tuple[Area, list[Island]]:
    """Area of a pocket with rounded corners and floor fillet, and its islands."""
    top = frame.origin[2]
    fillet = size_or_zero(job.program, feature.planar_radius)
    slope = slope_of(job, feature.slope, ref)
    inset = leaning(depth=top - bottom, slope_deg=slope, fillet=fillet)
    loops = _with_corners(job, ref, feature.orthogonal_radius, outline)
    found = list(islands(job, ref, feature.its_boss, frame, bottom))
    walls = [*(Wall(loop=loop, inset=inset) for loop in loops), *(one.wall for one in found)]
    condition = job.program.get(feature.bottom_condition) if feature.bottom_condition else None
    if isinstance(condition, GeneralPocketBottomCondition):
        raise job.fault("a floor of general shape is not supported", ref, "bottom_condition")
    if isinstance(condition, RadiusedPocketBottomCondition):
        walls.append(_dish(job, condition, frame, bottom))
    return Area(ref=ref, walls=tuple(walls), top=top, bottom=bottom), found


def _with_corners(
    job: ToolPathTask,
    ref: Ref[Entity],
    radius_ref: Ref[TolerancedLengthMeasure] | None,
    outline: Loop,
) -> tuple[Loop, ...]:
    """Outline with its sharp corners rounded as the feature specifies."""
    radius = size_or_zero(job.program, radius_ref)
    if radius <= 0.0:
        return (outline,)
    loops = rounded(outline, radius)
    if len(loops) != 1:
        raise job.fault(
            f"corner radius {radius:g} mm does not fit in the boundary",
            ref,
            "orthogonal_radius",
        )
    return loops


def _dish(
    job: ToolPathTask, condition: RadiusedPocketBottomCondition, frame: Frame, bottom: float
) -> Wall:
    """Spherical floor as a wall, with its lowest point at or above the depth plane."""
    x, y, z = frame.point(point_of(job.program, condition.floor_radius_center))
    radius = size(job.program, condition.floor_radius, condition.floor_radius_center)
    raised = max(z - radius - bottom, 0.0)
    return Wall(
        loop=circle(complex(x, y), radius),
        inset=lambda height: radius - chord(radius, height - raised),
    )


def _box(job: ToolPathTask, chain: Chain) -> Chain:
    """Box in front of the opening, from the end of an open pocket's wall to its start."""
    start, end = chain[0].start, chain[-1].end
    opening = start - end
    reach = job.tool.diameter + run_out(job)
    middle = shape((*chain, line(end, start)), tolerance=CHORD).representative_point()
    outward = 1j * opening / abs(opening)
    inside = complex(middle.x, middle.y) - 0.5 * (start + end)
    if (outward.conjugate() * inside).real > 0.0:
        outward = -outward
    before, after = start + reach * outward, end + reach * outward
    return (line(end, after), line(after, before), line(before, start))


def _require_apart(job: ToolPathTask, outline: Loop, islands: list[Island]) -> None:
    """Raise an error if an island touches the wall of its pocket."""
    outer = shape(outline, tolerance=CHORD)
    for island in islands:
        solid = shape(island.wall.loop, tolerance=CHORD)
        if outer.exterior.distance(solid) <= CHORD or not outer.covers(solid):
            raise job.fault(
                "the boss touches the wall of its pocket", island.ref, "its_boundary"
            )


def shapes(job: ToolPathTask, ref: Ref[Entity], frame: Frame) -> Iterator[Area | Flank]:
    """Areas and flanks that a feature removes.

    Parameters
    ----------
    ref : Ref
        A feature, not a pattern.
    frame : Frame
        Position of the feature in the setup.

    Raises
    ------
    PathError
        If a size is missing, the boundary is invalid, or the kind of feature cannot be milled.
    """
    feature = job.program.get(ref)
    require_upright(job, frame, ref)
    if isinstance(feature, CompoundFeature):
        for element in feature.elements:
            part = job.program.get(element)
            if isinstance(part, CompoundFeature):
                raise job.fault("nested compound features are not supported", ref, "elements")
            if not isinstance(part, TransitionFeature):
                placement = getattr(part, "feature_placement", None)
                yield from shapes(job, element, frame.inner(frame_of(job.program, placement)))
        return
    make = next((make for kind, make in MAKERS if isinstance(feature, kind)), None)
    if make is None:
        raise job.fault("this kind of feature cannot be milled", ref)
    yield make(job, ref, feature, frame, floor_of(job, ref, frame))


def floor_of(job: ToolPathTask, ref: Ref[Entity], frame: Frame) -> float:
    """Height of a feature's depth plane in the setup, mm."""
    depth = known_depth(job.program, ref)
    bottom = frame.origin[2] - depth
    if job.stock is not None and bottom < job.stock.low[2] - 1e-6:
        raise job.fault(
            f"the feature's floor at z = {bottom:g} mm lies below the workpiece, "
            f"whose bottom is at z = {job.stock.low[2]:g} mm",
            ref,
            "depth",
        )
    return bottom


def _face(
    job: ToolPathTask, ref: Ref[Entity], feature: PlanarFace, frame: Frame, bottom: float
) -> Area:
    """Area of a planar face: its boundary, or travel times profile, around its bosses."""
    if feature.face_boundary is not None:
        face = closed_outline(job, feature.face_boundary, frame)
        require_simple(job, face, ref)
    else:
        face = _swept(job, feature, frame)
    return Area(
        ref=ref,
        walls=tuple(
            island.wall for island in islands(job, ref, feature.its_boss, frame, bottom)
        ),
        top=frame.origin[2],
        bottom=bottom,
        face=face,
        solid=face,
    )


def _swept(job: ToolPathTask, feature: PlanarFace, frame: Frame) -> Loop:
    """Rectangle of travel and profile; the profile points towards +x, or +y for travel in x."""
    travel = course(job, feature.course_of_travel, frame)
    start, along = travel[0].start, travel[0].end - travel[0].start
    width = parameter(job.program, job.program.get(feature.removal_boundary).profile_length)
    across = -1j * along / abs(along)
    sign = across.real if abs(across.real) > 1e-9 else across.imag
    across = across * width * (1.0 if sign > 0.0 else -1.0)
    return counter_clockwise(
        polygon([start, start + along, start + along + across, start + across])
    )


def _hole(
    job: ToolPathTask, ref: Ref[Entity], feature: RoundHole, frame: Frame, bottom: float
) -> Area:
    """Area of a straight or tapered round hole; a conical or spherical bottom lies below it."""
    radius = 0.5 * size(job.program, feature.diameter, ref)
    top = frame.origin[2]
    centre = complex(frame.origin[0], frame.origin[1])
    angle = 0.0
    if feature.change_in_diameter is not None:
        taper = job.program.get(feature.change_in_diameter)
        angle = _taper_angle(job, ref, taper, radius=radius, depth=top - bottom)
    condition = job.program.get(feature.bottom_condition) if feature.bottom_condition else None
    fillet = 0.0
    if isinstance(condition, FlatWithRadiusHoleBottom):
        fillet = size_or_zero(job.program, condition.corner_radius)
    side = leaning(depth=top - bottom, slope_deg=angle, fillet=fillet)
    deeper, half = _below(job, ref, condition, radius - side(0.0))

    def inset(height: float) -> float:
        return side(height - deeper) if height >= deeper else radius - half(height)

    wall = Wall(loop=circle(centre, radius), inset=inset if deeper > 0.0 else side)
    return Area(ref=ref, walls=(wall,), top=top, bottom=bottom - deeper)


def _below(
    job: ToolPathTask, ref: Ref[Entity], condition: HoleBottomCondition | None, radius: float
) -> tuple[float, Inset]:
    """Depth of a conical or spherical bottom, and its half width by height above its tip."""
    if isinstance(condition, ConicalHoleBottom):
        written = condition.tip_angle or 0.0
        angle = vee_angle(written)
        if not 0.0 < angle < pi:
            raise job.fault(
                f"a tip angle of {written:g} degrees is not a valid cone",
                ref,
                "bottom_condition",
            )
        deep = radius / tan(0.5 * angle)
        return deep, lambda height: radius * max(height, 0.0) / deep
    if isinstance(condition, SphericalHoleBottom):
        sphere = size(job.program, condition.radius, ref)
        if sphere < radius * (1.0 - 1e-9):
            raise job.fault(
                f"sphere radius {sphere:g} mm is smaller than the hole radius {radius:g} mm",
                ref,
                "bottom_condition",
            )
        deep = sphere - sqrt(max(sphere**2 - radius**2, 0.0))
        return deep, lambda height: chord(sphere, height)
    return 0.0, upright


def _taper_angle(
    job: ToolPathTask,
    ref: Ref[Entity],
    taper: DiameterTaper | AngleTaper,
    *,
    radius: float,
    depth: float,
) -> float:
    """Wall angle of a tapered hole from the vertical, degrees."""
    if isinstance(taper, AngleTaper):
        return slope_of(job, taper.angle, ref)
    final = 0.5 * size(job.program, taper.final_diameter, ref)
    if final > radius:
        raise job.fault("the hole widens with depth: it cannot be milled from above", ref)
    return atan((radius - final) / depth) / rad_from_deg(1.0)


MAKERS: tuple[tuple[type[Entity], Callable[..., Area | Flank]], ...] = (
    (PlanarFace, _face),
    (ClosedPocket, closed_pocket),
    (OpenPocket, open_pocket),
    (Slot, slot_area),
    (RoundHole, _hole),
    (Step, step_flank),
    (GeneralOutsideProfile, outside_flank),
    (Boss, outside_flank),
    (ShapeProfile, outside_flank),
)
"""Functions that convert each kind of feature to an area or a flank."""
