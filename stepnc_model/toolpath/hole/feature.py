"""Holes of a workingstep: position, diameter, and the depth to which a tool goes.

These are round holes, the elements of counterbored and countersunk holes, patterns of them, and
other features whose placement and depth plane define where to drill (ISO 14649-10).

ISO 14649-10: the depth of a hole is the length of its cylindrical part, from its placement to
its depth plane. ISO 14649-11: ``cutting_depth`` is measured from the start of the cylindrical
part of the tool; for a centre drill, from its tip. A countersink, whose cylinder may stay above
the part, is measured like a centre drill here.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import cos, inf, pi, sqrt, tan

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import CompoundFeature, RoundHole
from stepnc_model.entities.geometry import CartesianPoint
from stepnc_model.entities.measures import PlusMinusValue
from stepnc_model.entities.milling import (
    Boring,
    CenterDrilling,
    CounterSinking,
    Drilling,
    DrillingOperation,
    DrillingTypeOperation,
    MultistepDrilling,
    Reaming,
    ThreadDrilling,
)
from stepnc_model.entities.profiles import (
    AngleTaper,
    ConicalHoleBottom,
    SphericalHoleBottom,
    ThroughBottomCondition,
    ThroughPocketBottomCondition,
)
from stepnc_model.entities.tools import BallEndmill, MillingCuttingTool, MillingToolBody
from stepnc_model.errors import Finding
from stepnc_model.part21.values import Ref
from stepnc_model.programs.outline import feature_depth
from stepnc_model.programs.tool import LEAST_TOP_ANGLE_DEG, body_of
from stepnc_model.toolpath.frame import (
    Frame,
    PlacedFeature,
    compound_of,
    frame_of,
    placements,
    point_of,
    surrounding_frame,
)
from stepnc_model.toolpath.path import Point
from stepnc_model.toolpath.task import ToolPathTask
from stepnc_model.units import rad_from_deg

SINK_TOOLS = ("COUNTERSINK", "COUNTERBORE", "BACKSIDE_COUNTERSINK", "BACKSIDE_COUNTERBORE")
"""EXPRESS keywords of tools that cut the wide part of a compound hole."""

DEFAULT_TOLERANCE = 0.01
"""Amount by which a tool may be wider than a hole without a tolerance, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hole:
    """Hole in setup coordinates; lengths in mm."""

    ref: Ref[Entity]
    """Round hole, or another feature that is drilled."""
    frame: Frame
    """Frame of the feature named by the workingstep."""
    top: Point
    """Centre of the plane from which the depth is measured."""
    entry_z: float
    """Height z where a tool enters the part: the top of the enclosing compound feature, mm."""
    depth: float | None
    """Depth of the cylindrical part below the top, mm; None where the file gives none."""
    diameter: float | None
    """Diameter at the top, mm; None for a feature that is not a round hole."""
    narrowest: float | None
    """Diameter at the narrow end of a taper, mm."""
    tolerance: float
    """Amount by which the hole may be wider than its diameter, mm."""
    bottom: Entity | None

    @property
    def is_tapered(self) -> bool:
        """True if the hole narrows with depth."""
        return self.narrowest != self.diameter

    @property
    def is_through(self) -> bool:
        """True if the hole is a through hole."""
        return isinstance(self.bottom, (ThroughBottomCondition, ThroughPocketBottomCondition))

    def at(self, z: float) -> Point:
        """Point on the hole's axis at height z."""
        return self.top[0], self.top[1], z

    def point(self, job: ToolPathTask, ref: Ref[CartesianPoint]) -> Point:
        """Convert a point from feature coordinates to setup coordinates."""
        return self.frame.point(point_of(job.program, ref))


def holes_of(job: ToolPathTask, operation: DrillingTypeOperation) -> Iterator[Hole]:
    """Holes that an operation machines, in the order of the file.

    Raises
    ------
    PathError
        If there is no hole, its axis is not parallel to the tool, or a size is missing.
    """
    if not job.step.features:
        raise job.fault("the workingstep has no feature to drill", job.step.ref, "its_feature")
    for feature in job.step.features:
        for placed in placements(job.program, job.step.setup, feature):
            yield _hole(job, operation, placed)


def _hole(job: ToolPathTask, operation: DrillingTypeOperation, placed: PlacedFeature) -> Hole:
    """Hole of a placed feature, or of the matching element of a compound feature."""
    frame = placed.frame
    if not frame.is_upright:
        along = ", ".join(f"{part:.4g}" for part in frame.z)
        message = f"the hole axis ({along}) is not parallel to the tool: use a separate setup"
        raise job.fault(message, placed.feature)
    with job.program.using(placed.feature):
        compound = job.program.get(placed.feature)
        if not isinstance(compound, CompoundFeature):
            return _sized(job, placed.feature, placed, frame, entry_z=_entry(job, placed))
        element = _element(job, operation, placed.feature, compound.elements)
        placement = getattr(job.program.get(element), "feature_placement", None)
        inner = frame.inner(frame_of(job.program, placement))
        if not inner.is_upright:
            raise job.fault("the hole axis is not parallel to the tool", element)
        return _sized(job, element, placed, inner, entry_z=frame.origin[2])


