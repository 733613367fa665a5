"""Features, operations and strategies of turning (ISO 14649-12).

Numbers are kept in the units of ISO 14649-10 §4.2.1: m/s, rev/s, mm per revolution, Pa, mm and
degrees. A feed is a typed value, ``FEED_VELOCITY_TYPE`` in m/s or ``FEED_PER_REV_TYPE`` in mm.

The order of the attributes follows the flattened XSD of ISO 14649-12, without its private
``ref_dt_cutting_tool``; it was not checked against the text of the standard.
"""

from __future__ import annotations

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import (
    CoolantSelect,
    ThreadCutDepthType,
    ThreadingDirectionType,
)
from stepnc_model.entities.features import PartialAreaDefinition, Two5dManufacturingFeature
from stepnc_model.entities.geometry import Direction
from stepnc_model.entities.measures import PropertyParameter, TolerancedLengthMeasure
from stepnc_model.entities.milling import ApproachRetractStrategy
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.entities.profiles import (
    AngleTaper,
    DiameterTaper,
    GeneralProfile,
    LinearProfile,
    OpenProfile,
    PartialCircularProfile,
    VeeProfile,
)
from stepnc_model.entities.technology import (
    AdaptiveControl,
    MachineFunctions,
    ProcessModelList,
    Technology,
)
from stepnc_model.part21.values import Ref, Typed


class TurningMachiningStrategy(Entity, abstract=True):
    """Base of all turning strategies."""

    overcut_length: float | None = None
    allow_multiple_passes: bool | None = None
    cutting_depth: tuple[float, ...]
    """one depth for all passes, or one for each"""
    variable_feedrate: float | None = None
    """ratio of the feedrate"""


class UnidirectionalTurning(TurningMachiningStrategy):
    """Turning in passes in one direction."""

    feed_direction: Ref[Direction] | None = None
    back_path_direction: Ref[Direction] | None = None
    lift_direction: Ref[Direction] | None = None
    stepover_direction: Ref[Direction] | None = None
    lift_height: float | None = None
    lift_feed: Typed | float | None = None
    stepover_feed: Typed | float | None = None


class BidirectionalTurning(TurningMachiningStrategy):
    """Turning in passes to and fro."""

    feed_direction: Ref[Direction] | None = None
    stepover_direction: Ref[Direction] | None = None
    stepover_feed: Typed | float | None = None


class ContourTurning(TurningMachiningStrategy):
    """Turning in passes along the contour."""

    feed_direction: Ref[Direction] | None = None
    back_path_direction: Ref[Direction] | None = None
    lift_direction: Ref[Direction] | None = None
    stepover_direction: Ref[Direction] | None = None
    lift_height: float | None = None
    lift_feed: Typed | float | None = None
    stepover_feed: Typed | float | None = None
    variable_stepover_feed: float | None = None


class ThreadStrategy(TurningMachiningStrategy):
    """Strategy of thread passes."""

    cut_in_amount_function: ThreadCutDepthType
    threading_direction: ThreadingDirectionType
    path_return_angle: float | None = None
    lift_height: float | None = None


class GroovingStrategy(TurningMachiningStrategy):
    """Grooving in plunges side by side."""

    grooving_direction: Ref[Direction] | None = None
    travel_distance: float | None = None


class MultistepGroovingStrategy(GroovingStrategy):
    """Grooving in plunges with retracts that break chips."""

    retract_distance: float


class ExplicitTurningStrategy(TurningMachiningStrategy):
    """Turning along an explicit tool path."""


class ConstSpindleSpeed(Entity):
    """Constant spindle speed."""

    rot_speed: float
    """rev/s; negative is clockwise"""


class ConstCuttingSpeed(Entity):
    """Constant cutting speed: the spindle speed follows the diameter."""

    speed: float
    """m/s"""
    max_speed: float | None = None
    """rev/s"""


class TurningTechnology(Technology):
    """Cutting conditions of a lathe."""

    spindle_speed: Ref[ConstSpindleSpeed | ConstCuttingSpeed]
    feed_per_revolution: float | None = None
    """mm"""
    sync_spindle_and_z_feed: bool
    inhibit_feedrate_override: bool
    inhibit_spindle_override: bool
    its_adaptive_control: Ref[AdaptiveControl] | None = None


