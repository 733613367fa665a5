"""How deep a tool goes into a hole, and what speaks against it.

ISO 14649-10: the depth of a hole is the length of its cylindrical part, from its placement to
its depth plane. ISO 14649-11: ``cutting_depth`` is measured from where the cylindrical part of
the tool begins, of a centre drill from its tip. A countersink, whose cylinder may stay above
the part, is measured like a centre drill here.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import cos, inf, pi, sqrt, tan

from stepnc_model.entities.bottoms import ConicalHoleBottom, SphericalHoleBottom
from stepnc_model.entities.drilling import (
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
from stepnc_model.entities.tools import BallEndmill, MillingCuttingTool, MillingToolBody
from stepnc_model.errors import Finding
from stepnc_model.tool import LEAST_TOP_ANGLE_DEG
from stepnc_model.toolpath.hole.feature import Hole
from stepnc_model.toolpath.job import Job
from stepnc_model.units import rad_from_deg

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
    """of the full diameter of the tool; negative when it stays above the hole"""
    tip: float
    """of the tip of the tool"""


def depth_of(job: Job, operation: DrillingTypeOperation, hole: Hole) -> Depth:
    """How deep an operation goes into a hole.

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


def tip_length(job: Job) -> float:
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
    job: Job, operation: DrillingTypeOperation, hole: Hole, depth: Depth
) -> list[Finding]:
    """What a machinist would want to see."""
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
    job: Job, operation: DrillingTypeOperation, hole: Hole, depth: Depth
) -> Iterator[Finding]:
    """Where the full diameter ends elsewhere than the hole."""
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


def _check_width(job: Job, operation: DrillingTypeOperation, hole: Hole) -> None:
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


def _check_stock(job: Job, hole: Hole, depth: Depth) -> None:
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


def _bottom(job: Job, hole: Hole) -> float:
    """Depth of the hole, which must be known."""
    if hole.depth is None:
        raise job.fault("has no depth, and the operation no cutting_depth", hole.ref, "depth")
    return hole.depth


def _body(job: Job) -> MillingToolBody:
    """Body of a rotating tool."""
    tool = job.program.get(job.step.tool_ref)
    body = job.program.get(tool.its_tool_body) if isinstance(tool, MillingCuttingTool) else None
    if not isinstance(body, MillingToolBody):
        raise job.fault("is no rotating tool: it drills no hole", job.step.tool_ref)
    return body


def lip_angle(job: Job) -> float:
    """Angle in rad between lip and face plane; small numbers are radians already."""
    ref = _body(job).dimension
    top = job.program.get(ref).tool_top_angle or 0.0
    angle = top if top < LEAST_TOP_ANGLE_DEG else rad_from_deg(top)
    if not 0.0 <= angle < 0.5 * pi:
        message = f"{top:g}: the angle between lip and face plane is 0 to 90 degrees"
        raise job.fault(message, ref, "tool_top_angle")
    return angle


def _overcut(job: Job, operation: DrillingTypeOperation) -> float:
    """Way in mm that the full diameter goes on below a through hole."""
    overcut = operation.overcut_length or 0.0
    if not 0.0 <= overcut < inf:
        message = f"{overcut:g} mm: it must not be negative"
        raise job.fault(message, job.step.operation_ref, "overcut_length")
    return overcut


def _below(job: Job, hole: Hole) -> float:
    """How far in mm the bottom of a blind hole lets a tip go below the depth plane.

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


def _sink(job: Job, hole: Hole) -> float:
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


def _centre(job: Job, point: float) -> float:
    """Depth of a centre drill's tip: its own point, up to the full diameter."""
    if point <= 0.0:
        message = "needs a cutting_depth: the tool has no point that tells how deep"
        raise job.fault(message, job.step.operation_ref, "cutting_depth")
    return point
