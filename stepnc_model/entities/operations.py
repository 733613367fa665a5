"""Base of all operations, and explicit tool paths (ISO 14649-10)."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity, apart
from stepnc_model.entities.enums import ContactType, SpeedName, ToolpathType
from stepnc_model.entities.geometry import BoundedCurve, BSplineCurve, CartesianPoint, Direction
from stepnc_model.entities.technology import MachineFunctions, Technology, ToolDirection
from stepnc_model.entities.tools import MachiningTool
from stepnc_model.part21.values import Ref, Typed


class ToolpathSpeed(Entity):
    """Factor on the feedrate along the path, as a B-spline."""

    speed: Ref[BSplineCurve]


class Toolpath(Entity, abstract=True):
    """Movement; what it leaves out it takes from its operation."""

    its_priority: bool
    its_type: ToolpathType
    its_speed: Ref[ToolpathSpeed] | SpeedName | Typed | float | None = None
    """curve of factors, one factor on the feedrate, or rapid"""
    its_technology: Ref[Technology] | None = None
    its_machine_functions: Ref[MachineFunctions] | None = None


class ToolpathList(Entity):
    """Tool paths in their order."""

    its_list: tuple[Ref[Toolpath], ...]


class Feedstop(Toolpath):
    """Pause at the end of a movement."""

    dwell: float
    """s"""


class Trajectory(Toolpath, abstract=True):
    """Movement along a curve; ``its_direction`` false runs it backwards."""

    its_direction: bool | None = None


class CutterLocationTrajectory(Trajectory):
    """Curve of the tool centre point."""

    basiccurve: Ref[BoundedCurve]
    its_toolaxis: Ref[BoundedCurve] | None = None
    surface_normal: Ref[BoundedCurve] | None = None


class CurveWithNormalVector(Entity):
    """Curve with the normal of the surface it lies on."""

    basiccurve: Ref[BoundedCurve]
    surface_normal: Ref[BoundedCurve]


class CutterContactTrajectory(Trajectory):
    """Curve of the point where cutter and surface touch."""

    basiccurve: Ref[CurveWithNormalVector | BoundedCurve]
    its_toolaxis: Ref[BoundedCurve] | None = None
    its_contact_type: ContactType | None = None


class AxisTrajectory(Trajectory):
    """Curves of the machine's own axes."""

    axis_list: tuple[str, ...]
    commands: tuple[Ref[BoundedCurve], ...]


class ParameterisedPath(Toolpath, abstract=True):
    """Movement that a few parameters tell."""


class Connector(ParameterisedPath, abstract=True):
    """Way from one cut to the next."""


class ConnectSecplane(Connector):
    """Way over the security plane."""

    up_dir: Ref[Direction] | None = None
    down_dir: Ref[Direction] | None = None


class ConnectDirect(Connector):
    """Straight way."""


class ApproachLiftPath(ParameterisedPath, abstract=True):
    """Way to the cut or from it."""

    fix_point: Ref[CartesianPoint]
    fix_point_dir: Ref[Direction] | None = None


class ApLiftPathAngle(ApproachLiftPath):
    """Straight way at an angle, degrees."""

    angle: float
    benddist: float


class ApLiftPathTangent(ApproachLiftPath):
    """Way along an arc that meets the path tangentially."""

    radius: float


class Operation(Entity, abstract=True):
    """Anything that moves the tool."""

    its_toolpath: Ref[ToolpathList] | None = None
    its_tool_direction: Ref[ToolDirection] | None = None


class MachiningOperation(Operation, abstract=True):
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
