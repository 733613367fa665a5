"""Features of turning (ISO 14649-12); mm and degrees."""

from __future__ import annotations

from stepnc_model.entities.entity import abstract, entity
from stepnc_model.entities.features import Two5dManufacturingFeature
from stepnc_model.entities.geometry import Direction
from stepnc_model.entities.measures import TolerancedLengthMeasure
from stepnc_model.entities.profiles import (
    AngleTaper,
    DiameterTaper,
    GeneralProfile,
    LinearProfile,
    OpenProfile,
    PartialCircularProfile,
    VeeProfile,
)
from stepnc_model.entities.threads import PartialAreaDefinition
from stepnc_model.part21.values import Ref


@abstract
class TurningFeature(Two5dManufacturingFeature):
    """Feature about the axis of a lathe."""


@abstract
class OuterRound(TurningFeature):
    """Outside diameter."""

    diameter_at_placement: Ref[TolerancedLengthMeasure]


@entity
class OuterDiameter(OuterRound):
    """Cylinder or cone."""

    feature_length: Ref[TolerancedLengthMeasure]
    reduced_size: Ref[DiameterTaper | AngleTaper] | None = None


@entity
class OuterDiameterToShoulder(OuterRound):
    """Cylinder that ends at a shoulder."""

    v_shape_boundary: Ref[VeeProfile]


@abstract
class RevolvedFeature(TurningFeature):
    """Profile turned about the axis at a radius, mm."""

    material_side: Ref[Direction] | None = None
    radius: float


@entity
class RevolvedFlat(RevolvedFeature):
    """Face or cone."""

    flat_edge_shape: Ref[LinearProfile]


@entity
class RevolvedRound(RevolvedFeature):
    """Rounded edge."""

    rounded_edge_shape: Ref[PartialCircularProfile]


@entity
class Groove(RevolvedFeature):
    """Groove in a diameter or a face."""

    sweep: Ref[OpenProfile]


@entity
class GeneralRevolution(RevolvedFeature):
    """Contour of any shape."""

    outer_edge_profile: Ref[GeneralProfile]


@abstract
class Knurl(TurningFeature):
    """Knurled surface."""

    base_feature: Ref[TurningFeature]
    partial_profile: Ref[PartialAreaDefinition] | None = None
    tooth_depth: Ref[TolerancedLengthMeasure] | None = None
    diametral_pitch: Ref[TolerancedLengthMeasure] | None = None
    root_fillet: Ref[TolerancedLengthMeasure] | None = None
    number_of_teeth: int | None = None
    major_diameter: Ref[TolerancedLengthMeasure] | None = None
    nominal_diameter: Ref[TolerancedLengthMeasure] | None = None


@entity
class StraightKnurl(Knurl):
    """Teeth along the axis."""


@entity
class DiagonalKnurl(Knurl):
    """Teeth along one helix."""

    helix_angle: float


@entity
class DiamondKnurl(Knurl):
    """Teeth along two helices."""

    helix1_angle: float
    helix2_angle: float | None = None


@entity
class ToolKnurl(Knurl):
    """As the knurling tool leaves it."""
