"""Canonical machining commands: the actions of a control, one call per line.

Names and arguments are those of [1]_ in the layout of NIST's STEP-NC interpreter: three axes,
arcs as (first end, second end, first centre, second centre, rotation, end along the normal) in
the axis order x y, z x or y z of their plane. Feed per revolution, constant surface speed and
synchronised motion, which [1]_ lacks, are named as LinuxCNC prints them. Units: mm, mm/min or
mm/rev, rpm or m/min, s. Only flood and mist coolant exist: coolant through the tool is flood.

The reader accepts our own commands, NIST's, and those that LinuxCNC prints.

References
----------
.. [1] T. R. Kramer, F. M. Proctor, E. Messina, "The NIST RS274NGC Interpreter - Version 3",
   NISTIR 6556, 2000, section 4 "Canonical machining functions".
"""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import copysign, dist, isfinite
from typing import Any

from stepnc_model.errors import PostError
from stepnc_model.plurals import counted
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    Coolant,
    CoolantKind,
    Linear,
    Message,
    OptionalStopBlock,
    PathControl,
    Pause,
    ProgramEnd,
    ProgramStart,
    ProgramStopBlock,
    Rapid,
    Rate,
    RateMode,
    Retract,
    RigidTap,
    SpindleOff,
    SpindleOn,
    SpindleOrient,
    SurfaceSpeed,
    ThreadingMove,
    ToolChange,
)
from stepnc_model.post.grid import flat, on_grid
from stepnc_model.post.words import shown
from stepnc_model.toolpath.arc import begun_turns
from stepnc_model.toolpath.path import ArcPlane, Point
from stepnc_model.units import m_min_from_speed, mm_min_from_speed, rpm_from_rev_s

PLACES = 4

UNLIMITED = 1e30
"""Spindle speed limit that LinuxCNC prints for no limit, rpm."""

PLANES = {
    ArcPlane.XY: "CANON_PLANE_XY",
    ArcPlane.ZX: "CANON_PLANE_XZ",
    ArcPlane.YZ: "CANON_PLANE_YZ",
}

Argument = float | int | str


@dataclass(frozen=True, slots=True)
class Canonical:
    """Canonical machining command with its arguments."""

    name: str
    arguments: tuple[Argument, ...] = ()

    def __str__(self) -> str:
        return f"{self.name}({', '.join(map(_shown, self.arguments))})"


def write(blocks: Iterable[Block]) -> Iterator[str]:
    """Write blocks as numbered lines of canonical commands."""
    for number, command in enumerate(commands(blocks), 1):
        yield f"{number:5} {command}"


def commands(blocks: Iterable[Block], *, places: int = PLACES) -> Iterator[Canonical]:
    """Convert neutral blocks to canonical commands, with cycles expanded.

    Parameters
    ----------
    places : int
        Decimal places to which coordinates are rounded.
    """
    writer = _Writer()
    for block in on_grid(flat(blocks), places):
        yield from writer.commands(block)


def synchronised(start: Point, end: Point, lead: float) -> float:
    """Lead along a path, mm, from the lead along the axis that moves most."""
    most = max(abs(e - s) for s, e in zip(start, end, strict=True))
    return lead * dist(start, end) / most


def along_longest(start: Sequence[float], end: Sequence[float], lead: float) -> float:
    """Lead along the axis that moves most, mm, from the lead along a path."""
    most = max(abs(e - s) for s, e in zip(start, end, strict=True))
    return lead * most / dist(start, end)


class _Writer:
    """Writer of canonical commands that tracks the modal state."""

    def __init__(self) -> None:
        self.at: Point = (0.0, 0.0, 0.0)
        self.plane: ArcPlane | None = None
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
            ThreadingMove: self._threading,
            RigidTap: self._tap,
            SpindleOn: self._spindle,
            SurfaceSpeed: self._surface,
            Coolant: self._coolant,
            ProgramStart: self._start,
            # Tolerances are no part of what a program does.
            PathControl: lambda _: iter(()),
        }

    def commands(self, block: Block) -> Iterator[Canonical]:
        """Canonical commands of one block."""
        maker = self._makers.get(type(block))
        if maker is not None:
            yield from maker(block)
        else:
            yield PLAIN[type(block)](block)

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
        plane, turn, end, centre = block.arc.plane, block.arc.turn, block.end, block.arc.centre
        if plane != self.plane:
            self.plane = plane
            yield Canonical("SELECT_PLANE", (PLANES[plane],))
        first, second, normal = plane.axes
        self.at = end
        yield Canonical(
            "ARC_FEED",
            (
                end[first],
                end[second],
                centre[first],
                centre[second],
                int(copysign(begun_turns(turn), turn)),
                end[normal],
            ),
        )

    def _threading(self, block: ThreadingMove) -> Iterator[Canonical]:
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
        """Set the spindle mode: 0 for constant speed, a limit for constant surface speed."""
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


