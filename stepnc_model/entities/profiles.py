"""Geometry of features: regions, bottoms, profiles, paths, ends of slots (ISO 14649-10).

Lengths in mm, angles in degrees.
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
    """Shape to be made, with the operations that make it."""

    its_id: str
    its_workpiece: Ref[Workpiece]
    its_operations: tuple[Ref[MachiningOperation], ...]


class Region(ManufacturingFeature, abstract=True):
    """Part of a free-form surface."""

    feature_placement: Ref[Axis2Placement3d] | None = None


class RegionProjection(Region):
    """Region below a closed curve."""

    proj_curve: Ref[BoundedCurve]
    proj_dir: Ref[Direction]
    depth: Ref[TolerancedLengthMeasure]


class RegionSurfaceList(Region):
    """Surfaces one by one."""

    surface_list: tuple[Ref[BoundedSurface], ...]


class TopologicalRegion(Region):
    """Faces that hang together; the second supertype, ``open_shell``, is spelt out."""

    name: str
    cfs_faces: tuple[Ref[Entity], ...]


class MachinedSurface(Entity):
    """Bottom or side of a feature.

    ISO 14649-10 names ``machining_feature``, which leaves out turning features; a turned seat
    has a roughness too, so any manufacturing feature is read.
    """

    its_machining_feature: Ref[ManufacturingFeature]
    surface_element: BottomOrSide


class SurfaceTextureParameter(Entity):
    """Roughness by its parameter, the unit as the parameter's standard has it (µm)."""

    its_value: float
    parameter_name: str
    measuring_method: str
    parameter_index: str | None = None
    applied_surfaces: tuple[Ref[MachinedSurface], ...]


class HoleBottomCondition(Entity, abstract=True):
    """Bottom of a hole."""


class ThroughBottomCondition(HoleBottomCondition):
    """The hole goes through."""


class BlindBottomCondition(HoleBottomCondition, abstract=True):
    """The hole has a bottom."""


class FlatHoleBottom(BlindBottomCondition):
    """Flat bottom."""


class FlatWithRadiusHoleBottom(BlindBottomCondition):
    """Flat bottom with a rounded edge."""

    corner_radius: Ref[TolerancedLengthMeasure]


class SphericalHoleBottom(BlindBottomCondition):
    """Round bottom."""

    radius: Ref[TolerancedLengthMeasure]


class ConicalHoleBottom(BlindBottomCondition):
    """Bottom that a drill leaves."""

    tip_angle: float
    tip_radius: Ref[TolerancedLengthMeasure] | None = None


class PocketBottomCondition(Entity, abstract=True):
    """Bottom of a pocket."""


class ThroughPocketBottomCondition(PocketBottomCondition):
    """The pocket goes through."""


class PlanarPocketBottomCondition(PocketBottomCondition):
    """Flat floor."""


class RadiusedPocketBottomCondition(PocketBottomCondition):
    """Floor that is part of a sphere."""

    floor_radius_center: Ref[CartesianPoint]
    floor_radius: Ref[TolerancedLengthMeasure]


class GeneralPocketBottomCondition(PocketBottomCondition):
    """Floor of any shape."""

    shape: Ref[Region]


class ThroughProfileFloor(Entity):
    """The profile has no floor."""


class ProfileFloor(Entity, abstract=True):
    """Floor of a profile."""

    floor_radius: Ref[NumericParameter] | None = None
    start_or_end: bool


class GeneralProfileFloor(ProfileFloor):
    """Floor of any shape, by its face."""

    floor: Ref[Entity]


class PlanarProfileFloor(ProfileFloor):
    """Flat floor."""

    floor: Ref[Plane]


class Profile(Entity, abstract=True):
    """Plane curve that bounds a feature or is swept."""

    placement: Ref[Axis2Placement3d] | None = None


class OpenProfile(Profile, abstract=True):
    """Profile with two ends."""


