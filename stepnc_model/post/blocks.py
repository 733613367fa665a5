"""Neutral blocks: what an NC program says, before any control spells it.

Numbers are resolved: mm, mm/s, mm/rev, rev/s, s, rad. Coordinates are those of the tool path;
on a lathe x is a radius.

Drilling cycles are taken apart for controls that lack one, and for readers. Motion after
LinuxCNC, "G-Code reference", G73 and G81 to G86; controls differ in the distance that they keep
above the last depth, which is an argument here.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import StrEnum

from stepnc_model.errors import PostError
from stepnc_model.toolpath.path import ArcPlane, CycleKind, Point


class MachineType(StrEnum):
    """Type of machine that a program is for."""

    MILL = "mill"
    LATHE = "lathe"


class Cycles(StrEnum):
    """Form in which drilling cycles are written."""

    EXPANDED = "expanded"
    """as lines"""
    OWN = "own"
    """as cycles of the control, where it has them"""


class RateMode(StrEnum):
    """Reference of a feed: per minute, per revolution, inverse time."""

    PER_MINUTE = "per minute"
    """of time; inside in mm/s"""
    PER_REVOLUTION = "per revolution"
    """of the spindle, mm"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rate:
    """A feed with its mode."""

    value: float
    """Value, mm/s or mm/rev"""
    mode: RateMode = RateMode.PER_MINUTE


class SpindleDirection(StrEnum):
    """Sense of the spindle, as canonical commands name it.

    M3, clockwise, drives a right-hand screw into the workpiece (EIA RS-274-D). A mill turns
    its tool so, negative about z; a lathe turns its workpiece the other way for the same
    effect, positive about z.
    """

    CLOCKWISE = "clockwise"
    COUNTERCLOCKWISE = "counterclockwise"

    @property
    def opposite(self) -> "SpindleDirection":
        """The other one."""
        return (
            SpindleDirection.COUNTERCLOCKWISE
            if self is SpindleDirection.CLOCKWISE
            else SpindleDirection.CLOCKWISE
        )


class CoolantKind(StrEnum):
    """Ways of cooling."""

    FLOOD = "flood"
    MIST = "mist"
    THROUGH = "through"
    """through the tool"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramStart:
    """Head of a program."""

    name: str
    machine: MachineType = MachineType.MILL


@dataclass(frozen=True, slots=True, kw_only=True)
class Comment:
    """Remark for the reader."""

    text: str
    workingstep: str = ""
    """id of the workingstep that begins here"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Message:
    """Text on the screen, or a comment where a control has none."""

    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolChange:
    """Tool into the spindle, with its length offset."""

    number: int
    id: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindleOn:
    """Spindle on at constant speed."""

    speed: float
    """Speed, rev/s"""
    sense: SpindleDirection = SpindleDirection.CLOCKWISE


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceSpeed:
    """Spindle on at constant surface speed."""

    speed: float
    """Speed, mm/s"""
    limit: float | None = None
    """Limit, rev/s"""
    sense: SpindleDirection = SpindleDirection.CLOCKWISE


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindleOff:
    """Spindle stop."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindleOrient:
    """Spindle stop at angle 0."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Coolant:
    """All coolant that is on from here; none: off."""

    kinds: frozenset[CoolantKind] = frozenset()


@dataclass(frozen=True, slots=True, kw_only=True)
class Retract:
    """Rapid along z only: nothing is known of x and y after a tool change."""

    z: float
    is_way: bool = False
    """between two workingsteps, not part of a path"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rapid:
    """Straight in rapid."""

    end: Point
    is_way: bool = False
    """between two workingsteps, not part of a path"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Linear:
    """Straight at a feed."""

    end: Point
    rate: Rate


@dataclass(frozen=True, slots=True, kw_only=True)
class Circular:
    """Arc or helix at a feed."""

    end: Point
    centre: Point
    """its coordinate along the normal of the plane means nothing"""
    turn: float
    """Turn, rad, positive counter-clockwise; more than 2π for several turns"""
    rate: Rate
    plane: ArcPlane = ArcPlane.XY


