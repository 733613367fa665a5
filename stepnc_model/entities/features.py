"""Features of milling and drilling (ISO 14649-10); mm and degrees."""

from __future__ import annotations

from stepnc_model.entities.bottoms import (
    HoleBottomCondition,
    PocketBottomCondition,
    ProfileFloor,
    ThroughProfileFloor,
)
from stepnc_model.entities.entity import Entity, abstract, entity
from stepnc_model.entities.geometry import Axis2Placement3d, Direction, ElementarySurface
from stepnc_model.entities.measures import NumericParameter, TolerancedLengthMeasure
from stepnc_model.entities.profiles import (
    AngleTaper,
    CircularClosedProfile,
    ClosedProfile,
    DiameterTaper,
    LinearPath,
    LinearProfile,
    OpenProfile,
    PartialCircularProfile,
    Profile,
    RectangularClosedProfile,
    SlotEndType,
    SquareUProfile,
    TravelPath,
    VeeProfile,
)
from stepnc_model.entities.regions import ManufacturingFeature
from stepnc_model.part21.values import Ref


@abstract
class Two5dManufacturingFeature(ManufacturingFeature):
    """Feature that lies on a plane."""

    feature_placement: Ref[Axis2Placement3d]


@abstract
class MachiningFeature(Two5dManufacturingFeature):
    """Feature with a depth, given as a surface in the feature's coordinates."""

    depth: Ref[ElementarySurface]


@entity
class Boss(MachiningFeature):
    """Material left standing within another feature."""

    its_boundary: Ref[ClosedProfile]
    slope: float | None = None


@entity
class PlanarFace(MachiningFeature):
    """Face to be milled flat."""

    course_of_travel: Ref[LinearPath]
    removal_boundary: Ref[LinearProfile]
    face_boundary: Ref[ClosedProfile] | None = None
    its_boss: tuple[Ref[Boss], ...]


@abstract
class Pocket(MachiningFeature):
    """Hollow with a floor and walls."""

    its_boss: tuple[Ref[Boss], ...]
    slope: float | None = None
    bottom_condition: Ref[PocketBottomCondition]
    planar_radius: Ref[TolerancedLengthMeasure] | None = None
    orthogonal_radius: Ref[TolerancedLengthMeasure] | None = None


@entity
class ClosedPocket(Pocket):
    """Pocket with walls all around."""

    feature_boundary: Ref[ClosedProfile]


@entity
class OpenPocket(Pocket):
    """Pocket that the tool may enter from the side."""

    open_boundary: Ref[OpenProfile]
    wall_boundary: Ref[OpenProfile] | None = None


@entity
class Slot(MachiningFeature):
    """Profile swept along a path."""

    course_of_travel: Ref[TravelPath]
    swept_shape: Ref[OpenProfile]
    end_conditions: tuple[Ref[SlotEndType], ...]


@entity
class Step(MachiningFeature):
    """Corner taken off along an edge."""

    open_boundary: Ref[LinearPath]
    wall_boundary: Ref[VeeProfile] | None = None
    its_boss: tuple[Ref[Boss], ...]


@entity
class RoundHole(MachiningFeature):
    """Hole by its diameter."""

    diameter: Ref[TolerancedLengthMeasure]
    change_in_diameter: Ref[DiameterTaper | AngleTaper] | None = None
    bottom_condition: Ref[HoleBottomCondition]


@entity
class ToolpathFeature(MachiningFeature):
    """Whatever the tool path leaves."""


@entity
class RoundedEnd(MachiningFeature):
    """Partial circle swept along a line."""

    course_of_travel: Ref[LinearPath]
    partial_circular_boundary: Ref[PartialCircularProfile]


@entity
class SphericalCap(MachiningFeature):
    """Part of a sphere."""

    internal_angle: Ref[NumericParameter]
    radius: Ref[NumericParameter]


@abstract
class ProfileFeature(MachiningFeature):
    """Profile swept along a line."""

    profile_swept_shape: Ref[LinearPath]


