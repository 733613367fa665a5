"""What a milling feature asks to be removed, read off its entities.

ISO 14649-10 features in their own coordinates. Arcs of composite curves count by their chords
here; the tool path, which keeps arcs, replaces this estimate.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import hypot

from optimiser.outline import (
    Outline,
    circle_outline,
    closed_outline,
    open_outline,
    parameter,
    size,
    swept_width,
    travel_length,
)
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
)
from stepnc_model.entities.profiles import (
    GeneralProfile,
    LinearProfile,
    OpenSlotEndType,
    PartialCircularProfile,
    SquareUProfile,
)
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program


@dataclass(frozen=True, slots=True, kw_only=True)
class Region:
    """A feature seen along the tool's axis."""

    area: float
    """mm² of floor to sweep; 0 when only walls are cut"""
    perimeter: float
    """mm of wall to follow"""
    width: float
    """mm, extent across the strokes"""
    depth: float
    """mm along the axis"""
    is_open: bool
    """the tool may enter and leave through the side"""
    count: int = 1
    """equal regions that a pattern repeats"""


def region_of(program: Program, ref: Ref[Entity]) -> Region:
    """Region of one feature.

    Parameters
    ----------
    program : Program
    ref : Ref
        A feature of ISO 14649-10.

    Returns
    -------
    Region

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
    depth = feature_depth(program, ref)
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
        diameter = size(program, feature.diameter)
        outline = circle_outline(diameter)
        return Region(
            area=outline.area,
            perimeter=outline.length,
            width=diameter,
            depth=depth,
            is_open=False,
        )
    outline = _profile_boundary(program, ref, feature)
    return Region(
        area=0.0, perimeter=outline.length, width=outline.width, depth=depth, is_open=True
    )


def feature_depth(program: Program, ref: Ref[Entity]) -> float:
    """Depth of a feature along its own axis, mm: where its depth plane lies."""
    feature = program.get(ref)
    plane = getattr(feature, "depth", None)
    if plane is None:
        raise program.error("has no depth", ref, "depth")
    placement = program.get(program.get(plane).position)
    depth = abs(float(program.get(placement.location).coordinates[2]))
    if depth <= 0.0:
        raise program.error(f"depth {depth:g} mm removes nothing", ref, "depth")
    return depth


def _face(program: Program, feature: PlanarFace, depth: float) -> Region:
    """Length of travel times profile length, less the bosses."""
    length = size(program, program.get(feature.course_of_travel).distance)
    profile = program.get(feature.removal_boundary)
    width = (
        parameter(program, profile.profile_length)
        if isinstance(profile, LinearProfile)
        else open_outline(program, feature.removal_boundary).width
    )
    islands = list(_islands(program, feature.its_boss))
    return Region(
        area=max(0.0, length * width - sum(island.area for island in islands)),
        perimeter=sum(island.length for island in islands),
        width=width,
        depth=depth,
        is_open=True,
    )


def _pocket(
    program: Program,
    outline: Outline,
    bosses: tuple[Ref[Boss], ...],
    *,
    depth: float,
    is_open: bool,
) -> Region:
    """Boundary less islands; island walls count as walls."""
    islands = list(_islands(program, bosses))
    return Region(
        area=max(0.0, outline.area - sum(island.area for island in islands)),
        perimeter=outline.length + sum(island.length for island in islands),
        width=outline.width,
        depth=depth,
        is_open=is_open,
    )


def _slot(program: Program, feature: Slot, depth: float) -> Region:
    """Width of the swept shape along the course of travel."""
    length = travel_length(program, feature.course_of_travel)
    width = swept_width(program, feature.swept_shape, depth)
    ends = [program.get(end) for end in feature.end_conditions]
    return Region(
        area=length * width,
        perimeter=2.0 * length,
        width=width,
        depth=depth,
        is_open=any(isinstance(end, OpenSlotEndType) for end in ends),
    )


def _step(program: Program, feature: Step, depth: float) -> Region:
    """From the edge to the side of the stock, which lies to the right of the edge's sense."""
    path = program.get(feature.open_boundary)
    length = size(program, path.distance)
    placement = program.get(feature.feature_placement)
    at = program.get(placement.location).coordinates
    along = program.get(path.its_direction).direction_ratios
    width = _distance_to_side(program, at=at, along=along)
    return Region(area=length * width, perimeter=length, width=width, depth=depth, is_open=True)


def _distance_to_side(
    program: Program, *, at: tuple[float, ...], along: tuple[float, ...]
) -> float:
    """Distance in mm from a line to the side of the stock's block on its right."""
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
"""mm, of a step when the file gives no stock to measure it by"""


def _islands(program: Program, bosses: tuple[Ref[Boss], ...]) -> Iterator[Outline]:
    """Outlines of the bosses that stay."""
    return (closed_outline(program, program.get(boss).its_boundary) for boss in bosses)


def _profile_boundary(program: Program, ref: Ref[Entity], feature: Entity) -> Outline:
    """Outline that an outside profile or a boss is cut along."""
    if isinstance(feature, GeneralOutsideProfile):
        boundary = feature.feature_boundary
    elif isinstance(feature, Boss):
        boundary = feature.its_boundary
    elif isinstance(feature, ShapeProfile):
        name = "open_boundary" if hasattr(feature, "open_boundary") else "closed_boundary"
        boundary = getattr(feature, name)
    else:
        raise program.error(
            "its path length cannot be estimated from a feature of this kind", ref
        )
    shape = program.get(boundary)
    is_open = isinstance(shape, (SquareUProfile, GeneralProfile, PartialCircularProfile))
    return open_outline(program, boundary) if is_open else closed_outline(program, boundary)


def pattern_count(pattern: GeneralPattern | RectangularPattern | CircularPattern) -> int:
    """Regions that a pattern makes."""
    if isinstance(pattern, GeneralPattern):
        return 1 + len(pattern.replicate_locations)
    if isinstance(pattern, CircularPattern):
        return max(1, pattern.number_of_feature - len(pattern.missing_base_feature))
    rows = pattern.number_of_rows or 1
    return max(1, rows * pattern.number_of_columns - len(pattern.missing_base_feature))
