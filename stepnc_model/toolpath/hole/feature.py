"""Holes of a workingstep: where they stand, how wide they are, and how deep a tool goes.

Round holes, the elements of counterbored and countersunk holes, patterns of them, and other
features whose placement and depth plane make them a place to drill (ISO 14649-10).

ISO 14649-10: the depth of a hole is the length of its cylindrical part, from its placement to
its depth plane. ISO 14649-11: ``cutting_depth`` is measured from where the cylindrical part of
the tool begins, of a centre drill from its tip. A countersink, whose cylinder may stay above
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
from stepnc_model.outline import feature_depth
from stepnc_model.part21.values import Ref
from stepnc_model.tool import LEAST_TOP_ANGLE_DEG, body_of
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
"""tools that make the wide part of a compound hole"""

DEFAULT_TOLERANCE = 0.01
"""mm by which a tool may be wider than a hole that names no tolerance"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hole:
    """One hole in the coordinates of the setup; lengths in mm."""

    ref: Ref[Entity]
    """the round hole, or the feature that is drilled into"""
    frame: Frame
    """Frame of the feature that the workingstep names"""
    top: Point
    """centre where its depth counts from"""
    entry_z: float
    """where a tool meets the part: the top of the compound feature that it belongs to"""
    depth: float | None
    """Depth of its cylindrical part, below the top; None where the file gives none"""
    diameter: float | None
    """at the top; None for a feature that is no round hole"""
    narrowest: float | None
    """diameter of a taper's narrow end"""
    tolerance: float
    """by which it may be wider"""
    bottom: Entity | None

    @property
    def is_tapered(self) -> bool:
        """Whether the hole narrows."""
        return self.narrowest != self.diameter

    @property
    def is_through(self) -> bool:
        """Whether it is a through hole."""
        return isinstance(self.bottom, (ThroughBottomCondition, ThroughPocketBottomCondition))

    def at(self, z: float) -> Point:
        """Point on its axis."""
        return self.top[0], self.top[1], z

    def point(self, job: ToolPathTask, ref: Ref[CartesianPoint]) -> Point:
        """A point given in the coordinates of the feature."""
        return self.frame.point(point_of(job.program, ref))


def holes_of(job: ToolPathTask, operation: DrillingTypeOperation) -> Iterator[Hole]:
    """Holes that an operation makes, in the order of the file.

    Raises
    ------
    PathError
        When there is none, its axis does not lie along the tool, or it lacks a size.
    """
    if not job.step.features:
        raise job.fault("has no feature: nothing tells where to drill", job.step.ref)
    for feature in job.step.features:
        for placed in placements(job.program, job.step.setup, feature):
            yield _hole(job, operation, placed)


def _hole(job: ToolPathTask, operation: DrillingTypeOperation, placed: PlacedFeature) -> Hole:
    """One hole, or the element of a compound feature that is meant."""
    frame = placed.frame
    if not frame.is_upright:
        along = ", ".join(f"{part:.4g}" for part in frame.z)
        message = (
            f"its axis ({along}) does not lie along the tool: a setup of its own is needed"
        )
        raise job.fault(message, placed.feature)
    with job.program.using(placed.feature):
        compound = job.program.get(placed.feature)
        if not isinstance(compound, CompoundFeature):
            return _sized(job, placed.feature, placed, frame, entry_z=_entry(job, placed))
        element = _element(job, operation, placed.feature, compound.elements)
        placement = getattr(job.program.get(element), "feature_placement", None)
        inner = frame.inner(frame_of(job.program, placement))
        if not inner.is_upright:
            raise job.fault("its axis does not lie along the tool", element)
        return _sized(job, element, placed, inner, entry_z=frame.origin[2])


def _entry(job: ToolPathTask, placed: PlacedFeature) -> float:
    """Height of the compound feature around a feature that is named by itself."""
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
    """Round hole of a compound feature that the operation and its tool make.

    A countersink or counterbore makes the tapered element, else the widest; a centre drill
    the uppermost; any other tool the narrowest that it fits into, else the widest.
    """
    holes = ((each, job.program.get(each)) for each in elements)
    widths = {
        each: size_of(job, each, hole) for each, hole in holes if isinstance(hole, RoundHole)
    }
    if not widths:
        raise job.fault("has no round hole among its elements", ref, "elements")
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
    """A hole with its sizes; its depth counts from the top of the feature that is named."""
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
    """Diameter at the top."""
    diameter = float(job.program.get(hole.diameter).theoretical_size)
    if not 0.0 < diameter < inf:
        raise job.fault(f"{diameter:g} mm: it must be positive", ref, "diameter")
    return diameter


