"""Trajectories of the file as lines and arcs of the tool tip, with their feeds.

ISO 14649-10: a trajectory is given by the tool centre point, by the point where cutter and
surface touch, or by the axes of the machine.

A feed is rapid, a factor, or a curve of factors along the path (``its_speed``). A missing speed
comes from the technology of the tool path, or else of the operation. A ``toolpath_speed`` is a
B-spline of one coordinate, the factor on the feedrate; its parameter runs evenly along the
path. Moves are split where a curve of degree 1 changes its slope; a change of the factor within
``STEP`` is a step, and other changes are sampled.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise
from math import ceil, dist, hypot, inf

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
from stepnc_model.plurals import counted
from stepnc_model.programs.program import Program
from stepnc_model.programs.tool import Tool
from stepnc_model.toolpath.arc import length, point_at
from stepnc_model.toolpath.curve import Segment, path_segments
from stepnc_model.toolpath.frame import Frame, point_of
from stepnc_model.toolpath.path import Feed, Move, MoveType, Point
from stepnc_model.toolpath.spline import Spline, spline_of

PIECES = 64
"""Least number of pieces of a path along which a curve of factors is sampled."""

STEP = 0.1
"""Length within which a linear change of the factor is read as a step, mm."""

SAME = 1e-6
"""Distance below which a change of the factor lies at the end of a move, mm."""

FLAT = 1e-9
"""Relative change of the factor below which it is constant."""

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


def pace_of(
    program: Program,
    ref: Ref[Toolpath],
    technology: Ref[Entity] | None,
    alike: Collection[Ref[Entity]] = (),
) -> MoveSpeeds:
    """Move type and feed of a tool path.

    Parameters
    ----------
    technology : Ref or None
        Technology of the operation; None for a rapid movement, where everything is rapid.
    alike : collection of Ref
        Technologies for which that of the operation stands.

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
    own = path.its_technology
    feed = Feed(technology=technology if own is None or own in alike else own)
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
    """Split moves where the feed factor changes.

    A constant factor splits nothing. A change of the factor within ``STEP`` becomes a step: at
    the end of a move where there is one, else where the slower part begins or ends. All else
    becomes pieces of at most ``1/PIECES`` of the path, each with the factor at its middle.

    Parameters
    ----------
    start : Point
        Start of the first move.
    moves : sequence of Move
        All moves of one tool path, at feed.
    """
    starts = [start, *(move.end for move in moves[:-1])]
    lengths = [length(at, move) for at, move in zip(starts, moves, strict=True)]
    ends = list(accumulate(lengths))
    course = _Course(factors=factors, whole=ends[-1] if ends else 0.0)
    spans = _spans(course, ends)
    begin, row = 0.0, 0
    for at, move, end in zip(starts, moves, ends, strict=True):
        while row < len(spans) - 1 and spans[row].end <= begin + SAME:
            row += 1
        pieces = list(_pieces(course, spans, row, begin=begin, end=end))
        # A move too short to be split has one factor.
        pieces = pieces or [_Piece(end=end, factor=course.at(0.5 * (begin + end)))]
        yield from _cut(at, move, pieces, begin=begin, size=end - begin)
        begin = end


