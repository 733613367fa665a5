"""Estimated cuts of milling and drilling workingsteps, before their tool paths are made.

The radial width follows from the strategy's overlap, axial depth and passes from the feature's
depth, and the path length from area over step-over plus approach and overrun. Explicit tool
paths are measured between the corner points of their curves. Cuts of drills, reamers and
boring bars follow from the hole. Turning is in :mod:`optimiser.cuts.feature_cuts`.
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, dist

from optimiser.cuts.cut import Cut, CutKind, Texture
from optimiser.cuts.region import FeatureRegion, pattern_count, points_of, region_of
from optimiser.solver.problem import ROUNDING, Setting
from simulator.physics.engagement import (
    Engagement,
    bilateral,
    centred_approach,
    drill_point_length,
    full_immersion,
    one_sided_approach,
    unidirectional,
)
from simulator.spec import ToolKind
from simulator.tool_kind import tool_kind
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import (
    CircularPattern,
    CompoundFeature,
    GeneralPattern,
    RectangularPattern,
    ReplicateFeature,
)
from stepnc_model.entities.milling import (
    BackBoring,
    Boring,
    BottomAndSideFinishMilling,
    BottomAndSideMilling,
    CenterDrilling,
    CenterMilling,
    CounterSinking,
    DrillingTypeOperation,
    FreeformOperation,
    PlaneFinishMilling,
    PlaneMilling,
    Reaming,
    SideFinishMilling,
    SideMilling,
    Two5dMillingStrategy,
)
from stepnc_model.entities.operations import (
    CutterLocationTrajectory,
    MachiningOperation,
    ToolpathList,
)
from stepnc_model.entities.profiles import ThroughBottomCondition
from stepnc_model.errors import Finding, SchemaError, Severity
from stepnc_model.part21.values import Ref
from stepnc_model.programs.outline import known_depth
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.tool import Tool, tool_of


def path_length(program: Program, ref: Ref[ToolpathList]) -> float:
    """Length of the trajectories of a list that are not run at rapid, mm.

    Curves that cannot be measured are not counted; 0 if nothing can be measured.
    """
    return sum(_moves_length(program, path) for path in program.get(ref).its_list)


def _moves_length(program: Program, ref: Ref[Entity]) -> float:
    path = program.model.entity(int(ref))
    if not isinstance(path, CutterLocationTrajectory) or str(path.its_speed) == "RAPID":
        return 0.0
    try:
        points = list(points_of(program, path.basiccurve))
    except SchemaError:
        return 0.0
    return sum(dist(one, other) for one, other in pairwise(points))


DEFAULT_SIDE_ALLOWANCE = 0.5
"""Depth taken off a wall by finishing when no roughing operation states its allowance, mm."""

LEAST_DEPTH = 1e-3
"""Least programmed depth of a pass that is accepted as intended, mm."""

FULL_LOAD = "the load along the given tool path is not known: full depth and width assumed"

FINISHING = (PlaneFinishMilling, SideFinishMilling, BottomAndSideFinishMilling)

FIXED_DEPTH = (FreeformOperation, SideFinishMilling, BottomAndSideFinishMilling)
"""Operations whose depth is given by the path or must stay to avoid marks on the wall."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sweep:
    """Width, depth and kind of the material that a milling operation sweeps."""

    radial_width: float
    """Radial width a_e, mm."""
    total_depth: float
    """Depth to remove in all passes together, mm."""
    axial_depth: float
    """Programmed axial depth of one pass, mm."""
    is_wall: bool
    """Whether only the wall is cut."""
    is_centred: bool
    """Whether one stroke along the middle covers the whole width."""


def milling_cut(
    program: Program, step: ResolvedWorkingstep, tool: Tool, *, speed: float, feed: float
) -> tuple[Cut, tuple[Finding, ...]]:
    """Estimate the cut of a milling workingstep from its feature.

    Parameters
    ----------
    speed : float, rev/s
        Programmed spindle speed.
    feed : float, mm
        Programmed feed per tooth.

    Returns
    -------
    Cut, findings
        The findings state what was assumed.
    """
    if not step.features:
        raise program.error(
            "has no feature: what to cut cannot be determined", step.ref, "its_feature"
        )
    region = region_of(program, step.features[0])
    sweep, findings = _sweep(program, step, region, tool)
    is_facemill = tool_kind(tool) is ToolKind.FACEMILL
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


