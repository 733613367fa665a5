"""Tool paths and NC code of a program: commands ``toolpath``, ``post`` and ``canonical``."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

from service.files import (
    beside,
    read_bytes,
    require_place,
    write_lines,
)
from service.paths.remarks import tell_check, tell_remarks
from service.progress import Progress
from service.reading import Tell, one_of, read_given, silent
from service.requests.given import ProgramRequest
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.executables import Setup
from stepnc_model.errors import Finding, PostError, SchemaError, StepNcError
from stepnc_model.part21.values import Ref
from stepnc_model.plausibility import refusal
from stepnc_model.post.blocks import Cycles, MachineType
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.dialects import read, with_exact_stops, write
from stepnc_model.post.neutral import blocks_of
from stepnc_model.program import Program, ProgramLine, ResolvedWorkingstep, Stock
from stepnc_model.technology import programmed
from stepnc_model.toolpath.generate import generate, raised
from stepnc_model.toolpath.left_out import LeftOut
from stepnc_model.toolpath.path import LEFT_OUT, Function, Point, ToolPath
from stepnc_model.toolpath.remarks import remarks
from stepnc_model.toolpath.task import clamps_of, stock_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Paths:
    """Tool paths of a program."""

    program: Program
    items: tuple[ToolPath | Function, ...]
    faults: tuple[SchemaError, ...]
    """Reasons why some executables were left out."""
    told: tuple[Finding, ...] = ()
    """Warnings about the program that were told already."""

    @property
    def paths(self) -> tuple[ToolPath, ...]:
        """Tool paths without the functions between them."""
        return tuple(item for item in self.items if isinstance(item, ToolPath))

    @property
    def clamps(self) -> tuple[Point, ...]:
        """Clamping positions of the workpiece, in the setup of the first workingstep."""
        return clamps_of(self.program, self._setup)

    @property
    def stock(self) -> Stock | None:
        """Raw part in the setup of the first workingstep."""
        return stock_of(self.program, self._setup)

    @property
    def _setup(self) -> Ref[Setup] | None:
        return next((step.setup for step in self.program.workingsteps), None)

    @property
    def remarks(self) -> tuple[Finding, ...]:
        """Warnings about the program, the same for every command."""
        return remarks(self.program, self.paths)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Assumptions made for the tool paths."""
        of_paths = tuple(finding for path in self.paths for finding in path.findings)
        return (*of_paths, *(each for each in self.told if each not in of_paths))


@dataclass(frozen=True, slots=True, kw_only=True)
class PostRequest:
    """Request to write NC code for a control."""

    file: Path
    control: str
    program: ProgramRequest = field(default_factory=ProgramRequest)
    """What is given about the program beyond its file."""
    output: Path | None = None
    cycles: bool = False
    exact_path: bool = False
    """Whether the control stops at corners instead of rounding them."""
    keep_going: bool = False


def with_remarks(paths: Paths, tell: Tell) -> Paths:
    """Tell the warnings about a program, and keep them with its paths."""
    told = paths.remarks
    tell_remarks(told, tell)
    return replace(paths, told=told)


def paths_of(program: Program, *, keep_going: bool = False, tell: Tell = silent) -> Paths:
    """Generate the tool paths of a program, or take those that it contains."""
    faults: list[SchemaError] = []
    progress = Progress(tell, total=len(program.workingsteps))
    items: list[ToolPath | Function] = []

    def left_out(executable: ProgramLine, fault: SchemaError) -> None:
        faults.append(fault)
        items.append(_left_out(executable.ref, executable.id))
        tell(f"left out: '{executable.id}': {fault}")

    for item in generate(program, left_out if keep_going else raised):
        items.append(item)
        progress()
    if not any(isinstance(item, ToolPath) for item in items):
        raise faults[0] if faults else SchemaError("the program has nothing to machine")
    return Paths(program=program, items=tuple(items), faults=tuple(faults))


