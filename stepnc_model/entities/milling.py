"""Operations, strategies and approaches of milling and of making holes (ISO 14649-11).

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
    """Strategy of covering an area at constant depth."""

    overlap: float | None = None
    """of neighbouring strokes, as a ratio of the tool diameter"""
    allow_multiple_passes: bool | None = None


class UnidirectionalMilling(Two5dMillingStrategy):
    """Strokes in one direction; UNIDIRECTIONAL in the draft of 2001."""

    feed_direction: Ref[Direction] | None = None
    cutmode: CutmodeType | None = None


class BidirectionalMilling(Two5dMillingStrategy):
    """Strokes to and fro; BIDIRECTIONAL in the draft of 2001."""

    feed_direction: Ref[Direction] | None = None
    stepover_direction: LeftOrRight | None = None
    its_stroke_connection_strategy: StrokeConnectionStrategy | None = None


class ContourParallel(Two5dMillingStrategy):
    """Offsets of the contour."""

    rotation_direction: RotDirection
    cutmode: CutmodeType | None = None


class BidirectionalContour(Two5dMillingStrategy):
    """Strokes to and fro, then along the contour."""

    feed_direction: Ref[Direction] | None = None
    stepover_direction: LeftOrRight | None = None
    rotation_direction: RotDirection | None = None
    spiral_cutmode: CutmodeType | None = None


class ContourBidirectional(Two5dMillingStrategy):
    """Along the contour, then strokes to and fro."""

    feed_direction: Ref[Direction] | None = None
    stepover_direction: LeftOrRight | None = None
    rotation_direction: RotDirection | None = None
    spiral_cutmode: CutmodeType | None = None


class ContourSpiral(Two5dMillingStrategy):
    """Spiral that follows the contour."""

    rotation_direction: RotDirection
    cutmode: CutmodeType | None = None


class CenterMilling(Two5dMillingStrategy):
    """One stroke in the middle of the slot."""


class ExplicitStrategy(Two5dMillingStrategy):
    """As the tool path says; EXPLICIT in the draft of 2001."""


class Tolerances(Entity):
    """Deviations allowed on a free-form surface, mm."""

    chordal_tolerance: float
    scallop_height: float


class FreeformStrategy(Entity, abstract=True):
    """Strategy of covering a free-form surface."""

    pathmode: PathmodeType
    cutmode: CutmodeType
    its_milling_tolerances: Ref[Tolerances]
    stepover: float | None = None


class UvStrategy(FreeformStrategy):
    """Along the parameters of the surface."""

    forward_direction: Ref[Direction]
    sideward_direction: Ref[Direction]


class PlaneCcStrategy(FreeformStrategy):
    """Contact points in parallel planes."""

    its_plane_normal: Ref[Direction]


class PlaneClStrategy(FreeformStrategy):
    """Tool centre points in parallel planes."""

    its_plane_normal: Ref[Direction]


class LeadingLineStrategy(FreeformStrategy):
    """Strokes parallel to a curve."""

    its_line: Ref[BoundedCurve]


class DrillingTypeStrategy(Entity):
    """Reduced cut and feed where a drill enters and leaves; depths in mm."""

    reduced_cut_at_start: float | None = None
    reduced_feed_at_start: float | None = None
    depth_of_start: float | None = None
    reduced_cut_at_end: float | None = None
    reduced_feed_at_end: float | None = None
    depth_of_end: float | None = None


class ApproachRetractStrategy(Entity, abstract=True):
    """Way in which the tool comes to the cut or leaves it."""

    tool_orientation: Ref[Direction] | None = None


class PlungeStrategy(ApproachRetractStrategy, abstract=True):
    """Way into material."""


class PlungeToolaxis(PlungeStrategy):
    """Straight down the tool axis."""


class PlungeRamp(PlungeStrategy):
    """Down a straight ramp."""

    angle: float


class PlungeHelix(PlungeStrategy):
    """Down a helix."""

    radius: float
    angle: float


class PlungeZigzag(PlungeStrategy):
    """Down a ramp to and fro."""

    angle: float
    width: float


class AirStrategy(ApproachRetractStrategy, abstract=True):
    """Way through air."""


class ApRetractAngle(AirStrategy):
    """Straight, at an angle to the path."""

    angle: float
    travel_length: float


class ApRetractTangent(AirStrategy):
    """Along an arc that meets the path tangentially."""

    radius: float


class AlongPath(ApproachRetractStrategy):
    """Along tool paths of its own."""

    path: Ref[ToolpathList]


class MillingMachiningOperation(MachiningOperation, abstract=True):
    """Operation of a rotating tool."""

    overcut_length: float | None = None


class MillingTypeOperation(MillingMachiningOperation, abstract=True):
    """Operation that mills."""

    approach: Ref[ApproachRetractStrategy] | None = None
    retract: Ref[ApproachRetractStrategy] | None = None


class FreeformOperation(MillingTypeOperation):
    """Milling of a free-form surface."""

    its_machining_strategy: Ref[FreeformStrategy] | None = None


class Two5dMillingOperation(MillingTypeOperation, abstract=True):
    """Milling at constant depth, layer by layer."""

    its_machining_strategy: Ref[Two5dMillingStrategy] | None = None


class PlaneMilling(Two5dMillingOperation, abstract=True):
    """Milling of a face."""

    axial_cutting_depth: float | None = None
    allowance_bottom: float | None = None


class PlaneRoughMilling(PlaneMilling):
    """Roughing of a face."""


class PlaneFinishMilling(PlaneMilling):
    """Finishing of a face."""


class SideMilling(Two5dMillingOperation, abstract=True):
    """Milling of a wall."""

    axial_cutting_depth: float | None = None
    radial_cutting_depth: float | None = None
    allowance_side: float | None = None


class SideRoughMilling(SideMilling):
    """Roughing of a wall."""


class SideFinishMilling(SideMilling):
    """Finishing of a wall."""


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
    """Operation of a drill."""


class Drilling(DrillingOperation):
    """Drilling in one go."""


class CenterDrilling(DrillingOperation):
    """Drilling of a centre hole."""


class CounterSinking(DrillingOperation):
    """Sinking of a cone."""


class MultistepDrilling(DrillingOperation):
    """Drilling with retracts that break or remove the chip."""

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
    """Widening with a boring tool."""


class Reaming(BoringOperation):
    """Finishing with a reamer."""


class BackBoring(DrillingTypeOperation):
    """Boring from behind."""


class Tapping(DrillingTypeOperation):
    """Tapping; ``compensation_chuck`` after the draft of 2001."""

    compensation_chuck: bool


class ThreadDrilling(DrillingTypeOperation):
    """Thread drilling; ``helical_movement_on_forward`` after the draft of 2001."""

    helical_movement_on_forward: bool
