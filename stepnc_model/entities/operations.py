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
    """Tool path; missing values are taken from its operation."""

    its_priority: bool
    its_type: ToolpathType
    its_speed: Ref[ToolpathSpeed] | SpeedName | Typed | float | None = None
    """curve of factors, one factor on the feedrate, or rapid"""
    its_technology: Ref[Technology] | None = None
    its_machine_functions: Ref[MachineFunctions] | None = None


class ToolpathList(Entity):
    """List of tool paths in order."""

    its_list: tuple[Ref[Toolpath], ...]


class Feedstop(Toolpath):
    """Dwell at the end of a movement."""

    dwell: float
    """s"""


class Trajectory(Toolpath, abstract=True):
    """Movement along a curve; with ``its_direction`` false it runs backwards."""

    its_direction: bool | None = None


class CutterLocationTrajectory(Trajectory):
    """Trajectory given by the curve of the tool centre point."""

    basiccurve: Ref[BoundedCurve]
    its_toolaxis: Ref[BoundedCurve] | None = None
    surface_normal: Ref[BoundedCurve] | None = None


class CurveWithNormalVector(Entity):
    """Curve with the normals of the surface on which it lies."""

    basiccurve: Ref[BoundedCurve]
    surface_normal: Ref[BoundedCurve]


class CutterContactTrajectory(Trajectory):
    """Trajectory given by the curve of contact between cutter and surface."""

    basiccurve: Ref[CurveWithNormalVector | BoundedCurve]
    its_toolaxis: Ref[BoundedCurve] | None = None
    its_contact_type: ContactType | None = None


class AxisTrajectory(Trajectory):
    """Trajectory given by curves of the machine axes."""

    axis_list: tuple[str, ...]
    commands: tuple[Ref[BoundedCurve], ...]


class ParameterisedPath(Toolpath, abstract=True):
    """Tool path given by a few parameters."""


class Connector(ParameterisedPath, abstract=True):
    """Connection from one cut to the next."""


class ConnectSecplane(Connector):
    """Connection over the security plane."""

    up_dir: Ref[Direction] | None = None
    down_dir: Ref[Direction] | None = None


class ConnectDirect(Connector):
    """Straight connection between two cuts."""


class ApproachLiftPath(ParameterisedPath, abstract=True):
    """Approach to the cut or lift from it."""

    fix_point: Ref[CartesianPoint]
    fix_point_dir: Ref[Direction] | None = None


class ApLiftPathAngle(ApproachLiftPath):
    """Straight approach or lift at an angle, degrees."""

    angle: float
    benddist: float


class ApLiftPathTangent(ApproachLiftPath):
    """Approach or lift along an arc tangential to the path."""

    radius: float


class Operation(Entity, abstract=True):
    """Operation, base of everything that moves the tool."""

    its_toolpath: Ref[ToolpathList] | None = None
    its_tool_direction: Ref[ToolDirection] | None = None


class MachiningOperation(Operation, abstract=True):
    """Machining operation with its tool, technology and machine functions.

    ``its_optimisation`` is not an attribute of the standard. Files with an optimum refer to
    it by one surplus parameter, after ``its_machine_functions`` or at the very end.
    """

    its_id: str
    retract_plane: float | None = None
    """mm above the feature"""
    start_point: Ref[CartesianPoint] | None = None
    its_tool: Ref[MachiningTool]
    its_technology: Ref[Technology]
    its_machine_functions: Ref[MachineFunctions]
    its_optimisation: Ref[Entity] | None = apart()
