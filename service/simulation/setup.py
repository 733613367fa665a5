"""Setup of a simulation: blocks, tools and stock of a STEP-NC program."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from service.programs.machine_choice import machine_for, material_for
from service.programs.needs import needs_of
from service.programs.raw_stock import (
    GivenStock,
    larger_stock_map,
    raw_triangles,
    stock_map,
)
from service.programs.reading import read_completed
from service.programs.toolpaths import paths_of, with_feeds
from service.progress import Tell
from service.requests.runs import RunRequest
from simulator.machine.interpreter import Numbered
from simulator.machine.tooling import loaded_tool
from simulator.machine.virtual import LoadedTool, StockMap
from simulator.spec import Machine, MaterialMatch
from simulator.tool_files.read import ToolLibrary
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.executables import Setup
from stepnc_model.errors import Finding, SchemaError
from stepnc_model.nc.program import NcProgram
from stepnc_model.part21.values import Ref
from stepnc_model.post.neutral import blocks_of, tool_numbers
from stepnc_model.programs.plausibility import refusal
from stepnc_model.programs.program import Program, ResolvedWorkingstep, Stock
from stepnc_model.toolpath.task import stock_of

T = TypeVar("T")

AROUND_PATH, AROUND_PROGRAM = 4, 7
"""Blocks around each path (tool, spindle, coolant), and at the start and end of a program."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PreparedRun:
    """Program or NC code, prepared with machine, tools and stock."""

    name: str
    machine: Machine
    material: MaterialMatch | None
    blocks: Iterator[Numbered]
    tools: dict[int, LoadedTool] | None
    stock: Callable[[str], StockMap | None]
    raw: Stock | None
    """Raw part of the first workingstep."""
    done: Callable[[], float]
    """Function that returns the share of the program that has been read, 0 to 1."""
    read: Callable[[], int]
    """Function that returns the number of the last block read."""
    program: Program | None = None
    """STEP-NC program; None for NC code alone."""
    code: NcProgram | None = None
    """NC code without a program; None for any other."""
    is_stock_guessed: bool = False
    findings: tuple[Finding, ...] = ()
    remarks: tuple[Finding, ...] = ()
    """Warnings about the program, the same for every command."""
    faults: tuple[SchemaError, ...] = ()
    """Reasons why some workingsteps were left out."""
    left_out: frozenset[int] = frozenset()
    """Instances of the workingsteps that were left out."""


class CountedIterator(Generic[T]):
    """Iterator that counts its items. Running state."""

    def __init__(self, items: Iterable[T], size: Callable[[T], int] | None = None) -> None:
        self.count = 0
        self.size = 0
        self._items = items
        self._size = size

    def __iter__(self) -> Iterator[T]:
        for item in self._items:
            self.count += 1
            self.size += 1 if self._size is None else self._size(item)
            yield item

    def share(self, whole: int) -> float:
        """Return the share of a whole that has been iterated."""
        return min(1.0, self.size / max(1, whole))


def from_program(
    file: Path,
    request: RunRequest,
    *,
    name: str = "",
    tools: ToolLibrary | None = None,
    keep_going: bool = False,
    tell: Tell,
) -> PreparedRun:
    """Prepare a STEP-NC program on a suitable machine.

    Parameters
    ----------
    name : str
        Name of the program; empty: the name of its file.
    tools : ToolLibrary or None
        Tools of which the file may have nothing but the name.
    keep_going : bool
        Whether workingsteps that cannot be run, and what depends on them, are left out.
    tell : callable
        Receives messages.

    Raises
    ------
    StepNcError
        When a name is invalid, or the program cannot be prepared.
    """
    program = read_completed(file, request, name=name, tools=tools, tell=tell).program
    if not keep_going:
        needs_of(program, request, file=name or str(file)).require_whole()
    match = material_for(request.material, program)
    tell(f"material: {match.reason}")
    machine = machine_for(request.machine, program)
    return prepared_program(program, machine, match, keep_going=keep_going, tell=tell)


