"""Milling features as areas and flanks (ISO 14649-10).

A feature lies in its own coordinates, its depth plane below their origin. Pockets are cleared
to their boundary, bosses stand as islands, faces are swept and run over; outside profiles,
bosses and steps are cut along.
"""

from collections.abc import Iterator
from math import atan, pi, sqrt, tan

from stepnc_model.entities.bottoms import (
    ConicalHoleBottom,
    FlatWithRadiusHoleBottom,
    HoleBottomCondition,
    SphericalHoleBottom,
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
    RoundHole,
    ShapeProfile,
    Slot,
    Step,
    TransitionFeature,
)
from stepnc_model.entities.profiles import AngleTaper, DiameterTaper
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.frame import Frame, frame_of
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.milling.area import (
    Area,
    Flank,
    Inset,
    Wall,
    chord,
    leaning,
    upright,
)
from stepnc_model.toolpath.milling.contour import Loop, circle, counter_clockwise, polygon
from stepnc_model.toolpath.milling.outline import (
    MOST,
    closed_outline,
    course,
    given,
    parameter,
    require_simple,
    require_upright,
    size,
    slope_of,
)
from stepnc_model.toolpath.milling.outside import outside_flank, step_flank
from stepnc_model.toolpath.milling.pocket import closed_pocket, islands, open_pocket
from stepnc_model.toolpath.milling.slot import slot_area
from stepnc_model.units import rad_from_deg


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
            if isinstance(part, CompoundFeature):
                raise job.fault("a compound feature within another one", ref, "elements")
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
    if not 0.0 < depth < MOST:
        raise job.fault(f"depth {depth:g} mm: it must be positive", ref, "depth")
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
    match feature:
        case PlanarFace():
            return _face(job, ref, feature, frame, bottom)
        case ClosedPocket():
            return closed_pocket(job, ref, feature, frame, bottom)
        case OpenPocket():
            return open_pocket(job, ref, feature, frame, bottom)
        case Slot():
            return slot_area(job, ref, feature, frame, bottom)
        case RoundHole():
            return _hole(job, ref, feature, frame, bottom)
        case Step():
            return step_flank(job, ref, feature, frame, bottom)
        case GeneralOutsideProfile() | Boss() | ShapeProfile():
            return outside_flank(job, ref, feature, frame, bottom)
    raise job.fault("a feature of this kind cannot be milled", ref)


def _face(job: Job, ref: Ref[Entity], feature: PlanarFace, frame: Frame, bottom: float) -> Area:
    """Rectangle of travel and profile, or the boundary given, around its bosses."""
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


def _hole(job: Job, ref: Ref[Entity], feature: RoundHole, frame: Frame, bottom: float) -> Area:
    """Round hole, straight or tapered; a cone or cap lies below its depth plane."""
    radius = 0.5 * size(job, feature.diameter, ref)
    top = frame.origin[2]
    centre = complex(frame.origin[0], frame.origin[1])
    angle = 0.0
    if feature.change_in_diameter is not None:
        taper = job.program.get(feature.change_in_diameter)
        angle = _taper_angle(job, ref, taper, radius=radius, depth=top - bottom)
    condition = job.program.get(feature.bottom_condition) if feature.bottom_condition else None
    fillet = 0.0
    if isinstance(condition, FlatWithRadiusHoleBottom):
        fillet = given(job, condition.corner_radius)
    side = leaning(depth=top - bottom, slope_deg=angle, fillet=fillet)
    deeper, half = _below(job, ref, condition, radius - side(0.0))

    def inset(height: float) -> float:
        return side(height - deeper) if height >= deeper else radius - half(height)

    wall = Wall(loop=circle(centre, radius), inset=inset if deeper > 0.0 else side)
    return Area(ref=ref, walls=(wall,), top=top, bottom=bottom - deeper)


def _below(
    job: Job, ref: Ref[Entity], condition: HoleBottomCondition | None, radius: float
) -> tuple[float, Inset]:
    """Depth of a cone or cap under the cylinder, and its half width over its lowest point."""
    if isinstance(condition, ConicalHoleBottom):
        written = condition.tip_angle or 0.0
        angle = written if written < pi else rad_from_deg(written)
        if not 0.0 < angle < pi:
            raise job.fault(f"a tip of {written:g} degrees is no cone", ref, "bottom_condition")
        deep = radius / tan(0.5 * angle)
        return deep, lambda height: radius * max(height, 0.0) / deep
    if isinstance(condition, SphericalHoleBottom):
        sphere = size(job, condition.radius, ref)
        if sphere < radius * (1.0 - 1e-9):
            raise job.fault(
                f"sphere of radius {sphere:g} mm below a hole of radius {radius:g} mm",
                ref,
                "bottom_condition",
            )
        deep = sphere - sqrt(max(sphere**2 - radius**2, 0.0))
        return deep, lambda height: chord(sphere, height)
    return 0.0, upright


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
        return slope_of(job, taper.angle, ref)
    final = 0.5 * size(job, taper.final_diameter, ref)
    if final > radius:
        raise job.fault("widens with depth: nothing can be milled from above", ref)
    return atan((radius - final) / depth) / rad_from_deg(1.0)
