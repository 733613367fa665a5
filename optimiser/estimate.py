"""Cuts estimated from features: what is known of a cut before its path is made.

Radial width from the strategy's overlap, axial depth and passes from the feature's depth, path
length from area over step-over plus approach and overrun. Milling; holes are in
:mod:`optimiser.estimate_hole`, turning is in :mod:`optimiser.estimate_turning`.
"""

from dataclasses import dataclass, replace
from math import ceil

from optimiser.cut import Cut, CutKind, Texture
from optimiser.limit import ROUNDING
from optimiser.path_length import path_length
from optimiser.problem import Setting
from optimiser.region import Region, region_of
from simulator.physics.engagement import Engagement, bilateral, full_immersion, unidirectional
from simulator.physics.travel import centred_approach, one_sided_approach
from simulator.spec import ToolKind
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.milling import (
    BottomAndSideFinishMilling,
    BottomAndSideMilling,
    FreeformOperation,
    PlaneFinishMilling,
    PlaneMilling,
    SideFinishMilling,
    SideMilling,
)
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.entities.strategies import CenterMilling, Two5dMillingStrategy
from stepnc_model.errors import Finding, Severity
from stepnc_model.program import Program, Workingstep
from stepnc_model.tool import Tool

DEFAULT_SIDE_ALLOWANCE = 0.5
"""mm that a finish pass takes off a wall when no roughing operation says how much it left"""

LEAST_FACEMILL = 25.0
"""mm; files call smaller end mills FACEMILL, and nobody makes face mills so small"""

LEAST_DEPTH = 1e-3
"""mm; a pass less deep than a micrometre is a slip of the pen"""

FULL_LOAD = "the load along the given tool path is not known: full depth and width assumed"

FINISHING = (PlaneFinishMilling, SideFinishMilling, BottomAndSideFinishMilling)

