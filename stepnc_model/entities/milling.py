"""Operations, strategies and approaches of milling and hole making (ISO 14649-11).

Lengths in mm, angles in degrees, times in s. Overlaps and reductions are ratios from 0 to 1;
files of the draft of 2001 write percent.
"""

from __future__ import annotations

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import (
    CutmodeType,
    LeftOrRight,
    PathmodeType,
    RotDirection,
    StrokeConnectionStrategy,
)
from stepnc_model.entities.geometry import BoundedCurve, CartesianPoint, Direction
from stepnc_model.entities.operations import MachiningOperation, ToolpathList
from stepnc_model.part21.values import Ref


class Two5dMillingStrategy(Entity, abstract=True):
    """Strategy for covering an area at constant depth."""

    overlap: float | None = None
    """of neighbouring strokes, as a ratio of the tool diameter"""
    allow_multiple_passes: bool | None = None


class UnidirectionalMilling(Two5dMillingStrategy):
    """Milling in strokes in one direction; UNIDIRECTIONAL in the draft of 2001."""

    feed_direction: Ref[Direction] | None = None
    cutmode: CutmodeType | None = None


class BidirectionalMilling(Two5dMillingStrategy):
    """Milling in strokes to and fro; BIDIRECTIONAL in the draft of 2001."""

    feed_direction: Ref[Direction] | None = None
    stepover_direction: LeftOrRight | None = None
    its_stroke_connection_strategy: StrokeConnectionStrategy | None = None


class ContourParallel(Two5dMillingStrategy):
    """Milling in offsets of the contour."""

    rotation_direction: RotDirection
    cutmode: CutmodeType | None = None


class BidirectionalContour(Two5dMillingStrategy):
    """Milling in strokes to and fro, then along the contour."""

    feed_direction: Ref[Direction] | None = None
    stepover_direction: LeftOrRight | None = None
    rotation_direction: RotDirection | None = None
    spiral_cutmode: CutmodeType | None = None


class ContourBidirectional(Two5dMillingStrategy):
    """Milling along the contour, then in strokes to and fro."""

    feed_direction: Ref[Direction] | None = None
    stepover_direction: LeftOrRight | None = None
    rotation_direction: RotDirection | None = None
    spiral_cutmode: CutmodeType | None = None


class ContourSpiral(Two5dMillingStrategy):
    """Milling in a spiral that follows the contour."""

    rotation_direction: RotDirection
    cutmode: CutmodeType | None = None


class CenterMilling(Two5dMillingStrategy):
    """Milling with one stroke along the middle of a slot."""


class ExplicitStrategy(Two5dMillingStrategy):
    """Milling along an explicit tool path; EXPLICIT in the draft of 2001."""


class Tolerances(Entity):
    """Permitted deviations on a free-form surface, mm."""

    chordal_tolerance: float
    scallop_height: float


class FreeformStrategy(Entity, abstract=True):
    """Strategy for covering a free-form surface."""

    pathmode: PathmodeType
    cutmode: CutmodeType
    its_milling_tolerances: Ref[Tolerances]
    stepover: float | None = None


class UvStrategy(FreeformStrategy):
    """Free-form milling along the parameter lines of the surface."""

    forward_direction: Ref[Direction]
    sideward_direction: Ref[Direction]


class PlaneCcStrategy(FreeformStrategy):
    """Free-form milling with contact points in parallel planes."""

    its_plane_normal: Ref[Direction]


class PlaneClStrategy(FreeformStrategy):
    """Free-form milling with tool centre points in parallel planes."""

    its_plane_normal: Ref[Direction]


class LeadingLineStrategy(FreeformStrategy):
    """Free-form milling in strokes parallel to a curve."""

    its_line: Ref[BoundedCurve]


class DrillingTypeStrategy(Entity):
    """Reduced speed and feed where a drill enters and leaves; depths in mm."""

    reduced_cut_at_start: float | None = None
    reduced_feed_at_start: float | None = None
    depth_of_start: float | None = None
    reduced_cut_at_end: float | None = None
    reduced_feed_at_end: float | None = None
    depth_of_end: float | None = None


class ApproachRetractStrategy(Entity, abstract=True):
    """Move by which the tool approaches or leaves the cut."""

    tool_orientation: Ref[Direction] | None = None


class PlungeStrategy(ApproachRetractStrategy, abstract=True):
    """Plunge move into material."""


class PlungeToolaxis(PlungeStrategy):
    """Plunge straight down the tool axis."""


