"""Sizes that place the walls of a feature: what the bending of a tool spoils.

A mill bends across its axis, so it moves walls and leaves depths alone. Widths, lengths and
diameters say where walls stand. Radii of corners and the length of a way that ends in the open
do not: there the tool or the edge of the part makes the shape. ISO 14649-10, sizes in mm.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import hypot

from optimiser.outline import closed_outline, points_of
from optimiser.region import region_of
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import (
    CompoundFeature,
    PlanarFace,
    ReplicateFeature,
    RoundHole,
    Slot,
)
from stepnc_model.entities.measures import TolerancedLengthMeasure
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
from stepnc_model.entities.turning_features import GeneralRevolution, Groove, OuterRound
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program

BOUNDARIES = (
    "feature_boundary",
    "open_boundary",
    "closed_boundary",
    "profile_boundary",
    "partial_circular_boundary",
    "swept_shape",
    "its_boundary",
)
"""attributes of features that hold the profile of their walls"""

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
"""toleranced lengths that place a wall"""

CLOSED_ENDS = (RadiusedSlotEndType, FlatSlotEndType)
"""ends of a slot that are walls as well"""


@dataclass(frozen=True, slots=True, kw_only=True)
class WallSize:
    """A size between walls, or of one."""

    name: str
    size: float
    """mm, nominal"""
    ref: Ref[TolerancedLengthMeasure] | None
    """None: measured on a shape that has no toleranced length"""


def wall_sizes(program: Program, ref: Ref[Entity]) -> list[WallSize]:
    """Sizes of the walls of a feature, those of its bosses included; none of a bare face.

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
    """Diameters of a turning feature; none of a face, which a bar that bends leaves alone."""
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
    """Toleranced lengths of a feature and of the profile of its walls."""
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
    """Toleranced lengths of one entity."""
    for attribute in SIZES.get(type(entity), ()):
        name = attribute.removeprefix("profile_").replace("_", " ")
        yield from _size(program, name, getattr(entity, attribute))


def _size(
    program: Program, name: str, ref: Ref[TolerancedLengthMeasure] | None
) -> Iterator[WallSize]:
    """One toleranced length, unless it has no size."""
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
