"""Trajectories of the file as lines and arcs of the tool's tip, in the setup.

ISO 14649-10: by the tool centre point, by the point where cutter and surface touch, or by the
axes of the machine.
"""

from itertools import pairwise
from math import dist, hypot

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.geometry import BSplineCurve, Polyline
from stepnc_model.entities.toolpaths import (
    AxisTrajectory,
    CurveWithNormalVector,
    CutterContactTrajectory,
    CutterLocationTrajectory,
    Trajectory,
)
from stepnc_model.errors import PathError
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program
from stepnc_model.tool import Tool
from stepnc_model.toolpath.curve import Segment, segments_of
from stepnc_model.toolpath.frame import Frame, point_of
from stepnc_model.toolpath.path import Point

AXES = ("X", "Y", "Z")

UPRIGHT = 1e-6
"""sine of the angle by which a tool axis may lean, or a normal differ from the tool's axis"""


def trajectory_segments(
    program: Program,
    ref: Ref[Trajectory],
    *,
    frame: Frame,
    tool: Tool | None,
    at: Point | None,
) -> tuple[Segment, ...]:
    """Way of the tool's tip along a trajectory, in its direction.

    Parameters
    ----------
    program : Program
    ref : Ref
    frame : Frame
        That its curve is given in.
    tool : Tool or None
        Needed where the curve is that of the cutter's contact.
    at : Point or None
        Where the tool is: axes that are not named stay there.

    Returns
    -------
    tuple of Segment
        In the coordinates of the setup; empty for a curve without length.

    Raises
    ------
    PathError
        When the curve cannot be followed with a tool that stands along z.
    """
    trajectory = program.get(ref)
    if isinstance(trajectory, AxisTrajectory):
        segments = _axes(program, ref, trajectory, at)
    elif isinstance(trajectory, (CutterLocationTrajectory, CutterContactTrajectory)):
        _check_axis(program, ref, trajectory.its_toolaxis, frame)
        if isinstance(trajectory, CutterLocationTrajectory):
            curve = segments_of(program, trajectory.basiccurve)
            segments = tuple(segment.within(frame) for segment in curve)
        else:
            segments = _contact(program, ref, trajectory, frame=frame, tool=tool)
    else:
        raise _fault(program, ref, "a trajectory of this kind cannot be followed")
    if trajectory.its_direction is False:
        return tuple(segment.reversed() for segment in reversed(segments))
    return segments


def _axes(
    program: Program, ref: Ref[Entity], trajectory: AxisTrajectory, at: Point | None
) -> tuple[Segment, ...]:
    """Polylines of single axes, point by point at the same time."""
    names = [name.strip().upper() for name in trajectory.axis_list]
    if len(set(names)) != len(names) or not set(names) <= set(AXES):
        raise _fault(program, ref, f"axes {', '.join(names)}: of X, Y and Z, each once")
    if len(names) != len(trajectory.commands):
        counts = f"{len(names)} axes, {len(trajectory.commands)} commands"
        raise _fault(program, ref, counts)
    if at is None and len(names) < len(AXES):
        raise _fault(program, ref, "does not say where its other axes are")
    columns = {
        AXES.index(name): _values(program, ref, command)
        for name, command in zip(names, trajectory.commands, strict=True)
    }
    counts_of = {len(values) for values in columns.values()}
    if len(counts_of) != 1:
        raise _fault(program, ref, "its axes have different numbers of points")
    rest = at or (0.0, 0.0, 0.0)
    x, y, z = (columns.get(axis, [rest[axis]] * max(counts_of)) for axis in range(3))
    points = list(zip(x, y, z, strict=True))
    if at is not None:
        points.insert(0, at)
    return tuple(Segment(start=a, end=b) for a, b in pairwise(points) if a != b)


def _values(program: Program, ref: Ref[Entity], command: Ref[Entity]) -> list[float]:
    """Positions of one axis."""
    return [point[0] for point in _points(program, ref, command)]


def _contact(
    program: Program,
    ref: Ref[Entity],
    trajectory: CutterContactTrajectory,
    *,
    frame: Frame,
    tool: Tool | None,
) -> tuple[Segment, ...]:
    """Tip of a tool that touches a surface, by the normals of the surface."""
    curve = program.get(trajectory.basiccurve)
    if not isinstance(curve, CurveWithNormalVector):
        message = "has no surface normals: the tool's place beside the surface is not known"
        raise _fault(program, ref, message)
    if tool is None or tool.diameter <= 0.0:
        raise _fault(program, ref, "needs a rotating tool")
    contacts = _points(program, ref, curve.basiccurve)
    normals = _points(program, ref, curve.surface_normal)
    if len(contacts) != len(normals):
        raise _fault(program, ref, f"{len(contacts)} points, but {len(normals)} normals")
    points = [
        _tip(program, ref, tool, contact=frame.point(contact), normal=frame.direction(normal))
        for contact, normal in zip(contacts, normals, strict=True)
    ]
    return tuple(Segment(start=a, end=b) for a, b in pairwise(points) if a != b)


def _points(program: Program, ref: Ref[Entity], curve: Ref[Entity]) -> list[Point]:
    """Points of a polyline: other curves have no normal for each of their points."""
    line = program.get(curve)
    if not isinstance(line, Polyline):
        raise _fault(program, ref, f"{curve} is no polyline: only those are followed here")
    return [point_of(program, point) for point in line.points]


def _tip(
    program: Program, ref: Ref[Entity], tool: Tool, *, contact: Point, normal: Point
) -> Point:
    """Tip of a tool that touches a point.

    With the tool's radius R, the radius r of its corner and the unit normal n it lies at
    ``contact + r·n + (R − r)·n_xy/|n_xy| − r·z``: R = r for a ball, r = 0 for a flat end.
    """
    size = dist(normal, (0.0, 0.0, 0.0))
    if size <= 0.0:
        raise _fault(program, ref, "a surface normal is 0: it points nowhere")
    x, y, z = (part / size for part in normal)
    corner = tool.corner_radius or 0.0
    flat = 0.5 * tool.diameter - corner
    across = hypot(x, y)
    if flat > UPRIGHT and across < UPRIGHT:
        message = "a flat tool on level ground: the normal does not tell where its axis is"
        raise _fault(program, ref, message)
    aside = corner + (flat / across if flat > UPRIGHT else 0.0)
    return contact[0] + aside * x, contact[1] + aside * y, contact[2] + corner * (z - 1.0)


def _check_axis(
    program: Program, ref: Ref[Entity], curve: Ref[Entity] | None, frame: Frame
) -> None:
    """Refuse a tool axis that leans: paths are those of three axes."""
    if curve is None:
        return
    axis = program.get(curve)
    if isinstance(axis, Polyline):
        ends = axis.points
    elif isinstance(axis, BSplineCurve):
        ends = axis.control_points_list
    else:
        raise _fault(program, ref, "its tool axis is no polyline or B-spline")
    for end in ends:
        x, y, z = frame.direction(point_of(program, end))
        if z <= 0.0 or hypot(x, y) > UPRIGHT * z:
            raise _fault(program, ref, "its tool axis leans: paths are those of three axes")


def _fault(program: Program, ref: Ref[Entity], message: str) -> PathError:
    return PathError(message, entity=program.label(ref), line=program.line(ref))
