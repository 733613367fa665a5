"""Trajectories of the file as lines and arcs of the tool tip, with their feeds.

ISO 14649-10: a trajectory is given by the tool centre point, by the point where cutter and
surface touch, or by the axes of the machine.

A feed is rapid, a factor, or a curve of factors along the path (``its_speed``). A missing speed
comes from the technology of the tool path, or else of the operation. A ``toolpath_speed`` is a
B-spline of one coordinate, the factor on the feedrate; its parameter runs evenly along the
path.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, cos, dist, hypot, inf, sin

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import SpeedName, ToolpathType
from stepnc_model.entities.geometry import BSplineCurve, Polyline
from stepnc_model.entities.operations import (
    AxisTrajectory,
    CurveWithNormalVector,
    CutterContactTrajectory,
    CutterLocationTrajectory,
    Toolpath,
    ToolpathSpeed,
    Trajectory,
)
from stepnc_model.part21.values import Ref, Typed
from stepnc_model.program import Program
from stepnc_model.tool import Tool
from stepnc_model.toolpath.curve import Segment, Spline, segments_of, spline_of
from stepnc_model.toolpath.frame import Frame, point_of
from stepnc_model.toolpath.path import Feed, Move, MoveType, Point, length

PIECES = 64
"""Least number of pieces of a path along which a curve of factors is sampled."""

TYPES = {
    ToolpathType.APPROACH: MoveType.APPROACH,
    ToolpathType.LIFT: MoveType.RETRACT,
    ToolpathType.CONNECT: MoveType.NO_CONTACT,
    ToolpathType.NON_CONTACT: MoveType.NO_CONTACT,
    ToolpathType.CONTACT: MoveType.CONTACT,
    ToolpathType.TRAJECTORY_PATH: MoveType.CONTACT,
}
"""Type of the moves of a tool path at feed, by the path's own type."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveSpeeds:
    """Move type and feed of the moves of one tool path."""

    type: MoveType
    feed: Feed | None
    """Feed of the moves; None for rapid."""
    factors: Spline | None = None
    """Factors on the feed along the path."""


def pace_of(program: Program, ref: Ref[Toolpath], technology: Ref[Entity] | None) -> MoveSpeeds:
    """Move type and feed of a tool path.

    Parameters
    ----------
    program : Program
    ref : Ref
    technology : Ref or None
        Technology of the operation; None for a rapid movement, where everything is rapid.

    Raises
    ------
    PathError
        If the factor on the feed is not positive.
    """
    path = program.get(ref)
    type = TYPES.get(path.its_type, MoveType.CONTACT)
    speed = path.its_speed
    if technology is None or speed is SpeedName.RAPID:
        is_own = type in {MoveType.APPROACH, MoveType.RETRACT}
        return MoveSpeeds(type=type if is_own else MoveType.RAPID, feed=None)
    feed = Feed(technology=path.its_technology or technology)
    if speed is None:
        return MoveSpeeds(type=type, feed=feed)
    if isinstance(speed, Ref):
        entity: Entity = program.get(speed)
        if not isinstance(entity, ToolpathSpeed):
            raise program.path_error(f"{speed} is not a tool path speed", ref, "its_speed")
        factors = spline_of(program, entity.speed)
        for factor, *others in factors.poles:
            _check(program, ref, factor)
            if any(others):
                raise program.path_error(
                    "feed factors must have one coordinate", ref, "its_speed"
                )
        return MoveSpeeds(type=type, feed=feed, factors=factors)
    value = speed.value if isinstance(speed, Typed) else speed
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise program.path_error(f"{value} is not a valid feed factor", ref, "its_speed")
    _check(program, ref, float(value))
    return MoveSpeeds(type=type, feed=replace(feed, ratio=float(value)))