@dataclass(frozen=True, slots=True, kw_only=True)
class ThreadingMove:
    """Straight, bound to the angle of the spindle."""

    end: Point
    lead: float
    """Lead, mm per revolution along the axis that moves most"""


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidTap:
    """Thread cut down along z and out again, both bound to the angle of the spindle."""

    start: Point
    bottom_z: float
    lead: float
    """Lead, mm per revolution"""
    speed: float
    """Speed, rev/s"""
    sense: SpindleDirection = SpindleDirection.CLOCKWISE


@dataclass(frozen=True, slots=True, kw_only=True)
class Pause:
    """Dwell."""

    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramStopBlock:
    """Stop until started again."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OptionalStopBlock:
    """Stop when the switch is on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramEnd:
    """End and rewind."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DrillingCycle:
    """A drilling cycle from the retract plane and back to it, and the blocks it stands for."""

    kind: CycleKind
    at: tuple[float, float]
    """x and y"""
    retract_z: float
    bottom_z: float
    rate: Rate
    step_depth: float = 0.0
    """Step depth, mm of each peck"""
    retract_distance: float = 0.0
    """Retract distance, mm of a short retract, or above the last depth after a full one"""
    dwell: float = 0.0
    """Dwell, s at the bottom"""
    expansion: tuple["Block", ...] = ()


Block = (
    ProgramStart
    | Comment
    | Message
    | ToolChange
    | SpindleOn
    | SurfaceSpeed
    | SpindleOff
    | SpindleOrient
    | Coolant
    | Retract
    | Rapid
    | Linear
    | Circular
    | ThreadingMove
    | RigidTap
    | Pause
    | ProgramStopBlock
    | OptionalStopBlock
    | ProgramEnd
    | DrillingCycle
)


MOST_PECKS = 10_000

LEAST = 1e-9
"""mm; a peck that leaves less has reached the bottom"""


def expanded(
    cycle: DrillingCycle, spindle: SpindleOn | SurfaceSpeed | None = None
) -> DrillingCycle:
    """The cycle with its expansion.

    Parameters
    ----------
    cycle : DrillingCycle
    spindle : SpindleOn or SurfaceSpeed, optional
        What turns again after a cycle that stops the spindle.
    """
    return replace(cycle, expansion=tuple(_expansion(cycle, spindle)))


def _expansion(
    cycle: DrillingCycle, spindle: SpindleOn | SurfaceSpeed | None
) -> Iterator[Block]:
    bottom, top = (*cycle.at, cycle.bottom_z), (*cycle.at, cycle.retract_z)
    if cycle.kind in {CycleKind.PECK, CycleKind.CHIP_BREAK} and cycle.step_depth > 0.0:
        yield from _pecks(cycle)
    else:
        yield Linear(end=bottom, rate=cycle.rate)
    if cycle.dwell:
        yield Pause(seconds=cycle.dwell)
    if cycle.kind is CycleKind.BORE:
        yield Linear(end=top, rate=cycle.rate)
        return
    if cycle.kind is CycleKind.BORE_STOP:
        yield SpindleOff()
    yield Rapid(end=top)
    if cycle.kind is CycleKind.BORE_STOP and spindle is not None:
        yield spindle


def _pecks(cycle: DrillingCycle) -> Iterator[Block]:
    """Down in steps; between them a full or a short retract."""
    x, y = cycle.at
    count = (cycle.retract_z - cycle.bottom_z) / cycle.step_depth
    if count > MOST_PECKS:
        raise PostError(f"a drilling cycle of {count:.4g} pecks: {MOST_PECKS} at most")
    depth = cycle.retract_z - cycle.step_depth
    while depth > cycle.bottom_z + LEAST:
        yield Linear(end=(x, y, depth), rate=cycle.rate)
        if cycle.kind is CycleKind.PECK:
            yield Rapid(end=(x, y, cycle.retract_z))
        above = min(depth + cycle.retract_distance, cycle.retract_z)
        yield Rapid(end=(x, y, above))
        depth -= cycle.step_depth
    yield Linear(end=(x, y, cycle.bottom_z), rate=cycle.rate)
