"""Builder of explicit tool paths; keeps running state, one object per path.

Some approach and lift paths are given by a few parameters (ISO 14649-10):

* ``ap_lift_path_angle``: from the fixed point straight to the bend, ``benddist`` before the
  cut, and from there down onto its tangent at ``angle`` to it;
* ``ap_lift_path_tangent``: from the fixed point straight onto an arc of ``radius`` that runs
  tangentially into the cut, in the plane of both.

A lift is an approach run backwards. The standard only draws the two paths; the above is how
they are interpreted here.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import atan2, cos, dist, inf, pi, sin, sqrt

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import ToolpathType
from stepnc_model.entities.operations import (
    ApLiftPathAngle,
    ApLiftPathTangent,
    ApproachLiftPath,
    ConnectDirect,
    ConnectSecplane,
    Feedstop,
    Toolpath,
    Trajectory,
)
from stepnc_model.errors import Finding, SchemaError, Severity
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program, Stock
from stepnc_model.programs.tool import Tool
from stepnc_model.toolpath.arc import points_along
from stepnc_model.toolpath.curve import Bend, Segment, move_of
from stepnc_model.toolpath.explicit.trajectory import (
    MoveSpeeds,
    pace_of,
    paced,
    trajectory_segments,
)
from stepnc_model.toolpath.frame import Frame, direction_of, point_of
from stepnc_model.toolpath.path import (
    Dwell,
    Feed,
    Move,
    MoveType,
    Point,
    SpindleSpeedChange,
    Step,
    cross,
    dot,
    minus,
    plus,
    times,
)
from stepnc_model.toolpath.task import DEFAULT_CLEARANCE
from stepnc_model.units import rad_from_deg

NO_LENGTH = 1e-9
"""Length below which a segment is dropped, mm."""

LEAST_RISE = 1e-3
"""Least z component of a unit direction that leads to a security plane."""


def approach_segments(
    program: Program, ref: Ref[ApproachLiftPath], *, frame: Frame, cut: Segment
) -> tuple[Segment, ...]:
    """Approach from the fixed point to the start of a cut.

    Parameters
    ----------
    frame : Frame
        Frame in which the fixed point is given.
    cut : Segment
        First segment of the cut, in the setup.

    Raises
    ------
    PathError
        If there is no such path.
    """
    start, tangent = cut.start, _tangent(cut)
    path = program.get(ref)
    fix = frame.point(point_of(program, path.fix_point))
    if isinstance(path, ApLiftPathAngle):
        angle = rad_from_deg(path.angle)
        along = minus(times(tangent, cos(angle)), (0.0, 0.0, sin(angle)))
        bend = minus(start, times(along, path.benddist))
        points = [fix, bend, start]
        return tuple(
            Segment(start=a, end=b) for a, b in pairwise(points) if dist(a, b) > NO_LENGTH
        )
    if isinstance(path, ApLiftPathTangent):
        return _onto_arc(program, ref, path.radius, fix, start=start, tangent=tangent)
    raise program.path_error("this kind of approach is not supported", ref)


def lift_segments(
    program: Program, ref: Ref[ApproachLiftPath], *, frame: Frame, cut: Segment
) -> tuple[Segment, ...]:
    """Lift from the end of a cut, given by its last segment, to the fixed point."""
    back = approach_segments(program, ref, frame=frame, cut=cut.reversed())
    return tuple(segment.reversed() for segment in reversed(back))


def point_on_plane(
    program: Program, at: Point, direction: Ref[Entity] | None, *, frame: Frame, height: float
) -> Point:
    """Point of the security plane reached in a direction; straight up if none is given.

    Raises
    ------
    PathError
        If the direction does not lead to the plane.
    """
    if direction is None:
        return at[0], at[1], height
    along = frame.direction(direction_of(program, direction))
    if abs(along[2]) < LEAST_RISE:
        raise program.path_error(
            "the direction is level: it does not reach the security plane", direction
        )
    part = (height - at[2]) / along[2]
    return at[0] + part * along[0], at[1] + part * along[1], height


def _tangent(segment: Segment) -> Point:
    """Unit tangent at the start of a segment, without the rise of a helix."""
    bend = segment.bend
    if bend is None:
        return _unit(minus(segment.end, segment.start))
    towards = cross(bend.normal, minus(segment.start, bend.centre))
    return _unit(towards if bend.turn > 0.0 else times(towards, -1.0))


def _onto_arc(
    program: Program,
    ref: Ref[Entity],
    radius: float,
    fix: Point,
    *,
    start: Point,
    tangent: Point,
) -> tuple[Segment, ...]:
    """Line and arc from a point that run tangentially into each other and into the cut."""
    away = minus(fix, start)
    forward = dot(away, tangent)
    aside = minus(away, times(tangent, forward))
    height = sqrt(dot(aside, aside))
    if not radius > 0.0 or height < NO_LENGTH:
        message = "the fixed point lies on the tangent of the cut: no arc is possible"
        raise program.path_error(message, ref)
    across = times(aside, 1.0 / height)
    # In the plane of tangent (u) and across (v) the centre is (0, radius).
    u, v = forward, height - radius
    reach = u * u + v * v - radius * radius
    if reach < 0.0:
        message = f"the fixed point lies within the arc of radius {radius:g} mm"
        raise program.path_error(message, ref)
    at = atan2(v, u) + atan2(sqrt(reach), radius)
    turn = (-0.5 * pi - at) % (2.0 * pi)
    centre = plus(start, times(across, radius))
    touch = plus(
        centre,
        plus(times(tangent, radius * cos(at)), times(across, radius * sin(at))),
    )
    bend = Bend(centre=centre, normal=cross(tangent, across), turn=turn)
    line = Segment(start=fix, end=touch)
    arc = Segment(start=touch, end=start, bend=bend)
    return (line, arc) if dist(fix, touch) > NO_LENGTH else (arc,)


def _unit(vector: Point) -> Point:
    return times(vector, 1.0 / dist(vector, (0.0, 0.0, 0.0)))


SHORT_GAP = 1.0
"""Greatest gap between two trajectories that a straight move bridges, mm."""

SAME = 1e-6
"""Distance below which two points are the same, mm."""

RAPID_CHORD = 0.05
"""Angle of an arc replaced by one chord in rapid, rad; controls have no rapid arcs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PathSurroundings:
    """Inputs of an explicit path: program, security plane, stock, tool and technology."""

    program: Program
    security_z: float
    """Height z of the security plane, mm."""
    stock: Stock | None
    tool: Callable[[], Tool] | None
    """Tool, read where it is needed; None if everything is rapid."""
    technology: Ref[Entity] | None
    """Technology of the operation; None if everything is rapid."""
    functions: Ref[Entity] | None = None
    """Machine functions of the operation."""
    alike: tuple[Ref[Entity], ...] = ()
    """Technologies for which that of the operation stands."""


