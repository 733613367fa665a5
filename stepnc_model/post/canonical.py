"""Canonical machining commands: what a control does, one call a line.

Names and arguments are those of [1]_ in the layout of NIST's STEP-NC interpreter: three axes,
arcs as (first end, second end, first centre, second centre, rotation, end along the normal) in
the order x y, z x or y z of their plane. Feed per revolution, constant surface speed and
synchronised motion, which [1]_ lacks, are named as LinuxCNC prints them. Units: mm, mm/min or
mm/rev, rpm or m/min, s. Of coolants only flood and mist are known: through the tool is flood.

References
----------
.. [1] T. R. Kramer, F. M. Proctor, E. Messina, "The NIST RS274NGC Interpreter - Version 3",
   NISTIR 6556, 2000, section 4 "Canonical machining functions".
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from math import ceil, dist, pi

from stepnc_model.errors import PostError
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    Coolant,
    CoolantKind,
    Linear,
    Message,
    OptionalStop,
    Pause,
    ProgramEnd,
    ProgramStart,
    ProgramStop,
    Rapid,
    Rate,
    RateMode,
    Retract,
    RigidTap,
    SpindleOff,
    SpindleOn,
    SpindleOrient,
    SurfaceSpeed,
    Threading,
    ToolChange,
)
from stepnc_model.post.grid import flat, on_grid
from stepnc_model.toolpath.path import Plane, Point
from stepnc_model.units import m_min_from_speed, mm_min_from_speed, rpm_from_rev_s

PLACES = 4

UNLIMITED = 1e30
"""rpm, what LinuxCNC prints for no limit"""

PLANES = {Plane.XY: "CANON_PLANE_XY", Plane.ZX: "CANON_PLANE_XZ", Plane.YZ: "CANON_PLANE_YZ"}

Argument = float | int | str


@dataclass(frozen=True, slots=True)
class Canonical:
    """One canonical command."""

    name: str
    arguments: tuple[Argument, ...] = ()

    def __str__(self) -> str:
        return f"{self.name}({', '.join(map(_shown, self.arguments))})"


def write(blocks: Iterable[Block]) -> Iterator[str]:
    """Numbered lines of canonical commands."""
    for number, command in enumerate(commands(blocks), 1):
        yield f"{number:5} {command}"


def commands(blocks: Iterable[Block], *, places: int = PLACES) -> Iterator[Canonical]:
    """Canonical commands of neutral blocks, cycles expanded.

    Parameters
    ----------
    blocks : iterable of Block
    places : int
        Decimal places to which coordinates are rounded.
    """
    writer = _Writer()
    for block in on_grid(flat(blocks), places):
        yield from writer.commands(block)


def synchronised(start: Point, end: Point, lead: float) -> float:
    """Lead in mm along a path, from the lead along the axis that moves most."""
    most = max(abs(e - s) for s, e in zip(start, end, strict=True))
    return lead * dist(start, end) / most


class _Writer:
    """Running state: what was said and holds."""

    def __init__(self) -> None:
        self.at: Point = (0.0, 0.0, 0.0)
        self.plane: Plane | None = None
        self.rate: Rate | None = None
        self.mode = RateMode.PER_MINUTE
        self.speed: float | None = None
        self.limit: float | None = 0.0
        self.coolant: frozenset[CoolantKind] = frozenset()
        self._makers: dict[type, Callable[..., Iterator[Canonical]]] = {
            Rapid: self._rapid,
            Linear: self._linear,
            Circular: self._circular,
            Retract: self._retract,
            Threading: self._threading,
            RigidTap: self._tap,
            SpindleOn: self._spindle,
            SurfaceSpeed: self._surface,
            Coolant: self._coolant,
            ProgramStart: self._start,
        }

    def commands(self, block: Block) -> Iterator[Canonical]:
        """Commands of one block."""
        maker = self._makers.get(type(block))
        if maker is not None:
            yield from maker(block)
        else:
            yield _plain(block)

    def _start(self, block: ProgramStart) -> Iterator[Canonical]:
        yield Canonical("COMMENT", (block.name,))
        yield Canonical("USE_LENGTH_UNITS", ("CANON_UNITS_MM",))
        yield Canonical("SET_FEED_REFERENCE", ("CANON_XYZ",))

    def _rapid(self, block: Rapid) -> Iterator[Canonical]:
        self.at = block.end
        yield Canonical("STRAIGHT_TRAVERSE", block.end)

    def _retract(self, block: Retract) -> Iterator[Canonical]:
        return self._rapid(Rapid(end=(self.at[0], self.at[1], block.z)))

    def _linear(self, block: Linear) -> Iterator[Canonical]:
        if block.rate != self.rate:
            yield from self._set_rate(block.rate)
        self.at = block.end
        yield Canonical("STRAIGHT_FEED", block.end)

    def _circular(self, block: Circular) -> Iterator[Canonical]:
        if block.rate != self.rate:
            yield from self._set_rate(block.rate)
        if block.plane != self.plane:
            self.plane = block.plane
            yield Canonical("SELECT_PLANE", (PLANES[block.plane],))
        first, second, normal = block.plane.axes
        turns = max(1, ceil(abs(block.turn) / (2.0 * pi) - 1e-9))
        end, centre = block.end, block.centre
        self.at = end
        yield Canonical(
            "ARC_FEED",
            (
                end[first],
                end[second],
                centre[first],
                centre[second],
                turns if block.turn > 0.0 else -turns,
                end[normal],
            ),
        )

    def _threading(self, block: Threading) -> Iterator[Canonical]:
        lead = synchronised(self.at, block.end, block.lead)
        self.at = block.end
        yield Canonical("START_SPEED_FEED_SYNC", (lead,))
        yield Canonical("STRAIGHT_FEED", block.end)
        yield Canonical("STOP_SPEED_FEED_SYNCH")

    def _tap(self, block: RigidTap) -> Iterator[Canonical]:
        self.at = block.start
        yield from self._spindle(SpindleOn(speed=block.speed, sense=block.sense))
        yield Canonical("START_SPEED_FEED_SYNC", (block.lead,))
        yield Canonical("RIGID_TAP", (*block.start[:2], block.bottom_z))
        yield Canonical("STOP_SPEED_FEED_SYNCH")

    def _spindle(self, block: SpindleOn) -> Iterator[Canonical]:
        yield from self._set_limit(0.0)
        yield from self._set_speed(rpm_from_rev_s(block.speed))
        yield Canonical(f"START_SPINDLE_{block.sense.name}")

    def _surface(self, block: SurfaceSpeed) -> Iterator[Canonical]:
        limit = UNLIMITED if block.limit is None else rpm_from_rev_s(block.limit)
        yield from self._set_limit(limit)
        yield from self._set_speed(m_min_from_speed(block.speed))
        yield Canonical(f"START_SPINDLE_{block.sense.name}")

    def _set_limit(self, limit: float) -> Iterator[Canonical]:
        """0 for constant speed, above 0 for constant surface speed."""
        if limit != self.limit:
            self.limit, self.speed = limit, None
            yield Canonical("SET_SPINDLE_MODE", (limit,))

    def _set_speed(self, speed: float) -> Iterator[Canonical]:
        if speed != self.speed:
            self.speed = speed
            yield Canonical("SET_SPINDLE_SPEED", (speed,))

    def _set_rate(self, rate: Rate) -> Iterator[Canonical]:
        is_per_revolution = rate.mode is RateMode.PER_REVOLUTION
        if rate.mode is not self.mode:
            self.mode = rate.mode
            yield Canonical("SET_FEED_MODE", (int(is_per_revolution),))
        self.rate = rate
        value = rate.value if is_per_revolution else mm_min_from_speed(rate.value)
        yield Canonical("SET_FEED_RATE", (value,))

    def _coolant(self, block: Coolant) -> Iterator[Canonical]:
        kinds = frozenset(
            CoolantKind.FLOOD if kind is CoolantKind.THROUGH else kind for kind in block.kinds
        )
        for kind in sorted(self.coolant - kinds):
            yield Canonical(f"{kind.name}_OFF")
        for kind in sorted(kinds - self.coolant):
            yield Canonical(f"{kind.name}_ON")
        self.coolant = kinds


def _plain(block: Block) -> Canonical:
    """The command of a block without memory."""
    match block:
        case Comment(text=text):
            return Canonical("COMMENT", (text,))
        case Message(text=text):
            return Canonical("MESSAGE", (text,))
        case ToolChange(number=number):
            return Canonical("CHANGE_TOOL", (number,))
        case Pause(seconds=seconds):
            return Canonical("DWELL", (seconds,))
        case SpindleOff():
            return Canonical("STOP_SPINDLE_TURNING")
        case SpindleOrient():
            return Canonical("ORIENT_SPINDLE", (0.0,))
        case ProgramStop():
            return Canonical("PROGRAM_STOP")
        case OptionalStop():
            return Canonical("OPTIONAL_PROGRAM_STOP")
        case ProgramEnd():
            return Canonical("PROGRAM_END")
        case _:
            raise PostError(f"no canonical command for {type(block).__name__}")


def _shown(argument: Argument) -> str:
    """One argument as text."""
    if isinstance(argument, float):
        text = f"{argument:.4f}"
        return "0.0000" if text == "-0.0000" else text
    return "".join(c if c.isprintable() else " " for c in str(argument))
