"""Conversion of tool paths to neutral blocks with tools, spindle, coolant and safe moves.

Between workingsteps the tool first rises to the highest security plane, then moves across, then
down. Tools change there: if a machine has a separate tool change position, M6 or the turret
handles it. Tools are numbered from 1 in the order of their first use; the list is at the head
of the program.

Moves that differ only in whether they touch material are merged: a control need not know.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from math import dist, isfinite

from stepnc_model.entities.entity import Entity
from stepnc_model.errors import PostError, StepNcError
from stepnc_model.part21.values import Ref
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    Coolant,
    DrillingCycle,
    Linear,
    MachineType,
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
from stepnc_model.post.modal_state import ModalState, conditions, constant_speed, coolant_of
from stepnc_model.post.path_tolerance import path_tolerance
from stepnc_model.programs.program import Program
from stepnc_model.programs.tool import is_described, tool_name, tool_of
from stepnc_model.toolpath.path import (
    LEFT_OUT,
    CannedCycle,
    CycleKind,
    Dwell,
    Feed,
    Function,
    Move,
    MoveType,
    Point,
    SpindleCommand,
    SpindleSpeedChange,
    Step,
    ToolPath,
)

STRAIGHT = 1e-9
"""Length tolerance within which two lines count as collinear, mm."""

INTERPOLATED = {MoveType.CONTACT, MoveType.NO_CONTACT}


def unsplit(start: Point, steps: Sequence[Step]) -> Iterator[Step]:
    """Merge moves that were split only between contact and air."""
    held: Move | None = None
    for step in steps:
        if held is not None:
            joined = _joined(start, held, step) if isinstance(step, Move) else None
            if joined is not None:
                held = joined
                continue
            yield held
            start = held.end
            held = None
        if isinstance(step, Move):
            held = step
        else:
            yield step
    if held is not None:
        yield held


def _joined(start: Point, one: Move, other: Move) -> Move | None:
    """Merge two moves into one, or return None if they must stay separate."""
    if one.type is other.type or {one.type, other.type} != INTERPOLATED:
        return None
    if one.feed != other.feed:
        return None
    if one.arc is None and other.arc is None:
        way = dist(start, one.end) + dist(one.end, other.end)
        return other if way - dist(start, other.end) <= STRAIGHT else None
    if one.arc is None or other.arc is None or one.arc.plane is not other.arc.plane:
        return None
    first, second, normal = one.arc.plane.axes
    is_one_circle = all(
        abs(one.arc.centre[axis] - other.arc.centre[axis]) <= STRAIGHT
        for axis in (first, second)
    )
    is_flat = start[normal] == one.end[normal] == other.end[normal]
    turns = one.arc.turn, other.arc.turn
    if not is_one_circle or not is_flat or turns[0] * turns[1] <= 0.0:
        return None
    return replace(other, arc=replace(other.arc, turn=sum(turns)))


STOPS = frozenset({"OPTIONAL_STOP", "PROGRAM_STOP"})

FUNCTIONS: dict[str, Callable[[Function], Block]] = {
    "OPTIONAL_STOP": lambda _: OptionalStopBlock(),
    "PROGRAM_STOP": lambda _: ProgramStopBlock(),
    LEFT_OUT: lambda _: Comment(text="THIS WORKINGSTEP IS LEFT OUT"),
    "DISPLAY_MESSAGE": lambda function: Message(text=function.text or function.id),
}

MOST = {RateMode.PER_MINUTE: 1e4, RateMode.PER_REVOLUTION: 1e3}
"""Greatest feed accepted by mode, mm/s and mm/rev."""

ON_LATHE = 1e-6
"""Tolerance of y on a lathe, mm."""

FASTEST = 1e4
"""Greatest spindle speed accepted, rev/s."""


def blocks_of(
    program: Program, paths: Sequence[ToolPath | Function], *, name: str
) -> Iterator[Block]:
    """Convert tool paths to neutral blocks, generated lazily.

    Parameters
    ----------
    program : Program
        Program in which tools and technologies are looked up.
    paths : sequence of ToolPath and Function
        Paths and functions in execution order.

    Raises
    ------
    SchemaError, PostError
        If a tool cannot be used, or a cut has no feed.
    """
    return _Sequence(program, paths).blocks(name)


def tool_numbers(paths: Iterable[ToolPath]) -> dict[Ref[Entity], int]:
    """Tool numbers, from 1 in the order of first use."""
    used = dict.fromkeys(path.tool_ref for path in paths if path.tool_ref is not None)
    return {ref: number for number, ref in enumerate(used, 1)}


def _is_turning(paths: Sequence[ToolPath | Function]) -> bool:
    return any(isinstance(path, ToolPath) and path.is_turning for path in paths)


def _turns_first(path: ToolPath) -> bool:
    """True if a path begins with its own spindle speed."""
    return bool(path.steps) and isinstance(path.steps[0], SpindleSpeedChange)


def _safe_z(path: ToolPath) -> float:
    """Height z at which the tool arrives at a path, mm."""
    return path.start[2] if path.safe_z is None else max(path.safe_z, path.start[2])


class _Sequence:
    """Converter that tracks tool, spindle, coolant and position between blocks."""

    def __init__(self, program: Program, paths: Sequence[ToolPath | Function]) -> None:
        self.program = program
        self.paths = paths
        self.machine = MachineType.LATHE if _is_turning(paths) else MachineType.MILL
        cuts = [path for path in paths if isinstance(path, ToolPath)]
        self.numbers = tool_numbers(cuts)
        self.safe_z = max(map(_safe_z, cuts), default=0.0)
        self.at: Point | None = None
        self.tool: Ref[Entity] | None = None
        self.programmed: SpindleOn | SurfaceSpeed | SpindleOff | None = None
        """Spindle state that the technology asks for."""
        self.turning: SpindleOn | SurfaceSpeed | SpindleOff | SpindleOrient | None = None
        """Current state of the spindle; None if unknown."""
        self.coolant = Coolant()
        self._known: dict[Feed, ModalState] = {}
        self._notes: set[str] = set()
        self._steps = {int(step.ref): step for step in program.workingsteps}

    def blocks(self, name: str) -> Iterator[Block]:
        """Neutral blocks of the whole program."""
        yield ProgramStart(name=name, machine=self.machine)
        for ref, number in self.numbers.items():
            yield Comment(text=self._listed(ref, number))
        for path in self.paths:
            if isinstance(path, Function):
                yield from self._function(path)
                continue
            try:
                yield from self._path(path)
            except StepNcError as error:
                raise PostError(f"'{path.id}': {error}") from error
        if self.at is not None:
            yield Retract(z=max(self.safe_z, self.at[2]), is_way=True)
        yield from self._spindle(SpindleOff())
        yield from self._cool(Coolant())
        yield ProgramEnd()

    def _listed(self, ref: Ref[Entity], number: int) -> str:
        """Line of the tool list for one tool."""
        is_sized = is_described(self.program, ref)
        diameter = tool_of(self.program, ref).diameter if is_sized else 0.0
        size = f" D{diameter:g}" if diameter else ""
        return f"T{number} {tool_name(self.program, ref)}{size}"

    def _function(self, function: Function) -> Iterator[Block]:
        yield Comment(text=function.id)
        maker = FUNCTIONS.get(function.keyword)
        if maker is None:
            yield Comment(text=f"{function.keyword} is not supported")
            return
        if function.keyword in STOPS:
            # The operator may reach into the machine.
            yield from self._spindle(SpindleOff())
            yield from self._cool(Coolant())
        yield maker(function)

    def _path(self, path: ToolPath) -> Iterator[Block]:
        """Blocks of one workingstep."""
        yield Comment(text=path.id, workingstep=path.id)
        workingstep = self._steps.get(int(path.workingstep))
        yield PathControl(tolerance=path_tolerance(self.program, workingstep))
        beside = max(abs(point[1]) for point in (path.start, *(m.end for m in path.moves)))
        if self.machine is MachineType.LATHE and beside > ON_LATHE:
            raise PostError(f"y = {beside:g} mm in a turning program: a lathe has no y axis")
        self._known.clear()
        if path.tool_ref is not None and path.tool_ref != self.tool:
            yield from self._change(path.tool_ref)
        if path.technology_ref is not None and not _turns_first(path):
            feed = Feed(technology=path.technology_ref)
            yield from self._take(self._conditions(feed))
            if self.programmed is not None and self.turning != self.programmed:
                yield from self._spindle(self.programmed)
        if path.functions_ref is not None:
            yield from self._cool(coolant_of(self.program, path.functions_ref))
        yield from self._go(path.start)
        if not path.cycles:
            for step in unsplit(path.start, path.steps):
                yield from self._step(step)
            return
        cycles = {cycle.first: cycle for cycle in path.cycles}
        index = 0
        while index < len(path.steps):
            cycle = cycles.get(index)
            if cycle is None:
                yield from self._step(path.steps[index])
                index += 1
            else:
                yield from self._cycle(cycle, path.steps[index : cycle.last + 1])
                index = cycle.last + 1

    def _change(self, ref: Ref[Entity]) -> Iterator[Block]:
        """Change the tool: spindle and coolant off, retract, new tool."""
        yield from self._spindle(SpindleOff())
        yield from self._cool(Coolant())
        if self.at is not None:
            yield Retract(z=max(self.safe_z, self.at[2]), is_way=True)
        self.at, self.tool = None, ref
        self.turning = self.programmed = None
        yield ToolChange(number=self.numbers[ref], id=tool_name(self.program, ref))

    def _go(self, start: Point) -> Iterator[Block]:
        """Move up, across and down to the start of a path."""
        if self.at == start:
            return
        x, y, _ = start
        safe_z = self.safe_z if self.at is None else max(self.safe_z, self.at[2])
        if self.at is None or self.at[2] != safe_z:
            yield Retract(z=safe_z, is_way=True)
        yield Rapid(end=(x, y, safe_z), is_way=True)
        if start[2] != safe_z:
            yield Rapid(end=start, is_way=True)
        self.at = start

    def _step(self, step: Step) -> Iterator[Block]:
        if isinstance(step, Move):
            yield from self._move(step)
        elif isinstance(step, Dwell):
            yield Pause(seconds=self._seconds(step))
        elif isinstance(step, SpindleSpeedChange):
            found = self._conditions(Feed(technology=step.technology))
            # Only the spindle counts here: a feed that is missing is of no account.
            yield from self._take(found if found.spindle is None else replace(found, note=""))
        elif step is SpindleCommand.STOP:
            yield from self._spindle(SpindleOff())
        elif step is SpindleCommand.ORIENT:
            self.turning = SpindleOrient()
            yield SpindleOrient()
        elif isinstance(self.programmed, (SpindleOn, SurfaceSpeed)):
            wanted = self.programmed
            if step is SpindleCommand.REVERSE:
                wanted = replace(wanted, sense=wanted.sense.opposite)
            yield from self._spindle(wanted)

    def _move(self, move: Move) -> Iterator[Block]:
        if move.feed is None:
            self.at = move.end
            yield Rapid(end=move.end)
            return
        found = self._conditions(move.feed)
        yield from self._take(found)
        if self.turning is None and self.programmed is not None:
            yield from self._spindle(self.programmed)
        if found.lead is not None:
            yield from self._constant(move)
            self.at = move.end
            yield ThreadingMove(end=move.end, lead=found.lead)
            return
        self.at = move.end
        rate = self._rate(found)
        if move.arc is None:
            yield Linear(end=move.end, rate=rate)
        else:
            yield Circular(end=move.end, arc=move.arc, rate=rate)

    def _rate(self, state: ModalState) -> Rate:
        """Feed of a move, checked against what a control can run."""
        if state.rate is None or not isfinite(state.rate.value) or state.rate.value <= 0.0:
            raise PostError(f"a cut has no feed: {state.note or 'the feed is 0'}")
        if state.rate.value > MOST[state.rate.mode]:
            value, mode, most = state.rate.value, state.rate.mode, MOST[state.rate.mode]
            unit = "mm/s" if mode is RateMode.PER_MINUTE else "mm/rev"
            raise PostError(f"a feed of {value:g} {unit}: at most {most:g} {unit} allowed")
        return state.rate

    def _constant(self, move: Move) -> Iterator[Block]:
        """Hold the spindle speed constant for a thread."""
        if isinstance(self.programmed, SurfaceSpeed):
            radius = max(abs((self.at or move.end)[0]), abs(move.end[0]))
            fixed = constant_speed(self.programmed, radius)
            # The first pass determines the speed: later passes must meet its thread.
            if not isinstance(self.turning, SpindleOn):
                yield Comment(text="constant spindle speed for the thread")
                yield from self._spindle(fixed)

    def _cycle(self, cycle: CannedCycle, steps: Sequence[Step]) -> Iterator[Block]:
        """Drilling cycle of the control with its expansion, or a rigid tap."""
        if self.at is None:
            raise PostError("a drilling cycle comes before the first move")
        x, y, _ = self.at
        found = self._conditions(cycle.feed)
        yield from self._take(found)
        if cycle.kind is CycleKind.TAP:
            yield from self._tap(cycle, found, (x, y))
            return
        if self.turning is None and self.programmed is not None:
            yield from self._spindle(self.programmed)
        expansion = tuple(block for step in steps for block in self._step(step))
        yield DrillingCycle(
            kind=cycle.kind,
            at=(x, y),
            retract_z=cycle.retract_z,
            bottom_z=cycle.bottom_z,
            rate=self._rate(found),
            step_depth=cycle.step_depth,
            retract_distance=cycle.retract_distance,
            dwell=cycle.dwell,
            expansion=expansion,
        )

    def _tap(
        self, cycle: CannedCycle, state: ModalState, at: tuple[float, float]
    ) -> Iterator[Block]:
        spindle = self.programmed
        if not isinstance(spindle, SpindleOn):
            raise PostError("a rigid tap needs a constant spindle speed")
        lead = state.lead
        if lead is None:
            rate = self._rate(state)
            is_timed = rate.mode is RateMode.PER_MINUTE
            lead = rate.value / spindle.speed if is_timed else rate.value
        self.at = (*at, cycle.retract_z)
        yield RigidTap(
            start=self.at,
            bottom_z=cycle.bottom_z,
            lead=lead,
            speed=spindle.speed,
            sense=spindle.sense,
        )
        # Some controls leave the spindle standing.
        self.turning = None

    def _conditions(self, feed: Feed) -> ModalState:
        """Feed and spindle of a move, cached per path."""
        found = self._known.get(feed)
        if found is None:
            with self.program.using(feed.technology):
                found = conditions(self.program, feed, self.tool, self.machine)
            self._known[feed] = found
        return found

    def _take(self, state: ModalState) -> Iterator[Block]:
        """Blocks for a change of technology, such as a new spindle speed."""
        if state.note and state.note not in self._notes:
            self._notes.add(state.note)
            yield Comment(text=state.note)
        if state.spindle is not None and state.spindle != self.programmed:
            self.programmed = state.spindle
            yield from self._spindle(state.spindle)

    def _spindle(self, wanted: SpindleOn | SurfaceSpeed | SpindleOff) -> Iterator[Block]:
        if isinstance(wanted, SpindleOn) and wanted.speed > FASTEST:
            raise PostError(
                f"a spindle speed of {wanted.speed:g} rev/s: must be at most {FASTEST:g} rev/s"
            )
        if wanted != self.turning:
            self.turning = wanted
            yield wanted

    def _cool(self, wanted: Coolant) -> Iterator[Block]:
        if wanted != self.coolant:
            self.coolant = wanted
            yield wanted

    def _seconds(self, dwell: Dwell) -> float:
        """Duration of a dwell, s."""
        if dwell.seconds is not None:
            return dwell.seconds
        spindle = self.turning
        if isinstance(spindle, SurfaceSpeed):
            spindle = constant_speed(spindle, abs((self.at or (0.0, 0.0, 0.0))[0]))
        if dwell.revolutions is None or not isinstance(spindle, SpindleOn):
            raise PostError("a dwell in revolutions while the spindle is stopped")
        return dwell.revolutions / spindle.speed
