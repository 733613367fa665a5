"""What all operations share (ISO 14649-10)."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity, abstract, apart
from stepnc_model.entities.geometry import CartesianPoint
from stepnc_model.entities.technology import MachineFunctions, Technology, ToolDirection
from stepnc_model.entities.toolpaths import ToolpathList
from stepnc_model.entities.tools import MachiningTool
from stepnc_model.part21.values import Ref


@abstract
class Operation(Entity):
    """Anything that moves the tool."""

    its_toolpath: Ref[ToolpathList] | None = None
    its_tool_direction: Ref[ToolDirection] | None = None


@abstract
class MachiningOperation(Operation):
    """Operation that cuts: tool, technology and machine functions.

    ``its_optimisation`` is no attribute of the standard. Files that carry an optimum refer
    to it from one surplus parameter, behind ``its_machine_functions`` or at the very end.
    """

    its_id: str
    retract_plane: float | None = None
    """mm above the feature"""
    start_point: Ref[CartesianPoint] | None = None
    its_tool: Ref[MachiningTool]
    its_technology: Ref[Technology]
    its_machine_functions: Ref[MachineFunctions]
    its_optimisation: Ref[Entity] | None = apart()
