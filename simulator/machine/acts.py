"""Acts of the machine that a program asks for, one after another.

Between the neutral blocks of a program and the run of the machine: feeds are speeds in mm/s,
cycles and threads are moves, and moves that follow each other without a pause are one stretch.
"""

from dataclasses import dataclass, field

from simulator.motion.segments import Floats, Segments
from stepnc_model.post.blocks import Coolant


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MoveStretch:
    """Moves from rest to rest."""

    segments: Segments
    spindle_speed: Floats
    """(N,) rev/s that the spindle has at the end of each segment; NaN: it keeps its speed"""
    per_revolution: Floats
    """Per revolution, (N,) mm of path in a revolution of the spindle; NaN: a feed by time"""
    way: int = 0
    """segments at the beginning that lead to the path of the workingstep"""
    back: int = 0
    """segments at the end that lead away from it"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindleTo:
    """The spindle goes to a speed; moves may begin meanwhile."""

    speed: float
    """Speed, rev/s, positive clockwise (M3), 0: stop"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindleReached:
    """Wait until the spindle has its speed: the feed is held back until then."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wait:
    """Dwell."""

    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolTo:
    """Tool change."""

    number: int


@dataclass(frozen=True, slots=True, kw_only=True)
class CoolantTo:
    """Coolant on or off."""

    coolant: Coolant = field(default_factory=Coolant)


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkingstepTo:
    """A workingstep begins."""

    id: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Stop:
    """The program stops until the operator starts it again; takes no time here."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EndOfProgram:
    """The program has ended."""


Act = (
    MoveStretch
    | SpindleTo
    | SpindleReached
    | Wait
    | ToolTo
    | CoolantTo
    | WorkingstepTo
    | Stop
    | EndOfProgram
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramAct:
    """An act and the line of the program from which it comes."""

    line: int
    act: Act