class LinearProfile(OpenProfile):
    """Straight line."""

    profile_length: Ref[NumericParameter]


class SquareUProfile(OpenProfile):
    """Floor and two walls, each with an angle and a radius."""

    width: Ref[TolerancedLengthMeasure]
    first_radius: Ref[TolerancedLengthMeasure]
    first_angle: float
    second_radius: Ref[TolerancedLengthMeasure]
    second_angle: float


class RoundedUProfile(OpenProfile):
    """Two walls and a half circle."""

    width: Ref[TolerancedLengthMeasure]


class TeeProfile(OpenProfile):
    """Section of a T slot."""

    first_angle: float
    second_angle: float
    cross_bar_width: Ref[TolerancedLengthMeasure]
    cross_bar_depth: Ref[TolerancedLengthMeasure]
    radius: Ref[TolerancedLengthMeasure]
    width: Ref[TolerancedLengthMeasure]
    first_offset: Ref[TolerancedLengthMeasure]
    second_offset: Ref[TolerancedLengthMeasure]


class VeeProfile(OpenProfile):
    """Two lines that meet in a radius."""

    profile_radius: Ref[TolerancedLengthMeasure]
    profile_angle: float
    tilt_angle: float


class PartialCircularProfile(OpenProfile):
    """Arc."""

    radius: Ref[TolerancedLengthMeasure]
    sweep_angle: float


class GeneralProfile(OpenProfile):
    """Any curve with two ends."""

    its_profile: Ref[BoundedCurve]


class ClosedProfile(Profile, abstract=True):
    """Profile that encloses an area."""


class RectangularClosedProfile(ClosedProfile):
    """Rectangle about the origin of its placement."""

    profile_width: Ref[TolerancedLengthMeasure]
    profile_length: Ref[TolerancedLengthMeasure]


class CircularClosedProfile(ClosedProfile):
    """Circle."""

    diameter: Ref[TolerancedLengthMeasure]


class NgonClosedProfile(ClosedProfile):
    """Regular polygon; NGON_PROFILE in the draft of 2001."""

    diameter: Ref[TolerancedLengthMeasure]
    number_of_sides: int
    circumscribed_or_across_flats: bool


class GeneralClosedProfile(ClosedProfile):
    """Any closed curve."""

    closed_profile_shape: Ref[BoundedCurve]


class TravelPath(Entity, abstract=True):
    """Way along which a profile is swept."""

    placement: Ref[Axis2Placement3d] | None = None


class GeneralPath(TravelPath):
    """Along any curve."""

    swept_path: Ref[BoundedCurve]


class LinearPath(TravelPath):
    """Along a straight line."""

    distance: Ref[TolerancedLengthMeasure]
    its_direction: Ref[Direction]


class CircularPath(TravelPath, abstract=True):
    """Along a circle."""

    radius: Ref[TolerancedLengthMeasure]


class CompleteCircularPath(CircularPath):
    """Once around."""


class PartialCircularPath(CircularPath):
    """Along an arc."""

    sweep_angle: float


class SlotEndType(Entity, abstract=True):
    """End of a slot."""


class OpenSlotEndType(SlotEndType):
    """The tool runs out."""


class RadiusedSlotEndType(SlotEndType):
    """Half circle as wide as the slot."""


class FlatSlotEndType(SlotEndType):
    """Wall with a radius in each corner."""

    corner_radius1: Ref[TolerancedLengthMeasure]
    corner_radius2: Ref[TolerancedLengthMeasure]


class WoodruffSlotEndType(SlotEndType):
    """Arc that a disc cutter leaves in the floor."""

    radius: Ref[TolerancedLengthMeasure]


class LoopSlotEndType(SlotEndType):
    """The end meets the start."""


class DiameterTaper(Entity):
    """Taper by the diameter at its end."""

    final_diameter: Ref[TolerancedLengthMeasure]


class AngleTaper(Entity):
    """Taper by its angle."""

    angle: float
