"""Cuts of drills, reamers and boring bars, estimated from the hole."""

from optimiser.cut import Cut, CutKind, Texture
from optimiser.estimate import earlier_operations
from optimiser.problem import Setting
from optimiser.region import feature_depth, pattern_count
from simulator.physics.travel import drill_point_length
from simulator.spec import ToolKind
from stepnc_model.entities.bottoms import ThroughBottomCondition
from stepnc_model.entities.drilling import (
    BackBoring,
    Boring,
    CenterDrilling,
    CounterSinking,
    DrillingTypeOperation,
    Reaming,
)
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import (
    CircularPattern,
    CompoundFeature,
    GeneralPattern,
    RectangularPattern,
    ReplicateFeature,
)
from stepnc_model.entities.milling import FreeformOperation
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.errors import Finding, Severity
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program, Workingstep
from stepnc_model.tool import Tool, tool_of

CLEARANCE = 2.0
"""mm between the start of the feed and the surface, customary"""

INTO_SOLID = "no earlier hole is known: the tool is taken to cut into the solid"

TOOL_KINDS: tuple[tuple[type[Entity], ToolKind], ...] = (
    (CenterDrilling, ToolKind.CENTER_DRILL),
    (CounterSinking, ToolKind.COUNTERSINK),
    (Reaming, ToolKind.REAMER),
    (Boring, ToolKind.BORING_BAR),
    (BackBoring, ToolKind.BORING_BAR),
)
"""kind of tool that an operation is done with"""

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
"""kind of tool by its body, where the operation does not tell; a drill for all others"""


def hole_cut(
    program: Program, step: Workingstep, tool: Tool, *, speed: float, feed: float
) -> tuple[Cut, tuple[Finding, ...]]:
    """Cut of a drilling workingstep; parameters as :func:`optimiser.estimate.milling_cut`."""
    operation = step.operation
    kind = _tool_kind(operation, tool)
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
    """Whether an operation drills: by its kind, or along a given path by its tool."""
    return isinstance(operation, DrillingTypeOperation) or (
        isinstance(operation, FreeformOperation) and tool.keyword in TOOL_BODIES
    )


def _tool_kind(operation: MachiningOperation, tool: Tool) -> ToolKind:
    """Kind of tool by the operation, or by its body where the path is given."""
    by_operation = (kind for cls, kind in TOOL_KINDS if isinstance(operation, cls))
    return next(by_operation, TOOL_BODIES.get(tool.keyword, ToolKind.DRILL))


def _depth_and_count(
    program: Program, step: Workingstep, operation: MachiningOperation
) -> tuple[float, int]:
    """Depth of the hole in mm, and how many of them a pattern makes."""
    if not step.features:
        raise program.error("has no feature: nothing tells how deep to drill", step.ref)
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
    return feature_depth(program, reference), count


def _is_through(program: Program, step: Workingstep) -> bool:
    """Whether the hole has no bottom."""
    feature: Entity = program.get(step.features[0])
    if isinstance(feature, ReplicateFeature):
        feature = program.get(feature.replicate_base_feature)
    bottom = getattr(feature, "bottom_condition", None)
    return bottom is not None and isinstance(program.get(bottom), ThroughBottomCondition)


def _previous_diameter(
    program: Program, step: Workingstep, operation: MachiningOperation, tool: Tool
) -> tuple[float, tuple[Finding, ...]]:
    """Diameter of the hole that is already there, mm."""
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