def paced(start: Point, moves: Sequence[Move], factors: Spline) -> Iterator[Move]:
    """Split moves into pieces, each with the feed factor at its middle.

    Parameters
    ----------
    start : Point
        Start of the first move.
    moves : sequence of Move
        All moves of one tool path, at feed.
    factors : Spline
    """
    starts = [start, *(move.end for move in moves[:-1])]
    lengths = [length(at, move) for at, move in zip(starts, moves, strict=True)]
    whole = sum(lengths)
    low, high = factors.spans[0], factors.spans[-1]
    done = 0.0
    for at, move, size in zip(starts, moves, lengths, strict=True):
        count = max(1, ceil(PIECES * size / whole)) if whole > 0.0 else 1
        for index, piece in enumerate(_pieces(at, move, count)):
            middle = done + (index + 0.5) / count * size
            part = middle / whole if whole > 0.0 else 0.0
            factor = factors.at(low + part * (high - low))[0]
            feed = piece.feed and replace(piece.feed, ratio=piece.feed.ratio * factor)
            yield replace(piece, feed=feed)
        done += size


def _pieces(start: Point, move: Move, count: int) -> Iterator[Move]:
    """Split a move into pieces of equal length."""
    arc = move.arc and replace(move.arc, turn=move.arc.turn / count)
    for index in range(1, count):
        yield replace(move, end=_point_at(start, move, index / count), arc=arc)
    yield replace(move, arc=arc)


def _point_at(start: Point, move: Move, part: float) -> Point:
    """Point at a fraction of a line, an arc or a helix."""
    point = [a + part * (b - a) for a, b in zip(start, move.end, strict=True)]
    if move.arc is not None:
        first, second, _ = move.arc.plane.axes
        centre, turned = move.arc.centre, part * move.arc.turn
        u, v = start[first] - centre[first], start[second] - centre[second]
        point[first] = centre[first] + u * cos(turned) - v * sin(turned)
        point[second] = centre[second] + u * sin(turned) + v * cos(turned)
    return point[0], point[1], point[2]


def _check(program: Program, ref: Ref[Entity], factor: float) -> None:
    if not 0.0 < factor < inf:
        raise program.path_error(f"feed factor {factor:g} must be positive", ref, "its_speed")


AXES = ("X", "Y", "Z")

UPRIGHT = 1e-6
"""Greatest sine of a tool axis's lean, or between a normal and the tool's axis."""