PLAIN: dict[type, Callable[[Any], Canonical]] = {
    Comment: lambda block: Canonical("COMMENT", (block.text,)),
    Message: lambda block: Canonical("MESSAGE", (block.text,)),
    ToolChange: lambda block: Canonical("CHANGE_TOOL", (block.number,)),
    Pause: lambda block: Canonical("DWELL", (block.seconds,)),
    SpindleOff: lambda _: Canonical("STOP_SPINDLE_TURNING"),
    SpindleOrient: lambda _: Canonical("ORIENT_SPINDLE", (0.0,)),
    ProgramStopBlock: lambda _: Canonical("PROGRAM_STOP"),
    OptionalStopBlock: lambda _: Canonical("OPTIONAL_PROGRAM_STOP"),
    ProgramEnd: lambda _: Canonical("PROGRAM_END"),
}
"""Commands of blocks that do not depend on modal state."""


def _shown(argument: Argument) -> str:
    """Format an argument of a canonical command as text."""
    if isinstance(argument, float):
        text = f"{argument:.4f}"
        return "0.0000" if text == "-0.0000" else text
    return "".join(c if c.isprintable() else " " for c in str(argument))


LINE = re.compile(r"\s*(?:\d+\s+)?(?:N\S+\s+)?([A-Z][A-Z0-9_]*)\((.*)\)\s*")
NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")

NUMBERS = {
    "STRAIGHT_TRAVERSE": slice(0, 3),
    "STRAIGHT_FEED": slice(0, 3),
    "RIGID_TAP": slice(0, 3),
    "ARC_FEED": slice(0, 6),
    "SET_FEED_RATE": slice(-1, None),
    "SET_FEED_MODE": slice(-1, None),
    "SET_SPINDLE_SPEED": slice(-1, None),
    "SET_SPINDLE_MODE": slice(-1, None),
    "START_SPEED_FEED_SYNC": slice(0, 1),
    "DWELL": slice(0, 1),
    "ORIENT_SPINDLE": slice(-2, -1),
}
"""Arguments that are evaluated: LinuxCNC appends rotary axes and prepends spindle numbers."""

NAMES = frozenset({
    "SELECT_PLANE",
    "CHANGE_TOOL",
    "SELECT_TOOL",
    "START_CHANGE",
    "START_SPINDLE_CLOCKWISE",
    "START_SPINDLE_COUNTERCLOCKWISE",
    "STOP_SPINDLE_TURNING",
    "SPINDLE_RETRACT",
    "FLOOD_ON",
    "FLOOD_OFF",
    "MIST_ON",
    "MIST_OFF",
    "COMMENT",
    "MESSAGE",
    "PROGRAM_STOP",
    "OPTIONAL_PROGRAM_STOP",
    "PROGRAM_END",
    "STOP_SPEED_FEED_SYNCH",
    "USE_LENGTH_UNITS",
    "SET_FEED_REFERENCE",
    "SET_ORIGIN_OFFSETS",
    "USE_TOOL_LENGTH_OFFSET",
    "SET_G5X_OFFSET",
    "SET_G92_OFFSET",
    "SET_XY_ROTATION",
    "ON_RESET",
    "SET_MOTION_CONTROL_MODE",
    "SET_NAIVECAM_TOLERANCE",
    "ENABLE_FEED_OVERRIDE",
    "DISABLE_FEED_OVERRIDE",
    "ENABLE_SPEED_OVERRIDE",
    "DISABLE_SPEED_OVERRIDE",
})
TEXTS = frozenset({"COMMENT", "MESSAGE"})


def read(lines: Iterable[str]) -> Iterator[Canonical]:
    """Read canonical commands in our own form, NIST's, or LinuxCNC's.

    Raises
    ------
    PostError
        If a line is not a canonical command.
    """
    for number, line in enumerate(lines, 1):
        if line.strip():
            yield _parsed(line, number)


def _parsed(line: str, number: int) -> Canonical:
    """Parse one line as a canonical command."""
    found = LINE.fullmatch(line)
    if found is None or (found[1] not in NUMBERS and found[1] not in NAMES):
        raise PostError(f"'{shown(line)}' is not a canonical command", line=number)
    name, text = found[1], found[2]
    if name in TEXTS:
        return Canonical(name, (text.strip('"'),))
    parts = [part for part in re.split(r"[,\s]+", text) if part]
    if name not in NUMBERS:
        return Canonical(name, () if name.startswith("START_SPINDLE") else (text,))
    if not all(NUMBER.fullmatch(part) and isfinite(float(part)) for part in parts):
        raise PostError(f"{name}({shown(text)}): the arguments must be numbers", line=number)
    values: list[Argument] = [float(part) for part in parts]
    chosen = values[NUMBERS[name]] if len(values) > 1 else values
    wanted = {"ARC_FEED": 6}.get(name, 3 if NUMBERS[name] == slice(0, 3) else 1)
    if len(chosen) != wanted:
        raise PostError(
            f"{name} has {counted(len(chosen), 'argument')}: it needs {wanted}", line=number
        )
    if name == "ARC_FEED":
        turns = float(chosen[4])
        if not turns or turns != int(turns):
            raise PostError(
                f"{name}: {turns:g} turns: must be a whole number other than 0", line=number
            )
        chosen[4] = int(turns)
    return Canonical(name, tuple(chosen))