def post(request: PostRequest, *, tell: Tell = silent) -> Paths:
    """Write NC code for a control.

    Raises
    ------
    StepNcError
        When the control is unknown, a path cannot be generated, or the file cannot be written.
    """
    control = one_of(Dialect, request.control.lower(), "control")
    output = request.output or beside(request.file, control.suffix)
    require_place(output, apart_from=request.file)
    program = read_given(request.file, request.program, tell=tell).program
    error = refusal(program, program.workingsteps)
    if error is not None and not request.keep_going:
        raise error
    paths = with_remarks(paths_of(program, keep_going=request.keep_going, tell=tell), tell)
    tell_check(program, paths.told, tell)
    paths = with_feeds(paths, keep_going=request.keep_going, tell=tell)
    cycles = Cycles.OWN if request.cycles else Cycles.EXPANDED
    lines = nc_lines(paths, control, cycles, is_exact=request.exact_path)
    count = write_lines(output, lines)
    tell(f"written: {output} ({count} lines)")
    return paths


def no_more(_step: ResolvedWorkingstep) -> None:
    """Require nothing more of a workingstep."""


def with_feeds(
    paths: Paths,
    *,
    keep_going: bool,
    also: Callable[[ResolvedWorkingstep], None] = no_more,
    tell: Tell = silent,
) -> Paths:
    """Keep only paths whose technology defines a feed, which a control needs.

    Parameters
    ----------
    paths : Paths
    keep_going : bool
        Whether other paths are left out; otherwise the first of them is an error.
    also : callable
        Raises an error for a workingstep that lacks more.
    tell : callable
        Receives messages.

    Raises
    ------
    SchemaError
        At the first path without a feed, unless it keeps going.
    """
    items: list[ToolPath | Function] = []
    faults: list[SchemaError] = []
    steps = {int(step.ref): step for step in paths.program.workingsteps}
    left_out = LeftOut(paths.program)
    for item in paths.items:
        step = steps.get(int(item.workingstep)) if isinstance(item, ToolPath) else None
        try:
            if step is not None and isinstance(item, ToolPath):
                left_out.require_ready(step, item)
                _require_numbers(paths.program, step, keep_going=keep_going)
                also(step)
            items.append(item)
        except SchemaError as fault:
            if not keep_going:
                raise
            if step is not None and isinstance(item, ToolPath):
                left_out.add(step, item)
                items.append(_left_out(step.ref, step.id))
            faults.append(fault)
            tell(f"left out: '{item.id}': {fault}")
    if not any(isinstance(item, ToolPath) for item in items):
        raise faults[0]
    return replace(paths, items=tuple(items), faults=(*paths.faults, *faults))


def _require_numbers(program: Program, step: ResolvedWorkingstep, *, keep_going: bool) -> None:
    """Refuse a workingstep without feed or speed, or with numbers that cannot be meant.

    Where one fault ends all, numbers are refused before any path is made.
    """
    programmed(program, step.technology_ref)
    error = refusal(program, (step,)) if keep_going else None
    if error is not None:
        raise error


def _left_out(ref: Ref[Entity], name: str) -> Function:
    """Placeholder for a workingstep without a path, which becomes a comment in the NC code."""
    return Function(ref=ref, keyword=LEFT_OUT, id=name)


def nc_lines(
    paths: Paths,
    control: Dialect,
    cycles: Cycles = Cycles.EXPANDED,
    *,
    is_exact: bool = False,
) -> Iterator[str]:
    """Generate NC code of tool paths, line by line.

    Raises
    ------
    PostError
        If exact stops are asked for, and are not written for the control.
    """
    blocks = blocks_of(paths.program, paths.items, name=Path(paths.program.name).stem)
    if is_exact:
        blocks = with_exact_stops(blocks, control)
    return write(blocks, control, cycles=cycles)


def canonical_of(path: Path, *, control: str, is_lathe: bool) -> Iterator[str]:
    """Convert NC code to canonical commands, one per line.

    Raises
    ------
    StepNcError
        When the control is unknown, or a line cannot be read.
    """
    dialect = one_of(Dialect, control.lower(), "control")
    machine = MachineType.LATHE if is_lathe else MachineType.MILL
    lines = read_bytes(path).decode("utf-8", errors="replace").splitlines()
    try:
        commands = read(lines, dialect, machine=machine)
    except PostError as error:
        may_be_lathe = dialect in {Dialect.FANUC, Dialect.HAAS} and not is_lathe
        hint = " (use --lathe for lathe code)" if may_be_lathe else ""
        raise StepNcError(f"{path.name}: {error}{hint}") from error
    return (str(command) for command in commands)
