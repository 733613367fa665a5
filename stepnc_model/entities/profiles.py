"""Profiles, paths, ends of slots and tapers (ISO 14649-10); mm and degrees."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity, abstract, entity
from stepnc_model.entities.geometry import Axis2Placement3d, BoundedCurve, Direction
from stepnc_model.entities.measures import NumericParameter, TolerancedLengthMeasure
from stepnc_model.part21.values import Ref


@abstract
class Profile(Entity):
    """Plane curve that bounds a feature or is swept."""

    placement: Ref[Axis2Placement3d] | None = None


@abstract
class OpenProfile(Profile):
    """Profile with two ends."""


@entity
class LinearProfile(OpenProfile):
    """Straight line."""

    profile_length: Ref[NumericParameter]


@entity
class SquareUProfile(OpenProfile):
    """Floor and two walls, each with an angle and a radius."""

    width: Ref[TolerancedLengthMeasure]
    first_radius: Ref[TolerancedLengthMeasure]
    first_angle: float
    second_radius: Ref[TolerancedLengthMeasure]
    second_angle: float


@entity
class RoundedUProfile(OpenProfile):
    """Two walls and a half circle."""

    width: Ref[TolerancedLengthMeasure]


@entity
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


@entity
class VeeProfile(OpenProfile):
    """Two lines that meet in a radius."""

    profile_radius: Ref[TolerancedLengthMeasure]
    profile_angle: float
    tilt_angle: float


@entity
class PartialCircularProfile(OpenProfile):
    """Arc."""

    radius: Ref[TolerancedLengthMeasure]
    sweep_angle: float


@entity
class GeneralProfile(OpenProfile):
    """Any curve with two ends."""

    its_profile: Ref[BoundedCurve]


@abstract
class ClosedProfile(Profile):
    """Profile that encloses an area."""


@entity
class RectangularClosedProfile(ClosedProfile):
    """Rectangle about the origin of its placement."""

    profile_width: Ref[TolerancedLengthMeasure]
    profile_length: Ref[TolerancedLengthMeasure]


@entity
class CircularClosedProfile(ClosedProfile):
    """Circle."""

    diameter: Ref[TolerancedLengthMeasure]


@entity
class NgonClosedProfile(ClosedProfile):
    """Regular polygon; NGON_PROFILE in the draft of 2001."""

    diameter: Ref[TolerancedLengthMeasure]
    number_of_sides: int
    circumscribed_or_across_flats: bool


@entity
class GeneralClosedProfile(ClosedProfile):
    """Any closed curve."""

    closed_profile_shape: Ref[BoundedCurve]


@abstract
class TravelPath(Entity):
    """Way along which a profile is swept."""

    placement: Ref[Axis2Placement3d] | None = None


@entity
class GeneralPath(TravelPath):
    """Along any curve."""

    swept_path: Ref[BoundedCurve]


@entity
class LinearPath(TravelPath):
    """Along a straight line."""

    distance: Ref[TolerancedLengthMeasure]
    its_direction: Ref[Direction]


@abstract
class CircularPath(TravelPath):
    """Along a circle."""

    radius: Ref[TolerancedLengthMeasure]


@entity
class CompleteCircularPath(CircularPath):
    """Once around."""


@entity
class PartialCircularPath(CircularPath):
    """Along an arc."""

    sweep_angle: float


@abstract
class SlotEndType(Entity):
    """How a slot ends."""


@entity
class OpenSlotEndType(SlotEndType):
    """The tool runs out."""


@entity
class RadiusedSlotEndType(SlotEndType):
    """Half circle as wide as the slot."""


@entity
class FlatSlotEndType(SlotEndType):
    """Wall with a radius in each corner."""

    corner_radius1: Ref[TolerancedLengthMeasure]
    corner_radius2: Ref[TolerancedLengthMeasure]


@entity
class WoodruffSlotEndType(SlotEndType):
    """Arc that a disc cutter leaves in the floor."""

    radius: Ref[TolerancedLengthMeasure]


@entity
class LoopSlotEndType(SlotEndType):
    """The end meets the start."""


@entity
class DiameterTaper(Entity):
    """Taper by the diameter at its end."""

    final_diameter: Ref[TolerancedLengthMeasure]


@entity
class AngleTaper(Entity):
    """Taper by its angle."""

    angle: float
