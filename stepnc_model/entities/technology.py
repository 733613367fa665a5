"""Feeds, speeds, machine functions and tool directions (ISO 14649-10 and -11).

Numbers are kept in the units of ISO 14649-10 §4.2.1: m/s, rev/s, mm/tooth, Pa, degrees.
"""

from __future__ import annotations

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import ToolReferencePoint
from stepnc_model.entities.geometry import Direction
from stepnc_model.entities.measures import PropertyParameter
from stepnc_model.part21.values import Ref


class Technology(Entity, abstract=True):
    """Base of all technologies: feed, speed, inhibitions."""

    feedrate: float | None = None
    """m/s"""
    feedrate_reference: ToolReferencePoint


class AdaptiveControl(Entity):
    """Adaptive control of the machine; the standard leaves the content to vendors."""


class MillingTechnology(Technology):
    """Cutting conditions of a rotating tool.

    WR1 and WR2 of ISO 14649-11: exactly one of ``cutspeed`` and ``spindle``, exactly one of
    ``feedrate`` and ``feedrate_per_tooth``, unless there is an adaptive control.
    """

    cutspeed: float | None = None
    """m/s"""
    spindle: float | None = None
    """rev/s; negative is clockwise, as right-hand tools need"""
    feedrate_per_tooth: float | None = None
    """mm"""
    synchronize_spindle_with_feed: bool
    inhibit_feedrate_override: bool
    inhibit_spindle_override: bool
    its_adaptive_control: Ref[AdaptiveControl] | None = None


class ProcessModel(Entity):
    """Process model, given by the file that holds its data."""

    ini_data_file: str
    its_type: str


class ProcessModelList(Entity):
    """Process models of one operation."""

    its_list: tuple[Ref[ProcessModel], ...]


class MachineFunctions(Entity, abstract=True):
    """Machine functions besides moves."""


class MillingMachineFunctions(MachineFunctions):
    """Coolant, clamping and chips on a milling machine; pressures in Pa."""

    coolant: bool
    coolant_pressure: float | None = None
    mist: bool | None = None
    through_spindle_coolant: bool
    through_pressure: float | None = None
    axis_clamping: tuple[str, ...]
    chip_removal: bool
    oriented_spindle_stop: Ref[Direction] | None = None
    its_process_model: Ref[ProcessModelList] | None = None
    other_functions: tuple[Ref[PropertyParameter], ...]


class ToolDirection(Entity, abstract=True):
    """Direction of the tool's axis."""


class TwoAxes(ToolDirection):
    """Tool direction of a lathe."""


class ThreeAxes(ToolDirection):
    """Tool direction along z."""


class ToolDirectionForMilling(ToolDirection, abstract=True):
    """Direction of a tool that may be inclined."""


class ThreeAxesTiltedTool(ToolDirectionForMilling):
    """Tool direction that is tilted but constant."""

    its_tool_direction: Ref[Direction]


class FiveAxesConstTiltYaw(ToolDirectionForMilling):
    """Tool direction at constant angles to the path, degrees."""

    tilt_angle: float
    yaw_angle: float


class FiveAxesVarTiltYaw(ToolDirectionForMilling):
    """Tool direction with varying angles, given by the tool path."""