def _entry(job: ToolPathTask, placed: PlacedFeature) -> float:
    """Height z of the compound feature around a feature that is named directly."""
    own = placed.frame.origin[2]
    if compound_of(job.program, placed.feature) is None:
        return own
    around: Frame = surrounding_frame(job.program, job.step.setup, placed.feature)
    return max(own, around.origin[2])


def _element(
    job: ToolPathTask,
    operation: DrillingTypeOperation,
    ref: Ref[Entity],
    elements: Sequence[Ref[Entity]],
) -> Ref[Entity]:
    """Round hole of a compound feature that the operation and its tool machine.

    A countersink or counterbore machines the tapered element, else the widest; a centre drill
    the uppermost; any other tool the narrowest that it fits into, else the widest.
    """
    holes = ((each, job.program.get(each)) for each in elements)
    widths = {
        each: size_of(job, each, hole) for each, hole in holes if isinstance(hole, RoundHole)
    }
    if not widths:
        raise job.fault(
            "the compound feature has no round hole among its elements", ref, "elements"
        )
    if isinstance(operation, CenterDrilling):
        return max(widths, key=lambda each: _height(job, each))
    if isinstance(operation, CounterSinking) or job.tool.keyword in SINK_TOOLS:
        return max(widths, key=lambda each: (_has_taper(job, each), widths[each]))
    fitting = {each: width for each, width in widths.items() if _fits(job, width)}
    if not fitting:
        return max(widths, key=widths.__getitem__)
    return min(fitting, key=fitting.__getitem__)


def _fits(job: ToolPathTask, width: float) -> bool:
    return job.tool.diameter <= width + DEFAULT_TOLERANCE


def _height(job: ToolPathTask, element: Ref[Entity]) -> float:
    placement = getattr(job.program.get(element), "feature_placement", None)
    return frame_of(job.program, placement).origin[2]


def _has_taper(job: ToolPathTask, element: Ref[Entity]) -> bool:
    return getattr(job.program.get(element), "change_in_diameter", None) is not None


def _sized(
    job: ToolPathTask, ref: Ref[Entity], placed: PlacedFeature, own: Frame, *, entry_z: float
) -> Hole:
    """Hole with its dimensions; its depth is measured from the top of the named feature."""
    entity = job.program.get(ref)
    depth = feature_depth(job.program, ref)
    diameter = narrowest = None
    if isinstance(entity, RoundHole):
        diameter = size_of(job, ref, entity)
        narrowest = narrowest_of(job, entity, diameter, depth)
    x, y, z = own.origin
    top_z = placed.frame.origin[2]
    bottom = getattr(entity, "bottom_condition", None)
    return Hole(
        ref=ref,
        frame=placed.frame,
        top=(x, y, top_z),
        entry_z=entry_z,
        depth=None if depth is None else depth + top_z - z,
        diameter=diameter,
        narrowest=narrowest,
        tolerance=tolerance_of(job, entity),
        bottom=job.program.get(bottom) if bottom is not None else None,
    )


def size_of(job: ToolPathTask, ref: Ref[Entity], hole: RoundHole) -> float:
    """Diameter of a round hole at its top, mm."""
    diameter = float(job.program.get(hole.diameter).theoretical_size)
    if not 0.0 < diameter < inf:
        raise job.fault(f"{diameter:g} mm: the diameter must be positive", ref, "diameter")
    return diameter


def narrowest_of(
    job: ToolPathTask, hole: RoundHole, diameter: float, depth: float | None
) -> float:
    """Diameter at the depth plane, mm: the narrow end of a tapered hole."""
    if hole.change_in_diameter is None:
        return diameter
    taper = job.program.get(hole.change_in_diameter)
    if isinstance(taper, AngleTaper):
        half = rad_from_deg(taper.angle)
        end = diameter - 2.0 * (depth or 0.0) * tan(half if 0.0 < half < 0.5 * pi else 0.0)
    else:
        end = float(job.program.get(taper.final_diameter).theoretical_size)
    return min(diameter, max(0.0, end))


def tolerance_of(job: ToolPathTask, entity: Entity) -> float:
    """Amount by which a hole may be wider than its diameter, mm."""
    if isinstance(entity, RoundHole):
        given = job.program.get(entity.diameter).implicit_tolerance
        limits = job.program.get(given) if given is not None else None
        if isinstance(limits, PlusMinusValue):
            return max(DEFAULT_TOLERANCE, limits.upper_limit)
    return DEFAULT_TOLERANCE


