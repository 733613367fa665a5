"""Setup of a simulation: blocks, tools and stock, from a program or from NC code."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from service.chosen import load_material_named, machine_for, material_for
from service.files import open_lines
from service.paths.toolpaths import paths_of, with_feeds
from service.raw_stock import (
    GivenStock,
    larger_stock_map,
    raw_stock_of,
    raw_triangles,
    stock_map,
)
from service.reading import Tell, one_of, read_program
from simulator.library import load_machine
from simulator.machine.interpreter import Numbered
from simulator.machine.tooling import loaded_tool, table_tool
from simulator.machine.virtual import LoadedTool, StockMap
from simulator.spec import Machine, MachineKind, MaterialMatch
from simulator.tool_files.file_unit import FileUnit
from simulator.tool_files.read import read_tools
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.executables import Setup
from stepnc_model.errors import Finding, PostError, Severity, StepNcError
from stepnc_model.part21.values import Ref
from stepnc_model.plausibility import refusal
from stepnc_model.post import blocks as post
from stepnc_model.post.dialect import SUFFIXES, Dialect
from stepnc_model.post.dialects import read_blocks
from stepnc_model.post.neutral import blocks_of, tool_numbers
from stepnc_model.program import Program, Stock
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
    findings: tuple[Finding, ...] = ()
    remarks: tuple[Finding, ...] = ()
    """Warnings about the program, the same for every command."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeRequest:
    """NC code, with the data that it lacks."""

    code: Path
    dialect: str = ""
    """Dialect of the code; empty: by the file extension."""
    tools: Path | None = None
    """Tool table, in any format that is read."""
    tools_unit: FileUnit | None = None
    """Unit of a tool table that names none; None: mm."""
    stock: str = ""
    """Raw part, as :func:`service.raw_stock.raw_stock_of` reads it; empty: unknown."""
    is_foreign: bool = False
    """Whether what is understood of code of any origin runs, and the rest is listed."""


class CountedIterator(Generic[T]):
    """Iterator that counts its items. Running state."""

    def __init__(self, items: Iterable[T], size: Callable[[T], int] = lambda _: 1) -> None:
        self.count = 0
        self.size = 0
        self._items = items
        self._size = size

    def __iter__(self) -> Iterator[T]:
        for item in self._items:
            self.count += 1
            self.size += self._size(item)
            yield item

    def share(self, whole: int) -> float:
        """Return the share of a whole that has been iterated."""
        return min(1.0, self.size / max(1, whole))


def from_program(
    file: Path, *, name: str = "", units: str, machine: str, material: str, tell: Tell
) -> PreparedRun:
    """Prepare a STEP-NC program on a suitable machine.

    Raises
    ------
    StepNcError
        When the file or a name is invalid.
    """
    program = read_program(file, units=units, name=name, tell=tell)
    match = material_for(material, program)
    tell(f"material: {match.reason}")
    return prepared_program(program, machine_for(machine, program), match, tell=tell)


def prepared_program(
    program: Program,
    chosen: Machine,
    match: MaterialMatch,
    *,
    tell: Tell,
    margin: float = 0.0,
) -> PreparedRun:
    """Prepare a program that is already read, on a suitable machine.

    Parameters
    ----------
    program : Program
    chosen : Machine
    match : MaterialMatch
    tell : callable
        Receives messages.
    margin : float, mm
        Distance by which the stock is larger than the file says.

    Raises
    ------
    StepNcError
        When a tool path cannot be generated, or the numbers cannot be in the program's units.
    """
    error = refusal(program, program.workingsteps)
    if error is not None:
        raise error
    paths = with_feeds(paths_of(program, tell=tell), keep_going=False)
    numbers = tool_numbers(paths.paths)
    steps = sum(len(path.steps) for path in paths.paths)
    blocks = CountedIterator(blocks_of(program, paths.items, name=Path(program.name).stem))
    return PreparedRun(
        name=program.name,
        machine=chosen,
        material=match,
        blocks=((blocks.count, block) for block in blocks),
        tools=_tools(program, numbers, match),
        stock=_Clamped(program, chosen, margin).stock,
        raw=paths.stock,
        # Most steps become one block; the number of other blocks is taken from the examples.
        done=lambda: blocks.share(steps + AROUND_PATH * len(paths.paths) + AROUND_PROGRAM),
        read=lambda: blocks.count,
        program=program,
        findings=paths.findings,
        remarks=paths.remarks,
    )


