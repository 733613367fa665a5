"""Region that a milling feature removes, with its area and boundary lengths.

Features of ISO 14649-10 are taken in their own coordinates. Arcs of composite curves count as
chords here; the tool path, which keeps arcs, replaces this estimate.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import hypot, pi, sin, tan

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import (
    Boss,
    CircularPattern,
    ClosedPocket,
    CompoundFeature,
    GeneralOutsideProfile,
    GeneralPattern,
    OpenPocket,
    PlanarFace,
    RectangularPattern,
    RoundHole,
    ShapeProfile,
    Slot,
    Step,
)
from stepnc_model.entities.geometry import (
    Block,
    CartesianPoint,
    CompositeCurve,
    Polyline,
    TrimmedCurve,
)
from stepnc_model.entities.profiles import (
    CircularClosedProfile,
    CompleteCircularPath,
    GeneralClosedProfile,
    GeneralPath,
    GeneralProfile,
    LinearPath,
    LinearProfile,
    NgonClosedProfile,
    OpenSlotEndType,
    PartialCircularPath,
    PartialCircularProfile,
    RectangularClosedProfile,
    RoundedUProfile,
    SquareUProfile,
    VeeProfile,
)
from stepnc_model.part21.values import Ref
from stepnc_model.programs.outline import boundary_of, known_depth, parameter, size, vee_angle
from stepnc_model.programs.program import Program
from stepnc_model.units import rad_from_deg

Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundarySize:
    """Area, length and width of a boundary, mm² and mm."""

    area: float
    length: float
    width: float


def closed_outline(program: Program, ref: Ref[Entity]) -> BoundarySize:
    """Area, length and width of a closed profile."""
    profile = program.get(ref)
    if isinstance(profile, RectangularClosedProfile):
        width, length = (
            size(program, profile.profile_width, ref),
            size(program, profile.profile_length, ref),
        )
        return BoundarySize(
            area=width * length, length=2.0 * (width + length), width=min(width, length)
        )
    if isinstance(profile, CircularClosedProfile):
        return circle_outline(size(program, profile.diameter, ref))
    if isinstance(profile, NgonClosedProfile):
        return _ngon(program, ref, profile)
    if isinstance(profile, GeneralClosedProfile):
        return _polygon(list(points_of(program, profile.closed_profile_shape)))
    raise program.error("is not a closed profile of a known kind", ref)


def open_outline(program: Program, ref: Ref[Entity]) -> BoundarySize:
    """Size of an open profile, its area closed by the straight line between its ends."""
    profile = program.get(ref)
    if isinstance(profile, GeneralProfile):
        points = list(points_of(program, profile.its_profile))
        closed = _polygon(points)
        gap = hypot(points[0][0] - points[-1][0], points[0][1] - points[-1][1])
        return BoundarySize(area=closed.area, length=closed.length - gap, width=closed.width)
    if isinstance(profile, PartialCircularProfile):
        radius = size(program, profile.radius, ref)
        sweep = rad_from_deg(profile.sweep_angle)
        area = 0.5 * radius**2 * (sweep - sin(sweep))
        return BoundarySize(area=area, length=radius * sweep, width=radius)
    if isinstance(profile, LinearProfile):
        length = parameter(program, profile.profile_length)
        return BoundarySize(area=0.0, length=length, width=length)
    width = swept_width(program, ref, 0.0)
    return BoundarySize(area=0.0, length=width, width=width)


def circle_outline(diameter: float) -> BoundarySize:
    """Size of a circle of a given diameter."""
    return BoundarySize(area=0.25 * pi * diameter**2, length=pi * diameter, width=diameter)


def _ngon(program: Program, ref: Ref[Entity], profile: NgonClosedProfile) -> BoundarySize:
    """Size of a regular polygon, from its circumscribed circle or its width across flats."""
    sides, half = profile.number_of_sides, 0.5 * size(program, profile.diameter, ref)
    angle = pi / sides
    edge = 2.0 * half * (sin(angle) if profile.circumscribed_or_across_flats else tan(angle))
    inner = 0.5 * edge / tan(angle)
    return BoundarySize(area=0.5 * sides * edge * inner, length=sides * edge, width=2.0 * inner)


def _polygon(points: list[Point]) -> BoundarySize:
    """Size of a closed polygon: shoelace area, length and narrower extent."""
    ring = [*points, points[0]]
    twice = sum(a[0] * b[1] - b[0] * a[1] for a, b in pairwise(ring))
    length = sum(hypot(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(ring))
    extents = [max(p[axis] for p in points) - min(p[axis] for p in points) for axis in (0, 1)]
    return BoundarySize(area=0.5 * abs(twice), length=length, width=min(extents))


def points_of(program: Program, ref: Ref[Entity]) -> Iterator[Point]:
    """Corner points of a bounded curve; arcs give only their ends."""
    curve = program.get(ref)
    if isinstance(curve, Polyline):
        for point in curve.points:
            yield _point(program, point)
    elif isinstance(curve, CompositeCurve):
        for segment in curve.segments:
            yield from points_of(program, program.get(segment).parent_curve)
    elif isinstance(curve, TrimmedCurve):
        for trims in (curve.trim_1, curve.trim_2):
            for trim in trims:
                if isinstance(trim, Ref):
                    yield _point(program, trim)
    else:
        raise program.error("a curve of this kind cannot be measured yet", ref)


def _point(program: Program, ref: Ref[Entity]) -> Point:
    point = program.get(ref)
    if not isinstance(point, CartesianPoint):
        raise program.error("is not a cartesian_point", ref)
    x, y, z = (*point.coordinates, 0.0, 0.0)[:3]
    return float(x), float(y), float(z)


def travel_length(program: Program, ref: Ref[Entity]) -> float:
    """Length of a travel path, mm."""
    path = program.get(ref)
    if isinstance(path, LinearPath):
        return size(program, path.distance, ref)
    if isinstance(path, CompleteCircularPath):
        return 2.0 * pi * size(program, path.radius, ref)
    if isinstance(path, PartialCircularPath):
        return size(program, path.radius, ref) * rad_from_deg(path.sweep_angle)
    if isinstance(path, GeneralPath):
        points = list(points_of(program, path.swept_path))
        return sum(hypot(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(points))
    raise program.error("is not a travel path of a known kind", ref)


def swept_width(program: Program, ref: Ref[Entity], depth: float) -> float:
    """Width at the top of the profile of a slot, mm."""
    profile = program.get(ref)
    if isinstance(profile, (SquareUProfile, RoundedUProfile)):
        return size(program, profile.width, ref)
    if isinstance(profile, VeeProfile):
        return 2.0 * depth * tan(0.5 * vee_angle(profile.profile_angle))
    if isinstance(profile, PartialCircularProfile):
        return 2.0 * size(program, profile.radius, ref)
    if isinstance(profile, GeneralProfile):
        return _polygon(list(points_of(program, profile.its_profile))).width
    raise program.error("the width cannot be derived from a profile of this kind", ref)


@dataclass(frozen=True, slots=True, kw_only=True)
class FeatureRegion:
    """Region of a feature seen along the tool axis."""

    area: float
    """Area of floor to sweep, mm²; 0 when only walls are cut."""
    perimeter: float
    """Length of wall to follow by the cutter, mm."""
    width: float
    """Extent of the region across the strokes, mm."""
    depth: float
    """Depth of the region along the tool axis, mm."""
    is_open: bool
    """Whether the tool may enter and leave through the side."""
    count: int = 1
    """Number of equal regions in a pattern."""


def region_of(program: Program, ref: Ref[Entity]) -> FeatureRegion:
    """Determine the region of one feature.

    Parameters
    ----------
    ref : Ref
        A feature of ISO 14649-10.

    Returns
    -------
    FeatureRegion

    Raises
    ------
    SchemaError
        When the feature lacks a size, or its kind cannot be estimated.
    """
    feature = program.get(ref)
    if isinstance(feature, (GeneralPattern, RectangularPattern, CircularPattern)):
        base = region_of(program, feature.replicate_base_feature)
        return replace(base, count=pattern_count(feature))
    if isinstance(feature, CompoundFeature):
        return region_of(program, feature.elements[0])
    depth = known_depth(program, ref)
    if isinstance(feature, PlanarFace):
        return _face(program, feature, depth)
    if isinstance(feature, ClosedPocket):
        outline = closed_outline(program, feature.feature_boundary)
        return _pocket(program, outline, feature.its_boss, depth=depth, is_open=False)
    if isinstance(feature, OpenPocket):
        outline = open_outline(program, feature.open_boundary)
        return _pocket(program, outline, feature.its_boss, depth=depth, is_open=True)
    if isinstance(feature, Slot):
        return _slot(program, feature, depth)
    if isinstance(feature, Step):
        return _step(program, feature, depth)
    if isinstance(feature, RoundHole):
        diameter = size(program, feature.diameter, ref)
        outline = circle_outline(diameter)
        return FeatureRegion(
            area=outline.area,
            perimeter=outline.length,
            width=diameter,
            depth=depth,
            is_open=False,
        )
    outline = _profile_boundary(program, ref, feature)
    return FeatureRegion(
        area=0.0, perimeter=outline.length, width=outline.width, depth=depth, is_open=True
    )


def _face(program: Program, feature: PlanarFace, depth: float) -> FeatureRegion:
    """Region of a planar face: travel length times profile length, less the bosses."""
    length = size(
        program, program.get(feature.course_of_travel).distance, feature.course_of_travel
    )
    profile = program.get(feature.removal_boundary)
    width = (
        parameter(program, profile.profile_length)
        if isinstance(profile, LinearProfile)
        else open_outline(program, feature.removal_boundary).width
    )
    islands = list(_islands(program, feature.its_boss))
    return FeatureRegion(
        area=max(0.0, length * width - sum(island.area for island in islands)),
        perimeter=sum(island.length for island in islands),
        width=width,
        depth=depth,
        is_open=True,
    )


def _pocket(
    program: Program,
    outline: BoundarySize,
    bosses: tuple[Ref[Boss], ...],
    *,
    depth: float,
    is_open: bool,
) -> FeatureRegion:
    """Region of a pocket: its boundary less the islands, whose walls count as walls."""
    islands = list(_islands(program, bosses))
    return FeatureRegion(
        area=max(0.0, outline.area - sum(island.area for island in islands)),
        perimeter=outline.length + sum(island.length for island in islands),
        width=outline.width,
        depth=depth,
        is_open=is_open,
    )


def _slot(program: Program, feature: Slot, depth: float) -> FeatureRegion:
    """Region of a slot: its width along the course of travel."""
    length = travel_length(program, feature.course_of_travel)
    width = swept_width(program, feature.swept_shape, depth)
    ends = [program.get(end) for end in feature.end_conditions]
    return FeatureRegion(
        area=length * width,
        perimeter=2.0 * length,
        width=width,
        depth=depth,
        is_open=any(isinstance(end, OpenSlotEndType) for end in ends),
    )


def _step(program: Program, feature: Step, depth: float) -> FeatureRegion:
    """Region of a step: from its edge to the side of the stock, on the right of the edge."""
    path = program.get(feature.open_boundary)
    length = size(program, path.distance, feature.open_boundary)
    placement = program.get(feature.feature_placement)
    at = program.get(placement.location).coordinates
    along = program.get(path.its_direction).direction_ratios
    width = _distance_to_side(program, at=at, along=along)
    return FeatureRegion(
        area=length * width, perimeter=length, width=width, depth=depth, is_open=True
    )


def _distance_to_side(
    program: Program, *, at: tuple[float, ...], along: tuple[float, ...]
) -> float:
    """Distance from a line to the side of the stock block on its right, mm."""
    workpiece = program.workpiece()
    bounding = workpiece.its_bounding_geometry if workpiece is not None else None
    block = program.get(bounding) if bounding is not None else None
    norm = hypot(along[0], along[1])
    if not isinstance(block, Block) or norm == 0.0:
        return DEFAULT_STEP_WIDTH
    corner = program.get(program.get(block.position).location).coordinates
    across = (along[1] / norm, -along[0] / norm)
    corners = [
        (corner[0] + i * block.x, corner[1] + j * block.y) for i in (0, 1) for j in (0, 1)
    ]
    reach = max((x - at[0]) * across[0] + (y - at[1]) * across[1] for x, y in corners)
    return reach if reach > 0.0 else DEFAULT_STEP_WIDTH


DEFAULT_STEP_WIDTH = 10.0
"""Width of a step when the file gives no stock to measure it from, mm."""


def _islands(program: Program, bosses: tuple[Ref[Boss], ...]) -> Iterator[BoundarySize]:
    """Sizes of the outlines of the bosses that remain."""
    return (closed_outline(program, program.get(boss).its_boundary) for boss in bosses)


def _profile_boundary(program: Program, ref: Ref[Entity], feature: Entity) -> BoundarySize:
    """Size of the outline that an outside profile or a boss is cut along."""
    boundary = boundary_of(feature)
    if boundary is None or not isinstance(feature, (GeneralOutsideProfile, Boss, ShapeProfile)):
        raise program.error(
            "the path length cannot be estimated for a feature of this kind", ref
        )
    shape = program.get(boundary)
    is_open = isinstance(shape, (SquareUProfile, GeneralProfile, PartialCircularProfile))
    return open_outline(program, boundary) if is_open else closed_outline(program, boundary)


def pattern_count(pattern: GeneralPattern | RectangularPattern | CircularPattern) -> int:
    """Number of regions that a pattern makes."""
    if isinstance(pattern, GeneralPattern):
        return 1 + len(pattern.replicate_locations)
    if isinstance(pattern, CircularPattern):
        return max(1, pattern.number_of_feature - len(pattern.missing_base_feature))
    rows = pattern.number_of_rows or 1
    return max(1, rows * pattern.number_of_columns - len(pattern.missing_base_feature))