TOLERANCE = 1e-6
"""Tolerance of lengths, mm."""

FITTING = (Drilling, MultistepDrilling, Reaming, Boring, ThreadDrilling)
"""Operations whose tool must not be wider than the hole."""

TAPERED_TOOLS = ("TAPERED_DRILL", "TAPERED_REAMER")
"""EXPRESS keywords of tools that may be wider than the narrow end of a taper."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Depth:
    """Depths of a tool below the top of a hole, mm."""

    full: float
    """Depth of the tool's full diameter; negative if it stays above the hole, mm."""
    tip: float
    """Depth of the tool tip, mm."""


def depth_of(job: ToolPathTask, operation: DrillingTypeOperation, hole: Hole) -> Depth:
    """Depth to which an operation goes in a hole.

    Raises
    ------
    PathError
        If the depth is missing or not positive, the tool is wider than the hole, or a blind
        hole would break through the workpiece.
    """
    _check_width(job, operation, hole)
    point = tip_length(job)
    given = operation.cutting_depth
    if given is not None and not 0.0 < given < inf:
        message = f"{given:g} mm: the cutting depth must be positive"
        raise job.fault(message, job.step.operation_ref, "cutting_depth")
    if isinstance(operation, (CenterDrilling, CounterSinking)):
        is_sink = isinstance(operation, CounterSinking)
        tip = given or (_sink(job, hole) if is_sink else _centre(job, point))
    elif given is not None:
        tip = given + point
    elif hole.is_through:
        tip = _bottom(job, hole) + _overcut(job, operation) + point
    else:
        tip = _bottom(job, hole) + min(point, _below(job, hole))
    depth = Depth(full=tip - point, tip=tip)
    _check_stock(job, hole, depth)
    return depth


def tip_length(job: ToolPathTask) -> float:
    """Height from the tip of the tool to its full diameter, mm.

    With the angle α between lip and face plane it is ``R·tan α``. With a rounded corner of
    radius r whose centre lies e off the axis, as in the APT tool, it is the height of that
    centre, ``e·tan α + r/cos α``; a corner without a given centre has e = R − r.
    """
    body = _body(job)
    radius = 0.5 * job.tool.diameter
    if isinstance(body, BallEndmill):
        return radius
    angle = lip_angle(job)
    dimension = job.program.get(body.dimension)
    corner = dimension.edge_radius or 0.0
    if corner <= 0.0:
        return radius * tan(angle)
    centre = dimension.edge_center_horizontal or max(0.0, radius - corner)
    return centre * tan(angle) + corner / cos(angle)


def depth_findings(
    job: ToolPathTask, operation: DrillingTypeOperation, hole: Hole, depth: Depth
) -> list[Finding]:
    """Findings about the depth of a hole compared with its tool."""
    found = list(_bottom_findings(job, operation, hole, depth))
    edge = job.tool.cutting_edge_length
    if edge is not None and isinstance(operation, DrillingOperation) and depth.tip > edge:
        text = f"cutting edge of {edge:g} mm is shorter than the depth of {depth.tip:.4g} mm"
        found.append(job.warning(text, job.step.tool_ref))
    tool = job.program.get(job.step.tool_ref)
    overall = tool.overall_assembly_length if isinstance(tool, MillingCuttingTool) else None
    if overall and depth.tip > overall:
        text = f"{overall:g} mm tool length is shorter than the depth of {depth.tip:.4g} mm"
        found.append(job.warning(text, job.step.tool_ref, "overall_assembly_length"))
    return found


def _bottom_findings(
    job: ToolPathTask, operation: DrillingTypeOperation, hole: Hole, depth: Depth
) -> Iterator[Finding]:
    """Report a full diameter that does not end at the depth of the hole."""
    if hole.depth is None or isinstance(operation, (CenterDrilling, CounterSinking)):
        return
    if not hole.is_through and depth.full > hole.depth + TOLERANCE:
        text = f"{depth.full:g} mm is deeper than the hole depth of {hole.depth:g} mm"
        yield job.warning(text, attribute="cutting_depth")
    if operation.cutting_depth is None and depth.full < hole.depth - TOLERANCE:
        text = (
            "the tip stops at the hole bottom: the full diameter ends "
            f"{hole.depth - depth.full:.4g} mm above the depth of the hole"
        )
        yield job.note(text, hole.ref, "bottom_condition")