class TurningMachineFunctions(MachineFunctions):
    """Coolant, clamping, chips and rests of a lathe; pressure in Pa."""

    coolant: bool
    coolant_type: CoolantSelect | None = None
    coolant_pressure: float | None = None
    axis_clamping: tuple[str, ...]
    chip_removal: bool | None = None
    oriented_spindle_stop: Ref[Direction] | None = None
    its_process_model: Ref[ProcessModelList] | None = None
    other_functions: tuple[Ref[PropertyParameter], ...]
    tail_stock: bool | None = None
    steady_rest: bool | None = None
    follow_rest: bool | None = None


class TurningMachiningOperation(MachiningOperation, abstract=True):
    """Operation on a lathe."""

    approach: Ref[ApproachRetractStrategy] | None = None
    retract: Ref[ApproachRetractStrategy] | None = None
    its_machining_strategy: Ref[TurningMachiningStrategy] | None = None


class Facing(TurningMachiningOperation, abstract=True):
    """Facing operation."""

    allowance: float | None = None


class FacingRough(Facing):
    """Roughing of a face."""


class FacingFinish(Facing):
    """Finishing of a face."""


class Grooving(TurningMachiningOperation, abstract=True):
    """Grooving operation."""

    dwell: Typed | float | None = None
    """DWELL_TIME in s or DWELL_REVOLUTION in revolutions, as the typed value says"""
    allowance: float | None = None


class GroovingRough(Grooving):
    """Roughing of a groove."""


class GroovingFinish(Grooving):
    """Finishing of a groove."""


class CuttingIn(Grooving):
    """Cutting in or parting off."""


class Contouring(TurningMachiningOperation, abstract=True):
    """Contour turning operation."""

    allowance: float | None = None


class ContouringRough(Contouring):
    """Roughing of a contour."""


class ContouringFinish(Contouring):
    """Finishing of a contour."""


class Threading(TurningMachiningOperation, abstract=True):
    """Thread turning operation."""

    allowance: float | None = None


class ThreadingRough(Threading):
    """Roughing of a thread."""


class ThreadingFinish(Threading):
    """Finishing of a thread."""


class Knurling(TurningMachiningOperation):
    """Knurling operation."""


class TurningFeature(Two5dManufacturingFeature, abstract=True):
    """Feature about the axis of a lathe."""


class OuterRound(TurningFeature, abstract=True):
    """Feature of the outside diameter."""

    diameter_at_placement: Ref[TolerancedLengthMeasure]


class OuterDiameter(OuterRound):
    """Outside cylinder or cone."""

    feature_length: Ref[TolerancedLengthMeasure]
    reduced_size: Ref[DiameterTaper | AngleTaper] | None = None


class OuterDiameterToShoulder(OuterRound):
    """Outside cylinder that ends at a shoulder."""

    v_shape_boundary: Ref[VeeProfile]


class RevolvedFeature(TurningFeature, abstract=True):
    """Feature with a profile revolved about the axis at a radius, mm."""

    material_side: Ref[Direction] | None = None
    radius: float


class RevolvedFlat(RevolvedFeature):
    """Revolved face or cone."""

    flat_edge_shape: Ref[LinearProfile]


class RevolvedRound(RevolvedFeature):
    """Revolved rounded edge."""

    rounded_edge_shape: Ref[PartialCircularProfile]


class Groove(RevolvedFeature):
    """Groove in a diameter or a face."""

    sweep: Ref[OpenProfile]


class GeneralRevolution(RevolvedFeature):
    """Revolved contour of general shape."""

    outer_edge_profile: Ref[GeneralProfile]


class Knurl(TurningFeature, abstract=True):
    """Knurled surface."""

    base_feature: Ref[TurningFeature]
    partial_profile: Ref[PartialAreaDefinition] | None = None
    tooth_depth: Ref[TolerancedLengthMeasure] | None = None
    diametral_pitch: Ref[TolerancedLengthMeasure] | None = None
    root_fillet: Ref[TolerancedLengthMeasure] | None = None
    number_of_teeth: int | None = None
    major_diameter: Ref[TolerancedLengthMeasure] | None = None
    nominal_diameter: Ref[TolerancedLengthMeasure] | None = None


class StraightKnurl(Knurl):
    """Knurl with teeth along the axis."""


class DiagonalKnurl(Knurl):
    """Knurl with teeth along one helix."""

    helix_angle: float


class DiamondKnurl(Knurl):
    """Knurl with teeth along two crossing helices."""

    helix1_angle: float
    helix2_angle: float | None = None


class ToolKnurl(Knurl):
    """Knurl in the form that its tool leaves."""
