"""Cuts estimated from features alone, for milling, drilling and turning operations.

Also determines what no tool path shows: tool kind, surface texture, whether the workingstep
finishes, and the programmed setting.

Estimated cuts of turning operations, from the feature and the bar.

The cutting speed is taken at the mean diameter of what is removed: a lathe at constant cutting
speed has it everywhere, one at constant spindle speed on average.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import hypot

from optimiser.cuts.bare_path import is_path_only, path_diameter, path_only_cut
from optimiser.cuts.conditions import tool_grade
from optimiser.cuts.cut import Cut, CutKind, Texture
from optimiser.cuts.feature_estimate import (
    FULL_LOAD,
    INTO_SOLID,
    LEAST_DEPTH,
    earlier_operations,
    hole_cut,
    is_hole_making,
    milling_cut,
    passes_for,
)
from optimiser.cuts.region import points_of
from optimiser.cuts.two_cores import Result, one_by_one
from optimiser.solver.problem import Setting
from simulator.spec import CuttingMaterial, Machine, ToolKind, WorkMaterial
from simulator.tool_kind import edge_material
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.geometry import RightCircularCylinder
from stepnc_model.entities.profiles import SquareUProfile
from stepnc_model.entities.turning import (
    Contouring,
    ContouringFinish,
    ContouringRough,
    CuttingIn,
    Facing,
    FacingFinish,
    GeneralRevolution,
    Groove,
    Grooving,
    OuterDiameter,
    OuterDiameterToShoulder,
    RevolvedFlat,
    TurningMachiningOperation,
)
from stepnc_model.errors import Finding, Severity
from stepnc_model.part21.values import Ref
from stepnc_model.programs.outline import size
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.technology import programmed
from stepnc_model.programs.tool import Tool, tool_of

CLEARANCE = 2.0
"""Distance between the start of the feed and the workpiece, mm (customary)."""

FALLBACK_DEPTH = 1.0
"""Depth of one pass when neither strategy nor allowance states what to remove, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Revolved:
    """Radii and contour length of a turning feature, mm."""

    inner_radius: float
    outer_radius: float
    length: float


def mean_diameter(program: Program, step: ResolvedWorkingstep) -> float:
    """Diameter at which the cutting speed of a turning workingstep is taken, mm."""
    if is_path_only(program, step):
        return path_diameter(program, step)
    shape = _shape(program, step)
    return shape.inner_radius + shape.outer_radius


def turning_cut(
    program: Program, step: ResolvedWorkingstep, tool: Tool, *, speed: float, feed: float
) -> tuple[Cut, tuple[Finding, ...]]:
    """Estimate the cut of a turning workingstep; parameters as for milling.

    See :func:`optimiser.cuts.feature_estimate.milling_cut`.
    """
    operation = step.operation
    shape = _shape(program, step)
    if isinstance(operation, Grooving):
        return _grooving_cut(program, step, tool, speed=speed, feed=feed), ()
    if not isinstance(operation, (Facing, Contouring)):
        raise program.error(
            f"{step.operation_type}: no cutting model exists", step.operation_ref
        )
    total, depth, findings = _depths(program, step, operation, shape)
    across = shape.outer_radius - shape.inner_radius
    length = across if isinstance(operation, Facing) else shape.length
    overcut = getattr(_strategy(program, operation), "overcut_length", None) or 0.0
    retract = operation.retract_plane or 0.0
    is_finish = isinstance(operation, (FacingFinish, ContouringFinish))
    cut = Cut(
        kind=CutKind.TURNING,
        tool=tool,
        tool_kind=ToolKind.TURNING,
        diameter=shape.inner_radius + shape.outer_radius,
        programmed=Setting(
            feed=feed, depth=depth, passes=passes_for(total, depth), speed=speed
        ),
        length=length + CLEARANCE + overcut,
        total_depth=total,
        is_depth_free=not is_finish,
        link_length=length + 2.0 * retract,
        is_fed_inwards=isinstance(operation, Facing),
        texture=Texture.CORNER_PER_REVOLUTION if tool.corner_radius else Texture.NONE,
        corner_radius=tool.corner_radius or 0.0,
        is_finishing=step.is_last_on_feature or is_finish,
        is_finish_operation=is_finish,
        depth_bound=tool.cutting_edge_length,
    )
    return cut, findings