class ExplicitPathBuilder:
    """Collect the steps of explicit tool paths and track the tool position."""

    def __init__(self, around: PathSurroundings) -> None:
        self._around = around
        self._last: Segment | None = None
        self.start: Point | None = None
        """Start point of the path."""
        self.at: Point | None = None
        """Current position of the tool."""
        self.steps: list[Step] = []
        self.findings: list[Finding] = []

    def follow(self, paths: Sequence[Ref[Toolpath]], frame: Frame) -> None:
        """Append tool paths that are given in a frame."""
        for index, ref in enumerate(paths):
            with self._around.program.using(ref):
                self._follow(ref, paths[index + 1 :], frame)

    def _follow(self, ref: Ref[Toolpath], rest: Sequence[Ref[Toolpath]], frame: Frame) -> None:
        """Append one tool path; the following paths define where a connector leads."""
        program = self._around.program
        path = program.get(ref)
        if not isinstance(path, Toolpath):
            raise program.error("is not a tool path, where one is expected", ref)
        pace = self._pace(ref)
        if path.its_machine_functions not in (None, self._around.functions):
            self._note("machine functions of a single tool path are ignored", ref)
        if pace.feed is None and path.its_technology is not None:
            # Tools that fold open by the direction of rotation depend on the spindle here.
            self.steps.append(SpindleSpeedChange(technology=path.its_technology))
        if isinstance(path, Trajectory):
            segments = self._segments(Ref(ref), frame)
            if not segments:
                self._note("the trajectory has no length: left out", ref)
            self._trace(segments, pace)
        elif isinstance(path, Feedstop):
            self._pause(ref, path)
        elif isinstance(path, ConnectSecplane):
            self._over(path, self._next(rest, frame), frame)
        elif isinstance(path, ConnectDirect):
            self._straight(self._next(rest, frame), pace)
        elif isinstance(path, ApproachLiftPath):
            self._approach_or_lift(ref, path, self._next(rest, frame), frame)
        else:
            raise program.path_error("this kind of tool path is not supported", ref)

    def _pace(self, ref: Ref[Toolpath]) -> MoveSpeeds:
        """Move type and feed of a tool path."""
        around = self._around
        return pace_of(around.program, ref, around.technology, around.alike)

    def _segments(self, ref: Ref[Trajectory], frame: Frame) -> tuple[Segment, ...]:
        """Segments of a trajectory."""
        return trajectory_segments(
            self._around.program, ref, frame=frame, tool=self._around.tool, at=self.at
        )

    def _next(self, rest: Sequence[Ref[Toolpath]], frame: Frame) -> Segment | None:
        """First segment of the following trajectory, or None."""
        for ref in rest:
            if isinstance(self._around.program.get(ref), Trajectory):
                return next(iter(self._segments(Ref(ref), frame)), None)
        return None

    def _trace(self, segments: Sequence[Segment], pace: MoveSpeeds) -> None:
        """Follow segments, moving to their start first."""
        if not segments:
            return
        self._join(segments[0].start, is_rapid=pace.feed is None)
        first = segments[0].start
        moves = [move for each in segments for move in _moves(each, pace)]
        if pace.factors is not None and pace.feed is not None:
            moves = list(paced(first, moves, pace.factors))
        self._add(moves)
        self._last = segments[-1]

    def _pause(self, ref: Ref[Entity], path: Feedstop) -> None:
        """Append a dwell."""
        if not 0.0 < path.dwell < inf:
            message = f"dwell {path.dwell:g} s must be positive"
            raise self._around.program.path_error(message, ref)
        self.steps.append(Dwell(seconds=path.dwell))

    def _join(self, target: Point, *, is_rapid: bool) -> None:
        """Move to the start of the next trajectory, straight or over the security plane.

        Where the next one is rapid, no material is at its start.
        """
        if self.at is None:
            self.start = self.at = target
            return
        gap = dist(self.at, target)
        if gap <= SAME:
            return
        if gap <= SHORT_GAP:
            self._add([Move(end=target, type=MoveType.NO_CONTACT, feed=self._feed)])
            return
        self._rise((self.at[0], self.at[1], self._around.security_z))
        above = (target[0], target[1], self._around.security_z)
        if is_rapid:
            self._add([
                Move(end=(*above[:2], max(above[2], self.at[2])), type=MoveType.RAPID),
                Move(end=target, type=MoveType.RAPID),
            ])
            return
        self._down(above, target)

    def _over(self, path: ConnectSecplane, following: Segment | None, frame: Frame) -> None:
        """Move up to the security plane, over, and down."""
        program, height = self._around.program, self._around.security_z
        if self.at is not None:
            up = point_on_plane(program, self.at, path.up_dir, frame=frame, height=height)
            self._rise(up)
        if following is not None:
            target = following.start
            above = point_on_plane(program, target, path.down_dir, frame=frame, height=height)
            if self.at is None:
                self.start = self.at = above
            self._down(above, target)

    def _straight(self, following: Segment | None, pace: MoveSpeeds) -> None:
        """Move straight to the next trajectory."""
        if following is not None and self.at is not None:
            self._add([Move(end=following.start, type=pace.type, feed=pace.feed)])

    def _approach_or_lift(
        self,
        ref: Ref[Toolpath],
        path: ApproachLiftPath,
        following: Segment | None,
        frame: Frame,
    ) -> None:
        """Move to the next cut, or away from the last one, by the type of the path."""
        program = self._around.program
        pace = self._pace(ref)
        cut = self._last if path.its_type is ToolpathType.LIFT else following
        if cut is None:
            raise program.path_error("there is no trajectory to approach or leave", ref)
        make = lift_segments if path.its_type is ToolpathType.LIFT else approach_segments
        self._trace(make(program, Ref(ref), frame=frame, cut=cut), pace)

    @property
    def _feed(self) -> Feed | None:
        """Programmed feed; None if everything is rapid."""
        technology = self._around.technology
        return None if technology is None else Feed(technology=technology)

    def _rise(self, end: Point) -> None:
        """Move up in rapid unless the tool is already as high."""
        if self.at is not None and self.at[2] < end[2]:
            self._add([Move(end=end, type=MoveType.RETRACT)])

    def _down(self, above: Point, target: Point) -> None:
        """Move over in rapid, then down: in rapid where no stock can be, else at feed."""
        height = max(above[2], self.at[2] if self.at is not None else above[2])
        self._add([Move(end=(above[0], above[1], height), type=MoveType.RAPID)])
        if self._is_clear(target):
            self._add([Move(end=target, type=MoveType.RAPID)])
            return
        stock = self._around.stock
        if (
            stock is not None
            and above[2] > (z := stock.high[2] + DEFAULT_CLEARANCE) > target[2]
        ):
            part = (z - target[2]) / (above[2] - target[2])
            near = tuple(t + part * (a - t) for a, t in zip(above, target, strict=True))
            self._add([Move(end=(near[0], near[1], z), type=MoveType.RAPID)])
        self._add([Move(end=target, type=MoveType.APPROACH, feed=self._feed)])

    def _is_clear(self, target: Point) -> bool:
        """True if a tool at a point stands beside or above the raw part."""
        stock, tool = self._around.stock, self._around.tool
        if stock is None:
            return False
        if target[2] >= stock.high[2]:
            return True
        try:
            radius = 0.0 if tool is None else 0.5 * tool().diameter
        except SchemaError:
            return False
        return any(
            target[axis] + radius <= stock.low[axis]
            or target[axis] - radius >= stock.high[axis]
            for axis in (0, 1)
        )

    def _add(self, moves: Iterable[Move]) -> None:
        """Append moves, replacing rapid arcs by chords."""
        for move in moves:
            for part in _without_rapid_arcs(self.at or move.end, move):
                if part.arc is not None or self.at is None or dist(self.at, part.end) > SAME:
                    self.steps.append(part)
                    self.at = part.end

    def _note(self, text: str, ref: Ref[Entity]) -> None:
        finding = self._around.program.finding(Severity.NOTE, text, ref)
        if finding not in self.findings:
            self.findings.append(finding)


def _moves(segment: Segment, pace: MoveSpeeds) -> Iterator[Move]:
    return move_of(segment, pace.type, pace.feed)


def _without_rapid_arcs(start: Point, move: Move) -> Iterator[Move]:
    """Split a rapid arc into chords; yield other moves unchanged."""
    if move.arc is None or move.feed is not None:
        yield move
        return
    for point in points_along(start, move, step=RAPID_CHORD):
        yield replace(move, end=point, arc=None)
