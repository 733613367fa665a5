"""Data model of tool paths: lines and arcs by station, each with its purpose.

Types of moves after Shin et al., "Developing a virtual machining model to generate MTConnect
machine-monitoring data from STEP-NC", Int. J. Prod. Res. 54 (2016) 4487-4505, section 3.2.2:
approach, retract, rapid, interpolation in contact and not in contact; each interpolation is
linear or circular. Coordinates are those of the setup, mm; on a lathe x is the radius, y is 0
and z the spindle axis, away from the chuck.

The module also holds NC functions between workingsteps, which a control does besides cutting
(ISO 14649-10), and operations on vectors of three numbers.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

from stepnc_model.entities.entity import Entity
from stepnc_model.errors import Finding
from stepnc_model.part21.values import Ref

Point = tuple[float, float, float]
"""Coordinates x, y, z, mm."""

FARTHEST = 1e5
"""Greatest coordinate accepted, mm; no machine reaches further."""


class MoveType(StrEnum):
    """Purpose of a move in a tool path."""

    APPROACH = "approach"
    """Move to the first cut, down into the material if need be."""
    RETRACT = "retract"
    """Move away from the last cut."""
    RAPID = "rapid"
    """Rapid move between cuts."""
    NO_CONTACT = "no contact"
    """Interpolation through air: overcut, links."""
    CONTACT = "contact"
    """Interpolation that cuts material."""


class ArcPlane(StrEnum):
    """Plane of an arc; counter-clockwise as seen from the tip of its normal."""

    XY = "XY"
    ZX = "ZX"
    YZ = "YZ"

    @property
    def axes(self) -> tuple[int, int, int]:
        """Indices of the first, second and normal axis."""
        return {"XY": (0, 1, 2), "ZX": (2, 0, 1), "YZ": (1, 2, 0)}[self.value]


@dataclass(frozen=True, slots=True, kw_only=True)
class Feed:
    """Feed and spindle speed of a move, by technology, ratios or explicit values."""

    technology: Ref[Entity]
    ratio: float = 1.0
    """Ratio to the programmed feed."""
    speed_ratio: float = 1.0
    """Ratio to the programmed spindle speed."""
    per_revolution: float | None = None
    """Feed per revolution, mm; overrides the programmed feed."""
    velocity: float | None = None
    """Feed, mm/s; overrides the programmed feed."""
    is_synchronised: bool = False
    """Whether the feed is synchronised with the spindle angle, as for threads."""
    is_plunge: bool = False
    """Whether a mill moves down into the material, where another feed may apply."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Arc:
    """Arc of a move about a centre; a helix if it rises along the normal."""

    centre: Point
    """Centre of the arc; its coordinate along the normal of the plane has no meaning."""
    turn: float
    """Angle of the arc, rad, positive counter-clockwise; more than 2π for several turns."""
    plane: ArcPlane = ArcPlane.XY


@dataclass(frozen=True, slots=True, kw_only=True)
class Move:
    """Line or arc that starts where the previous move ended."""

    end: Point
    type: MoveType
    feed: Feed | None = None
    """Feed of the move; None for rapid."""
    arc: Arc | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Dwell:
    """Pause in a tool path, in seconds or in revolutions."""

    seconds: float | None = None
    revolutions: float | None = None


class SpindleCommand(StrEnum):
    """Command to the spindle between moves."""

    START = "start"
    """Start the spindle in the direction of cutting."""
    REVERSE = "reverse"
    STOP = "stop"
    ORIENT = "orient"


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindleSpeedChange:
    """Change of the spindle to a technology's speed, also for following rapid moves."""

    technology: Ref[Entity]


Step = Move | Dwell | SpindleCommand | SpindleSpeedChange