def _floor(
    program: Program, step: ResolvedWorkingstep, region: FeatureRegion, wall: Cut
) -> Cut | None:
    """Return the floor that a bottom and side finishing operation sweeps once, or None."""
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
    program: Program, step: ResolvedWorkingstep
) -> list[tuple[ResolvedWorkingstep, MachiningOperation]]:
    """Return the earlier workingsteps on the same feature with their operations, in order."""
    return [(other, other.operation) for other in program.before(step)]


def _sweep(
    program: Program, step: ResolvedWorkingstep, region: FeatureRegion, tool: Tool
) -> tuple[Sweep, list[Finding]]:
    """Determine the width, depth and kind of the swept material of an operation."""
    operation = step.operation
    findings: list[Finding] = []
    total = _total_depth(program, step, region)
    depth = getattr(operation, "axial_cutting_depth", None)
    if depth is not None and depth < LEAST_DEPTH:
        raise program.error(
            f"depth {depth:g} mm: it must be at least {LEAST_DEPTH:g} mm",
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


def _total_depth(program: Program, step: ResolvedWorkingstep, region: FeatureRegion) -> float:
    """Depth that this operation removes in all passes together, mm."""
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
            f"allowance {left:g} mm on a depth of {region.depth:g} mm: nothing is removed",
            step.operation_ref,
            "allowance_bottom",
        )
    return total


def _left_on_side(program: Program, step: ResolvedWorkingstep) -> float:
    """Thickness that earlier operations left on the wall, mm."""
    left = [
        earlier.allowance_side
        for _, earlier in earlier_operations(program, step)
        if isinstance(earlier, (SideMilling, BottomAndSideMilling)) and earlier.allowance_side
    ]
    return left[-1] if left else DEFAULT_SIDE_ALLOWANCE


def _radial_width(
    program: Program, operation: Entity, region: FeatureRegion, tool: Tool
) -> float:
    """Radial width ``a_e = D·(1 − overlap)``, limited by the radial depth and the feature."""
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
    """Return an overlap as a ratio below one; values above one are read as percent."""
    value = written / 100.0 if written > 1.0 else written
    return min(max(value, 0.0), 0.95)


def _texture(sweep: Sweep, tool: Tool, kind: ToolKind) -> tuple[Texture, float]:
    """Texture of the finished surface, and the radius that forms it, mm."""
    return (Texture.WALL, 0.0) if sweep.is_wall else texture_of_floor(tool, kind)


def texture_of_floor(tool: Tool, kind: ToolKind) -> tuple[Texture, float]:
    """Texture that the end of a tool leaves on a floor, and the radius that forms it, mm."""
    if not tool.corner_radius:
        return Texture.NONE, 0.0
    if kind is ToolKind.FACEMILL:
        return Texture.CORNER_PER_REVOLUTION, tool.corner_radius
    return Texture.CORNER_PER_TOOTH, tool.corner_radius


def _engagement(sweep: Sweep, tool: Tool) -> Engagement:
    """Classify the engagement as full, centred or one-sided."""
    if sweep.radial_width >= tool.diameter * (1.0 - ROUNDING):
        return full_immersion()
    if sweep.is_centred:
        return bilateral(sweep.radial_width, tool.diameter)
    return unidirectional(sweep.radial_width, tool.diameter)


def _length(region: FeatureRegion, sweep: Sweep, tool: Tool) -> float:
    """Length at cutting feed of one pass over one region, mm."""
    width = sweep.radial_width
    if sweep.is_wall:
        return region.perimeter + 2.0 * one_sided_approach(tool.diameter, width)
    swept = region.area / width
    if not region.is_open:
        return swept
    strokes = max(1, ceil(region.width / width - ROUNDING))
    return swept + strokes * 2.0 * centred_approach(tool.diameter, width)


CLEARANCE = 2.0
"""Distance between the start of the feed and the surface, mm (customary)."""

INTO_SOLID = "no earlier hole is known: cutting into solid material assumed"

TOOL_KINDS: tuple[tuple[type[Entity], ToolKind], ...] = (
    (CenterDrilling, ToolKind.CENTER_DRILL),
    (CounterSinking, ToolKind.COUNTERSINK),
    (Reaming, ToolKind.REAMER),
    (Boring, ToolKind.BORING_BAR),
    (BackBoring, ToolKind.BORING_BAR),
)
"""Kind of tool implied by the type of operation."""

