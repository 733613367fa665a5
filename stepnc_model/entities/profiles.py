"""Geometry of features: regions, bottoms, profiles, paths, slot ends (ISO 14649-10).

Lengths are in mm, angles in degrees.
"""

from __future__ import annotations

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import BottomOrSide
from stepnc_model.entities.geometry import (
    Axis2Placement3d,
    BoundedCurve,
    BoundedSurface,
    CartesianPoint,
    Direction,
    Plane,
)
from stepnc_model.entities.measures import NumericParameter, TolerancedLengthMeasure
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.entities.workpiece import Workpiece
from stepnc_model.part21.values import Ref


class ManufacturingFeature(Entity, abstract=True):
    """Manufacturing feature: a shape to be made, with its operations."""

    its_id: str
    its_workpiece: Ref[Workpiece]
    its_operations: tuple[Ref[MachiningOperation], ...]


class Region(ManufacturingFeature, abstract=True):
    """Region, part of a free-form surface."""

    feature_placement: Ref[Axis2Placement3d] | None = None


class RegionProjection(Region):
    """Region defined by projecting a closed curve."""

    proj_curve: Ref[BoundedCurve]
    proj_dir: Ref[Direction]
    depth: Ref[TolerancedLengthMeasure]


class RegionSurfaceList(Region):
    """Region given by a list of surfaces."""

    surface_list: tuple[Ref[BoundedSurface], ...]


class TopologicalRegion(Region):
    """Region of connected faces; includes the second supertype, ``open_shell``."""

    name: str
    cfs_faces: tuple[Ref[Entity], ...]


class MachinedSurface(Entity):
    """Machined surface, the bottom or side of a feature.

    ISO 14649-10 refers to ``machining_feature``, which excludes turning features; turned
    surfaces have a roughness too, so any manufacturing feature is accepted.
    """

    its_machining_feature: Ref[ManufacturingFeature]
    surface_element: BottomOrSide


class SurfaceTextureParameter(Entity):
    """Surface roughness, given by a parameter in the unit of its standard (µm)."""

    its_value: float
    parameter_name: str
    measuring_method: str
    parameter_index: str | None = None
    applied_surfaces: tuple[Ref[MachinedSurface], ...]


class HoleBottomCondition(Entity, abstract=True):
    """Bottom of a hole."""


class ThroughBottomCondition(HoleBottomCondition):
    """Bottom condition of a through hole."""


class BlindBottomCondition(HoleBottomCondition, abstract=True):
    """Bottom condition of a blind hole."""


class FlatHoleBottom(BlindBottomCondition):
    """Flat bottom of a hole."""


class FlatWithRadiusHoleBottom(BlindBottomCondition):
    """Flat bottom of a hole with a rounded edge."""

    corner_radius: Ref[TolerancedLengthMeasure]


class SphericalHoleBottom(BlindBottomCondition):
    """Spherical bottom of a hole."""

    radius: Ref[TolerancedLengthMeasure]


class ConicalHoleBottom(BlindBottomCondition):
    """Conical bottom of a hole, as left by a drill."""

    tip_angle: float
    tip_radius: Ref[TolerancedLengthMeasure] | None = None


class PocketBottomCondition(Entity, abstract=True):
    """Bottom of a pocket."""


class ThroughPocketBottomCondition(PocketBottomCondition):
    """Bottom condition of a through pocket."""


class PlanarPocketBottomCondition(PocketBottomCondition):
    """Flat floor of a pocket."""


class RadiusedPocketBottomCondition(PocketBottomCondition):
    """Spherical floor of a pocket."""

    floor_radius_center: Ref[CartesianPoint]
    floor_radius: Ref[TolerancedLengthMeasure]


class GeneralPocketBottomCondition(PocketBottomCondition):
    """Floor of a pocket with general shape."""

    shape: Ref[Region]


class ThroughProfileFloor(Entity):
    """Floor condition of a profile without a floor."""


class ProfileFloor(Entity, abstract=True):
    """Floor of a profile."""

    floor_radius: Ref[NumericParameter] | None = None
    start_or_end: bool


class GeneralProfileFloor(ProfileFloor):
    """Floor of a profile with general shape, given by its face."""

    floor: Ref[Entity]


class PlanarProfileFloor(ProfileFloor):
    """Flat floor of a profile."""

    floor: Ref[Plane]


