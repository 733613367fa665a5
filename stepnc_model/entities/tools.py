"""Rotating tools (ISO 14649-10 and -111); lengths in mm, angles in degrees."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import Hand
from stepnc_model.entities.geometry import Direction
from stepnc_model.entities.technology import MillingTechnology
from stepnc_model.entities.workpiece import Material
from stepnc_model.part21.values import Ref


class MachiningTool(Entity, abstract=True):
    """Base of all machining tools."""

    its_id: str


class TouchProbe(Entity):
    """Touch probe for measuring."""

    its_id: str


class CuttingEdgeTechnologicalData(Entity):
    """Angles of the cutting edge."""

    cutting_angle: float | None = None
    free_angle: float | None = None
    aux_angle: float | None = None


class CuttingComponent(Entity):
    """Cutting edge; drafts have four parameters, the standard of 2004 five."""

    tool_offset_length: float
    its_material: Ref[Material] | None = None
    technological_data: Ref[CuttingEdgeTechnologicalData] | None = None
    expected_tool_life: float | None = None
    """s"""
    its_technology: Ref[MillingTechnology] | None = None


class MillingToolDimension(Entity):
    """Dimensions of a tool body; TOOL_DIMENSION in the draft of 2001."""

    diameter: float
    tool_top_angle: float | None = None
    tool_circumference_angle: float | None = None
    cutting_edge_length: float | None = None
    edge_radius: float | None = None
    edge_center_vertical: float | None = None
    edge_center_horizontal: float | None = None


class ToolBody(Entity, abstract=True):
    """Body that carries the cutting edges."""


class MillingToolBody(ToolBody, abstract=True):
    """Base of all rotating tool bodies."""

    dimension: Ref[MillingToolDimension]
    number_of_teeth: int | None = None
    hand_of_cut: Hand | None = None
    coolant_through_tool: bool | None = None
    pilot_length: float | None = None


class CuttingTool(MachiningTool, abstract=True):
    """Tool body with its edges; in drafts, instances of it are milling tools."""

    its_tool_body: Ref[ToolBody]
    its_cutting_edge: tuple[Ref[CuttingComponent], ...]
    overall_assembly_length: float | None = None


class MillingCuttingTool(CuttingTool):
    """Rotating tool ready for use."""

    direction_for_spindle_orientation: Ref[Direction] | None = None
    tool_holder_diameter_for_spindle_orientation: float | None = None


class MillingCutter(MillingToolBody, abstract=True):
    """Milling cutter, a tool that cuts with its side."""


class Facemill(MillingCutter):
    """Face mill, a cutter for faces."""


class Endmill(MillingCutter):
    """End mill with edges on end and side."""


class TaperedEndmill(Endmill):
    """End mill with a conical side."""

    taper_angle: float | None = None


class BallEndmill(Endmill):
    """End mill with a hemispherical end."""


class BullnoseEndmill(Endmill):
    """End mill with rounded corners."""


class SideMill(MillingCutter):
    """Side mill, a disc-shaped cutter."""

    cutter_width: float | None = None


class TSlotMill(MillingCutter):
    """Cutter for T slots."""

    cutting_thickness: float | None = None


class DovetailMill(MillingCutter):
    """Cutter for dovetails."""

    included_angle: float | None = None


class WoodruffKeyseatMill(MillingCutter):
    """Cutter for Woodruff keys."""

    cutter_width: float | None = None


class ThreadMill(MillingCutter):
    """Cutter for threads."""


class Drill(MillingToolBody, abstract=True):
    """Drill, a tool that cuts with its point."""


class TwistDrill(Drill):
    """Drill with helical flutes."""


class TaperedDrill(TwistDrill):
    """Twist drill with a conical side."""

    taper_angle: float | None = None


class SpadeDrill(Drill):
    """Drill with a flat blade."""


class CenterDrill(MillingToolBody):
    """Drill for centre holes."""


class Countersink(MillingToolBody):
    """Countersink, a tool for conical sinks."""

    countersink_radius: float | None = None


class BacksideCountersink(Countersink):
    """Countersink that works from behind."""


class Counterbore(MillingToolBody):
    """Counterbore, a tool for cylindrical sinks."""


class BacksideCounterbore(Counterbore):
    """Counterbore that works from behind."""


class Reamer(MillingToolBody):
    """Reamer, a tool that finishes a hole."""


class TaperedReamer(Reamer):
    """Reamer with a conical side."""

    taper_angle: float | None = None


class CombinedDrillAndReamer(Reamer):
    """Reamer combined with a drill in front of it."""

    drill_length: float | None = None


class Tap(MillingToolBody):
    """Tap, a tool that cuts a thread in one pass."""


class TaperedTap(Tap):
    """Tap with a conical side."""

    taper_angle: float | None = None


class CombinedDrillAndTap(Tap):
    """Tap combined with a drill in front of it."""

    drill_length: float | None = None


class MillingThreadingTool(MillingToolBody):
    """Tool for thread drilling; THREADING_TOOL in the draft of 2001."""


class BoringTool(MillingToolBody):
    """Boring tool with one adjustable edge.

    Some files have a sixth parameter, a BOOLEAN, that neither edition explains; its name here
    was chosen by this project.
    """

    is_adjustable: bool | None = None


class UserDefinedTool(MillingToolBody):
    """Tool with a name that manufacturer and user agree on."""

    identifier: str