class CycleKind(StrEnum):
    """Kinds of canned cycles that controls offer."""

    DRILL = "drill"
    """Simple drilling: feed in, rapid out."""
    DWELL = "drill with dwell"
    PECK = "peck, full retract"
    CHIP_BREAK = "peck, short retract"
    TAP = "tap"
    BORE = "feed in, feed out"
    BORE_STOP = "feed in, spindle stop, rapid out"


@dataclass(frozen=True, slots=True, kw_only=True)
class CannedCycle:
    """Run of steps that a control can make with a canned cycle."""

    kind: CycleKind
    first: int
    """Index of the first step that the cycle replaces: the feed from the retract plane."""
    last: int
    """Index of the last step: back on the retract plane."""
    retract_z: float
    """Height z of the retract plane, mm."""
    bottom_z: float
    """Height z of the bottom of the hole, mm."""
    feed: Feed
    step_depth: float = 0.0
    """Depth of each peck in drilling, mm."""
    retract_distance: float = 0.0
    """Distance of a short retract, mm."""
    dwell: float = 0.0
    """Dwell at the bottom, s."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolPath:
    """Tool path of one workingstep: from the security plane and back to it."""

    workingstep: Ref[Entity]
    id: str
    """Name of the workingstep (``its_id``)."""
    operation_ref: Ref[Entity]
    tool_ref: Ref[Entity] | None
    """Tool of the path; None for a rapid movement with whatever tool is in the spindle."""
    technology_ref: Ref[Entity] | None
    functions_ref: Ref[Entity] | None
    is_turning: bool
    start: Point
    steps: tuple[Step, ...]
    safe_z: float | None = None
    """Height z at which the tool arrives and leaves, mm; by default that of the start."""
    cycles: tuple[CannedCycle, ...] = ()
    findings: tuple[Finding, ...] = ()
    """Findings about assumptions that were made."""

    def __post_init__(self) -> None:
        for point in (self.start, *(move.end for move in self.moves)):
            x, y, z = point
            if not (abs(x) <= FARTHEST and abs(y) <= FARTHEST and abs(z) <= FARTHEST):
                shown = ", ".join(f"{coordinate:g}" for coordinate in point)
                message = f"is not finite, or lies beyond {FARTHEST:g} mm"
                raise ValueError(f"'{self.id}': position ({shown}) mm {message}")

    @property
    def moves(self) -> tuple[Move, ...]:
        """Moves of the path, without dwells and spindle commands."""
        return tuple(step for step in self.steps if isinstance(step, Move))

    @property
    def end(self) -> Point:
        """End point of the tool path."""
        return next((move.end for move in reversed(self.moves)), self.start)

    def segments(self) -> Iterator[tuple[Point, Move]]:
        """Iterate over the moves with their start points."""
        start = self.start
        for move in self.moves:
            yield start, move
            start = move.end


LEFT_OUT = "LEFT_OUT"
"""Keyword of a placeholder for a missing workingstep; files never contain it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Function:
    """NC function at its place in the program, such as a stop or a message."""

    ref: Ref[Entity]
    keyword: str
    """EXPRESS name in capitals, such as ``OPTIONAL_STOP``."""
    id: str
    text: str = ""
    """Text of a message to the operator."""


def plus(one: Point, other: Point) -> Point:
    """Sum of two vectors."""
    return one[0] + other[0], one[1] + other[1], one[2] + other[2]


def minus(one: Point, other: Point) -> Point:
    """Difference of two vectors."""
    return one[0] - other[0], one[1] - other[1], one[2] - other[2]


def times(vector: Point, factor: float) -> Point:
    """Product of a vector and a number."""
    return vector[0] * factor, vector[1] * factor, vector[2] * factor


def dot(one: Point, other: Point) -> float:
    """Scalar product of two vectors."""
    return sum(a * b for a, b in zip(one, other, strict=True))


def cross(one: Point, other: Point) -> Point:
    """Vector product of two vectors."""
    return (
        one[1] * other[2] - one[2] * other[1],
        one[2] * other[0] - one[0] * other[2],
        one[0] * other[1] - one[1] * other[0],
    )
