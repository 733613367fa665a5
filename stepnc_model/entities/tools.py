"""Rotating tools (ISO 14649-10 and -111); lengths in mm, angles in degrees."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity, abstract, entity
from stepnc_model.entities.enums import Hand
from stepnc_model.entities.geometry import Direction
from stepnc_model.entities.technology import MillingTechnology
from stepnc_model.entities.workpiece import Material
from stepnc_model.part21.values import Ref


@abstract
class MachiningTool(Entity):
    """What is clamped in the machine."""

    its_id: str


@entity
class TouchProbe(Entity):
    """Probe that measures by touching."""

    its_id: str


@entity
class CuttingEdgeTechnologicalData(Entity):
    """Angles of the cutting edge."""

    cutting_angle: float | None = None
    free_angle: float | None = None
    aux_angle: float | None = None


@entity
class CuttingComponent(Entity):
    """One cutting edge; drafts write four parameters, the standard of 2004 five."""

    tool_offset_length: float
    its_material: Ref[Material] | None = None
    technological_data: Ref[CuttingEdgeTechnologicalData] | None = None
    expected_tool_life: float | None = None
    """s"""
    its_technology: Ref[MillingTechnology] | None = None


@entity
class MillingToolDimension(Entity):
    """Sizes of a tool body; TOOL_DIMENSION in the draft of 2001."""

    diameter: float
    tool_top_angle: float | None = None
    tool_circumference_angle: float | None = None
    cutting_edge_length: float | None = None
    edge_radius: float | None = None
    edge_center_vertical: float | None = None
    edge_center_horizontal: float | None = None


@abstract
class ToolBody(Entity):
    """What carries the cutting edges."""


@abstract
class MillingToolBody(ToolBody):
    """What every rotating tool body has."""

    dimension: Ref[MillingToolDimension]
    number_of_teeth: int | None = None
    hand_of_cut: Hand | None = None
    coolant_through_tool: bool | None = None
    pilot_length: float | None = None


@abstract
class CuttingTool(MachiningTool):
    """Tool body with its edges; instances named so in drafts are milling tools."""

    its_tool_body: Ref[ToolBody]
    its_cutting_edge: tuple[Ref[CuttingComponent], ...]
    overall_assembly_length: float | None = None


@entity
class MillingCuttingTool(CuttingTool):
    """Rotating tool ready for use."""

    direction_for_spindle_orientation: Ref[Direction] | None = None
    tool_holder_diameter_for_spindle_orientation: float | None = None


@abstract
class MillingCutter(MillingToolBody):
    """Tool that cuts with its side."""


@entity
class Facemill(MillingCutter):
    """Cutter for faces."""


@entity
class Endmill(MillingCutter):
    """Cutter with edges on end and side."""


@entity
class TaperedEndmill(Endmill):
    """End mill whose side is a cone."""

    taper_angle: float | None = None


@entity
class BallEndmill(Endmill):
    """End mill whose end is half a sphere."""


@entity
class BullnoseEndmill(Endmill):
    """End mill with rounded corners."""


@entity
class SideMill(MillingCutter):
    """Disc cutter."""

    cutter_width: float | None = None


@entity
class TSlotMill(MillingCutter):
    """Cutter for T slots."""

    cutting_thickness: float | None = None


@entity
class DovetailMill(MillingCutter):
    """Cutter for dovetails."""

    included_angle: float | None = None


@entity
class WoodruffKeyseatMill(MillingCutter):
    """Cutter for Woodruff keys."""

    cutter_width: float | None = None


@entity
class ThreadMill(MillingCutter):
    """Cutter for threads."""


@abstract
class Drill(MillingToolBody):
    """Tool that cuts with its point."""


@entity
class TwistDrill(Drill):
    """Drill with helical flutes."""


@entity
class TaperedDrill(TwistDrill):
    """Twist drill whose side is a cone."""

    taper_angle: float | None = None


@entity
class SpadeDrill(Drill):
    """Drill with a flat blade."""


@entity
class CenterDrill(MillingToolBody):
    """Drill for centre holes."""


@entity
class Countersink(MillingToolBody):
    """Tool for conical sinks."""

    countersink_radius: float | None = None


@entity
class BacksideCountersink(Countersink):
    """Countersink that works from behind."""


@entity
class Counterbore(MillingToolBody):
    """Tool for cylindrical sinks."""


@entity
class BacksideCounterbore(Counterbore):
    """Counterbore that works from behind."""


@entity
class Reamer(MillingToolBody):
    """Tool that finishes a hole."""


@entity
class TaperedReamer(Reamer):
    """Reamer whose side is a cone."""

    taper_angle: float | None = None


@entity
class CombinedDrillAndReamer(Reamer):
    """Reamer with a drill before it."""

    drill_length: float | None = None


@entity
class Tap(MillingToolBody):
    """Tool that cuts a thread in one go."""


@entity
class TaperedTap(Tap):
    """Tap whose side is a cone."""

    taper_angle: float | None = None


@entity
class CombinedDrillAndTap(Tap):
    """Tap with a drill before it."""

    drill_length: float | None = None


@entity
class MillingThreadingTool(MillingToolBody):
    """Tool for thread drilling; THREADING_TOOL in the draft of 2001."""


@entity
class BoringTool(MillingToolBody):
    """Tool with one adjustable edge.

    Files with a sixth parameter, a BOOLEAN, exist; neither edition explains it, so its name
    here is ours.
    """

    is_adjustable: bool | None = None


@entity
class UserDefinedTool(MillingToolBody):
    """Tool by a name that maker and user agree on."""

    identifier: str
