"""Permitted deflection of tool or bar, from the tolerance or the allowance of the wall.

The operation that finishes a wall must keep its tolerance. Its deflection counts twice, as the
walls on both sides of a size move alike, and may use half of the permitted deviation; the rest
is for machine, clamping, heat, wear and measuring. So the bound is a quarter of the half-width
of the tolerance. An earlier operation may deflect into its allowance: a third of it, so that
two thirds are left to clean up, and the finish never meets more than four thirds of the planned
allowance. Lengths in mm.

A mill bends across its axis, so it displaces walls and does not affect depths. Widths, lengths
and diameters place walls. Radii of corners and the length of a slot with an open end do not:
there the tool or the edge of the part makes the shape.

Allowance that a given tool path leaves on the walls for later given paths. Unit mm.

A given path states no allowance. Where the paths of later workingsteps on the same feature go
further out on all four sides, down to the same depth, what they go further is left by this one.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from math import hypot

from optimiser.cuts.bare_path import is_path_only
from optimiser.cuts.conditions import GREATEST_DEFLECTION, PermittedDeflection
from optimiser.cuts.feature_estimate import DEFAULT_SIDE_ALLOWANCE, FINISHING
from optimiser.cuts.region import closed_outline, points_of, region_of
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import (
    CompoundFeature,
    PlanarFace,
    ReplicateFeature,
    RoundHole,
    Slot,
)
from stepnc_model.entities.measures import TolerancedLengthMeasure
from stepnc_model.entities.milling import (
    Boring,
    BottomAndSideMilling,
    FreeformOperation,
    PlaneMilling,
    Reaming,
    SideMilling,
)
from stepnc_model.entities.profiles import (
    CircularClosedProfile,
    FlatSlotEndType,
    NgonClosedProfile,
    PartialCircularProfile,
    RadiusedSlotEndType,
    RectangularClosedProfile,
    RoundedUProfile,
    SquareUProfile,
    TeeProfile,
)
from stepnc_model.entities.turning import (
    GeneralRevolution,
    Groove,
    OuterRound,
    TurningMachiningOperation,
)
from stepnc_model.errors import Finding, SchemaError, Severity
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.tolerance import (
    FileTolerance,
    Tolerance,
    general_tolerance,
    written_tolerance,
)
from stepnc_model.toolpath.generate import workingstep_path
from stepnc_model.toolpath.omissions import TOUCHING, SweptBox, swept_box

PASSES_KEPT = 2048
"""Number of boxes that are remembered: each is compared with those of all later paths."""


def left_by_path(program: Program, step: ResolvedWorkingstep) -> float:
    """Least distance by which later given paths on the same feature go further out, mm.

    Parameters
    ----------
    step : ResolvedWorkingstep
        A workingstep with a given tool path.

    Returns
    -------
    float
        0 where no later path goes further out on all sides, or none as deep.
    """
    own = _box(program, step.index)
    later = [
        box
        for other in program.after(step)
        if isinstance(other.operation, FreeformOperation)
        and other.setup == step.setup
        and (box := _box(program, other.index)) is not None
    ]
    if own is None or not later or min(box.low[2] for box in later) > own.low[2] + TOUCHING:
        return 0.0
    beyond = [own.low[axis] - min(box.low[axis] for box in later) for axis in (0, 1)]
    beyond += [max(box.high[axis] for box in later) - own.high[axis] for axis in (0, 1)]
    return max(0.0, min(beyond))


@lru_cache(maxsize=PASSES_KEPT)
def _box(program: Program, index: int) -> SweptBox | None:
    """Box that the path of a workingstep sweeps; None where no path can be made."""
    try:
        return swept_box(program, workingstep_path(program, program.workingsteps[index]))
    except SchemaError:
        return None


BOUNDARIES = (
    "feature_boundary",
    "open_boundary",
    "closed_boundary",
    "profile_boundary",
    "partial_circular_boundary",
    "swept_shape",
    "its_boundary",
)
"""Attributes of features that hold the profile of their walls."""

SIZES: dict[type[Entity], tuple[str, ...]] = {
    RoundHole: ("diameter",),
    RectangularClosedProfile: ("profile_width", "profile_length"),
    CircularClosedProfile: ("diameter",),
    NgonClosedProfile: ("diameter",),
    SquareUProfile: ("width",),
    RoundedUProfile: ("width",),
    TeeProfile: ("width", "cross_bar_width"),
    PartialCircularProfile: ("radius",),
}
"""Toleranced lengths that place a wall, by the type of entity."""

CLOSED_ENDS = (RadiusedSlotEndType, FlatSlotEndType)
"""Types of slot ends that are walls as well."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WallSize:
    """Size between two walls, or of a single wall."""

    name: str
    size: float
    """Nominal width, length or diameter, mm."""
    ref: Ref[TolerancedLengthMeasure] | None
    """Toleranced length in the file; None if the size was measured on a shape."""


