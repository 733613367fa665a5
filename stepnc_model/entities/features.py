"""Features of milling and drilling, and threads (ISO 14649-10); mm and degrees."""

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
    """Boss, material left standing within another feature."""

    its_boundary: Ref[ClosedProfile]
    slope: float | None = None


class PlanarFace(MachiningFeature):
    """Planar face to be milled."""

    course_of_travel: Ref[LinearPath]
    removal_boundary: Ref[LinearProfile]
    face_boundary: Ref[ClosedProfile] | None = None
    its_boss: tuple[Ref[Boss], ...]


class Pocket(MachiningFeature, abstract=True):
    """Pocket, a cavity with a floor and walls."""

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
    """Slot, a profile swept along a path."""

    course_of_travel: Ref[TravelPath]
    swept_shape: Ref[OpenProfile]
    end_conditions: tuple[Ref[SlotEndType], ...]


class Step(MachiningFeature):
    """Step, a corner removed along an edge."""

    open_boundary: Ref[LinearPath]
    wall_boundary: Ref[VeeProfile] | None = None
    its_boss: tuple[Ref[Boss], ...]


class RoundHole(MachiningFeature):
    """Round hole given by its diameter."""

    diameter: Ref[TolerancedLengthMeasure]
    change_in_diameter: Ref[DiameterTaper | AngleTaper] | None = None
    bottom_condition: Ref[HoleBottomCondition]


class ToolpathFeature(MachiningFeature):
    """Feature defined only by its tool path."""


class RoundedEnd(MachiningFeature):
    """Partial circle swept along a line."""

    course_of_travel: Ref[LinearPath]
    partial_circular_boundary: Ref[PartialCircularProfile]


class SphericalCap(MachiningFeature):
    """Spherical cap, part of a sphere."""

    internal_angle: Ref[NumericParameter]
    radius: Ref[NumericParameter]


class ProfileFeature(MachiningFeature, abstract=True):
    """Profile swept along a line."""

    profile_swept_shape: Ref[LinearPath]


class GeneralOutsideProfile(ProfileFeature):
    """Outside profile of the workpiece."""

    feature_boundary: Ref[Profile]


class ShapeProfile(ProfileFeature, abstract=True):
    """Swept profile with a floor."""

    floor_condition: Ref[ThroughProfileFloor | ProfileFloor]
    removal_direction: Ref[Direction]


class GeneralShapeProfile(ShapeProfile):
    """Shape profile with a general profile."""

    profile_boundary: Ref[Profile]


class PartialCircularShapeProfile(ShapeProfile):
    """Shape profile with an arc as its profile."""

    open_boundary: Ref[PartialCircularProfile]


class CircularClosedShapeProfile(ShapeProfile):
    """Shape profile with a circle as its profile."""

    closed_boundary: Ref[CircularClosedProfile]


class RectangularOpenShapeProfile(ShapeProfile):
    """Shape profile with a U-shaped profile."""

    open_boundary: Ref[SquareUProfile]


class RectangularClosedShapeProfile(ShapeProfile):
    """Shape profile with a rectangle as its profile."""

    closed_boundary: Ref[RectangularClosedProfile]


class TransitionFeature(ManufacturingFeature, abstract=True):
    """Transition between two other features."""

    first_feature: Ref[MachiningFeature]
    second_feature: Ref[MachiningFeature]


class Chamfer(TransitionFeature):
    """Chamfered edge."""

    angle_to_plane: float
    first_offset_amount: Ref[TolerancedLengthMeasure]


class EdgeRound(TransitionFeature):
    """Rounded edge."""

    radius: Ref[TolerancedLengthMeasure]
    first_offset_amount: Ref[TolerancedLengthMeasure] | None = None
    second_offset_amount: Ref[TolerancedLengthMeasure] | None = None


class CompoundFeature(Two5dManufacturingFeature):
    """Compound of several features."""

    elements: tuple[Ref[MachiningFeature | TransitionFeature], ...]


class CounterboreHole(CompoundFeature):
    """Hole with a cylindrical counterbore."""


class CountersunkHole(CompoundFeature):
    """Hole with a conical countersink."""


class ReplicateFeature(Two5dManufacturingFeature, abstract=True):
    """Pattern that repeats a feature."""

    replicate_base_feature: Ref[Two5dManufacturingFeature]


class GeneralPattern(ReplicateFeature):
    """Pattern with individual placements."""

    replicate_locations: tuple[Ref[Axis2Placement3d], ...]


class CircularOffset(Entity):
    """Relocated copy of a circular pattern."""

    angular_offset: float
    index: int


class CircularOmit(Entity):
    """Omitted copy of a circular pattern."""

    index: int


class CircularPattern(ReplicateFeature):
    """Pattern of copies on a circle."""

    angle_increment: float
    number_of_feature: int
    relocated_base_feature: tuple[Ref[CircularOffset], ...]
    missing_base_feature: tuple[Ref[CircularOmit], ...]
    base_feature_diameter: Ref[TolerancedLengthMeasure] | None = None
    base_feature_rotation: float


class RectangularOffset(Entity):
    """Relocated copy of a rectangular pattern."""

    offset_direction: Ref[Direction]
    offset_distance: float
    row_index: int
    column_index: int


class RectangularOmit(Entity):
    """Omitted copy of a rectangular pattern."""

    row_index: int
    column_index: int


class RectangularPattern(ReplicateFeature):
    """Pattern of copies in rows and columns, with attribute names of the draft of 2001."""

    spacing: Ref[TolerancedLengthMeasure]
    its_direction: Ref[Direction]
    number_of_rows: int | None = None
    number_of_columns: int
    row_spacing: Ref[TolerancedLengthMeasure] | None = None
    row_layout_direction: Ref[Direction] | None = None
    relocated_base_feature: tuple[Ref[RectangularOffset], ...]
    missing_base_feature: tuple[Ref[RectangularOmit], ...]


class PartialAreaDefinition(Entity):
    """Part of a feature's length to which something is limited."""

    effective_length: float
    placement: Ref[Axis2Placement3d]
    maximum_length: float | None = None


class SpecificationUsageConstraint(Entity):
    """Element of a specification document that applies."""

    element: str
    class_id: str


class Specification(Entity):
    """Specification document, given by its name."""

    constraint: tuple[Ref[SpecificationUsageConstraint], ...]
    specification_id: str
    specification_description: str | None = None
    specification_class: str | None = None


class Thread(MachiningFeature, abstract=True):
    """Thread on another feature."""

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
    """Thread defined by a standard."""

    documentation: Ref[Specification]


class DefinedThread(Thread):
    """Thread defined by its dimensions."""

    pitch_diameter: float
    minor_diameter: float | None = None
    crest: float | None = None