TOOL_BODIES = {
    "TWIST_DRILL": ToolKind.DRILL,
    "TAPERED_DRILL": ToolKind.DRILL,
    "SPADE_DRILL": ToolKind.DRILL,
    "CENTER_DRILL": ToolKind.CENTER_DRILL,
    "COUNTERSINK": ToolKind.COUNTERSINK,
    "COUNTERBORE": ToolKind.COUNTERSINK,
    "REAMER": ToolKind.REAMER,
    "TAPERED_REAMER": ToolKind.REAMER,
    "BORING_TOOL": ToolKind.BORING_BAR,
}
"""Kind of tool by its body, where the operation does not tell; any other is a drill."""


def hole_cut(
    program: Program, step: ResolvedWorkingstep, tool: Tool, *, speed: float, feed: float
) -> tuple[Cut, tuple[Finding, ...]]:
    """Estimate the cut of a drilling workingstep; parameters as :func:`milling_cut`."""
    operation = step.operation
    kind = drill_kind(operation, tool)
    depth, count = _depth_and_count(program, step, operation)
    previous, findings = _previous_diameter(program, step, operation, tool)
    length = depth + CLEARANCE + (getattr(operation, "overcut_length", None) or 0.0)
    if kind is ToolKind.DRILL and tool.point_angle and _is_through(program, step):
        length += drill_point_length(tool.diameter, tool.point_angle)
    cut = Cut(
        kind=CutKind.DRILLING,
        tool=tool,
        tool_kind=kind,
        diameter=tool.diameter,
        programmed=Setting(feed=feed, depth=depth, passes=1, speed=speed),
        length=count * length,
        total_depth=depth,
        is_depth_free=False,
        previous_diameter=previous,
        link_length=count * (length + 2.0 * (operation.retract_plane or 0.0)),
        texture=Texture.NONE,
        is_finishing=step.is_last_on_feature,
    )
    return cut, findings


def is_hole_making(operation: MachiningOperation, tool: Tool) -> bool:
    """True if an operation drills: by its type, or by its tool along a given path."""
    return isinstance(operation, DrillingTypeOperation) or (
        isinstance(operation, FreeformOperation) and tool.keyword in TOOL_BODIES
    )


def drill_kind(operation: MachiningOperation, tool: Tool) -> ToolKind:
    """Kind of tool by the operation, or by the tool body where the path is given."""
    by_operation = (kind for cls, kind in TOOL_KINDS if isinstance(operation, cls))
    return next(by_operation, TOOL_BODIES.get(tool.keyword, ToolKind.DRILL))


def _depth_and_count(
    program: Program, step: ResolvedWorkingstep, operation: MachiningOperation
) -> tuple[float, int]:
    """Depth of the hole, mm, and number of holes in its pattern."""
    if not step.features:
        raise program.error(
            "has no feature: the depth to drill cannot be determined", step.ref, "its_feature"
        )
    reference: Ref[Entity] = step.features[0]
    feature: Entity = program.get(reference)
    count = 1
    if isinstance(feature, GeneralPattern | RectangularPattern | CircularPattern):
        count = pattern_count(feature)
        reference = feature.replicate_base_feature
        feature = program.get(reference)
    if isinstance(feature, CompoundFeature):
        reference = feature.elements[0]
    given = getattr(operation, "cutting_depth", None)
    if given:
        return float(given), count
    return known_depth(program, reference), count


def _is_through(program: Program, step: ResolvedWorkingstep) -> bool:
    """True if the hole is a through hole."""
    feature: Entity = program.get(step.features[0])
    if isinstance(feature, ReplicateFeature):
        feature = program.get(feature.replicate_base_feature)
    bottom = getattr(feature, "bottom_condition", None)
    return bottom is not None and isinstance(program.get(bottom), ThroughBottomCondition)


def _previous_diameter(
    program: Program, step: ResolvedWorkingstep, operation: MachiningOperation, tool: Tool
) -> tuple[float, tuple[Finding, ...]]:
    """Diameter of the hole that is already there, mm, and findings on missing holes."""
    given = getattr(operation, "previous_diameter", None)
    if given and given < tool.diameter:
        return given, ()
    earlier = [
        tool_of(program, other.tool_ref).diameter
        for other, done in earlier_operations(program, step)
        if is_hole_making(done, tool) and not isinstance(done, CenterDrilling)
    ]
    smaller = [diameter for diameter in earlier if 0.0 < diameter < tool.diameter]
    if smaller:
        return max(smaller), ()
    if isinstance(operation, (Reaming, Boring, BackBoring)):
        return 0.0, (program.finding(Severity.WARNING, INTO_SOLID, step.operation_ref),)
    return 0.0, ()