def narrowest_of(
    job: ToolPathTask, hole: RoundHole, diameter: float, depth: float | None
) -> float:
    """Diameter at the depth plane of a tapered hole; its own where it does not narrow."""
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
    """Upper limit of a hole's diameter."""
    if isinstance(entity, RoundHole):
        given = job.program.get(entity.diameter).implicit_tolerance
        limits = job.program.get(given) if given is not None else None
        if isinstance(limits, PlusMinusValue):
            return max(DEFAULT_TOLERANCE, limits.upper_limit)
    return DEFAULT_TOLERANCE


TOLERANCE = 1e-6
"""mm"""

FITTING = (Drilling, MultistepDrilling, Reaming, Boring, ThreadDrilling)
"""operations whose tool must not be wider than the hole"""

TAPERED_TOOLS = ("TAPERED_DRILL", "TAPERED_REAMER")
"""tools that may be wider than the narrow end of a taper"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Depth:
    """Depths below the top of a hole, mm."""

    full: float
    """Full of the full diameter of the tool; negative when it stays above the hole"""
    tip: float
    """Tip of the tip of the tool"""


def depth_of(job: ToolPathTask, operation: DrillingTypeOperation, hole: Hole) -> Depth:
    """Depth of an operation in a hole.

    Raises
    ------
    PathError
        When the depth is missing or not positive, the tool is wider than the hole, or a blind
        hole would leave the workpiece.
    """
    _check_width(job, operation, hole)
    point = tip_length(job)
    given = operation.cutting_depth
    if given is not None and not 0.0 < given < inf:
        message = f"{given:g} mm removes nothing: it must be positive"
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
    """Height in mm from the tip of the tool to its full diameter.

    With the angle α between lip and face plane it is ``R·tan α``. With a rounded corner of
    radius r whose centre stands e beside the axis, the tool of APT, it is the height of that
    centre, ``e·tan α + r/cos α``; a corner without a centre touches the cylinder, e = R − r.
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
    """Remarks for a machinist."""
    found = list(_bottom_findings(job, operation, hole, depth))
    edge = job.tool.cutting_edge_length
    if edge is not None and isinstance(operation, DrillingOperation) and depth.tip > edge:
        text = f"cutting edge of {edge:g} mm for a depth of {depth.tip:.4g} mm"
        found.append(job.warning(text, job.step.tool_ref))
    tool = job.program.get(job.step.tool_ref)
    overall = tool.overall_assembly_length if isinstance(tool, MillingCuttingTool) else None
    if overall and depth.tip > overall:
        text = f"{overall:g} mm of tool for a depth of {depth.tip:.4g} mm"
        found.append(job.warning(text, job.step.tool_ref, "overall_assembly_length"))
    return found


def _bottom_findings(
    job: ToolPathTask, operation: DrillingTypeOperation, hole: Hole, depth: Depth
) -> Iterator[Finding]:
    """Remark on a full diameter that does not end where the hole does."""
    if hole.depth is None or isinstance(operation, (CenterDrilling, CounterSinking)):
        return
    if not hole.is_through and depth.full > hole.depth + TOLERANCE:
        text = f"{depth.full:g} mm is deeper than the hole of {hole.depth:g} mm"
        yield job.warning(text, attribute="cutting_depth")
    if operation.cutting_depth is None and depth.full < hole.depth - TOLERANCE:
        text = (
            "the tip stops on the bottom: the full diameter ends "
            f"{hole.depth - depth.full:.4g} mm above the depth of the hole"
        )
        yield job.note(text, hole.ref, "bottom_condition")


def _check_width(job: ToolPathTask, operation: DrillingTypeOperation, hole: Hole) -> None:
    """Refuse a tool that is wider than the hole."""
    if hole.diameter is None or hole.narrowest is None or not isinstance(operation, FITTING):
        return
    width = hole.diameter if job.tool.keyword in TAPERED_TOOLS else hole.narrowest
    if job.tool.diameter > width + hole.tolerance:
        message = (
            f"tool of {job.tool.diameter:g} mm for a hole of {width:g} mm "
            f"that may be {hole.tolerance:g} mm wider"
        )
        raise job.fault(message, job.step.operation_ref, "its_tool")