def trajectory_segments(
    program: Program,
    ref: Ref[Trajectory],
    *,
    frame: Frame,
    tool: Tool | None,
    at: Point | None,
) -> tuple[Segment, ...]:
    """Path of the tool tip along a trajectory, in its direction.

    Parameters
    ----------
    program : Program
    ref : Ref
    frame : Frame
        Frame in which the curve is given.
    tool : Tool or None
        Needed for curves of the cutter contact point.
    at : Point or None
        Position of the tool: axes that are not named stay there.

    Returns
    -------
    tuple of Segment
        In the coordinates of the setup; empty for a curve without length.

    Raises
    ------
    PathError
        If the curve cannot be followed with a tool parallel to z.
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
        raise program.path_error("this kind of trajectory is not supported", ref)
    if trajectory.its_direction is False:
        return tuple(segment.reversed() for segment in reversed(segments))
    return segments


def _axes(
    program: Program, ref: Ref[Entity], trajectory: AxisTrajectory, at: Point | None
) -> tuple[Segment, ...]:
    """Segments of single-axis polylines whose points are reached simultaneously."""
    names = [name.strip().upper() for name in trajectory.axis_list]
    if len(set(names)) != len(names) or not set(names) <= set(AXES):
        raise program.path_error(f"axes {', '.join(names)}: only X, Y and Z, each once", ref)
    if len(names) != len(trajectory.commands):
        counts = f"{len(names)} axes but {len(trajectory.commands)} commands"
        raise program.path_error(counts, ref)
    if at is None and len(names) < len(AXES):
        raise program.path_error("the positions of the other axes are unknown", ref)
    columns = {
        AXES.index(name): _values(program, ref, command)
        for name, command in zip(names, trajectory.commands, strict=True)
    }
    counts_of = {len(values) for values in columns.values()}
    if len(counts_of) != 1:
        raise program.path_error("the axes have different numbers of points", ref)
    rest = at or (0.0, 0.0, 0.0)
    x, y, z = (columns.get(axis, [rest[axis]] * max(counts_of)) for axis in range(3))
    points = list(zip(x, y, z, strict=True))
    if at is not None:
        points.insert(0, at)
    return tuple(Segment(start=a, end=b) for a, b in pairwise(points) if a != b)


def _values(program: Program, ref: Ref[Entity], command: Ref[Entity]) -> list[float]:
    """Positions of a single axis along its command curve, mm."""
    return [point[0] for point in _points(program, ref, command)]


def _contact(
    program: Program,
    ref: Ref[Entity],
    trajectory: CutterContactTrajectory,
    *,
    frame: Frame,
    tool: Tool | None,
) -> tuple[Segment, ...]:
    """Path of the tip of a tool that touches a surface, from the surface normals."""
    curve = program.get(trajectory.basiccurve)
    if not isinstance(curve, CurveWithNormalVector):
        message = "the curve has no surface normals: the tool position is not known"
        raise program.path_error(message, ref)
    if tool is None or tool.diameter <= 0.0:
        raise program.path_error("a contact trajectory needs a rotating tool", ref)
    contacts = _points(program, ref, curve.basiccurve)
    normals = _points(program, ref, curve.surface_normal)
    if len(contacts) != len(normals):
        raise program.path_error(f"{len(contacts)} points, but {len(normals)} normals", ref)
    points = [
        _tip(program, ref, tool, contact=frame.point(contact), normal=frame.direction(normal))
        for contact, normal in zip(contacts, normals, strict=True)
    ]
    return tuple(Segment(start=a, end=b) for a, b in pairwise(points) if a != b)


def _points(program: Program, ref: Ref[Entity], curve: Ref[Entity]) -> list[Point]:
    """Points of a polyline; other curves have no normal for each point."""
    line = program.get(curve)
    if not isinstance(line, Polyline):
        raise program.path_error(
            f"{curve} is not a polyline: only polylines are supported here", ref
        )
    return [point_of(program, point) for point in line.points]


def _tip(
    program: Program, ref: Ref[Entity], tool: Tool, *, contact: Point, normal: Point
) -> Point:
    """Tip of a tool that touches a surface at a point.

    With the tool's radius R, its corner radius r and the unit normal n it lies at
    ``contact + r·n + (R − r)·n_xy/|n_xy| − r·z``: R = r for a ball, r = 0 for a flat end.
    """
    size = dist(normal, (0.0, 0.0, 0.0))
    if size <= 0.0:
        raise program.path_error("a surface normal has zero length", ref)
    x, y, z = (part / size for part in normal)
    corner = tool.corner_radius or 0.0
    flat = 0.5 * tool.diameter - corner
    across = hypot(x, y)
    if flat > UPRIGHT and across < UPRIGHT:
        message = "a flat tool on a level surface: its position is ambiguous"
        raise program.path_error(message, ref)
    aside = corner + (flat / across if flat > UPRIGHT else 0.0)
    return contact[0] + aside * x, contact[1] + aside * y, contact[2] + corner * (z - 1.0)


def _check_axis(
    program: Program, ref: Ref[Entity], curve: Ref[Entity] | None, frame: Frame
) -> None:
    """Raise an error if the tool axis is tilted: only three-axis paths are supported."""
    if curve is None:
        return
    axis = program.get(curve)
    if isinstance(axis, Polyline):
        ends = axis.points
    elif isinstance(axis, BSplineCurve):
        ends = axis.control_points_list
    else:
        raise program.path_error("the tool axis is not a polyline or B-spline", ref)
    for end in ends:
        x, y, z = frame.direction(point_of(program, end))
        if z <= 0.0 or hypot(x, y) > UPRIGHT * z:
            raise program.path_error("the tool axis is tilted: only three-axis paths work", ref)
