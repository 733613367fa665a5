"""Course of a program: the stretches of its paths with what the tools meet along them."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from optimiser.along_path.caps import CutBounds
from optimiser.along_path.stretch import PathStretch
from service.simulation.setup import PreparedRun
from simulator.machine.acts import MoveStretch, ProgramAct
from simulator.machine.interpreter import Numbered, interpret
from simulator.machine.samples import Episode
from simulator.machine.virtual import MachineSetup, StockMap, VirtualMachine
from simulator.motion.segments import Bools, ControlModel, Floats, Ints, Segments
from simulator.removal.stations import Stations
from stepnc_model.errors import Finding
from stepnc_model.nc.written_lines import WrittenLines
from stepnc_model.post.blocks import Circular, DrillingCycle, Linear


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """Part of a program with one tool: a workingstep, or what lies between two tool changes."""

    name: str
    tool: int
    """Number of the tool."""


class NumberedBlocks(Protocol):
    """Blocks of a program with numbers, by which their feeds are planned."""

    def __iter__(self) -> Iterator[Numbered]:
        """Yield the blocks in the order of execution, each with its number."""
        ...

    def can_change(self, numbers: Ints) -> Bools:
        """True if blocks that were yielded may have another feed."""
        ...

    def can_split(self, numbers: Ints) -> Bools:
        """True if blocks that were yielded may be split."""
        ...

    def line(self, number: int) -> int:
        """Line of the program, counted from 1."""
        ...


class BlockLog:
    """Blocks numbered in the order of execution, each move with a feed of its own.

    Running state: it grows as the program is read.
    """

    def __init__(self, blocks: Iterable[Numbered]) -> None:
        self._blocks = blocks
        self._can_change: list[bool] = [False]
        self._can_split: list[bool] = [False]
        self._lines: list[int] = [0]

    def __iter__(self) -> Iterator[Numbered]:
        """Yield the blocks with their numbers, from 1."""
        for line, block in self._blocks:
            is_move = isinstance(block, (Linear, Circular))
            self._can_change.append(is_move or isinstance(block, DrillingCycle))
            self._can_split.append(is_move)
            self._lines.append(line)
            yield len(self._lines) - 1, block

    def can_change(self, numbers: Ints) -> Bools:
        """True if blocks are moves or cycles."""
        return np.array(self._can_change)[numbers]

    def can_split(self, numbers: Ints) -> Bools:
        """True if blocks are moves."""
        return np.array(self._can_split)[numbers]

    def line(self, number: int) -> int:
        """Line of the program, counted from 1."""
        return self._lines[number]


Choose = Callable[[Part], CutBounds | None]


class Cautious(Protocol):
    """Bounds of a program beyond the limits of its cuts."""

    def bounded(self, stretch: PathStretch, machine: VirtualMachine) -> PathStretch:
        """Return a stretch with bounds on how its programmed feeds may change."""
        ...

    def end_run(self) -> None:
        """Forget what only a run in progress needs."""
        ...

    def as_programmed(self, stretch: PathStretch, lines: Ints) -> PathStretch:
        """Return a stretch of a plan with the programmed feeds of the lines it comes from."""
        ...

    def findings(self) -> Iterable[Finding]:
        """Doubts about the program that were found."""
        ...

    def of_written(self, lines: WrittenLines) -> "Cautious":
        """Bounds of code that was written from the program."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class PathSource:
    """Program whose paths are planned."""

    prepare: Callable[[float], PreparedRun]
    """Function that prepares the program anew, in a stock that is larger by some mm."""
    bounds: Choose
    """Bounds of a part of the program; None if its feed may not be chosen."""
    numbered: Callable[[PreparedRun], NumberedBlocks] = lambda run: BlockLog(run.blocks)
    """Function that numbers the blocks of a prepared program."""
    caution: Cautious | None = None
    """Bounds on how programmed feeds may change; None: the limits of the cuts alone."""