def _check_stock(job: ToolPathTask, hole: Hole, depth: Depth) -> None:
    """Refuse a hole whose depth leaves the workpiece through its bottom.

    A through hole ends there; what its tool needs to break through is no depth of the hole.
    """
    if job.stock is None:
        return
    full = (hole.depth or 0.0) if hole.is_through else depth.full
    reach, bottom = hole.top[2] - full, job.stock.low[2]
    if reach < bottom - TOLERANCE:
        kind = "through" if hole.is_through else "blind"
        message = (
            f"a {kind} hole down to z = {reach:g} mm leaves the workpiece, "
            f"whose bottom lies at z = {bottom:g} mm"
        )
        raise job.fault(message, hole.ref, "depth")


def _bottom(job: ToolPathTask, hole: Hole) -> float:
    """Depth of the hole, which must be known."""
    if hole.depth is None:
        raise job.fault("has no depth, and the operation no cutting_depth", hole.ref, "depth")
    return hole.depth


def _body(job: ToolPathTask) -> MillingToolBody:
    """Body of a rotating tool."""
    body = body_of(job.program, job.step.tool_ref)
    if body is None:
        raise job.fault("is no rotating tool: it drills no hole", job.step.tool_ref)
    return body


def lip_angle(job: ToolPathTask) -> float:
    """Angle in rad between lip and face plane; small numbers are radians already."""
    ref = _body(job).dimension
    top = job.program.get(ref).tool_top_angle or 0.0
    angle = top if top < LEAST_TOP_ANGLE_DEG else rad_from_deg(top)
    if not 0.0 <= angle < 0.5 * pi:
        message = f"{top:g}: the angle between lip and face plane is 0 to 90 degrees"
        raise job.fault(message, ref, "tool_top_angle")
    return angle


def _overcut(job: ToolPathTask, operation: DrillingTypeOperation) -> float:
    """Way in mm that the full diameter goes on below a through hole."""
    overcut = operation.overcut_length or 0.0
    if not 0.0 <= overcut < inf:
        message = f"{overcut:g} mm: it must not be negative"
        raise job.fault(message, job.step.operation_ref, "overcut_length")
    return overcut


def _below(job: ToolPathTask, hole: Hole) -> float:
    """Depth in mm to which the bottom of a blind hole lets a tip go below the depth plane.

    A flat bottom, with or without a corner radius, ends there: no tip may pass it. A conical
    one is what a drill leaves, ISO 14649-10: the cone begins there and is the drill's own. A
    spherical one reaches down by the height of its cap.
    """
    if isinstance(hole.bottom, ConicalHoleBottom):
        return inf
    if isinstance(hole.bottom, SphericalHoleBottom) and hole.diameter is not None:
        sphere = job.program.get(hole.bottom.radius).theoretical_size
        radius = 0.5 * hole.diameter
        if not radius - TOLERANCE <= sphere < inf:
            message = f"sphere of radius {sphere:g} mm below a hole of radius {radius:g} mm"
            raise job.fault(message, hole.ref, "bottom_condition")
        return sphere - sqrt(max(0.0, sphere**2 - radius**2))
    return 0.0


def _sink(job: ToolPathTask, hole: Hole) -> float:
    """Depth of a countersink's tip when its cone is as wide as the sink at the top."""
    if hole.diameter is None or not hole.is_tapered:
        message = "needs a cutting_depth: the hole has no taper that tells how wide the sink is"
        raise job.fault(message, job.step.operation_ref, "cutting_depth")
    if hole.diameter > job.tool.diameter + TOLERANCE:
        message = f"tool of {job.tool.diameter:g} mm for a sink of {hole.diameter:g} mm"
        raise job.fault(message, job.step.operation_ref, "its_tool")
    angle = lip_angle(job)
    if angle <= 0.0:
        raise job.fault("has no point that could sink a cone", job.step.tool_ref)
    return tip_length(job) - 0.5 * (job.tool.diameter - hole.diameter) * tan(angle)


def _centre(job: ToolPathTask, point: float) -> float:
    """Depth of a centre drill's tip: its own point, up to the full diameter."""
    if point <= 0.0:
        message = "needs a cutting_depth: the tool has no point that tells how deep"
        raise job.fault(message, job.step.operation_ref, "cutting_depth")
    return point
