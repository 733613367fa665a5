"""Neutral blocks: the content of an NC program, independent of a control's dialect.

Numbers are resolved: mm, mm/s, mm/rev, rev/s, s, rad. Coordinates are those of the tool path;
on a lathe x is a radius.

Drilling cycles are expanded for readers and for controls that lack them. Moves follow
LinuxCNC, "G-Code reference", G73 and G81 to G86; controls differ in the distance that they keep
above the last depth, which is an argument here.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import StrEnum

from stepnc_model.errors import PostError
from stepnc_model.toolpath.path import Arc, CycleKind, Point


class MachineType(StrEnum):
    """Type of machine that an NC program is for."""

    MILL = "mill"
    LATHE = "lathe"


class Cycles(StrEnum):
    """Form in which drilling cycles are written."""

    EXPANDED = "expanded"
    """Cycles written as single moves."""
    OWN = "own"
    """Cycles written as canned cycles of the control, where it has them."""


class RateMode(StrEnum):
    """Reference of a feed: per minute or per revolution."""

    PER_MINUTE = "per minute"
    """Feed per time; internally in mm/s."""
    PER_REVOLUTION = "per revolution"
    """Feed per revolution of the spindle, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rate:
    """Feed value with its mode, per minute or per revolution."""

    value: float
    """Feed, mm/s or mm/rev."""
    mode: RateMode = RateMode.PER_MINUTE


class SpindleDirection(StrEnum):
    """Direction of the spindle, as canonical commands name it.

    M3, clockwise, drives a right-hand screw into the workpiece (EIA RS-274-D). A mill turns
    its tool this way, negative about z; a lathe turns its workpiece the other way for the same
    effect, positive about z.
    """

    CLOCKWISE = "clockwise"
    COUNTERCLOCKWISE = "counterclockwise"

    @property
    def opposite(self) -> "SpindleDirection":
        """Opposite direction of spindle rotation."""
        return (
            SpindleDirection.COUNTERCLOCKWISE
            if self is SpindleDirection.CLOCKWISE
            else SpindleDirection.CLOCKWISE
        )


class CoolantKind(StrEnum):
    """Kinds of coolant supply."""

    FLOOD = "flood"
    MIST = "mist"
    THROUGH = "through"
    """Coolant through the tool."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramStart:
    """Start of an NC program, with its name and machine type."""

    name: str
    machine: MachineType = MachineType.MILL
    has_adaptive_feed: bool = False
    """Whether an outer loop may change the feed while the program runs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Comment:
    """Comment for the reader of the NC program."""

    text: str
    workingstep: str = ""
    """Name of the workingstep that begins here."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PathControl:
    """Mode in which the control runs from one move into the next, from here on."""

    tolerance: float
    """Path tolerance, mm; 0: corners are stops; infinite: none is given."""
    joining: float | None = None
    """Distance from short lines that may be joined to one, mm; None: the path tolerance, if
    one is given."""
    is_exact_stop: bool = False
    """Whether each move ends at rest, at a corner or not."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Message:
    """Message on the screen; written as a comment if a control has no messages."""

    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolChange:
    """Tool change, with the tool's length offset."""

    number: int
    id: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindleOn:
    """Spindle on at constant speed."""

    speed: float
    """Spindle speed, rev/s."""
    sense: SpindleDirection = SpindleDirection.CLOCKWISE


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceSpeed:
    """Spindle on at constant surface speed."""

    speed: float
    """Surface speed, mm/s."""
    limit: float | None = None
    """Limit of the spindle speed, rev/s."""
    sense: SpindleDirection = SpindleDirection.CLOCKWISE


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindleOff:
    """Spindle stop."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindleOrient:
    """Spindle stop at angle 0."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Coolant:
    """All coolant that is on from here; empty for off."""

    kinds: frozenset[CoolantKind] = frozenset()


@dataclass(frozen=True, slots=True, kw_only=True)
class Retract:
    """Rapid move along z only, as x and y are unknown after a tool change."""

    z: float
    is_way: bool = False
    """Whether the move lies between two workingsteps, outside a tool path."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rapid:
    """Straight rapid move."""

    end: Point
    is_way: bool = False
    """Whether the move lies between two workingsteps, outside a tool path."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Linear:
    """Straight move at a feed."""

    end: Point
    rate: Rate

    @property
    def arc(self) -> None:
        """No arc: a line."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Circular:
    """Arc or helix at a feed."""

    end: Point
    arc: Arc
    rate: Rate


@dataclass(frozen=True, slots=True, kw_only=True)
class ThreadingMove:
    """Straight threading move, synchronised with the spindle angle."""

    end: Point
    lead: float
    """Lead, mm per revolution along the axis that moves most."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidTap:
    """Rigid tap down along z and out again, synchronised with the spindle angle."""

    start: Point
    bottom_z: float
    lead: float
    """Lead of the tapped thread, mm per revolution."""
    speed: float
    """Spindle speed, rev/s."""
    sense: SpindleDirection = SpindleDirection.CLOCKWISE


@dataclass(frozen=True, slots=True, kw_only=True)
class Pause:
    """Dwell for a time in seconds."""

    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramStopBlock:
    """Program stop until the operator restarts."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OptionalStopBlock:
    """Program stop that applies only if the optional stop switch is on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramEnd:
    """End of the program, with rewind."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DrillingCycle:
    """Drilling cycle from the retract plane and back, with the single moves it stands for."""

    kind: CycleKind
    at: tuple[float, float]
    """Position x, y of the hole, mm."""
    retract_z: float
    bottom_z: float
    rate: Rate
    step_depth: float = 0.0
    """Depth of each peck in drilling, mm."""
    retract_distance: float = 0.0
    """Distance of a short retract, or above the last depth after a full retract, mm."""
    dwell: float = 0.0
    """Dwell at the bottom of the hole, s."""
    expansion: tuple["Block", ...] = ()


Block = (
    ProgramStart
    | Comment
    | PathControl
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
"""Remaining depth below which a peck has reached the bottom, mm."""


def expanded(
    cycle: DrillingCycle, spindle: SpindleOn | SurfaceSpeed | None = None
) -> DrillingCycle:
    """Drilling cycle with its expansion into single moves.

    Parameters
    ----------
    spindle : SpindleOn or SurfaceSpeed, optional
        Spindle state to restore after a cycle that stops the spindle.
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
    """Peck down in steps with a full or a short retract between them."""
    x, y = cycle.at
    count = (cycle.retract_z - cycle.bottom_z) / cycle.step_depth
    if count > MOST_PECKS:
        raise PostError(f"a drilling cycle of {count:.4g} pecks: at most {MOST_PECKS} allowed")
    depth = cycle.retract_z - cycle.step_depth
    while depth > cycle.bottom_z + LEAST:
        yield Linear(end=(x, y, depth), rate=cycle.rate)
        if cycle.kind is CycleKind.PECK:
            yield Rapid(end=(x, y, cycle.retract_z))
        above = min(depth + cycle.retract_distance, cycle.retract_z)
        yield Rapid(end=(x, y, above))
        depth -= cycle.step_depth
    yield Linear(end=(x, y, cycle.bottom_z), rate=cycle.rate)