def from_code(
    request: CodeRequest, *, program: Path | None, units: str, machine: str, material: str
) -> PreparedRun:
    """Prepare NC code, with tools and stock of its program or as the user specifies.

    Raises
    ------
    StepNcError
        When a file or a name is invalid.
    """
    if program is not None:
        return _code_of_program(request, program, units=units, names=(machine, material))
    if not machine:
        raise StepNcError("NC code without a program: name a machine with --machine")
    chosen = load_machine(machine)
    match = load_material_named(material) if material else None
    tools = None
    findings: tuple[Finding, ...] = ()
    if request.tools is not None:
        if match is None:
            raise StepNcError("a tool table without a material: name one with --material")
        library = read_tools(request.tools, unit=request.tools_unit)
        findings += library.findings
        tools = {tool.number: table_tool(tool, match.material) for tool in library.tools}
    raw = raw_stock_of(request.stock) if request.stock else None
    size = _size(request.code)
    lines = CountedIterator(_lines(request.code), len)
    clamped = None if raw is None else stock_map(chosen, raw)
    if clamped is None or tools is None:
        text = "no material is removed without stock, tool table and material: idle power only"
        findings += (Finding(severity=Severity.WARNING, message=text),)
    return PreparedRun(
        name=request.code.name,
        machine=chosen,
        material=match,
        blocks=_read(request, lines, chosen, {}),
        tools=tools,
        stock=lambda _: clamped,
        raw=None if raw is None else raw.bounds,
        done=lambda: lines.share(size),
        read=lambda: lines.count,
        findings=findings,
    )


def _code_of_program(
    request: CodeRequest, file: Path, *, units: str, names: tuple[str, str]
) -> PreparedRun:
    """Prepare NC code made from a program; tools are numbered in the order of their use."""
    program = read_program(file, units=units)
    match = material_for(names[1], program)
    machine = machine_for(names[0], program)
    used = dict.fromkeys(step.tool_ref for step in program.workingsteps)
    numbers = {ref: number for number, ref in enumerate(used, 1)}
    ids = {_plain(step.id): step.id for step in program.workingsteps}
    size = _size(request.code)
    lines = CountedIterator(_lines(request.code), len)
    setup = next((step.setup for step in program.workingsteps), None)
    return PreparedRun(
        name=request.code.name,
        machine=machine,
        material=match,
        blocks=_read(request, lines, machine, ids),
        tools=_tools(program, numbers, match),
        stock=_Clamped(program, machine).stock,
        raw=stock_of(program, setup),
        done=lambda: lines.share(size),
        read=lambda: lines.count,
        program=program,
    )


class _Clamped:
    """Stock of each setup, updated as it is machined. Running state."""

    def __init__(self, program: Program, machine: Machine, margin: float = 0.0) -> None:
        self._program = program
        self._machine = machine
        self._margin = margin
        self._setups = {step.id: step.setup for step in program.workingsteps}
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


def _tools(
    program: Program, numbers: dict[Ref[Entity], int], match: MaterialMatch
) -> dict[int, LoadedTool]:
    return {
        number: loaded_tool(program, ref, number, match.material)
        for ref, number in numbers.items()
    }


def _size(path: Path) -> int:
    """Size of a file, in bytes; raises an error of the project if it does not exist."""
    try:
        return path.stat().st_size
    except OSError as error:
        raise StepNcError(f"{path}: {error.strerror}") from error
    except ValueError as error:
        raise StepNcError(f"{str(path)!r} is not a valid file name: {error}") from error


def _lines(path: Path) -> Iterator[str]:
    """Yield the lines of a file, which is opened only when the first is requested."""
    yield from open_lines(path)


def _read(
    request: CodeRequest, lines: CountedIterator[str], machine: Machine, ids: dict[str, str]
) -> Iterator[Numbered]:
    """Yield the blocks of NC code; comments that name a workingstep start it."""
    kind = (
        post.MachineType.LATHE if machine.kind is MachineKind.LATHE else post.MachineType.MILL
    )
    dialect = dialect_of(request.code, request.dialect)
    try:
        for block in read_blocks(lines, dialect, machine=kind):
            if isinstance(block, post.Comment) and _plain(block.text) in ids:
                name = ids[_plain(block.text)]
                yield lines.count, post.Comment(text=block.text, workingstep=name)
            else:
                yield lines.count, block
    except PostError as error:
        raise StepNcError(
            f"{request.code.name}: {error} (the virtual machine reads plain code; --foreign "
            "runs what is understood of code of any origin, as `stepnc check` and `optimise` "
            "read it)"
        ) from error


def dialect_of(code: Path, named: str) -> Dialect:
    """Dialect of NC code: as named, or by the file extension.

    Raises
    ------
    StepNcError
        When the name or the extension is unknown.
    """
    if named:
        return one_of(Dialect, named.lower(), "dialect")
    for control, suffix in SUFFIXES.items():
        if code.name.lower().endswith(suffix):
            return control
    known = ", ".join(control.value for control in Dialect)
    raise StepNcError(f"{code}: unknown file extension; add --dialect: {known}")


def _plain(text: str) -> str:
    """Normalise a comment, which controls may spell differently, to capitals and digits."""
    return "".join(filter(str.isalnum, text)).upper()