FIXED_DEPTH = (FreeformOperation, SideFinishMilling, BottomAndSideFinishMilling)
"""depth is given by the path, or each level would leave its mark on the finished wall"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sweep:
    """How a milling operation sweeps its region."""

    radial_width: float
    """a_e, mm"""
    total_depth: float
    """mm"""
    axial_depth: float
    """mm of one pass as programmed"""
    is_wall: bool
    """only the wall is cut"""
    is_centred: bool
    """one stroke along the middle makes the width"""


def milling_cut(
    program: Program, step: Workingstep, tool: Tool, *, speed: float, feed: float
) -> tuple[Cut, tuple[Finding, ...]]:
    """Cut of a milling workingstep.

    Parameters
    ----------
    program : Program
    step : Workingstep
    tool : Tool
    speed : float, rev/s
        Programmed spindle speed.
    feed : float, mm
        Programmed feed per tooth.

    Returns
    -------
    Cut, findings
        What was assumed is among the findings.
    """
    if not step.features:
        raise program.error("has no feature: nothing tells what to cut", step.ref)
    region = region_of(program, step.features[0])
    sweep, findings = _sweep(program, step, region, tool)
    is_facemill = tool.keyword == "FACEMILL" and tool.diameter >= LEAST_FACEMILL
    kind = ToolKind.FACEMILL if is_facemill else ToolKind.ENDMILL
    texture, corner = _texture(sweep, tool, kind)
    is_finish = isinstance(step.operation, FINISHING)
    length = region.count * _length(region, sweep, tool)
    if step.operation.its_toolpath is not None:
        length = path_length(program, step.operation.its_toolpath) or length
        sweep = replace(sweep, total_depth=sweep.axial_depth)
        findings.append(program.finding(Severity.WARNING, FULL_LOAD, step.operation_ref))
    cut = Cut(
        kind=CutKind.MILLING,
        tool=tool,
        tool_kind=kind,
        diameter=tool.diameter,
        programmed=Setting(
            feed=feed,
            depth=sweep.axial_depth,
            passes=passes_for(sweep.total_depth, sweep.axial_depth),
            speed=speed,
        ),
        length=length,
        total_depth=sweep.total_depth,
        is_depth_free=not isinstance(step.operation, FIXED_DEPTH),
        engagement=_engagement(sweep, tool),
        radial_width=sweep.radial_width,
        link_length=region.count * 2.0 * (step.operation.retract_plane or 0.0),
        texture=texture,
        corner_radius=corner,
        is_finishing=step.is_last_on_feature or is_finish,
        is_finish_operation=is_finish,
        depth_bound=tool.cutting_edge_length,
    )
    return replace(cut, floor=_floor(program, step, region, cut)), tuple(findings)


def _floor(program: Program, step: Workingstep, region: Region, wall: Cut) -> Cut | None:
    """The floor that a bottom and side finish sweeps once, or None."""
    operation = step.operation
    if not isinstance(operation, BottomAndSideFinishMilling) or region.area <= 0.0:
        return None
    left = [
        earlier.allowance_bottom
        for _, earlier in earlier_operations(program, step)
        if isinstance(earlier, BottomAndSideMilling) and earlier.allowance_bottom
    ]
    if not left:
        return None
    tool = wall.tool
    sweep = Sweep(
        radial_width=min(_radial_width(program, operation, region, tool), tool.diameter),
        total_depth=left[-1],
        axial_depth=left[-1],
        is_wall=False,
        is_centred=False,
    )
    texture, corner = _texture(sweep, tool, wall.tool_kind)
    return replace(
        wall,
        texture=texture,
        corner_radius=corner,
        length=region.count * _length(region, sweep, tool),
        total_depth=left[-1],
        engagement=_engagement(sweep, tool),
        radial_width=sweep.radial_width,
    )


def passes_for(total: float, depth: float) -> int:
    """Least number of passes that are no deeper than programmed."""
    return max(1, ceil(total / depth - ROUNDING))


def earlier_operations(
    program: Program, step: Workingstep
) -> list[tuple[Workingstep, MachiningOperation]]:
    """Workingsteps on the same feature that run before this one, in order."""
    return [(other, other.operation) for other in program.before(step)]


def _sweep(
    program: Program, step: Workingstep, region: Region, tool: Tool
) -> tuple[Sweep, list[Finding]]:
    """Width, depth and passes of an operation."""
    operation = step.operation
    findings: list[Finding] = []
    total = _total_depth(program, step, region)
    depth = getattr(operation, "axial_cutting_depth", None)
    if depth is not None and depth < LEAST_DEPTH:
        raise program.error(
            f"a depth of {depth:g} mm: it must be {LEAST_DEPTH:g} mm at least",
            step.operation_ref,
            "axial_cutting_depth",
        )
    if depth is None:
        reach = min(total, tool.cutting_edge_length or total)
        depth = total / passes_for(total, reach)
        text = f"no axial_cutting_depth: {depth:.4g} mm assumed"
        findings.append(
            program.finding(Severity.NOTE, text, step.operation_ref, "axial_cutting_depth")
        )
    is_wall = region.area <= 0.0 or isinstance(operation, SideMilling)
    if isinstance(operation, (SideFinishMilling, BottomAndSideFinishMilling)):
        is_wall = True
        width = _left_on_side(program, step)
    else:
        width = _radial_width(program, operation, region, tool)
    sweep = Sweep(
        radial_width=min(width, tool.diameter),
        total_depth=total,
        axial_depth=min(depth, total),
        is_wall=is_wall,
        is_centred=region.width <= width * (1.0 + ROUNDING) and not is_wall,
    )
    return sweep, findings


def _total_depth(program: Program, step: Workingstep, region: Region) -> float:
    """Depth that this operation removes, all passes together, mm."""
    operation = step.operation
    left = getattr(operation, "allowance_bottom", None) or 0.0
    total = region.depth - left
    if isinstance(operation, PlaneFinishMilling):
        allowances = [
            earlier.allowance_bottom or 0.0
            for _, earlier in earlier_operations(program, step)
            if isinstance(earlier, PlaneMilling)
        ]
        total = (allowances[-1] if allowances else region.depth) - left
    if total <= 0.0:
        raise program.error(
            f"leaves {left:g} mm of {region.depth:g} mm: nothing is removed",
            step.operation_ref,
            "allowance_bottom",
        )
    return total


def _left_on_side(program: Program, step: Workingstep) -> float:
    """Thickness in mm that earlier operations left on the wall."""
    left = [
        earlier.allowance_side
        for _, earlier in earlier_operations(program, step)
        if isinstance(earlier, (SideMilling, BottomAndSideMilling)) and earlier.allowance_side
    ]
    return left[-1] if left else DEFAULT_SIDE_ALLOWANCE


def _radial_width(program: Program, operation: Entity, region: Region, tool: Tool) -> float:
    """``a_e = D·(1 − overlap)``, at most the programmed radial depth and the feature."""
    reference = getattr(operation, "its_machining_strategy", None)
    strategy = program.model.entity(int(reference)) if reference is not None else None
    overlap = 0.0
    if isinstance(strategy, Two5dMillingStrategy) and strategy.overlap is not None:
        overlap = ratio(strategy.overlap)
    width = tool.diameter * (1.0 - overlap)
    if isinstance(strategy, CenterMilling):
        width = tool.diameter
    radial = getattr(operation, "radial_cutting_depth", None)
    if radial:
        width = min(width, radial)
    return min(width, region.width) if region.area > 0.0 else width


def ratio(written: float) -> float:
    """An overlap as a ratio below one; numbers above one are percent, as drafts wrote them."""
    value = written / 100.0 if written > 1.0 else written
    return min(max(value, 0.0), 0.95)


def _texture(sweep: Sweep, tool: Tool, kind: ToolKind) -> tuple[Texture, float]:
    """How the feed marks the surface, and the radius in mm that marks it."""
    if sweep.is_wall:
        return Texture.WALL, 0.0
    if not tool.corner_radius:
        return Texture.NONE, 0.0
    if kind is ToolKind.FACEMILL:
        return Texture.CORNER_PER_REVOLUTION, tool.corner_radius
    return Texture.CORNER_PER_TOOTH, tool.corner_radius


def _engagement(sweep: Sweep, tool: Tool) -> Engagement:
    """Full, centred or one-sided, as paper 002 sorts face milling."""
    if sweep.radial_width >= tool.diameter * (1.0 - ROUNDING):
        return full_immersion()
    if sweep.is_centred:
        return bilateral(sweep.radial_width, tool.diameter)
    return unidirectional(sweep.radial_width, tool.diameter)


def _length(region: Region, sweep: Sweep, tool: Tool) -> float:
    """Length at cutting feed of one pass over one region, mm."""
    width = sweep.radial_width
    if sweep.is_wall:
        return region.perimeter + 2.0 * one_sided_approach(tool.diameter, width)
    swept = region.area / width
    if not region.is_open:
        return swept
    strokes = max(1, ceil(region.width / width - ROUNDING))
    return swept + strokes * 2.0 * centred_approach(tool.diameter, width)
