"""Curves of the file as chains of lines and circular arcs in space.

ISO 10303-42: polylines, composite and trimmed curves, circles, lines, Bezier curves and
B-splines, and the helix of NIST's ``ex1E.stp``. Circles remain arcs; ellipses, Bezier curves
and B-splines become chords within ``CHORD_TOLERANCE``.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import atan2, ceil, cos, dist, pi, sin

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import TrimmingPreference
from stepnc_model.entities.geometry import (
    BSplineCurve,
    Circle,
    CompositeCurve,
    Ellipse,
    Helix,
    Line,
    Polyline,
    TrimmedCurve,
)
from stepnc_model.part21.values import Ref, Typed
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.arc import chord_angle
from stepnc_model.toolpath.frame import Frame, direction_of, frame_of, point_of
from stepnc_model.toolpath.path import Arc, ArcPlane, Feed, Move, MoveType, Point
from stepnc_model.toolpath.spline import spline_of
from stepnc_model.units import rad_from_deg

CHORD_TOLERANCE = 1e-3
"""Greatest distance between a curve and the chords that replace it, mm."""

JOINED = 1e-2
"""Greatest gap between two curves of a chain that is accepted, mm."""

ON_CIRCLE = 1e-2
"""Greatest distance of a trimming point from its circle, mm."""

MOST_CHORDS = 4096

MOST_NESTED = 20
"""Greatest nesting depth of curves within curves."""

MOST_CURVES = 20_000
"""Greatest number of curves that one curve may consist of."""

MOST_TURNS = 10_000
"""Greatest number of turns of a helix."""

PRINCIPAL = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Bend:
    """Circular arc or helix in space."""

    centre: Point
    normal: Point
    """Unit normal; counter-clockwise is seen from its tip."""
    turn: float
    """Angle of the arc, rad."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Segment:
    """Line in space, or an arc if it has a bend."""

    start: Point
    end: Point
    bend: Bend | None = None

    def reversed(self) -> "Segment":
        """Segment traversed in the opposite direction."""
        bend = replace(self.bend, turn=-self.bend.turn) if self.bend else None
        return Segment(start=self.end, end=self.start, bend=bend)

    def within(self, frame: Frame) -> "Segment":
        """Convert a segment from a frame to the surrounding coordinates."""
        bend = self.bend and Bend(
            centre=frame.point(self.bend.centre),
            normal=frame.direction(self.bend.normal),
            turn=self.bend.turn,
        )
        return Segment(start=frame.point(self.start), end=frame.point(self.end), bend=bend)


def segments_of(program: Program, ref: Ref[Entity]) -> tuple[Segment, ...]:
    """Lines and arcs of a bounded curve, in its direction.

    Raises
    ------
    PathError
        If the kind of curve is not supported, it has no length, or its parts do not join.
    """
    segments = path_segments(program, ref)
    if not segments:
        raise program.path_error("the curve has no length", ref)
    return segments


def path_segments(program: Program, ref: Ref[Entity]) -> tuple[Segment, ...]:
    """Lines and arcs of a curve that a tool follows, in its direction; none without length.

    Raises
    ------
    PathError
        If the kind of curve is not supported, or its parts do not join.
    """
    with program.using(ref):
        budget = iter(range(MOST_CURVES))
        found = _segments(program, ref, _CurveVisit(budget))
        segments = tuple(segment for segment in found if not _is_point(segment))
    for one, other in pairwise(segments):
        gap = dist(one.end, other.start)
        if gap > JOINED:
            raise program.path_error(
                f"the parts of the curve do not join: gap of {gap:.4g} mm", ref
            )
    return segments


def move_of(segment: Segment, type: MoveType, feed: Feed | None) -> Iterator[Move]:
    """Moves along a segment: one, or chords if its plane is not a principal plane."""
    bend = segment.bend
    if bend is None:
        yield Move(end=segment.end, type=type, feed=feed)
        return
    for plane in ArcPlane:
        along = bend.normal[plane.axes[2]]
        if abs(abs(along) - 1.0) < PRINCIPAL:
            turn = bend.turn if along > 0.0 else -bend.turn
            arc = Arc(centre=bend.centre, turn=turn, plane=plane)
            yield Move(end=segment.end, type=type, feed=feed, arc=arc)
            return
    for point in _bend_points(segment, bend):
        yield Move(end=point, type=type, feed=feed)


@dataclass(frozen=True, slots=True)
class _CurveVisit:
    """Nesting level of a curve, and the remaining number of curves."""

    budget: Iterator[int]
    level: int = 0

    def inner(self) -> "_CurveVisit":
        return _CurveVisit(self.budget, self.level + 1)


