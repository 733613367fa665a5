"""A tool path: lines and arcs by station, each with what it is for.

Types of moves after Shin et al., "Developing a virtual machining model to generate MTConnect
machine-monitoring data from STEP-NC", Int. J. Prod. Res. 54 (2016) 4487-4505, section 3.2.2:
approach, retract, rapid, interpolation in contact and not in contact; each interpolation is
linear or circular. Coordinates are those of the setup, mm; on a lathe x is the radius, y is 0
and z the spindle axis, away from the chuck.

NC functions between workingsteps, which a control does besides cutting (ISO 14649-10), are
here too, and vectors of three numbers.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from itertools import accumulate
from math import atan2, cos, dist, hypot, pi, sin

from stepnc_model.entities.entity import Entity
from stepnc_model.errors import Finding
from stepnc_model.part21.values import Ref

Point = tuple[float, float, float]
"""x, y, z in mm"""

FARTHEST = 1e5
"""mm; no machine goes there"""


class MoveType(StrEnum):
    """Purpose of a move."""

    APPROACH = "approach"
    """to the first cut, down into the material if need be"""
    RETRACT = "retract"
    """away from the last cut"""
    RAPID = "rapid"
    """between cuts"""
    NO_CONTACT = "no contact"
    """interpolation through air: overcut, links"""
    CONTACT = "contact"
    """interpolation that cuts"""


class ArcPlane(StrEnum):
    """Plane of an arc; counter-clockwise is seen from the tip of its normal."""

    XY = "XY"
    ZX = "ZX"
    YZ = "YZ"

    @property
    def axes(self) -> tuple[int, int, int]:
        """Indices of the first, second and normal axis."""
        return {"XY": (0, 1, 2), "ZX": (2, 0, 1), "YZ": (1, 2, 0)}[self.value]


@dataclass(frozen=True, slots=True, kw_only=True)
class Feed:
    """At which feed and speed a move runs: those of a technology, or ratios of them."""

    technology: Ref[Entity]
    ratio: float = 1.0
    """Ratio of the programmed feed"""
    speed_ratio: float = 1.0
    """Speed ratio of the programmed spindle speed"""
    per_revolution: float | None = None
    """Per revolution, mm; overrides the programmed feed"""
    velocity: float | None = None
    """Velocity, mm/s; overrides the programmed feed"""
    is_synchronised: bool = False
    """bound to the angle of the spindle: threads"""
    is_plunge: bool = False
    """of a mill's way down into the material, whose feed may be another than that of the cut"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Arc:
    """Arc of a move: about a centre, with a rise along the normal when it is a helix."""

    centre: Point
    """its coordinate along the normal of the plane means nothing"""
    turn: float
    """Turn, rad, positive counter-clockwise; more than 2π for several turns"""
    plane: ArcPlane = ArcPlane.XY


@dataclass(frozen=True, slots=True, kw_only=True)
class Move:
    """One line or arc, from where the last one ended."""

    end: Point
    type: MoveType
    feed: Feed | None = None
    """None: rapid"""
    arc: Arc | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Dwell:
    """Pause; exactly one of the two is given."""

    seconds: float | None = None
    revolutions: float | None = None


class SpindleCommand(StrEnum):
    """Command to the spindle between moves."""

    START = "start"
    """in the direction of cutting"""
    REVERSE = "reverse"
    STOP = "stop"
    ORIENT = "orient"


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindleSpeedChange:
    """The spindle turns as a technology programs it, from here on, also in rapid."""

    technology: Ref[Entity]


Step = Move | Dwell | SpindleCommand | SpindleSpeedChange


class CycleKind(StrEnum):
    """Cycles that controls have of their own."""

    DRILL = "drill"
    """feed in, rapid out"""
    DWELL = "drill with dwell"
    PECK = "peck, full retract"
    CHIP_BREAK = "peck, short retract"
    TAP = "tap"
    BORE = "feed in, feed out"
    BORE_STOP = "feed in, spindle stop, rapid out"


