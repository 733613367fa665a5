"""Translation of neutral program blocks to actions of the machine: the virtual control.

Feeds per revolution become speeds along the path; at constant surface speed, a move is split so
that the spindle speed changes by at most a few per cent from piece to piece. Cycles, threads
and taps become moves. Memory is bounded because moves are passed on in stretches.

The rows of a stretch are mutable while it is collected.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from math import ceil, copysign, exp, inf, isfinite, isnan, log, nan, pi
from typing import NamedTuple

import numpy as np

from simulator.errors import ProgramFault
from simulator.machine.acts import (
    Act,
    CoolantTo,
    EndOfProgram,
    MoveStretch,
    PathControlTo,
    ProgramAct,
    SpindleReached,
    SpindleTo,
    Stop,
    ToolTo,
    Wait,
    WorkingstepTo,
)
from simulator.motion.segments import Segments
from simulator.spec import Machine
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    Coolant,
    DrillingCycle,
    Linear,
    PathControl,
    Pause,
    ProgramEnd,
    ProgramStopBlock,
    Rapid,
    Rate,
    RateMode,
    Retract,
    RigidTap,
    SpindleDirection,
    SpindleOff,
    SpindleOn,
    SpindleOrient,
    SurfaceSpeed,
    ThreadingMove,
    ToolChange,
)
from stepnc_model.post.canonical import synchronised
from stepnc_model.toolpath.arc import FULL, inner_points, point_at
from stepnc_model.toolpath.arc import radius as radius_of
from stepnc_model.toolpath.path import ArcPlane, Point


class PieceSpeed(NamedTuple):
    """Path and spindle speeds of one piece of a move; a tuple, as each block has one."""

    speed: float
    """Speed along the path at the nominal spindle speed, mm/s; infinite for a rapid."""
    spindle: float = nan
    """Spindle speed at the end of the piece, rev/s; NaN: unchanged."""
    per_revolution: float = nan
    """Feed per revolution, mm; NaN for a feed per time."""


Paces = Callable[[float, float], PieceSpeed]
"""Function from x in the middle and at the end of a piece to its speeds."""


class Rows:
    """Collects lines and arcs until they form a stretch."""

    def __init__(self) -> None:
        self._points: list[tuple[Point, Point, Point]] = []
        self._numbers: list[tuple[float, int, int, float, float, float]] = []
        self._way, self._back = 0, 0

    def __len__(self) -> int:
        return len(self._points)

    def line(
        self, start: Point, end: Point, *, pace: PieceSpeed, line: int, is_way: bool = False
    ) -> None:
        """Add a line, which is a rapid if its speed is infinite."""
        leads = is_way and self._way == len(self._points)
        self._way += leads
        self._back = self._back + 1 if is_way and not leads else 0
        self._add((start, end, start), pace, turn=0.0, normal=2, line=line)

    def arc(
        self, start: Point, block: Circular, *, pieces: int, paces: Paces, line: int
    ) -> None:
        """Add an arc or helix divided into pieces."""
        arc, here, self._back = block.arc, start, 0
        turn, normal = arc.turn / pieces, arc.plane.axes[2]
        for index, there in enumerate((*inner_points(start, block, pieces), block.end)):
            middle = point_at(start, block, (index + 0.5) / pieces)
            pace = paces(middle[0], there[0])
            self._add((here, there, arc.centre), pace, turn=turn, normal=normal, line=line)
            here = there

    def _add(
        self,
        points: tuple[Point, Point, Point],
        pace: PieceSpeed,
        *,
        turn: float,
        normal: int,
        line: int,
    ) -> None:
        self._points.append(points)
        self._numbers.append((turn, normal, line, *pace))

    def taken(self) -> MoveStretch:
        """Return the collected moves as a stretch and clear the rows."""
        points = np.array(self._points)
        turn, normal, line, speed, spindle, per_revolution = np.array(self._numbers).T
        way, back = self._way, self._back
        self._points, self._numbers, self._way, self._back = [], [], 0, 0
        segments = Segments(
            start=points[:, 0],
            end=points[:, 1],
            speed=speed,
            is_rapid=speed == inf,
            centre=points[:, 2],
            turn=turn,
            normal=normal.astype(np.int64),
            block=line.astype(np.int64),
        )
        return MoveStretch(
            segments=segments,
            spindle_speed=spindle,
            per_revolution=per_revolution,
            way=way,
            back=back,
        )


Numbered = tuple[int, Block]
"""Line number of the program and its block."""

LONGEST = 20_000
"""Number of segments in a stretch after which it ends, with a stop, to limit memory."""

PIECE = 0.02
"""Relative change of the radius within one piece at constant surface speed."""

MOST_TURNS = 100
"""Largest number of turns in one arc; more is a mistake and exceeds the stock map's limit."""

