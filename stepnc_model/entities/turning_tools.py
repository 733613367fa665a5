"""Turning tools (ISO 14649-121); mm and degrees."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import (
    HandOfToolType,
    KnurlPatternType,
    ThreadHandType,
    ThreadProfileType,
    ThreadType,
)
from stepnc_model.entities.technology import Technology
from stepnc_model.entities.tools import MachiningTool
from stepnc_model.part21.values import Ref


class CornerTransition(Entity, abstract=True):
    """Corner of an insert."""


class RoundedCorner(CornerTransition):
    """Corner with a nose radius."""

    corner_radius: float


class ChamferedCorner(CornerTransition):
    """Corner with a chamfer."""

    corner_chamfer_angle: float
    corner_chamfer_length: float | None = None
    corner_chamfer_width: float | None = None


class CuttingEdgeProperties(Entity):
    """Geometry of the cutting edge of a turning tool."""

    expected_tool_life: float | None = None
    """s"""
    its_technology: Ref[Technology] | None = None
    cutting_edge_length: float | None = None
    tool_cutting_edge_angle: float | None = None
    tool_cutting_edge_angle_type: str | None = None
    tool_included_angle: float | None = None
    corner_transitions: tuple[Ref[CornerTransition], ...]
    maximum_side_cutting_depth: float | None = None
    maximum_end_cutting_depth: float | None = None


class TurningMachineCuttingTool(MachiningTool):
    """Base of all turning tools."""

    functional_length: float
    f_dimension: float
    minimum_cutting_diameter: float | None = None
    a_dimension_on_f: float | None = None
    a_dimension_on_lf: float | None = None
    cutting_edge: Ref[CuttingEdgeProperties]
    hand_of_tool: HandOfToolType | None = None


class GeneralTurningTool(TurningMachineCuttingTool):
    """Tool for turning, facing and boring."""


class TurningThreadingTool(TurningMachineCuttingTool):
    """Turning tool for threads."""

    threading_pitch: float
    thread_hand: ThreadHandType
    its_thread_type: ThreadType
    thread_profile: ThreadProfileType
    thread_form_type: str


class GroovingTool(TurningMachineCuttingTool):
    """Turning tool for grooves."""

    cutting_width: float
    maximum_grooving_depth: float
    corner_radius: float | None = None
    maximum_axial_grooving_diameter: float | None = None
    minimum_axial_grooving_diameter: float | None = None


class KnurlingTool(TurningMachineCuttingTool):
    """Knurling tool; its own attributes follow AP238."""

    knurl_pattern: KnurlPatternType
    cutting_length: float | None = None
    angle: float | None = None
    pitch: float | None = None


class UserDefinedTurningTool(TurningMachineCuttingTool):
    """Turning tool with a name that manufacturer and user agree on."""

    identifier: str
