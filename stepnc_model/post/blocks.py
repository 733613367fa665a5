"""Neutral blocks: what an NC program says, before any control spells it.

Numbers are resolved: mm, mm/s, mm/rev, rev/s, s, rad. Coordinates are those of the tool path;
on a lathe x is a radius.
"""

from dataclasses import dataclass
from enum import StrEnum

from stepnc_model.toolpath.path import CycleKind, Plane, Point


class Machine(StrEnum):
    """What kind of machine a program is for."""

    MILL = "mill"
    LATHE = "lathe"


class Cycles(StrEnum):
    """How drilling cycles are written."""

    EXPANDED = "expanded"
    """as lines"""
    OWN = "own"
    """as cycles of the control, where it has them"""


class RateMode(StrEnum):
    """What a feed counts against."""

    PER_MINUTE = "per minute"
    """of time; inside in mm/s"""
    PER_REVOLUTION = "per revolution"
    """of the spindle, mm"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rate:
    """A feed with its mode."""

    value: float
    """mm/s or mm/rev"""
    mode: RateMode = RateMode.PER_MINUTE


class Sense(StrEnum):
    """Sense of the spindle, as canonical commands name it.

    M3, clockwise, drives a right-hand screw into the workpiece (EIA RS-274-D). A mill turns
    its tool so, negative about z; a lathe turns its workpiece the other way for the same
    effect, positive about z.
    """

    CLOCKWISE = "clockwise"
    COUNTERCLOCKWISE = "counterclockwise"

    @property
    def opposite(self) -> "Sense":
        """The other one."""
        return Sense.COUNTERCLOCKWISE if self is Sense.CLOCKWISE else Sense.CLOCKWISE


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
    machine: Machine = Machine.MILL


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
    """rev/s"""
    sense: Sense = Sense.CLOCKWISE


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceSpeed:
    """Spindle on at constant surface speed."""

    speed: float
    """mm/s"""
    limit: float | None = None
    """rev/s"""
    sense: Sense = Sense.CLOCKWISE


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
    """rad, positive counter-clockwise; more than 2π for several turns"""
    rate: Rate
    plane: Plane = Plane.XY


@dataclass(frozen=True, slots=True, kw_only=True)
class Threading:
    """Straight, bound to the angle of the spindle."""

    end: Point
    lead: float
    """mm per revolution along the axis that moves most"""


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidTap:
    """Thread cut down along z and out again, both bound to the angle of the spindle."""

    start: Point
    bottom_z: float
    lead: float
    """mm per revolution"""
    speed: float
    """rev/s"""
    sense: Sense = Sense.CLOCKWISE


@dataclass(frozen=True, slots=True, kw_only=True)
class Pause:
    """Dwell."""

    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramStop:
    """Stop until started again."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OptionalStop:
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
    """mm of each peck"""
    retract_distance: float = 0.0
    """mm of a short retract, or above the last depth after a full one"""
    dwell: float = 0.0
    """s at the bottom"""
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
    | Threading
    | RigidTap
    | Pause
    | ProgramStop
    | OptionalStop
    | ProgramEnd
    | DrillingCycle
)