def wall_sizes(program: Program, ref: Ref[Entity]) -> list[WallSize]:
    """Sizes of the walls of a feature and of its bosses; empty for a plain face.

    Raises
    ------
    SchemaError
        When the feature lacks a size.
    """
    feature = program.get(ref)
    if isinstance(feature, ReplicateFeature):
        return wall_sizes(program, feature.replicate_base_feature)
    if isinstance(feature, CompoundFeature):
        first, *others = feature.elements
        written = (size for other in others for size in _written(program, program.get(other)))
        return [*wall_sizes(program, first), *written]
    own = list(_written(program, feature))
    if not own and not isinstance(feature, PlanarFace):
        own = [WallSize(name="width", size=region_of(program, ref).width, ref=None)]
    return own + _boss_sizes(program, feature)


def bar_sizes(program: Program, ref: Ref[Entity]) -> list[WallSize]:
    """Diameters of a turning feature; empty for a face, which bar bending does not affect."""
    feature = program.get(ref)
    if isinstance(feature, OuterRound):
        return list(_size(program, "diameter", feature.diameter_at_placement))
    if isinstance(feature, Groove):
        return [WallSize(name="diameter", size=2.0 * feature.radius, ref=None)]
    if not isinstance(feature, GeneralRevolution):
        return []
    points = points_of(program, program.get(feature.outer_edge_profile).its_profile)
    radii = {feature.radius + hypot(point[0], point[1]) for point in points}
    return [WallSize(name="diameter", size=2.0 * radius, ref=None) for radius in radii]


def _written(program: Program, feature: Entity) -> Iterator[WallSize]:
    """Sizes with toleranced lengths, of a feature and of the profile of its walls."""
    yield from _of(program, feature)
    for name in BOUNDARIES:
        boundary = getattr(feature, name, None)
        if boundary is not None:
            yield from _of(program, program.get(boundary))
    if isinstance(feature, Slot):
        ends = [program.get(end) for end in feature.end_conditions]
        if any(isinstance(end, CLOSED_ENDS) for end in ends):
            course = program.get(feature.course_of_travel)
            yield from _size(program, "length", getattr(course, "distance", None))


def _of(program: Program, entity: Entity) -> Iterator[WallSize]:
    """Sizes with toleranced lengths, of one entity."""
    for attribute in SIZES.get(type(entity), ()):
        name = attribute.removeprefix("profile_").replace("_", " ")
        yield from _size(program, name, getattr(entity, attribute))


def _size(
    program: Program, name: str, ref: Ref[TolerancedLengthMeasure] | None
) -> Iterator[WallSize]:
    """Size of one toleranced length, if it has a nominal size."""
    length = program.model.entity(int(ref)) if ref is not None else None
    if isinstance(length, TolerancedLengthMeasure) and (length.theoretical_size or 0.0) > 0.0:
        yield WallSize(name=name, size=length.theoretical_size, ref=ref)


def _boss_sizes(program: Program, feature: Entity) -> list[WallSize]:
    """Sizes of the bosses that stay within a feature."""
    found: list[WallSize] = []
    for boss in map(program.get, getattr(feature, "its_boss", ())):
        own = list(_written(program, boss))
        if not own:
            outline = closed_outline(program, boss.its_boundary)
            own = [WallSize(name="width of a boss", size=outline.width, ref=None)]
        found += own
    return found


SHARE_OF_TOLERANCE = 0.25
"""Permitted deflection over the half-width of the tolerance; see the module docstring."""

SHARE_OF_ALLOWANCE = 1.0 / 3.0
"""Permitted deflection over the allowance; see the module docstring."""

GREATEST_AT_WALL = 0.05
"""Greatest deflection at a finished wall, mm, however wide the tolerance (customary)."""