def _segments(program: Program, ref: Ref[Entity], visit: _CurveVisit) -> Iterator[Segment]:
    """Lines and arcs of a curve of any supported kind."""
    if visit.level > MOST_NESTED or next(visit.budget, None) is None:
        message = f"contains itself, or nests over {MOST_NESTED} levels or {MOST_CURVES} curves"
        raise program.path_error(message, ref)
    curve = program.get(ref)
    if isinstance(curve, Polyline):
        points = [point_of(program, point) for point in curve.points]
        yield from (Segment(start=a, end=b) for a, b in pairwise(points))
    elif isinstance(curve, CompositeCurve):
        for each in map(program.get, curve.segments):
            inner = tuple(_segments(program, each.parent_curve, visit.inner()))
            yield from inner if each.same_sense is not False else _backwards(inner)
    elif isinstance(curve, TrimmedCurve):
        yield from _trimmed(program, ref, curve, visit)
    elif isinstance(curve, BSplineCurve):
        yield from _spline(program, ref)
    elif isinstance(curve, (Circle, Ellipse)):
        if isinstance(curve, Circle) and not curve.radius > 0.0:
            raise program.path_error(f"radius {curve.radius:g} mm must be positive", ref)
        yield from _conic(program, curve, 0.0, 2.0 * pi)
    else:
        raise program.path_error("this kind of curve is not supported", ref)


def _backwards(segments: Sequence[Segment]) -> Iterator[Segment]:
    return (segment.reversed() for segment in reversed(segments))


def _trimmed(
    program: Program, ref: Ref[Entity], curve: TrimmedCurve, visit: _CurveVisit
) -> Iterator[Segment]:
    """Lines and arcs of a trimmed line, circle, ellipse, helix or bounded curve."""
    basis = program.get(curve.basis_curve)
    sense = curve.sense_agreement is not False
    if isinstance(basis, Line):
        start, end = (_line_point(program, ref, curve, basis, t) for t in _trims(curve))
        yield Segment(start=start, end=end)
    elif isinstance(basis, (Circle, Ellipse, Helix)):
        frame = frame_of(program, basis.position)
        first, second = (
            _angle(program, ref, curve, basis, frame, trims) for trims in _trims(curve)
        )
        if isinstance(basis, Helix):
            yield from _helix(program, ref, curve, basis, frame)
            return
        turn = (second - first) % (2.0 * pi) if sense else -((first - second) % (2.0 * pi))
        if abs(turn) < PRINCIPAL or 2.0 * pi - abs(turn) < PRINCIPAL:
            turn = 2.0 * pi if sense else -2.0 * pi
        segments = tuple(_conic(program, basis, first, turn))
        yield from _exact_ends(program, curve, segments)
    elif isinstance(basis, (Polyline, CompositeCurve, BSplineCurve)):
        # A bounded curve that is trimmed at its own ends.
        inner = tuple(_segments(program, curve.basis_curve, visit.inner()))
        yield from inner if sense else _backwards(inner)
    else:
        raise program.path_error("this kind of curve cannot be trimmed", ref)


def _trims(curve: TrimmedCurve) -> tuple[tuple[object, ...], tuple[object, ...]]:
    return tuple(curve.trim_1), tuple(curve.trim_2)


def _cartesian(
    program: Program, curve: TrimmedCurve, trims: tuple[object, ...]
) -> Point | None:
    """Trimming point, unless the parameter is preferred and given."""
    points = [trim for trim in trims if isinstance(trim, Ref)]
    is_other = len(points) < len(trims)
    if points and not (
        is_other and curve.master_representation is TrimmingPreference.PARAMETER
    ):
        return point_of(program, points[0])
    return None


def _parameter(program: Program, ref: Ref[Entity], trims: tuple[object, ...]) -> float:
    for trim in trims:
        value = trim.value if isinstance(trim, Typed) else trim
        if isinstance(value, (int, float)):
            return float(value)
    raise program.path_error("the curve is trimmed by neither a point nor a parameter", ref)


def _line_point(
    program: Program,
    ref: Ref[Entity],
    curve: TrimmedCurve,
    line: Line,
    trims: tuple[object, ...],
) -> Point:
    point = _cartesian(program, curve, trims)
    if point is not None:
        return point
    at = _parameter(program, ref, trims)
    vector = program.get(line.dir)
    origin, along = (
        point_of(program, line.pnt),
        direction_of(program, vector.orientation),
    )
    a, b, c = (o + at * vector.magnitude * d for o, d in zip(origin, along, strict=True))
    return a, b, c


def _angle(
    program: Program,
    ref: Ref[Entity],
    curve: TrimmedCurve,
    basis: Circle | Ellipse | Helix,
    frame: Frame,
    trims: tuple[object, ...],
) -> float:
    """Parameter of a trim, rad; parameters in the file are in degrees."""
    point = _cartesian(program, curve, trims)
    if point is None:
        return rad_from_deg(_parameter(program, ref, trims))
    a, b, beside = local(frame, point)
    if isinstance(basis, Ellipse):
        return atan2(b / basis.semi_axis_2, a / basis.semi_axis_1)
    off = abs(dist((a, b), (0.0, 0.0)) - basis.radius)
    if not isinstance(basis, Helix):
        off = max(off, abs(beside))
    if off > ON_CIRCLE:
        raise program.path_error(f"a trimming point lies {off:.4g} mm off its circle", ref)
    return atan2(b, a)


def local(frame: Frame, point: Point) -> Point:
    """Coordinates of a point in a frame."""
    from_origin = tuple(p - o for p, o in zip(point, frame.origin, strict=True))
    a, b, c = (
        sum(f * d for f, d in zip(from_origin, axis, strict=True))
        for axis in (frame.x, frame.y, frame.z)
    )
    return a, b, c