class PlungeRamp(PlungeStrategy):
    """Plunge down a straight ramp."""

    angle: float


class PlungeHelix(PlungeStrategy):
    """Plunge down a helix."""

    radius: float
    angle: float


class PlungeZigzag(PlungeStrategy):
    """Plunge down a ramp to and fro."""

    angle: float
    width: float


class AirStrategy(ApproachRetractStrategy, abstract=True):
    """Approach or retract through air."""


class ApRetractAngle(AirStrategy):
    """Straight approach or retract at an angle to the path."""

    angle: float
    travel_length: float


class ApRetractTangent(AirStrategy):
    """Approach or retract along an arc tangential to the path."""

    radius: float


class AlongPath(ApproachRetractStrategy):
    """Approach or retract along an explicit tool path."""

    path: Ref[ToolpathList]


class MillingMachiningOperation(MachiningOperation, abstract=True):
    """Operation with a rotating tool."""

    overcut_length: float | None = None


class MillingTypeOperation(MillingMachiningOperation, abstract=True):
    """Milling operation."""

    approach: Ref[ApproachRetractStrategy] | None = None
    retract: Ref[ApproachRetractStrategy] | None = None


class FreeformOperation(MillingTypeOperation):
    """Milling of a free-form surface."""

    its_machining_strategy: Ref[FreeformStrategy] | None = None


class Two5dMillingOperation(MillingTypeOperation, abstract=True):
    """Milling at constant depth, layer by layer."""

    its_machining_strategy: Ref[Two5dMillingStrategy] | None = None


class PlaneMilling(Two5dMillingOperation, abstract=True):
    """Milling of a planar face."""

    axial_cutting_depth: float | None = None
    allowance_bottom: float | None = None


class PlaneRoughMilling(PlaneMilling):
    """Roughing of a planar face."""


class PlaneFinishMilling(PlaneMilling):
    """Finishing of a planar face."""


class SideMilling(Two5dMillingOperation, abstract=True):
    """Milling of side walls."""

    axial_cutting_depth: float | None = None
    radial_cutting_depth: float | None = None
    allowance_side: float | None = None


class SideRoughMilling(SideMilling):
    """Roughing of side walls."""


class SideFinishMilling(SideMilling):
    """Finishing of side walls."""


class BottomAndSideMilling(Two5dMillingOperation, abstract=True):
    """Milling of floor and walls."""

    axial_cutting_depth: float | None = None
    radial_cutting_depth: float | None = None
    allowance_side: float | None = None
    allowance_bottom: float | None = None


class BottomAndSideRoughMilling(BottomAndSideMilling):
    """Roughing of floor and walls."""


class BottomAndSideFinishMilling(BottomAndSideMilling):
    """Finishing of floor and walls."""


class DrillingTypeOperation(MillingMachiningOperation, abstract=True):
    """Operation along the axis of a hole."""

    cutting_depth: float | None = None
    previous_diameter: float | None = None
    dwell_time_bottom: float | None = None
    feed_on_retract: float | None = None
    """ratio of the feedrate"""
    its_machining_strategy: Ref[DrillingTypeStrategy] | None = None


class DrillingOperation(DrillingTypeOperation, abstract=True):
    """Operation with a drill."""


class Drilling(DrillingOperation):
    """Drilling of a hole in one pass."""


class CenterDrilling(DrillingOperation):
    """Drilling of a centre hole."""


class CounterSinking(DrillingOperation):
    """Countersinking of a hole."""


class MultistepDrilling(DrillingOperation):
    """Drilling with retracts that break or remove chips."""

    retract_distance: float
    first_depth: float
    depth_of_step: float
    dwell_time_step: float | None = None


class BoringOperation(DrillingTypeOperation, abstract=True):
    """Widening of a hole."""

    spindle_stop_at_bottom: bool
    depth_of_testcut: float | None = None
    waiting_position: Ref[CartesianPoint] | None = None


class Boring(BoringOperation):
    """Boring of a hole with a boring tool."""


class Reaming(BoringOperation):
    """Finishing of a hole with a reamer."""


class BackBoring(DrillingTypeOperation):
    """Boring of a hole from behind."""


class Tapping(DrillingTypeOperation):
    """Tapping of a thread; ``compensation_chuck`` is from the draft of 2001."""

    compensation_chuck: bool


class ThreadDrilling(DrillingTypeOperation):
    """Thread drilling; ``helical_movement_on_forward`` is from the draft of 2001."""

    helical_movement_on_forward: bool