MOST_PIECES = 400
"""Largest number of pieces in a move; radii below e⁻⁸ of its greatest are not resolved."""


def interpret(blocks: Iterable[Numbered], machine: Machine) -> Iterator[ProgramAct]:
    """Translate the blocks of a program to actions of the machine.

    Parameters
    ----------
    blocks : iterable of (int, Block)
        Line numbers, counted from 1, and blocks; read as needed.
    machine : Machine
        Gives the maximum spindle speed.

    Raises
    ------
    ProgramFault
        With the line: for a feed that is not positive, a feed per revolution with a stopped
        spindle, or a constant surface speed at the axis without a spindle speed limit.
    """
    return _with_ends(_Interpreter(machine).steps(blocks))


DRAINS = (CoolantTo, EndOfProgram, Stop, ToolTo, Wait)
"""Actions for which the control waits until all moves before them have ended."""


def _with_ends(acts: Iterable[ProgramAct]) -> Iterator[ProgramAct]:
    """Actions, whose stretches know whether they are followed by one that waits for them."""
    held: list[ProgramAct] = []
    for step in acts:
        is_drained = isinstance(step.act, DRAINS)
        if is_drained or isinstance(step.act, MoveStretch | SpindleReached):
            yield from held if is_drained else map(_undrained, held)
            held = []
        held.append(step)
    yield from held


def _undrained(step: ProgramAct) -> ProgramAct:
    if not isinstance(step.act, MoveStretch):
        return step
    return replace(step, act=replace(step.act, is_drained=False))