@dataclass(frozen=True, slots=True, kw_only=True)
class CannedCycle:
    """A run of steps that a control can make with one of its own cycles."""

    kind: CycleKind
    first: int
    """index of the first step that the cycle replaces: the feed from the retract plane"""
    last: int
    """index of the last one: back on the retract plane"""
    retract_z: float
    """Retract z, mm, of the retract plane"""
    bottom_z: float
    """Bottom z, mm"""
    feed: Feed
    step_depth: float = 0.0
    """Step depth, mm of each peck"""
    retract_distance: float = 0.0
    """Retract distance, mm of a short retract"""
    dwell: float = 0.0
    """Dwell, s at the bottom"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolPath:
    """Tool path of one workingstep: from the security plane and back to it."""

    workingstep: Ref[Entity]
    id: str
    """Id of the workingstep"""
    operation_ref: Ref[Entity]
    tool_ref: Ref[Entity] | None
    """None: a rapid movement with whatever tool there is"""
    technology_ref: Ref[Entity] | None
    functions_ref: Ref[Entity] | None
    is_turning: bool
    start: Point
    steps: tuple[Step, ...]
    safe_z: float | None = None
    """height over which the tool comes and goes; that of the start unless given"""
    cycles: tuple[CannedCycle, ...] = ()
    findings: tuple[Finding, ...] = ()
    """what was assumed"""

    def __post_init__(self) -> None:
        for point in (self.start, *(move.end for move in self.moves)):
            x, y, z = point
            if not (abs(x) <= FARTHEST and abs(y) <= FARTHEST and abs(z) <= FARTHEST):
                shown = ", ".join(f"{coordinate:g}" for coordinate in point)
                message = f"is not finite, or lies beyond {FARTHEST:g} mm"
                raise ValueError(f"'{self.id}': position ({shown}) mm {message}")

    @property
    def moves(self) -> tuple[Move, ...]:
        """The moves without the pauses between them."""
        return tuple(step for step in self.steps if isinstance(step, Move))

    @property
    def end(self) -> Point:
        """End of the path."""
        return next((move.end for move in reversed(self.moves)), self.start)

    def segments(self) -> Iterator[tuple[Point, Move]]:
        """Each move with the point where it starts."""
        start = self.start
        for move in self.moves:
            yield start, move
            start = move.end

    def stations(self) -> tuple[float, ...]:
        """Arc length in mm from the start to the end of each move."""
        return tuple(accumulate(length(start, move) for start, move in self.segments()))


def length(start: Point, move: Move) -> float:
    """Length of one move, mm."""
    if move.arc is None:
        return dist(start, move.end)
    normal = move.arc.plane.axes[2]
    return hypot(radius(start, move.arc) * move.arc.turn, move.end[normal] - start[normal])


def radius(start: Point, arc: Arc) -> float:
    """Radius of an arc, mm."""
    first, second, _ = arc.plane.axes
    return hypot(start[first] - arc.centre[first], start[second] - arc.centre[second])


def points_along(start: Point, move: Move, *, step: float) -> Iterator[Point]:
    """Points on a move after its start, the last one its end.

    Parameters
    ----------
    start : Point
    move : Move
    step : float, rad
        Greatest angle between two points of an arc.
    """
    if move.arc is not None:
        first, second, normal = move.arc.plane.axes
        centre = move.arc.centre
        size = radius(start, move.arc)
        angle = atan2(start[second] - centre[second], start[first] - centre[first])
        rise = move.end[normal] - start[normal]
        count = max(1, int(abs(move.arc.turn) / min(step, pi)) + 1)
        for index in range(1, count):
            part = index / count
            turned = angle + part * move.arc.turn
            point = [0.0, 0.0, 0.0]
            point[first] = centre[first] + size * cos(turned)
            point[second] = centre[second] + size * sin(turned)
            point[normal] = start[normal] + part * rise
            yield point[0], point[1], point[2]
    yield move.end


LEFT_OUT = "LEFT_OUT"
"""keyword that no file has: here a workingstep is missing"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Function:
    """One NC function in the order of the program."""

    ref: Ref[Entity]
    keyword: str
    """EXPRESS name in capitals, ``OPTIONAL_STOP``"""
    id: str
    text: str = ""
    """Text of a message"""


def plus(one: Point, other: Point) -> Point:
    """Sum of two vectors."""
    return one[0] + other[0], one[1] + other[1], one[2] + other[2]


def minus(one: Point, other: Point) -> Point:
    """Difference of two vectors."""
    return one[0] - other[0], one[1] - other[1], one[2] - other[2]


def times(vector: Point, factor: float) -> Point:
    """Vector times a number."""
    return vector[0] * factor, vector[1] * factor, vector[2] * factor


def dot(one: Point, other: Point) -> float:
    """Scalar product."""
    return sum(a * b for a, b in zip(one, other, strict=True))


def cross(one: Point, other: Point) -> Point:
    """Vector product."""
    return (
        one[1] * other[2] - one[2] * other[1],
        one[2] * other[0] - one[0] * other[2],
        one[0] * other[1] - one[1] * other[0],
    )