def _grooving_cut(
    program: Program, step: ResolvedWorkingstep, tool: Tool, *, speed: float, feed: float
) -> Cut:
    """Estimate the cut of a plunged groove or of a cut-off."""
    shape = _shape(program, step)
    width = tool.width
    if not width:
        message = "a grooving tool must state its cutting width"
        raise program.error(message, step.tool_ref, "cutting_width")
    infeed = shape.outer_radius - shape.inner_radius
    is_off = isinstance(step.operation, CuttingIn)
    plunges = 1 if is_off else passes_for(shape.length, width)
    retract = step.operation.retract_plane or 0.0
    return Cut(
        kind=CutKind.GROOVING,
        tool=tool,
        tool_kind=ToolKind.GROOVING,
        diameter=shape.inner_radius + shape.outer_radius,
        programmed=Setting(feed=feed, depth=infeed, passes=plunges, speed=speed),
        length=infeed + CLEARANCE,
        total_depth=infeed * plunges,
        is_depth_free=False,
        radial_width=width,
        is_fed_inwards=True,
        link_length=infeed + 2.0 * retract,
        is_finishing=step.is_last_on_feature,
    )


def _depths(
    program: Program,
    step: ResolvedWorkingstep,
    operation: TurningMachiningOperation,
    shape: Revolved,
) -> tuple[float, float, tuple[Finding, ...]]:
    """Total depth and programmed depth of one pass, mm, with findings."""
    allowance = getattr(operation, "allowance", None) or 0.0
    left = [
        getattr(earlier, "allowance", None) or 0.0
        for _, earlier in earlier_operations(program, step)
        if isinstance(earlier, type(operation).__mro__[1])
    ]
    written = getattr(_strategy(program, operation), "cutting_depth", None) or ()
    if isinstance(operation, (FacingFinish, ContouringFinish)) and left and left[-1] > 0.0:
        total = left[-1] - allowance
    elif isinstance(operation, Facing):
        total = _stock_in_front(program) - allowance
    else:
        total = _bar_radius_or(program, shape.outer_radius) - shape.inner_radius - allowance
    findings: tuple[Finding, ...] = ()
    if total <= 0.0:
        total = written[0] if written else FALLBACK_DEPTH
        text = f"the depth to remove cannot be derived from the bar: {total:g} mm assumed"
        findings = (program.finding(Severity.WARNING, text, step.operation_ref),)
    if written and written[0] < LEAST_DEPTH:
        raise program.error(
            f"depth {written[0]:g} mm: it must be at least {LEAST_DEPTH:g} mm",
            operation.its_machining_strategy or step.operation_ref,
            "cutting_depth",
        )
    depth = min(written[0], total) if written else total
    return total, depth, findings


def _strategy(program: Program, operation: TurningMachiningOperation) -> Entity | None:
    """Machining strategy of an operation, or None."""
    reference = operation.its_machining_strategy
    return program.model.entity(int(reference)) if reference is not None else None


def _bar(program: Program) -> RightCircularCylinder | None:
    """Cylindrical bar that the part is turned from, or None."""
    workpiece = program.workpiece()
    reference = workpiece.its_bounding_geometry if workpiece is not None else None
    if reference is None:
        return None
    bounding = program.get(reference)
    return bounding if isinstance(bounding, RightCircularCylinder) else None


def _bar_radius_or(program: Program, radius: float) -> float:
    """Radius of the bar, or the given radius without a bar, mm."""
    bar = _bar(program)
    return bar.radius if bar is not None else radius