WALL_OPERATIONS = (SideMilling, BottomAndSideMilling, FreeformOperation, Boring, Reaming)
"""Operations that remove an allowance from a wall."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Toleranced:
    """Size between walls with its tolerance."""

    wall: WallSize
    tolerance: Tolerance


def permitted_deflection(
    program: Program, step: ResolvedWorkingstep
) -> tuple[PermittedDeflection, list[Finding]]:
    """Permitted deflection of the end mill of a workingstep; the findings state assumptions.

    Parameters
    ----------
    step : ResolvedWorkingstep
        A milling workingstep.

    Returns
    -------
    PermittedDeflection, findings

    Raises
    ------
    SchemaError
        When the feature lacks a size.
    """
    if is_path_only(program, step):
        origin = "the customary maximum for any wall, as the path names no tolerance"
        return PermittedDeflection(value=GREATEST_AT_WALL, origin=origin), []
    return _permitted(program, step, _walls(program, step), _allowance(program, step))


def permitted_bar_deflection(
    program: Program, step: ResolvedWorkingstep
) -> tuple[PermittedDeflection, list[Finding]]:
    """Permitted deflection of the bar of a turning workingstep; findings state assumptions.

    A bar that deflects gets thicker by twice as much. Parameters, result and errors as in
    :func:`permitted_deflection`.
    """
    diameters = [size for feature in step.features for size in bar_sizes(program, feature)]
    allowance = getattr(step.operation, "allowance", None) or 0.0
    return _permitted(program, step, diameters, max(0.0, allowance))


def _permitted(
    program: Program, step: ResolvedWorkingstep, walls: list[WallSize], allowance: float
) -> tuple[PermittedDeflection, list[Finding]]:
    """Permitted deflection for given sizes and the allowance that is left on them."""
    forgiven = SHARE_OF_ALLOWANCE * allowance
    if not walls or forgiven >= GREATEST_DEFLECTION:
        return PermittedDeflection(), []
    tightest, findings = _tightest(program, walls)
    permitted = _within_tolerance(tightest)
    # An allowance that permits less than the tolerance does not tighten the bound.
    if forgiven > permitted.value:
        origin = f"a third of the allowance of {allowance:g} mm on the wall"
        return PermittedDeflection(value=forgiven, origin=origin), findings
    left = f"{allowance:g} mm on " if allowance > 0.0 else "no allowance on "
    what = "bar" if isinstance(step.operation, TurningMachiningOperation) else "tool"
    bound = f"{what} deflection at most {permitted.value:.3g} mm"
    text = f"leaves {left}the wall: {bound}, {permitted.origin}"
    return permitted, [*findings, program.finding(Severity.NOTE, text, step.operation_ref)]


def _tightest(program: Program, walls: list[WallSize]) -> tuple[_Toleranced, list[Finding]]:
    """Size with the tightest tolerance, and findings on unreadable tolerances."""
    toleranced = []
    findings: list[Finding] = []
    for wall in walls:
        written = FileTolerance(tolerance=None)
        if wall.ref is not None:
            written = written_tolerance(program, wall.ref)
        if written.finding is not None and written.finding not in findings:
            findings.append(written.finding)
        tolerance = written.tolerance or general_tolerance(wall.size)
        toleranced.append(_Toleranced(wall=wall, tolerance=tolerance))
    return min(toleranced, key=lambda each: each.tolerance.half_width), findings


def _walls(program: Program, step: ResolvedWorkingstep) -> list[WallSize]:
    """Sizes of the walls that an operation cuts; a face has only those of its bosses."""
    if not step.features:
        return []
    feature = step.features[0]
    is_face = isinstance(program.get(feature), PlanarFace)
    if isinstance(step.operation, PlaneMilling) and not is_face:
        return []
    return wall_sizes(program, feature)


def _allowance(program: Program, step: ResolvedWorkingstep) -> float:
    """Allowance left on the wall for a later operation, mm; 0 if this one finishes it."""
    operation = step.operation
    written: float | None = getattr(operation, "allowance_side", None)
    if written is not None:
        return max(0.0, written)
    # A given tool path states no allowance: it finishes the wall unless later ones do.
    if isinstance(operation, FreeformOperation):
        return left_by_path(program, step)
    if isinstance(operation, FINISHING):
        return 0.0
    later = (each.operation for each in program.after(step))
    is_followed = any(isinstance(each, WALL_OPERATIONS) for each in later)
    return DEFAULT_SIDE_ALLOWANCE if is_followed else 0.0


def _within_tolerance(size: _Toleranced) -> PermittedDeflection:
    """Permitted deflection as a share of the tolerance, at most that of any wall."""
    tolerance, wall = size.tolerance, size.wall
    share = SHARE_OF_TOLERANCE * tolerance.half_width
    places = [str(wall.ref)] if wall.ref is not None else []
    if tolerance.code != f"±{tolerance.half_width:g} mm":
        places.insert(0, tolerance.code)
    origin = (
        f"a quarter of the ±{tolerance.half_width:.4g} mm tolerance of the {wall.name} "
        f"of {wall.size:.4g} mm ({', '.join(places)})"
    )
    if share > GREATEST_AT_WALL:
        origin = f"the customary maximum for any wall ({origin} would be more)"
    return PermittedDeflection(value=min(share, GREATEST_AT_WALL), origin=origin)