def prepared_program(
    program: Program,
    chosen: Machine,
    match: MaterialMatch,
    *,
    tell: Tell,
    margin: float = 0.0,
    keep_going: bool = False,
) -> PreparedRun:
    """Prepare a program that is already read, on a suitable machine.

    Parameters
    ----------
    tell : callable
        Receives messages.
    margin : float, mm
        Distance by which the stock is larger than the file says.
    keep_going : bool
        Whether workingsteps that cannot be run, and what depends on them, are left out.

    Raises
    ------
    StepNcError
        When a tool path cannot be generated, or the numbers cannot be in the program's units.
    """
    error = refusal(program, program.workingsteps)
    if error is not None and not keep_going:
        raise error
    paths = paths_of(program, keep_going=keep_going, tell=tell)

    def require_tool(step: ResolvedWorkingstep) -> None:
        loaded_tool(program, step.tool_ref, 1, match.material)

    paths = with_feeds(paths, keep_going=keep_going, also=require_tool, tell=tell)
    present = {int(path.workingstep) for path in paths.paths}
    numbers = tool_numbers(paths.paths)
    steps = sum(len(path.steps) for path in paths.paths)
    blocks = CountedIterator(blocks_of(program, paths.items, name=Path(program.name).stem))
    return PreparedRun(
        name=program.name,
        machine=chosen,
        material=match,
        blocks=((blocks.count, block) for block in blocks),
        tools=loaded_tools(program, numbers, match),
        stock=ClampedStock(program, chosen, margin).stock,
        raw=paths.stock,
        # Most steps become one block; the number of other blocks is taken from the examples.
        done=lambda: blocks.share(steps + AROUND_PATH * len(paths.paths) + AROUND_PROGRAM),
        read=lambda: blocks.count,
        program=program,
        findings=paths.findings,
        remarks=paths.remarks,
        faults=paths.faults,
        left_out=frozenset(
            int(step.ref) for step in program.workingsteps if int(step.ref) not in present
        ),
    )


class ClampedStock:
    """Stock of each setup, updated as it is machined. Running state."""

    def __init__(self, program: Program, machine: Machine, margin: float = 0.0) -> None:
        self._program = program
        self._machine = machine
        self._margin = margin
        self._setups = _setups(program)
        self._maps: dict[object, StockMap | None] = {}

    def stock(self, workingstep: str) -> StockMap | None:
        """Return the stock at the beginning of a workingstep."""
        if workingstep not in self._setups:
            return None
        setup = self._setups[workingstep]
        if setup not in self._maps:
            raw = stock_of(self._program, setup)
            self._maps[setup] = None if raw is None else self._map(raw, setup)
        return self._maps[setup]

    def _map(self, bounds: Stock, setup: Ref[Setup] | None) -> StockMap:
        """Map of a raw part, which is a mesh if the file has a B-rep body of it."""
        mesh = raw_triangles(self._program, setup)
        if mesh is None:
            return stock_map(self._machine, GivenStock(bounds=bounds.grown(self._margin)))
        raw = GivenStock(bounds=bounds, triangles=mesh, name=self._program.name)
        if self._margin > 0.0:
            return larger_stock_map(self._machine, raw, self._margin)
        return stock_map(self._machine, raw)


def _setups(program: Program) -> dict[str, Ref[Setup] | None]:
    """Setup of each workingstep by its id, by which a run tells them apart.

    Raises
    ------
    SchemaError
        If an id stands for workingsteps in two setups.
    """
    first: dict[str, ResolvedWorkingstep] = {}
    for step in program.workingsteps:
        other = first.setdefault(step.id, step)
        if other.setup != step.setup:
            raise program.error(same_id(step, other, "setup"), step.ref, "its_id")
    return {name: step.setup for name, step in first.items()}


def same_id(step: ResolvedWorkingstep, other: ResolvedWorkingstep, what: str) -> str:
    """Reason why an id must not stand for two workingsteps."""
    return f"'{step.id}' is also the id of {other.ref}, with another {what}"


def loaded_tools(
    program: Program, numbers: dict[Ref[Entity], int], match: MaterialMatch
) -> dict[int, LoadedTool]:
    """Tools of a program by number, with their data for the material.

    Raises
    ------
    StepNcError
        When a tool lacks something that a run needs.
    """
    return {
        number: loaded_tool(program, ref, number, match.material)
        for ref, number in numbers.items()
    }