def stretches_of(  # noqa: PLR0913 (a run, its larger stock, and who watches it)
    prepared: PreparedRun,
    larger: PreparedRun | None,
    *,
    control: ControlModel,
    bounds: Choose,
    log: NumberedBlocks,
    watch: Callable[[Episode, VirtualMachine], None],
    caution: Cautious | None = None,
) -> Iterator[PathStretch]:
    """Run a program on the virtual machine, and yield what its tools meet.

    Parameters
    ----------
    larger : PreparedRun or None
        The same program in a larger stock, of which only the stock is used; None: what is air
        is known exactly.
    bounds : callable
        Bounds of a part of the program; None if its feed may not be chosen.
    log : NumberedBlocks
        Blocks of ``prepared``.
    watch : callable
        Receives all episodes of ``prepared``.
    caution : Cautious, optional
        Bounds on how programmed feeds may change.

    Raises
    ------
    SimulationError
        When the machine cannot run the program.
    """
    run = _CourseRun(prepared, control, log, watch)
    beside = None if larger is None else _LargerStock(larger)
    for episode, stretch in run.stretches():
        course = episode.course
        if course is None:
            continue
        machine, state = run.machine, episode.state
        name = _workingstep(episode, machine)
        part = Part(name=name, tool=state.tool)
        chosen = bounds(part) if _meets_stock(prepared, part) else None
        blocks, spindle = course.segments.block, _spindle(episode)
        can_change = log.can_change(blocks) & (chosen is not None) & (spindle > 0.0)
        found = PathStretch(
            segments=course.segments,
            spindle=spindle,
            per_revolution=stretch.per_revolution,
            is_free=can_change & ~course.segments.is_rapid,
            can_split=log.can_split(blocks),
            met=course.stations,
            near=None if beside is None else beside.met(course.segments, name, machine),
            bounds=chosen,
            workingstep=name,
        )
        yield found if caution is None else caution.bounded(found, machine)
    if caution is not None:
        caution.end_run()


def _meets_stock(prepared: PreparedRun, part: Part) -> bool:
    """True if tool and stock are known, so that a path without contact is in air."""
    tool = (prepared.tools or {}).get(part.tool)
    is_known = tool is not None and tool.shape is not None
    return is_known and prepared.stock(part.name) is not None


def _workingstep(episode: Episode, machine: VirtualMachine) -> str:
    """Name of the workingstep of an episode; empty before the first."""
    number = episode.state.workingstep
    return machine.workingsteps[number - 1] if number else ""


class _LargerStock:
    """Stock that is larger by a margin, cut beside a run. Running state."""

    def __init__(self, prepared: PreparedRun) -> None:
        self._stock_of = prepared.stock
        self._known: dict[str, StockMap | None] = {}

    def met(self, segments: Segments, workingstep: str, machine: VirtualMachine) -> Stations:
        """Cut the stock where the machine has just moved; return what its tool would meet."""
        if workingstep not in self._known:
            self._known[workingstep] = self._stock_of(workingstep)
        return machine.cut(self._known[workingstep], segments)


class _CourseRun:
    """Run of a program whose stretches are paired with the acts that request them."""

    def __init__(
        self,
        prepared: PreparedRun,
        control: ControlModel,
        log: NumberedBlocks,
        watch: Callable[[Episode, VirtualMachine], None],
    ) -> None:
        self.machine = VirtualMachine(
            MachineSetup(
                machine=prepared.machine,
                control=control,
                tools=prepared.tools,
                stock=prepared.stock,
            )
        )
        self._watch = watch
        self._asked: deque[MoveStretch] = deque()
        self._episodes = self.machine.run(self._noted(interpret(log, prepared.machine)))

    def _noted(self, acts: Iterable[ProgramAct]) -> Iterator[ProgramAct]:
        for act in acts:
            if isinstance(act.act, MoveStretch):
                self._asked.append(act.act)
            yield act

    def stretches(self) -> Iterator[tuple[Episode, MoveStretch]]:
        """Yield the episodes that move, each with its request."""
        for episode in self._episodes:
            self._watch(episode, self.machine)
            if episode.course is not None:
                yield episode, self._asked.popleft()


def _spindle(episode: Episode) -> Floats:
    """Magnitude of the spindle speed in the middle of each segment, (N,), rev/s."""
    course = episode.course
    if course is None:
        return np.zeros(0)
    ends = course.motion.ends
    middle = ends - 0.5 * np.diff(ends, prepend=0.0)
    speed: Floats = np.abs(episode.spindle.speed(episode.begin + middle))
    return speed