def _check_width(job: ToolPathTask, operation: DrillingTypeOperation, hole: Hole) -> None:
    """Raise an error if the tool is wider than the hole."""
    if hole.diameter is None or hole.narrowest is None or not isinstance(operation, FITTING):
        return
    width = hole.diameter if job.tool.keyword in TAPERED_TOOLS else hole.narrowest
    if job.tool.diameter > width + hole.tolerance:
        message = (
            f"tool of {job.tool.diameter:g} mm diameter is too wide for a hole of {width:g} mm "
            f"with a tolerance of {hole.tolerance:g} mm"
        )
        raise job.fault(message, job.step.operation_ref, "its_tool")


def _check_stock(job: ToolPathTask, hole: Hole, depth: Depth) -> None:
    """Raise an error if a hole's depth leads through the bottom of the workpiece.

    The tool's breakthrough below a through hole is not counted.
    """
    if job.stock is None:
        return
    full = (hole.depth or 0.0) if hole.is_through else depth.full
    reach, bottom = hole.top[2] - full, job.stock.low[2]
    if reach < bottom - TOLERANCE:
        kind = "through" if hole.is_through else "blind"
        message = (
            f"a {kind} hole down to z = {reach:g} mm breaks through the workpiece, "
            f"whose bottom lies at z = {bottom:g} mm"
        )
        raise job.fault(message, hole.ref, "depth")


def _bottom(job: ToolPathTask, hole: Hole) -> float:
    """Depth of the hole, mm; an error if the file does not give it."""
    if hole.depth is None:
        raise job.fault(
            "neither the hole's depth nor the operation's cutting_depth is given",
            hole.ref,
            "depth",
        )
    return hole.depth


def _body(job: ToolPathTask) -> MillingToolBody:
    """Body of the operation's rotating tool."""
    body = body_of(job.program, job.step.tool_ref)
    if body is None:
        raise job.fault("is not a rotating tool: it cannot drill", job.step.tool_ref)
    return body


def lip_angle(job: ToolPathTask) -> float:
    """Angle between lip and face plane, rad; small numbers in the file are already radians."""
    ref = _body(job).dimension
    top = job.program.get(ref).tool_top_angle or 0.0
    angle = top if top < LEAST_TOP_ANGLE_DEG else rad_from_deg(top)
    if not 0.0 <= angle < 0.5 * pi:
        message = f"{top:g}: the angle between lip and face plane must be 0 to 90 degrees"
        raise job.fault(message, ref, "tool_top_angle")
    return angle


def _overcut(job: ToolPathTask, operation: DrillingTypeOperation) -> float:
    """Distance that the full diameter goes below a through hole, mm."""
    overcut = operation.overcut_length or 0.0
    if not 0.0 <= overcut < inf:
        message = f"{overcut:g} mm: the overcut length must not be negative"
        raise job.fault(message, job.step.operation_ref, "overcut_length")
    return overcut


def _below(job: ToolPathTask, hole: Hole) -> float:
    """Depth to which a tip may go below the depth plane of a blind hole, mm.

    A flat bottom, with or without a corner radius, ends at the depth plane: no tip may pass it.
    A conical bottom is left by the drill itself and begins there, ISO 14649-10. A spherical
    bottom reaches down by the height of its cap.
    """
    if isinstance(hole.bottom, ConicalHoleBottom):
        return inf
    if isinstance(hole.bottom, SphericalHoleBottom) and hole.diameter is not None:
        sphere = job.program.get(hole.bottom.radius).theoretical_size
        radius = 0.5 * hole.diameter
        if not radius - TOLERANCE <= sphere < inf:
            message = (
                f"sphere radius {sphere:g} mm is smaller than the hole radius {radius:g} mm"
            )
            raise job.fault(message, hole.ref, "bottom_condition")
        return sphere - sqrt(max(0.0, sphere**2 - radius**2))
    return 0.0


def _sink(job: ToolPathTask, hole: Hole) -> float:
    """Depth of a countersink's tip at which its cone has the sink's diameter at the top, mm."""
    if hole.diameter is None or not hole.is_tapered:
        message = "a cutting depth is needed: no taper of the hole gives the sink diameter"
        raise job.fault(message, job.step.operation_ref, "cutting_depth")
    if hole.diameter > job.tool.diameter + TOLERANCE:
        message = (
            f"tool of {job.tool.diameter:g} mm is too narrow for a sink of {hole.diameter:g} mm"
        )
        raise job.fault(message, job.step.operation_ref, "its_tool")
    angle = lip_angle(job)
    if angle <= 0.0:
        raise job.fault("the tool has no tip angle: it cannot countersink", job.step.tool_ref)
    return tip_length(job) - 0.5 * (job.tool.diameter - hole.diameter) * tan(angle)


def _centre(job: ToolPathTask, point: float) -> float:
    """Depth of a centre drill's tip, mm: the length of its point."""
    if point <= 0.0:
        message = "a cutting depth is needed: the tool has no tip angle that gives a depth"
        raise job.fault(message, job.step.operation_ref, "cutting_depth")
    return point