@dataclass(frozen=True, slots=True, kw_only=True)
class _Course:
    """Factors over the length of a path."""

    factors: Spline
    whole: float
    """Length of the path, mm."""

    def at(self, station: float) -> float:
        """Factor at a length from the start, mm."""
        low, high = self.factors.knots[self.factors.degree], self._last
        part = station / self.whole if self.whole > 0.0 else 0.0
        return self.factors.at(low + part * (high - low))[0]

    def station(self, knot: float) -> float:
        """Length from the start at a parameter of the curve, mm."""
        low, high = self.factors.knots[self.factors.degree], self._last
        return self.whole * (knot - low) / (high - low) if high > low else 0.0

    @property
    def _last(self) -> float:
        return self.factors.knots[len(self.factors.poles)]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Span:
    """Stretch of a path with one factor, or with a factor to be sampled."""

    begin: float
    end: float
    factor: float | None = None
    """Factor of the stretch; None where it changes along it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Piece:
    """Piece of a move with its factor."""

    end: float
    """Length of the path up to the end of the piece, mm."""
    factor: float


def _spans(course: _Course, ends: Sequence[float]) -> list[_Span]:
    """Stretches of the path between the changes of the factor."""
    if course.factors.degree > 1:
        return [_Span(begin=0.0, end=course.whole)]
    spans = [
        _span(course, low, high)
        for low, high in pairwise(map(course.station, course.factors.spans))
    ]
    for row in range(1, len(spans) - 1):
        before, ramp, after = spans[row - 1 : row + 2]
        is_short = ramp.factor is None and ramp.end - ramp.begin <= STEP
        if is_short and before.factor is not None and after.factor is not None:
            place = _place(ends, ramp, is_rising=after.factor > before.factor)
            spans[row - 1] = replace(before, end=place)
            spans[row] = replace(ramp, begin=place, end=place)
            spans[row + 1] = replace(after, begin=place)
    return spans


def _span(course: _Course, low: float, high: float) -> _Span:
    """Stretch between two knots of a curve of degree 1."""
    near, far = (course.at(low + share * (high - low)) for share in (0.25, 0.75))
    is_flat = abs(far - near) <= FLAT * near
    return _Span(begin=low, end=high, factor=near if is_flat else None)


def _place(ends: Sequence[float], ramp: _Span, *, is_rising: bool) -> float:
    """Place of a step: the end of a move within a ramp, else the slower end of the ramp."""
    first, last = bisect_left(ends, ramp.begin - SAME), bisect_right(ends, ramp.end + SAME)
    if first < last:
        return ends[first if is_rising else last - 1]
    return ramp.end if is_rising else ramp.begin


def _pieces(
    course: _Course, spans: Sequence[_Span], first: int, *, begin: float, end: float
) -> Iterator[_Piece]:
    """Pieces of a move between two lengths of the path."""
    for row in range(first, len(spans)):
        span = spans[row]
        low, high = max(begin, span.begin), min(end, span.end)
        if span.begin >= end - SAME:
            return
        if high - low <= SAME:
            continue
        count = 1
        if span.factor is None:
            count = max(1, ceil(PIECES * (high - low) / course.whole - FLAT))
        for index in range(count):
            middle = course.at(low + (index + 0.5) / count * (high - low))
            yield _Piece(
                end=low + (index + 1) / count * (high - low),
                factor=middle if span.factor is None else span.factor,
            )


def _cut(
    start: Point, move: Move, pieces: Sequence[_Piece], *, begin: float, size: float
) -> Iterator[Move]:
    """Split a move of some size that begins at a length of the path."""
    done = 0.0
    for piece in pieces:
        is_last = piece is pieces[-1]
        part = 1.0 if is_last else (piece.end - begin) / size
        arc = move.arc and replace(move.arc, turn=move.arc.turn * (part - done))
        end = move.end if is_last else point_at(start, move, part)
        feed = move.feed and replace(move.feed, ratio=move.feed.ratio * piece.factor)
        yield replace(move, end=end, arc=arc, feed=feed)
        done = part


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
    tool: Callable[[], Tool] | None,
    at: Point | None,
) -> tuple[Segment, ...]:
    """Path of the tool tip along a trajectory, in its direction.

    Parameters
    ----------
    frame : Frame
        Frame in which the curve is given.
    tool : callable or None
        Gives the tool, which is needed for curves of the cutter contact point.
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
            curve = path_segments(program, trajectory.basiccurve)
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
        commands = counted(len(trajectory.commands), "command")
        counts = f"{counted(len(names), 'axis', 'axes')} but {commands}"
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
    tool: Callable[[], Tool] | None,
) -> tuple[Segment, ...]:
    """Path of the tip of a tool that touches a surface, from the surface normals."""
    curve = program.get(trajectory.basiccurve)
    if not isinstance(curve, CurveWithNormalVector):
        message = "the curve has no surface normals: the tool position is not known"
        raise program.path_error(message, ref)
    cutter = None if tool is None else tool()
    if cutter is None or cutter.diameter <= 0.0:
        raise program.path_error("a contact trajectory needs a rotating tool", ref)
    contacts = _points(program, ref, curve.basiccurve)
    normals = _points(program, ref, curve.surface_normal)
    if len(contacts) != len(normals):
        counts = f"{counted(len(contacts), 'point')}, but {counted(len(normals), 'normal')}"
        raise program.path_error(counts, ref)
    points = [
        _tip(program, ref, cutter, contact=frame.point(contact), normal=frame.direction(normal))
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