def _stock_in_front(program: Program) -> float:
    """Length of the bar in front of the workpiece zero, mm; 0 without a bar."""
    bar = _bar(program)
    if bar is None:
        return 0.0
    start = program.get(program.get(bar.position).location).coordinates[2]
    return float(start + bar.height)


def _shape(program: Program, step: ResolvedWorkingstep) -> Revolved:
    """Combined radii and length of all features of the workingstep."""
    if not step.features:
        raise program.error(
            "has no feature: what to turn cannot be determined", step.ref, "its_features"
        )
    shapes = [_revolved(program, feature) for feature in step.features]
    outer = max(shape.outer_radius for shape in shapes)
    if isinstance(step.operation, ContouringRough):
        bar = _bar(program)
        outer = max(outer, bar.radius if bar is not None else 0.0)
    return Revolved(
        inner_radius=min(shape.inner_radius for shape in shapes),
        outer_radius=outer,
        length=sum(shape.length for shape in shapes),
    )


def _revolved(program: Program, ref: Ref[Entity]) -> Revolved:
    """Radii and length of one turning feature."""
    feature = program.get(ref)
    if isinstance(feature, OuterDiameter):
        radius = 0.5 * size(program, feature.diameter_at_placement, ref)
        length = size(program, feature.feature_length, ref)
        return Revolved(inner_radius=radius, outer_radius=radius, length=length)
    if isinstance(feature, OuterDiameterToShoulder):
        radius = 0.5 * size(program, feature.diameter_at_placement, ref)
        length = _shoulder_distance(program, feature)
        return Revolved(inner_radius=radius, outer_radius=radius, length=length)
    if isinstance(feature, RevolvedFlat):
        edge = program.get(program.get(feature.flat_edge_shape).profile_length)
        length = float(edge.its_parameter_value)
        return Revolved(
            inner_radius=feature.radius, outer_radius=feature.radius + length, length=length
        )
    if isinstance(feature, GeneralRevolution):
        points = list(points_of(program, program.get(feature.outer_edge_profile).its_profile))
        return _contour(points, feature.radius)
    if isinstance(feature, Groove):
        return _groove(program, feature)
    raise program.error("a turning feature of this kind cannot be estimated", ref)


def _shoulder_distance(program: Program, feature: OuterDiameterToShoulder) -> float:
    """Distance to the shoulder from the placement of its profile, mm."""
    profile = program.get(feature.v_shape_boundary)
    if profile.placement is None:
        raise program.error(
            "has no placement: the position of the shoulder is unknown",
            feature.v_shape_boundary,
        )
    return abs(float(program.get(program.get(profile.placement).location).coordinates[2]))


def _contour(points: list[tuple[float, float, float]], offset: float) -> Revolved:
    """Radii and length of a polyline in the x, z half plane."""
    radii = [offset + hypot(point[0], point[1]) for point in points]
    heights = [point[2] for point in points]
    return Revolved(
        inner_radius=min(radii),
        outer_radius=max(radii),
        length=max(heights) - min(heights),
    )


def _groove(program: Program, feature: Groove) -> Revolved:
    """Radii and width of a groove, from the surface above it to its bottom radius."""
    profile = program.get(feature.sweep)
    if not isinstance(profile, SquareUProfile):
        raise program.error("a groove of this profile cannot be estimated", feature.sweep)
    radii = [
        0.5 * size(program, other.diameter_at_placement, of)
        for of, other in program.model.of_type(OuterDiameter)
    ]
    above = [radius for radius in radii if radius > feature.radius]
    return Revolved(
        inner_radius=feature.radius,
        outer_radius=min(above, default=_bar_radius_or(program, feature.radius)),
        length=size(program, profile.width, feature.sweep),
    )


GUESSES = frozenset({FULL_LOAD, INTO_SOLID})
"""Messages that no longer apply once the contact along the path is known."""


