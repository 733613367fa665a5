"""Features of milling and drilling, threads (ISO 14649-10); mm and degrees."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.geometry import Axis2Placement3d, Direction, ElementarySurface
from stepnc_model.entities.measures import (
    DescriptiveParameter,
    NumericParameter,
    TolerancedLengthMeasure,
)
from stepnc_model.entities.profiles import (
    AngleTaper,
    CircularClosedProfile,
    ClosedProfile,
    DiameterTaper,
    HoleBottomCondition,
    LinearPath,
    LinearProfile,
    ManufacturingFeature,
    OpenProfile,
    PartialCircularProfile,
    PocketBottomCondition,
    Profile,
    ProfileFloor,
    RectangularClosedProfile,
    SlotEndType,
    SquareUProfile,
    ThroughProfileFloor,
    TravelPath,
    VeeProfile,
)
from stepnc_model.part21.values import Ref


class Two5dManufacturingFeature(ManufacturingFeature, abstract=True):
    """Feature that lies on a plane."""

    feature_placement: Ref[Axis2Placement3d]


class MachiningFeature(Two5dManufacturingFeature, abstract=True):
    """Feature with a depth, given as a surface in the feature's coordinates."""

    depth: Ref[ElementarySurface]


class Boss(MachiningFeature):
    """Material left standing within another feature."""

    its_boundary: Ref[ClosedProfile]
    slope: float | None = None


class PlanarFace(MachiningFeature):
    """Face to be milled flat."""

    course_of_travel: Ref[LinearPath]
    removal_boundary: Ref[LinearProfile]
    face_boundary: Ref[ClosedProfile] | None = None
    its_boss: tuple[Ref[Boss], ...]


class Pocket(MachiningFeature, abstract=True):
    """Hollow with a floor and walls."""

    its_boss: tuple[Ref[Boss], ...]
    slope: float | None = None
    bottom_condition: Ref[PocketBottomCondition]
    planar_radius: Ref[TolerancedLengthMeasure] | None = None
    orthogonal_radius: Ref[TolerancedLengthMeasure] | None = None


class ClosedPocket(Pocket):
    """Pocket with walls all around."""

    feature_boundary: Ref[ClosedProfile]


class OpenPocket(Pocket):
    """Pocket that the tool may enter from the side."""

    open_boundary: Ref[OpenProfile]
    wall_boundary: Ref[OpenProfile] | None = None


class Slot(MachiningFeature):
    """Profile swept along a path."""

    course_of_travel: Ref[TravelPath]
    swept_shape: Ref[OpenProfile]
    end_conditions: tuple[Ref[SlotEndType], ...]


class Step(MachiningFeature):
    """Corner taken off along an edge."""

    open_boundary: Ref[LinearPath]
    wall_boundary: Ref[VeeProfile] | None = None
    its_boss: tuple[Ref[Boss], ...]


class RoundHole(MachiningFeature):
    """Hole by its diameter."""

    diameter: Ref[TolerancedLengthMeasure]
    change_in_diameter: Ref[DiameterTaper | AngleTaper] | None = None
    bottom_condition: Ref[HoleBottomCondition]


class ToolpathFeature(MachiningFeature):
    """Whatever the tool path leaves."""


class RoundedEnd(MachiningFeature):
    """Partial circle swept along a line."""

    course_of_travel: Ref[LinearPath]
    partial_circular_boundary: Ref[PartialCircularProfile]


class SphericalCap(MachiningFeature):
    """Part of a sphere."""

    internal_angle: Ref[NumericParameter]
    radius: Ref[NumericParameter]


class ProfileFeature(MachiningFeature, abstract=True):
    """Profile swept along a line."""

    profile_swept_shape: Ref[LinearPath]


class GeneralOutsideProfile(ProfileFeature):
    """Outside of the workpiece."""

    feature_boundary: Ref[Profile]


class ShapeProfile(ProfileFeature, abstract=True):
    """Swept profile with a floor."""

    floor_condition: Ref[ThroughProfileFloor | ProfileFloor]
    removal_direction: Ref[Direction]


class GeneralShapeProfile(ShapeProfile):
    """Shape of any profile."""

    profile_boundary: Ref[Profile]


