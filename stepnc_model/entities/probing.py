"""Probing of workpieces and tools (ISO 14649-10); mm."""

from __future__ import annotations

from stepnc_model.entities.entity import abstract, entity
from stepnc_model.entities.executables import Workingstep
from stepnc_model.entities.expressions import NcVariable
from stepnc_model.entities.geometry import Axis2Placement3d, CartesianPoint, Direction
from stepnc_model.entities.measures import TolerancedLengthMeasure
from stepnc_model.entities.setup import OffsetVector
from stepnc_model.entities.technology import ToolDirection
from stepnc_model.entities.toolpaths import ToolpathList
from stepnc_model.entities.tools import MachiningTool, TouchProbe
from stepnc_model.entities.workpiece import Workpiece
from stepnc_model.part21.values import Ref


@abstract
class TouchProbing(Workingstep):
    """Measurement; the second supertype, ``operation``, is spelt out."""

    its_toolpath: Ref[ToolpathList] | None = None
    its_tool_direction: Ref[ToolDirection] | None = None
    measured_offset: Ref[NcVariable]


@entity
class WorkpieceProbing(TouchProbing):
    """One point of the workpiece."""

    start_position: Ref[Axis2Placement3d]
    its_workpiece: Ref[Workpiece]
    its_direction: Ref[Direction]
    expected_value: Ref[TolerancedLengthMeasure]
    its_probe: Ref[TouchProbe]


@entity
class WorkpieceCompleteProbing(TouchProbing):
    """Place and attitude of the workpiece."""

    its_workpiece: Ref[Workpiece]
    probing_distance: Ref[TolerancedLengthMeasure]
    its_probe: Ref[TouchProbe]
    computed_offset: Ref[OffsetVector]


@abstract
class ToolProbing(TouchProbing):
    """Measurement of a tool."""

    offset: Ref[CartesianPoint]
    max_wear: float
    its_tool: Ref[MachiningTool]


@entity
class ToolLengthProbing(ToolProbing):
    """Length of a tool."""


@entity
class ToolRadiusProbing(ToolProbing):
    """Radius of a tool."""