class Estimates:
    """Source of cuts that are estimated from features, without tool paths."""

    def __init__(self, program: Program, machine: Machine, material: WorkMaterial) -> None:
        self.program = program
        self.machine = machine
        self.material = material

    def cut(self, step: ResolvedWorkingstep) -> tuple[Cut, list[Finding]]:
        """Return the estimated cut of a workingstep as programmed, with findings."""
        return estimated_cut(self.program, step, self.machine, self.material)

    def at(self, _step: ResolvedWorkingstep, cut: Cut, _setting: Setting) -> Cut:
        """Return the cut unchanged: an estimate does not depend on the setting."""
        return cut

    def timed(self, _step: ResolvedWorkingstep, cut: Cut, _setting: Setting) -> Cut:
        """Return the cut unchanged: its length and time are those of one pass."""
        return cut

    def leave_out(self, step: ResolvedWorkingstep) -> None:
        """Do nothing: estimated workingsteps do not affect each other."""

    def map_workingsteps(
        self, steps: Sequence[ResolvedWorkingstep], do: Callable[[ResolvedWorkingstep], Result]
    ) -> Iterator[Result]:
        """Run a function on each workingstep, one after the other, and yield the results."""
        return one_by_one(steps, do)


def estimated_cut(
    program: Program,
    step: ResolvedWorkingstep,
    machine: Machine,
    material: WorkMaterial,
    *,
    depth: float | None = None,
) -> tuple[Cut, list[Finding]]:
    """Estimate the cut of a workingstep from its feature; the findings state assumptions.

    Parameters
    ----------
    material : WorkMaterial
        Workpiece material; helix and parallel land come from the tool grade, the land unless
        the machine uses only its stated limits.
    depth : float or None, mm
        Greatest depth met along a path that alone tells what is cut; None: it is not known.

    Raises
    ------
    SchemaError
        When the workingstep lacks what a cut needs.
    """
    tool = tool_of(program, step.tool_ref)
    conditions = programmed(program, step.technology_ref)
    findings: list[Finding] = []
    operation = step.operation
    is_turning = isinstance(operation, TurningMachiningOperation)
    diameter = mean_diameter(program, step) if is_turning else tool.diameter
    if diameter <= 0.0:
        raise program.error("cuts at the spindle axis: cutting speed 0", step.operation_ref)
    speed = conditions.spindle_speed(diameter)
    feed = conditions.feed_per_tooth(speed, tool.teeth)
    if not is_turning and not tool.has_teeth:
        text = "number_of_teeth is not given: one tooth assumed"
        findings.append(program.finding(Severity.NOTE, text, step.tool_ref))
    if conditions.has_both_speeds:
        text = "cutspeed and spindle are both given (ISO 14649-11 WR1): the spindle counts"
        findings.append(
            program.finding(Severity.WARNING, text, step.technology_ref, "cutspeed")
        )
    make = milling_cut
    if is_path_only(program, step):
        make = partial(path_only_cut, depth=depth)
    elif is_turning:
        make = turning_cut
    elif is_hole_making(operation, tool):
        make = hole_cut
    cut, found = make(program, step, tool, speed=speed, feed=feed)
    return _with_edges(cut, tool, machine, material), findings + list(found)


def _with_edges(cut: Cut, tool: Tool, machine: Machine, material: WorkMaterial) -> Cut:
    """Milling cut with the helix and the parallel land of its grade."""
    if cut.kind is not CutKind.MILLING:
        return cut
    cutting_material = edge_material(tool.edge_material) or CuttingMaterial.CARBIDE
    grade = tool_grade(cut.tool_kind, cutting_material, machine, material)
    if grade is None:
        return cut
    is_marked = cut.texture is Texture.CORNER_PER_REVOLUTION and not machine.only_stated_limits
    land = grade.parallel_land if is_marked else 0.0
    return replace(cut, helix_angle=grade.helix_angle, parallel_land=land)