class PartialCircularShapeProfile(ShapeProfile):
    """Shape of an arc."""

    open_boundary: Ref[PartialCircularProfile]


class CircularClosedShapeProfile(ShapeProfile):
    """Shape of a circle."""

    closed_boundary: Ref[CircularClosedProfile]


class RectangularOpenShapeProfile(ShapeProfile):
    """Shape of a U."""

    open_boundary: Ref[SquareUProfile]


class RectangularClosedShapeProfile(ShapeProfile):
    """Shape of a rectangle."""

    closed_boundary: Ref[RectangularClosedProfile]


class TransitionFeature(ManufacturingFeature, abstract=True):
    """Feature that joins two others."""

    first_feature: Ref[MachiningFeature]
    second_feature: Ref[MachiningFeature]


class Chamfer(TransitionFeature):
    """Broken edge."""

    angle_to_plane: float
    first_offset_amount: Ref[TolerancedLengthMeasure]


class EdgeRound(TransitionFeature):
    """Rounded edge."""

    radius: Ref[TolerancedLengthMeasure]
    first_offset_amount: Ref[TolerancedLengthMeasure] | None = None
    second_offset_amount: Ref[TolerancedLengthMeasure] | None = None


class CompoundFeature(Two5dManufacturingFeature):
    """Several features as one."""

    elements: tuple[Ref[MachiningFeature | TransitionFeature], ...]


class CounterboreHole(CompoundFeature):
    """Hole with a cylindrical sink."""


class CountersunkHole(CompoundFeature):
    """Hole with a conical sink."""


class ReplicateFeature(Two5dManufacturingFeature, abstract=True):
    """Feature repeated."""

    replicate_base_feature: Ref[Two5dManufacturingFeature]


class GeneralPattern(ReplicateFeature):
    """Feature repeated at placements of its own."""

    replicate_locations: tuple[Ref[Axis2Placement3d], ...]


class CircularOffset(Entity):
    """Copy of a circular pattern that is turned."""

    angular_offset: float
    index: int


class CircularOmit(Entity):
    """Copy of a circular pattern that is left out."""

    index: int


class CircularPattern(ReplicateFeature):
    """Feature repeated on a circle."""

    angle_increment: float
    number_of_feature: int
    relocated_base_feature: tuple[Ref[CircularOffset], ...]
    missing_base_feature: tuple[Ref[CircularOmit], ...]
    base_feature_diameter: Ref[TolerancedLengthMeasure] | None = None
    base_feature_rotation: float


class RectangularOffset(Entity):
    """Copy of a rectangular pattern that is moved."""

    offset_direction: Ref[Direction]
    offset_distance: float
    row_index: int
    column_index: int


class RectangularOmit(Entity):
    """Copy of a rectangular pattern that is left out."""

    row_index: int
    column_index: int


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


class PartialAreaDefinition(Entity):
    """Part of a feature's length."""

    effective_length: float
    placement: Ref[Axis2Placement3d]
    maximum_length: float | None = None


class SpecificationUsageConstraint(Entity):
    """Element of a document that applies."""

    element: str
    class_id: str


class Specification(Entity):
    """Document by its name."""

    constraint: tuple[Ref[SpecificationUsageConstraint], ...]
    specification_id: str
    specification_description: str | None = None
    specification_class: str | None = None


class Thread(MachiningFeature, abstract=True):
    """Thread on a shape."""

    partial_profile: Ref[PartialAreaDefinition]
    applied_shape: tuple[Ref[MachiningFeature], ...]
    inner_or_outer_thread: bool
    qualifier: Ref[DescriptiveParameter] | None = None
    fit_class: Ref[DescriptiveParameter]
    form: Ref[DescriptiveParameter]
    major_diameter: float
    number_of_threads: Ref[NumericParameter]
    thread_hand: Ref[DescriptiveParameter]


class CatalogueThread(Thread):
    """Thread by a standard."""

    documentation: Ref[Specification]


class DefinedThread(Thread):
    """Thread by its sizes."""

    pitch_diameter: float
    minor_diameter: float | None = None
    crest: float | None = None
