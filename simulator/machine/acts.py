"""Actions that a program requests from the machine, one after another.

They lie between the neutral blocks of a program and the run of the machine: feeds are speeds in
mm/s, cycles and threads are moves, and consecutive moves without a pause form one stretch.
"""

from dataclasses import dataclass, field

from simulator.motion.segments import Floats, Segments
from stepnc_model.post.blocks import Coolant, PathControl


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MoveStretch:
    """Consecutive moves that begin and end at rest."""

    segments: Segments
    spindle_speed: Floats
    """Spindle speed at the end of each segment, (N,), rev/s; NaN: unchanged."""
    per_revolution: Floats
    """Feed per revolution of the spindle, (N,), mm; NaN for a feed per time."""
    way: int = 0
    """Number of segments at the beginning that lead to the path of the workingstep."""
    back: int = 0
    """Number of segments at the end that lead away from the path of the workingstep."""
    is_drained: bool = True
    """Whether something other than a move follows that waits for its end: a dwell, a change of
    tool or coolant, a stop, the end; false if moves follow, or a wait for the spindle."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PathControlTo:
    """Command to run corners otherwise from here on."""

    control: PathControl


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindleTo:
    """Command to change the spindle speed; moves may begin meanwhile."""

    speed: float
    """Spindle speed, rev/s, positive clockwise (M3); 0 stops the spindle."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindleReached:
    """Wait until the spindle reaches its speed; feed moves are held until then."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wait:
    """Dwell for a given time."""

    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolTo:
    """Command to change the tool."""

    number: int


@dataclass(frozen=True, slots=True, kw_only=True)
class CoolantTo:
    """Command to switch the coolant on or off."""

    coolant: Coolant = field(default_factory=Coolant)


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkingstepTo:
    """Beginning of a workingstep."""

    id: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Stop:
    """Program stop until the operator restarts the program; takes no simulated time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EndOfProgram:
    """End of the program."""


Act = (
    MoveStretch
    | PathControlTo
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
    """Action of the machine with the program line that requests it."""

    line: int
    act: Act