class _Interpreter:
    """Interpreter of blocks; keeps the tool position and the commanded spindle speed."""

    def __init__(self, machine: Machine) -> None:
        self.fastest = machine.spindle.max_speed or inf
        self.at: list[float] = [nan, nan, nan]
        """Tool position, mm; NaN until the first move sets it."""
        self.surface: SurfaceSpeed | None = None
        self.speed = 0.0
        """Commanded spindle speed, rev/s, signed."""
        self.is_awaited = False
        """Whether the next feed move waits for the spindle."""
        self.rows = Rows()
        self.path_mode: PathControl | None = None
        self.line = 0
        self._readers: dict[type, Callable[..., Iterator[Act]]] = {
            Comment: self._comment,
            PathControl: self._path_mode,
            ToolChange: self._tool,
            SpindleOn: self._spindle_on,
            SurfaceSpeed: self._surface_speed,
            SpindleOff: self._spindle_off,
            SpindleOrient: self._spindle_off,
            Coolant: self._cool,
            Retract: self._retract,
            Rapid: self._rapid,
            Linear: self._linear,
            Circular: self._circular,
            ThreadingMove: self._threading,
            RigidTap: self._tap,
            Pause: self._pause,
            ProgramStopBlock: self._stop,
            ProgramEnd: self._end,
            DrillingCycle: self._cycle,
        }

    def steps(self, blocks: Iterable[Numbered]) -> Iterator[ProgramAct]:
        """Actions with their lines; collected moves are passed on when another action comes."""
        for line, block in blocks:
            self.line = line
            if len(self.rows) < LONGEST - 1 and self._goes_on(block):
                continue
            for act in self._read(block):
                yield ProgramAct(line=line, act=act)
            if isinstance(block, ProgramEnd):
                return
        yield from (ProgramAct(line=self.line, act=act) for act in self._flush())

    def _read(self, block: Block) -> Iterator[Act]:
        reader = self._readers.get(type(block))
        if reader is not None:
            yield from reader(block)
        if len(self.rows) >= LONGEST:
            yield from self._flush()

    def _flush(self) -> Iterator[Act]:
        if self.rows:
            yield self.rows.taken()

    def _comment(self, block: Comment) -> Iterator[Act]:
        if block.workingstep:
            yield from self._flush()
            yield WorkingstepTo(id=block.workingstep)

    def _path_mode(self, block: PathControl) -> Iterator[Act]:
        if block == self.path_mode:
            return
        self.path_mode = block
        yield from self._flush()
        yield PathControlTo(control=block)

    def _tool(self, block: ToolChange) -> Iterator[Act]:
        yield from self._flush()
        yield ToolTo(number=block.number)

    def _spindle_on(self, block: SpindleOn) -> Iterator[Act]:
        self.surface = None
        yield from self._turn(_signed(block.speed, block.sense))

    def _surface_speed(self, block: SurfaceSpeed) -> Iterator[Act]:
        self.surface = block
        if not isnan(self.at[0]):
            yield from self._turn(_signed(self._speed_at(self.at[0]), block.sense))

    def _spindle_off(self, _block: SpindleOff | SpindleOrient) -> Iterator[Act]:
        self.surface = None
        yield from self._turn(0.0)

    def _turn(self, speed: float) -> Iterator[Act]:
        if speed == self.speed:
            return
        yield from self._flush()
        self.speed = speed
        self.is_awaited = True
        yield SpindleTo(speed=speed)

    def _speed_at(self, radius: float) -> float:
        """Spindle speed while the tool is at a radius, rev/s."""
        if self.surface is None:
            return min(abs(self.speed), self.fastest)
        around = 2.0 * pi * abs(radius)
        speed = self.surface.speed / around if around > 0.0 else inf
        speed = min(speed, self._most(self.surface))
        if not isfinite(speed):
            raise ProgramFault("surface speed at x = 0 needs a spindle speed limit", self.line)
        return speed

    def _most(self, surface: SurfaceSpeed) -> float:
        """Greatest spindle speed at constant surface speed, rev/s."""
        return min(self.fastest, surface.limit or inf)

    def _cool(self, block: Coolant) -> Iterator[Act]:
        yield from self._flush()
        yield CoolantTo(coolant=block)

    def _pause(self, block: Pause) -> Iterator[Act]:
        yield from self._flush()
        yield Wait(seconds=block.seconds)

    def _stop(self, _block: ProgramStopBlock) -> Iterator[Act]:
        yield from self._flush()
        yield Stop()

    def _end(self, _block: ProgramEnd) -> Iterator[Act]:
        yield from self._flush()
        yield EndOfProgram()

    def _cycle(self, block: DrillingCycle) -> Iterator[Act]:
        for part in block.expansion:
            yield from self._read(part)

    # Interpretation of moves.

    def _start(self, end: Point) -> Point:
        """Start of a move; unknown coordinates are taken from its end."""
        x, y, z = self.at
        return (
            end[0] if isnan(x) else x,
            end[1] if isnan(y) else y,
            end[2] if isnan(z) else z,
        )

    def _retract(self, block: Retract) -> Iterator[Act]:
        x, y, _ = self.at
        if isnan(x) or isnan(y):
            # Along z only, from an unknown position: assume the machine is there already.
            self.at[2] = block.z
            return
        yield from self._rapid(Rapid(end=(x, y, block.z), is_way=block.is_way))

    def _rapid(self, block: Rapid) -> Iterator[Act]:
        start = self._start(block.end)
        if self.surface is not None:
            wanted = _signed(self._speed_at(block.end[0]), self.surface.sense)
            yield from self._turn(wanted)
        if start != block.end:
            pace = PieceSpeed(speed=inf)
            self.rows.line(start, block.end, pace=pace, line=self.line, is_way=block.is_way)
        self.at = list(block.end)

    def _goes_on(self, block: Block) -> bool:
        """Collect a line that is one piece, the usual block; return whether it is one."""
        if type(block) is not Linear or self.surface is not None or self.is_awaited:
            return False
        start, end = self._start(block.end), block.end
        pace = self._pace(block.rate, 0.5 * (start[0] + end[0]), end[0])
        if start != end:
            self.rows.line(start, end, pace=pace, line=self.line)
        self.at = list(end)
        return True

    def _linear(self, block: Linear) -> Iterator[Act]:
        start = self._start(block.end)
        yield from self._cut_begins(start[0])
        if self._goes_on(block):
            return
        *parts, _ = self._parts(start[0], block.end[0])
        at = start
        for to in (*(_between(start, block.end, part) for part in parts), block.end):
            middle = 0.5 * (at[0] + to[0])
            pace = self._pace(block.rate, middle, to[0])
            if at != to:
                self.rows.line(at, to, pace=pace, line=self.line)
            at = to
        self.at = list(block.end)

    def _circular(self, block: Circular) -> Iterator[Act]:
        turns = abs(block.arc.turn) / FULL
        if turns > MOST_TURNS:
            text = f"an arc has {turns:g} turns; at most {MOST_TURNS} are allowed"
            raise ProgramFault(text, self.line)
        start = self._start(block.end)
        yield from self._cut_begins(start[0])
        self.rows.arc(
            start,
            block,
            pieces=self._arc_pieces(start, block),
            paces=lambda middle, end: self._pace(block.rate, middle, end),
            line=self.line,
        )
        self.at = list(block.end)

    def _parts(self, one: float, other: float) -> list[float]:
        """Shares of a line at which its pieces end, at constant surface speed."""
        if self.surface is None:
            return [1.0]
        if one * other < 0.0:
            axis = one / (one - other)
            before, after = self._parts(one, 0.0), self._parts(0.0, other)
            return [axis * part for part in before] + [
                axis + (1.0 - axis) * part for part in after
            ]
        low, high = sorted((abs(one), abs(other)))
        least = max(low, self._least_radius(self.surface), high * exp(-MOST_PIECES * PIECE))
        if least >= high:
            return [1.0]
        count = ceil(log(high / least) / PIECE)
        radii = [high * (least / high) ** (index / count) for index in range(count)]
        # Below the least radius the spindle keeps its limit; a late spindle may still ramp.
        inner = ceil((least - low) / (PIECE * least))
        radii += [least - (least - low) * index / inner for index in range(inner)] + [low]
        parts = [(high - radius) / (high - low) for radius in radii]
        if abs(one) < abs(other):
            parts = [1.0 - part for part in reversed(parts)]
        return parts[1:]

    def _arc_pieces(self, start: Point, block: Circular) -> int:
        """Number of pieces into which an arc is split at constant surface speed."""
        arc = block.arc
        if self.surface is None or arc.plane is ArcPlane.YZ:
            return 1
        size = radius_of(start, arc)
        way = size * abs(arc.turn)
        # Lower bound of the distance from the axis; the arc itself may stay farther away.
        nearest = max(abs(arc.centre[0]) - size, self._least_radius(self.surface))
        fits = way < PIECE * nearest * MOST_PIECES
        return max(1, ceil(way / (PIECE * nearest))) if fits else MOST_PIECES

    def _least_radius(self, surface: SurfaceSpeed) -> float:
        """Radius below which the spindle stays at its greatest speed, mm."""
        return surface.speed / (2.0 * pi * self._most(surface))

    def _pace(self, rate: Rate, middle: float, end: float) -> PieceSpeed:
        """Speeds of a piece from the radii at its middle and at its end."""
        speed, last, per_revolution = rate.value, nan, nan
        if rate.mode is RateMode.PER_REVOLUTION:
            per_revolution = rate.value
            speed *= self._speed_at(middle)
        if self.surface is not None:
            last = self.speed = _signed(self._speed_at(end), self.surface.sense)
        if not speed > 0.0:
            reason = "the spindle is stopped" if rate.value > 0.0 else "it must be positive"
            unit = "mm/rev" if rate.mode is RateMode.PER_REVOLUTION else "mm/s"
            raise ProgramFault(f"feed {rate.value:g} {unit}: {reason}", self.line)
        return PieceSpeed(speed, last, per_revolution)

    def _cut_begins(self, radius: float) -> Iterator[Act]:
        """Set the spindle speed for a feed move and wait for the spindle if necessary."""
        if self.surface is not None:
            yield from self._turn(_signed(self._speed_at(radius), self.surface.sense))
        if self.is_awaited:
            yield from self._flush()
            yield SpindleReached()
            self.is_awaited = False

    def _threading(self, block: ThreadingMove) -> Iterator[Act]:
        start = self._start(block.end)
        if start == block.end:
            return
        lead = synchronised(start, block.end, block.lead)
        rate = Rate(value=lead, mode=RateMode.PER_REVOLUTION)
        yield from self._linear(Linear(end=block.end, rate=rate))

    def _tap(self, block: RigidTap) -> Iterator[Act]:
        """Tap with a synchronised spindle: move down, reverse the spindle, move up."""
        self.surface = None
        rate = Rate(value=block.lead, mode=RateMode.PER_REVOLUTION)
        x, y, _ = block.start
        yield from self._rapid(Rapid(end=block.start))
        for sense, z in (
            (block.sense, block.bottom_z),
            (block.sense.opposite, block.start[2]),
        ):
            yield from self._turn(_signed(block.speed, sense))
            yield from self._linear(Linear(end=(x, y, z), rate=rate))
        yield from self._turn(_signed(block.speed, block.sense))


def _signed(speed: float, sense: SpindleDirection) -> float:
    return copysign(speed, 1.0 if sense is SpindleDirection.CLOCKWISE else -1.0)


def _between(start: Point, end: Point, part: float) -> Point:
    x, y, z = (a + part * (b - a) for a, b in zip(start, end, strict=True))
    return x, y, z