class Profile(Entity, abstract=True):
    """Profile, a plane curve that bounds a feature or is swept."""

    placement: Ref[Axis2Placement3d] | None = None


class OpenProfile(Profile, abstract=True):
    """Profile with two ends."""


class LinearProfile(OpenProfile):
    """Straight line profile."""

    profile_length: Ref[NumericParameter]


class SquareUProfile(OpenProfile):
    """U profile with a floor and two walls, each with an angle and a radius."""

    width: Ref[TolerancedLengthMeasure]
    first_radius: Ref[TolerancedLengthMeasure]
    first_angle: float
    second_radius: Ref[TolerancedLengthMeasure]
    second_angle: float


class RoundedUProfile(OpenProfile):
    """U profile with two walls and a semicircular floor."""

    width: Ref[TolerancedLengthMeasure]


class TeeProfile(OpenProfile):
    """Profile of a T slot."""

    first_angle: float
    second_angle: float
    cross_bar_width: Ref[TolerancedLengthMeasure]
    cross_bar_depth: Ref[TolerancedLengthMeasure]
    radius: Ref[TolerancedLengthMeasure]
    width: Ref[TolerancedLengthMeasure]
    first_offset: Ref[TolerancedLengthMeasure]
    second_offset: Ref[TolerancedLengthMeasure]


class VeeProfile(OpenProfile):
    """V profile of two lines that meet in a radius."""

    profile_radius: Ref[TolerancedLengthMeasure]
    profile_angle: float
    tilt_angle: float


class PartialCircularProfile(OpenProfile):
    """Profile in the form of an arc."""

    radius: Ref[TolerancedLengthMeasure]
    sweep_angle: float


class GeneralProfile(OpenProfile):
    """General open profile."""

    its_profile: Ref[BoundedCurve]


class ClosedProfile(Profile, abstract=True):
    """Profile that encloses an area."""


class RectangularClosedProfile(ClosedProfile):
    """Rectangular profile about the origin of its placement."""

    profile_width: Ref[TolerancedLengthMeasure]
    profile_length: Ref[TolerancedLengthMeasure]


class CircularClosedProfile(ClosedProfile):
    """Circular profile."""

    diameter: Ref[TolerancedLengthMeasure]


class NgonClosedProfile(ClosedProfile):
    """Profile in the form of a regular polygon; NGON_PROFILE in the draft of 2001."""

    diameter: Ref[TolerancedLengthMeasure]
    number_of_sides: int
    circumscribed_or_across_flats: bool


class GeneralClosedProfile(ClosedProfile):
    """General closed profile."""

    closed_profile_shape: Ref[BoundedCurve]


class TravelPath(Entity, abstract=True):
    """Course of travel along which a profile is swept."""

    placement: Ref[Axis2Placement3d] | None = None


class GeneralPath(TravelPath):
    """Course of travel along a general curve."""

    swept_path: Ref[BoundedCurve]


class LinearPath(TravelPath):
    """Course of travel along a straight line."""

    distance: Ref[TolerancedLengthMeasure]
    its_direction: Ref[Direction]


class CircularPath(TravelPath, abstract=True):
    """Course of travel along a circle."""

    radius: Ref[TolerancedLengthMeasure]


class CompleteCircularPath(CircularPath):
    """Course of travel along a full circle."""


class PartialCircularPath(CircularPath):
    """Course of travel along an arc."""

    sweep_angle: float


class SlotEndType(Entity, abstract=True):
    """Type of the end of a slot."""


class OpenSlotEndType(SlotEndType):
    """Open slot end, from which the tool runs out."""


class RadiusedSlotEndType(SlotEndType):
    """Semicircular slot end, as wide as the slot."""


class FlatSlotEndType(SlotEndType):
    """Flat slot end, a wall with a radius in each corner."""

    corner_radius1: Ref[TolerancedLengthMeasure]
    corner_radius2: Ref[TolerancedLengthMeasure]


class WoodruffSlotEndType(SlotEndType):
    """Slot end with the arc that a disc cutter leaves in the floor."""

    radius: Ref[TolerancedLengthMeasure]


class LoopSlotEndType(SlotEndType):
    """Slot end that meets the start of the slot."""


class DiameterTaper(Entity):
    """Taper given by the diameter at its end."""

    final_diameter: Ref[TolerancedLengthMeasure]


class AngleTaper(Entity):
    """Taper given by its angle."""

    angle: float