@entity
class GeneralOutsideProfile(ProfileFeature):
    """Outside of the workpiece."""

    feature_boundary: Ref[Profile]


@abstract
class ShapeProfile(ProfileFeature):
    """Swept profile with a floor."""

    floor_condition: Ref[ThroughProfileFloor | ProfileFloor]
    removal_direction: Ref[Direction]


@entity
class GeneralShapeProfile(ShapeProfile):
    """Shape of any profile."""

    profile_boundary: Ref[Profile]


@entity
class PartialCircularShapeProfile(ShapeProfile):
    """Shape of an arc."""

    open_boundary: Ref[PartialCircularProfile]


@entity
class CircularClosedShapeProfile(ShapeProfile):
    """Shape of a circle."""

    closed_boundary: Ref[CircularClosedProfile]


@entity
class RectangularOpenShapeProfile(ShapeProfile):
    """Shape of a U."""

    open_boundary: Ref[SquareUProfile]


@entity
class RectangularClosedShapeProfile(ShapeProfile):
    """Shape of a rectangle."""

    closed_boundary: Ref[RectangularClosedProfile]


@abstract
class TransitionFeature(ManufacturingFeature):
    """What joins two features."""

    first_feature: Ref[MachiningFeature]
    second_feature: Ref[MachiningFeature]


@entity
class Chamfer(TransitionFeature):
    """Broken edge."""

    angle_to_plane: float
    first_offset_amount: Ref[TolerancedLengthMeasure]


@entity
class EdgeRound(TransitionFeature):
    """Rounded edge."""

    radius: Ref[TolerancedLengthMeasure]
    first_offset_amount: Ref[TolerancedLengthMeasure] | None = None
    second_offset_amount: Ref[TolerancedLengthMeasure] | None = None


@entity
class CompoundFeature(Two5dManufacturingFeature):
    """Several features as one."""

    elements: tuple[Ref[MachiningFeature | TransitionFeature], ...]


@entity
class CounterboreHole(CompoundFeature):
    """Hole with a cylindrical sink."""


@entity
class CountersunkHole(CompoundFeature):
    """Hole with a conical sink."""


@abstract
class ReplicateFeature(Two5dManufacturingFeature):
    """Feature repeated."""

    replicate_base_feature: Ref[Two5dManufacturingFeature]


@entity
class GeneralPattern(ReplicateFeature):
    """Feature repeated at placements of its own."""

    replicate_locations: tuple[Ref[Axis2Placement3d], ...]


@entity
class CircularOffset(Entity):
    """Copy of a circular pattern that is turned."""

    angular_offset: float
    index: int


@entity
class CircularOmit(Entity):
    """Copy of a circular pattern that is left out."""

    index: int


@entity
class CircularPattern(ReplicateFeature):
    """Feature repeated on a circle."""

    angle_increment: float
    number_of_feature: int
    relocated_base_feature: tuple[Ref[CircularOffset], ...]
    missing_base_feature: tuple[Ref[CircularOmit], ...]
    base_feature_diameter: Ref[TolerancedLengthMeasure] | None = None
    base_feature_rotation: float


@entity
class RectangularOffset(Entity):
    """Copy of a rectangular pattern that is moved."""

    offset_direction: Ref[Direction]
    offset_distance: float
    row_index: int
    column_index: int


@entity
class RectangularOmit(Entity):
    """Copy of a rectangular pattern that is left out."""

    row_index: int
    column_index: int


@entity
class RectangularPattern(ReplicateFeature):
    """Feature repeated in rows and columns; names after the draft of 2001."""

    spacing: Ref[TolerancedLengthMeasure]
    its_direction: Ref[Direction]
    number_of_rows: int | None = None
    number_of_columns: int
    row_spacing: Ref[TolerancedLengthMeasure] | None = None
    row_layout_direction: Ref[Direction] | None = None
    relocated_base_feature: tuple[Ref[RectangularOffset], ...]
    missing_base_feature: tuple[Ref[RectangularOmit], ...]