def _exact_ends(
    program: Program, curve: TrimmedCurve, segments: tuple[Segment, ...]
) -> Iterator[Segment]:
    """Segments that start and end exactly at the trimming points of the file."""
    start = _cartesian(program, curve, tuple(curve.trim_1))
    end = _cartesian(program, curve, tuple(curve.trim_2))
    last = len(segments) - 1
    for index, segment in enumerate(segments):
        yield replace(
            segment,
            start=start if index == 0 and start is not None else segment.start,
            end=end if index == last and end is not None else segment.end,
        )


def _conic(
    program: Program, conic: Circle | Ellipse, first: float, turn: float
) -> Iterator[Segment]:
    """Arc of a circle, or chords of an ellipse, from an angle through a turn."""
    frame = frame_of(program, conic.position)
    if isinstance(conic, Circle):
        ends = [
            frame.point((conic.radius * cos(at), conic.radius * sin(at), 0.0))
            for at in (first, first + turn)
        ]
        bend = Bend(centre=frame.origin, normal=frame.z, turn=turn)
        yield Segment(start=ends[0], end=ends[1], bend=bend)
        return
    yield from _chords(
        lambda at: frame.point((conic.semi_axis_1 * cos(at), conic.semi_axis_2 * sin(at), 0.0)),
        first,
        first + turn,
    )


def _helix(
    program: Program,
    ref: Ref[Entity],
    curve: TrimmedCurve,
    helix: Helix,
    frame: Frame,
) -> Iterator[Segment]:
    """Part of a right-hand helix between two points; rise and pitch give the turns."""
    ends = [_cartesian(program, curve, trims) for trims in _trims(curve)]
    if ends[0] is None or ends[1] is None or not helix.pitch:
        raise program.path_error("a helix needs a pitch and two trimming points", ref)
    start, end = local(frame, ends[0]), local(frame, ends[1])
    first, second = atan2(start[1], start[0]), atan2(end[1], end[0])
    rise = end[2] - start[2]
    # Files round the pitch: it gives the whole turns, the points give the rest.
    whole = 2.0 * pi * rise / helix.pitch
    rest = (second - first) % (2.0 * pi)
    turn = rest + 2.0 * pi * round((whole - rest) / (2.0 * pi))
    if not abs(turn) <= MOST_TURNS * 2.0 * pi:
        message = f"a pitch of {helix.pitch:g} mm gives more than {MOST_TURNS} turns"
        raise program.path_error(message, ref)
    bend = Bend(centre=frame.origin, normal=frame.z, turn=turn)
    yield Segment(start=ends[0], end=ends[1], bend=bend)


def _spline(program: Program, ref: Ref[Entity]) -> Iterator[Segment]:
    """Chords of a B-spline curve."""
    spline = spline_of(program, ref)
    for low, high in pairwise(spline.spans):
        yield from _chords(spline.at, low, high)


def _chords(curve: Callable[[float], Point], low: float, high: float) -> Iterator[Segment]:
    """Equal-parameter chords within the tolerance; their number is doubled until they fit."""
    count = 4
    while count < MOST_CHORDS:
        ends = [curve(low + (high - low) * i / count) for i in range(count + 1)]
        middles = [curve(low + (high - low) * (i + 0.5) / count) for i in range(count)]
        if all(
            dist(middle, tuple(0.5 * (p + q) for p, q in zip(a, b, strict=True)))
            <= CHORD_TOLERANCE
            for middle, (a, b) in zip(middles, pairwise(ends), strict=True)
        ):
            break
        count *= 2
    yield from (Segment(start=a, end=b) for a, b in pairwise(ends))


def _bend_points(segment: Segment, bend: Bend) -> Iterator[Point]:
    """Points of an arc in any plane, after its start."""
    towards = tuple(s - c for s, c in zip(segment.start, bend.centre, strict=True))
    n = bend.normal
    along = sum(t * c for t, c in zip(towards, n, strict=True))
    x = tuple(t - along * c for t, c in zip(towards, n, strict=True))
    y = (n[1] * x[2] - n[2] * x[1], n[2] * x[0] - n[0] * x[2], n[0] * x[1] - n[1] * x[0])
    size = dist(x, (0.0, 0.0, 0.0))
    rise = sum((e - s) * c for e, s, c in zip(segment.end, segment.start, n, strict=True))
    step = chord_angle(size, CHORD_TOLERANCE)
    count = min(MOST_CHORDS, max(2, ceil(abs(bend.turn) / step)))
    for i in range(1, count):
        part = i / count
        a, b = cos(part * bend.turn), sin(part * bend.turn)
        lift = along + part * rise
        p, q, r = (
            c + a * u + b * v + lift * w
            for c, u, v, w in zip(bend.centre, x, y, n, strict=True)
        )
        yield p, q, r
    yield segment.end


def _is_point(segment: Segment) -> bool:
    """True if a segment has no length, as files leave between their curves."""
    return segment.start == segment.end and segment.bend is None
