"""Feed of an explicit tool path: rapid, a factor, or a curve of factors along the way.

ISO 14649-10, ``its_speed``: what is left out comes from the technology of the tool path, else
from that of the operation. A ``toolpath_speed`` is a B-spline of one coordinate, the factor on
the feedrate; its parameter runs evenly along the path.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import ceil, cos, inf, sin

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import SpeedName, ToolpathType
from stepnc_model.entities.toolpaths import Toolpath, ToolpathSpeed
from stepnc_model.errors import PathError
from stepnc_model.part21.values import Ref, Typed
from stepnc_model.program import Program
from stepnc_model.toolpath.path import Feed, Move, MoveType, Point, length
from stepnc_model.toolpath.spline import Spline, spline_of

PIECES = 64
"""pieces of a path along which a curve of factors is sampled, at least"""

TYPES = {
    ToolpathType.APPROACH: MoveType.APPROACH,
    ToolpathType.LIFT: MoveType.RETRACT,
    ToolpathType.CONNECT: MoveType.NO_CONTACT,
    ToolpathType.NON_CONTACT: MoveType.NO_CONTACT,
    ToolpathType.CONTACT: MoveType.CONTACT,
    ToolpathType.TRAJECTORY_PATH: MoveType.CONTACT,
}
"""what the moves of a tool path at feed are for"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pace:
    """How the moves of one tool path run."""

    type: MoveType
    feed: Feed | None
    """None: rapid"""
    factors: Spline | None = None
    """on the feed, along the path"""


def pace_of(program: Program, ref: Ref[Toolpath], technology: Ref[Entity] | None) -> Pace:
    """Pace of a tool path.

    Parameters
    ----------
    program : Program
    ref : Ref
    technology : Ref or None
        Of the operation; None for a rapid movement, where everything is rapid.

    Raises
    ------
    PathError
        When the factor on the feed is not positive.
    """
    path = program.get(ref)
    type = TYPES.get(path.its_type, MoveType.CONTACT)
    speed = path.its_speed
    if technology is None or speed is SpeedName.RAPID:
        is_own = type in {MoveType.APPROACH, MoveType.RETRACT}
        return Pace(type=type if is_own else MoveType.RAPID, feed=None)
    feed = Feed(technology=path.its_technology or technology)
    if speed is None:
        return Pace(type=type, feed=feed)
    if isinstance(speed, Ref):
        entity: Entity = program.get(speed)
        if not isinstance(entity, ToolpathSpeed):
            raise _fault(program, ref, f"{speed} is no speed")
        factors = spline_of(program, entity.speed)
        for factor, *others in factors.poles:
            _check(program, ref, factor)
            if any(others):
                raise _fault(program, ref, "factors on the feed have one coordinate")
        return Pace(type=type, feed=feed, factors=factors)
    value = speed.value if isinstance(speed, Typed) else speed
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise _fault(program, ref, f"{value} is no factor on the feed")
    _check(program, ref, float(value))
    return Pace(type=type, feed=replace(feed, ratio=float(value)))


def paced(start: Point, moves: Sequence[Move], factors: Spline) -> Iterator[Move]:
    """Moves in pieces, each with the factor of its middle.

    Parameters
    ----------
    start : Point
        Where the first move starts.
    moves : sequence of Move
        All of one tool path, at feed.
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
    """A move in pieces of equal length."""
    arc = move.arc and replace(move.arc, turn=move.arc.turn / count)
    for index in range(1, count):
        yield replace(move, end=_point_at(start, move, index / count), arc=arc)
    yield replace(move, arc=arc)


def _point_at(start: Point, move: Move, part: float) -> Point:
    """Point at a part of a line, an arc or a helix."""
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
        raise _fault(program, ref, f"factor {factor:g} on the feed: it must be positive")


def _fault(program: Program, ref: Ref[Entity], message: str) -> PathError:
    return PathError(
        message, entity=program.label(ref), attribute="its_speed", line=program.line(ref)
    )
