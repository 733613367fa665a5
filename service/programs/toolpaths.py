"""Tool paths of a program, and the NC code that is made of them."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from service.programs.refusals import require_one_channel
from service.programs.remarks import tell_check, tell_remarks
from service.progress import Progress, Tell, silent
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.executables import Setup
from stepnc_model.errors import Finding, SchemaError
from stepnc_model.part21.values import Ref
from stepnc_model.post.blocks import Cycles
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.dialects import with_adaptive_feed, with_exact_stops, write
from stepnc_model.post.neutral import blocks_of
from stepnc_model.programs.plausibility import refusal
from stepnc_model.programs.program import Program, ResolvedWorkingstep, Stock
from stepnc_model.programs.program_listing import ProgramLine
from stepnc_model.programs.technology import programmed
from stepnc_model.toolpath.generate import PathOf, generate, raised, workingstep_path
from stepnc_model.toolpath.omissions import LeftOut
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
    reported: tuple[Finding, ...] = ()
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
        return (*of_paths, *(each for each in self.reported if each not in of_paths))


def with_remarks(paths: Paths, tell: Tell) -> Paths:
    """Tell the warnings about a program, and keep them with its paths."""
    told = paths.remarks
    tell_remarks(told, tell)
    return replace(paths, reported=told)


def paths_of(
    program: Program,
    *,
    keep_going: bool = False,
    tell: Tell = silent,
    path_of: PathOf = workingstep_path,
) -> Paths:
    """Generate the tool paths of a program, or take those that it contains."""
    faults: list[SchemaError] = []
    progress = Progress(tell, total=len(program.workingsteps))
    items: list[ToolPath | Function] = []

    def left_out(executable: ProgramLine, fault: SchemaError) -> None:
        faults.append(fault)
        items.append(_left_out(executable.ref, executable.id))
        tell(f"left out: '{executable.id}': {fault}")

    for item in generate(program, left_out if keep_going else raised, path_of=path_of):
        items.append(item)
        progress()
    if not any(isinstance(item, ToolPath) for item in items):
        raise faults[0] if faults else SchemaError("the program has nothing to machine")
    return Paths(program=program, items=tuple(items), faults=tuple(faults))


def paths_for_code(program: Program, *, keep_going: bool = False, tell: Tell = silent) -> Paths:
    """Tool paths that a control can run; tell all that ``check`` would.

    Parameters
    ----------
    keep_going : bool
        Whether workingsteps without a usable path are left out.
    tell : callable
        Receives messages.

    Raises
    ------
    StepNcError
        When a path cannot be generated or run, unless it keeps going.
    """
    require_one_channel(program)
    error = refusal(program, program.workingsteps)
    if error is not None and not keep_going:
        raise error
    paths = with_remarks(paths_of(program, keep_going=keep_going, tell=tell), tell)
    tell_check(program, paths.reported, tell)
    return with_feeds(paths, keep_going=keep_going, tell=tell)


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
    is_adaptive: bool = False,
) -> Iterator[str]:
    """Generate NC code of tool paths, line by line.

    Raises
    ------
    PostError
        If exact stops or adaptive feed are wanted, and are not written for the control.
    """
    blocks = blocks_of(paths.program, paths.items, name=Path(paths.program.name).stem)
    if is_exact:
        blocks = with_exact_stops(blocks, control)
    if is_adaptive:
        blocks = with_adaptive_feed(blocks, control)
    return write(blocks, control, cycles=cycles)
