"""Explicit tool paths (ISO 14649-10)."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity, abstract, entity
from stepnc_model.entities.enums import ContactType, SpeedName, ToolpathType
from stepnc_model.entities.geometry import (
    BoundedCurve,
    BSplineCurve,
    CartesianPoint,
    Direction,
)
from stepnc_model.entities.technology import MachineFunctions, Technology
from stepnc_model.part21.values import Ref, Typed


@entity
class ToolpathSpeed(Entity):
    """Factor on the feedrate along the path, as a B-spline."""

    speed: Ref[BSplineCurve]


@abstract
class Toolpath(Entity):
    """Movement; what it leaves out it takes from its operation."""

    its_priority: bool
    its_type: ToolpathType
    its_speed: Ref[ToolpathSpeed] | SpeedName | Typed | float | None = None
    """curve of factors, one factor on the feedrate, or rapid"""
    its_technology: Ref[Technology] | None = None
    its_machine_functions: Ref[MachineFunctions] | None = None


@entity
class ToolpathList(Entity):
    """Tool paths in their order."""

    its_list: tuple[Ref[Toolpath], ...]


@entity
class Feedstop(Toolpath):
    """Pause at the end of a movement."""

    dwell: float
    """s"""


@abstract
class Trajectory(Toolpath):
    """Movement along a curve; ``its_direction`` false runs it backwards."""

    its_direction: bool | None = None


@entity
class CutterLocationTrajectory(Trajectory):
    """Curve of the tool centre point."""

    basiccurve: Ref[BoundedCurve]
    its_toolaxis: Ref[BoundedCurve] | None = None
    surface_normal: Ref[BoundedCurve] | None = None


@entity
class CurveWithNormalVector(Entity):
    """Curve with the normal of the surface it lies on."""

    basiccurve: Ref[BoundedCurve]
    surface_normal: Ref[BoundedCurve]


@entity
class CutterContactTrajectory(Trajectory):
    """Curve of the point where cutter and surface touch."""

    basiccurve: Ref[CurveWithNormalVector | BoundedCurve]
    its_toolaxis: Ref[BoundedCurve] | None = None
    its_contact_type: ContactType | None = None


@entity
class AxisTrajectory(Trajectory):
    """Curves of the machine's own axes."""

    axis_list: tuple[str, ...]
    commands: tuple[Ref[BoundedCurve], ...]


@abstract
class ParameterisedPath(Toolpath):
    """Movement that a few parameters tell."""


@abstract
class Connector(ParameterisedPath):
    """Way from one cut to the next."""


@entity
class ConnectSecplane(Connector):
    """Way over the security plane."""

    up_dir: Ref[Direction] | None = None
    down_dir: Ref[Direction] | None = None


@entity
class ConnectDirect(Connector):
    """Straight way."""


@abstract
class ApproachLiftPath(ParameterisedPath):
    """Way to the cut or from it."""

    fix_point: Ref[CartesianPoint]
    fix_point_dir: Ref[Direction] | None = None


@entity
class ApLiftPathAngle(ApproachLiftPath):
    """Straight way at an angle, degrees."""

    angle: float
    benddist: float


@entity
class ApLiftPathTangent(ApproachLiftPath):
    """Way along an arc that meets the path tangentially."""

    radius: float
