"""Setup of NC code: as given, else of its setup file, its comments and blocks, else guessed.

What is missing is told at once, with the command that is ready to be completed. Material and
machine are never guessed.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import ceil, floor
from pathlib import Path
from shlex import quote

import numpy as np

from service.programs.machine_choice import DEFAULT_LATHE, DEFAULT_MILL
from service.requests.program_facts import RawPart, StockFile
from service.simulation.code_simulation import with_called_tools
from service.simulation.placement import (
    frame_of_stock,
    in_guessed_stock,
    is_in_frame,
    placed,
)
from service.simulation.setup_file import SetupFile
from simulator.errors import LibraryError
from simulator.removal.cutter import ENDS, Cutter
from simulator.spec import WorkMaterial
from simulator.tool_files.code_tools import CodeTools, against_table, tools_of_code
from simulator.tool_files.file_unit import FileUnit
from simulator.tool_files.read import ToolLibrary, read_tools
from simulator.tools.plausible_tools import ToolGuess, ToolUse, plausible_tools
from simulator.tools.tool_table import TableTool, ToolRow
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.nc.cut_extents import CutExtents, cut_extents
from stepnc_model.nc.moves import MoveFlag, MoveKind
from stepnc_model.nc.program import NcProgram
from stepnc_model.nc.stated_stock import stated_stock
from stepnc_model.post.blocks import MachineType
from stepnc_model.programs.program import Stock

BOX, BAR = "X0,Y0,Z0,X1,Y1,Z1", "DIAMETER,Z0,Z1"


@dataclass(frozen=True, slots=True, kw_only=True)
class GivenSetup:
    """Setup that the user gives for NC code; empty values are not given."""

    file: Path
    tools: Path | None = None
    unit: FileUnit | None = None
    stock: RawPart = ""
    material: str = ""
    machine: str = ""
    file_of_setup: SetupFile | Finding | None = None
    """Setup file, or why it is not used; what is given beside it counts in its place."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeSetup:
    """Tools and stock of an NC program, and what is missing."""

    library: ToolLibrary
    stock: RawPart
    material: str = ""
    """Name of the material; empty: it is not known."""
    machine: str = ""
    """Name of the machine; the usual one where nothing names any."""
    rows: Mapping[int, ToolRow] = field(default_factory=dict)
    """Rows of the tools that comments describe, by the numbers of the tools."""
    is_stock_guessed: bool = False
    guesses: Mapping[int, ToolGuess] = field(default_factory=dict)
    """What is guessed about tools, by their numbers; nothing about those of a table."""
    uses: Mapping[int, ToolUse] = field(default_factory=dict)
    """How the program uses its tools, by their numbers."""
    lines: Mapping[int, int] = field(default_factory=dict)
    """Lines of the comments that describe tools, by the numbers of the tools."""
    missing: tuple[str, ...] = ()
    """What the user must give, in words."""
    command: str = ""
    """Command with a place for everything that is missing."""
    findings: tuple[Finding, ...] = ()
    """Where tools and stock come from, what is guessed, and contradictions."""

    def require_whole(self) -> None:
        """Raise an error that names all missing data.

        Raises
        ------
        StepNcError
            With everything that is missing, and the command to complete.
        """
        if self.missing:
            lacks = "; ".join(self.missing)
            raise StepNcError(f"missing: {lacks}; complete and run: {self.command}")

    def plausible(self, tool: TableTool, material: WorkMaterial) -> tuple[TableTool, ...]:
        """Tools that a tool may be, as far as anything about it is guessed."""
        guess = self.guesses.get(tool.number)
        if guess is None:
            return (tool,)
        return plausible_tools(tool, guess, self.uses.get(tool.number, ToolUse()), material)

    def faults_in_stock(self, faults: tuple[Finding, ...]) -> tuple[Finding, ...]:
        """Faults of a run that are none of a guessed stock."""
        return () if self.is_stock_guessed else faults

    def doubts(self, faults: tuple[Finding, ...]) -> Iterator[Finding]:
        """Warnings in place of faults of a run in a guessed stock."""
        return in_guessed_stock(faults if self.is_stock_guessed else ())


def code_setup(program: NcProgram, known: GivenSetup) -> CodeSetup:
    """Find tools and stock of NC code.

    Raises
    ------
    StepNcError
        When the tool table cannot be read, the setup file is of a program in another unit or
        with another zero, or no tool meets the stock.
    """
    known = _with_file(program, known)
    described = CodeTools()
    if program.machine is MachineType.MILL:
        described = tools_of_code(program, name=known.file.name)
    library, guesses = _tools(known, described)
    found = _stock(program, library, known)
    missing = (*_missing_tools(program, library, known), *_missing(program, known, found))
    setup = replace(
        found,
        material=known.material,
        machine=known.machine or default_machine(program),
        rows=described.rows,
        guesses=guesses,
        lines=described.lines,
        uses=dict(_uses(program, library)) if guesses else {},
        missing=missing,
        command=_command(program, known, found, lacks_tools=not library.tools),
    )
    return replace(
        setup,
        findings=(
            *_on_file(known.file_of_setup),
            *setup.findings,
            *placed(program, setup.stock, library),
            *_notes(program, known, setup),
        ),
    )


def default_machine(program: NcProgram) -> str:
    """Return the name of the machine that is taken where nothing names one."""
    return DEFAULT_LATHE if program.machine is MachineType.LATHE else DEFAULT_MILL


def _with_file(program: NcProgram, known: GivenSetup) -> GivenSetup:
    """Take what the user does not give from the setup file, if there is one."""
    file = known.file_of_setup
    if not isinstance(file, SetupFile):
        return known
    _require_same(program, file)
    return replace(
        known,
        tools=known.tools or file.table,
        material=known.material or file.material,
        machine=known.machine or file.machine,
    )


def _on_file(file: SetupFile | Finding | None) -> Iterator[Finding]:
    """Say which setup file counts, and that another one does not."""
    if isinstance(file, Finding):
        yield file
    elif file is not None:
        yield Finding(
            severity=Severity.NOTE,
            message=f"what is not given otherwise is that of {file.path}",
        )


def _require_same(program: NcProgram, file: SetupFile) -> None:
    """Refuse the setup of a program in another unit, or with another zero."""
    is_inch = program.unit > 1.0
    if file.unit is not None and (file.unit is FileUnit.INCH) is not is_inch:
        own = FileUnit.INCH if is_inch else FileUnit.MM
        raise LibraryError(
            f"{file.unit}, but the program is in {own}", path=str(file.path), key="unit"
        )
    zero = frame_of_stock(program)
    if file.zero and file.zero != zero:
        message = f"'{file.zero}', but the first cut of the program is in {zero}"
        raise LibraryError(message, path=str(file.path), key="zero")


def _tools(
    known: GivenSetup, described: CodeTools
) -> tuple[ToolLibrary, Mapping[int, ToolGuess]]:
    """Tools of a table, of the setup file, or of comments, and what is guessed about them."""
    file = known.file_of_setup
    if known.tools is not None:
        library = read_tools(known.tools, unit=known.unit)
        contradictions = against_table(described, library.by_number)
        return replace(library, findings=(*library.findings, *contradictions)), {}
    if isinstance(file, SetupFile) and file.tools:
        library = ToolLibrary(tools=file.tools)
        contradictions = against_table(described, library.by_number)
        return replace(library, findings=tuple(contradictions)), file.guesses
    library = ToolLibrary(tools=described.tools, findings=described.findings)
    return library, described.guesses


def _stock(program: NcProgram, library: ToolLibrary, known: GivenSetup) -> CodeSetup:
    """Stock as given, as the program states it, or around its cutting moves."""
    if known.stock:
        return CodeSetup(library=library, stock=known.stock)
    file = known.file_of_setup
    if isinstance(file, SetupFile) and file.stock:
        return CodeSetup(
            library=library, stock=file.stock, is_stock_guessed=file.is_stock_guessed
        )
    stated = stated_stock(program)
    if stated.stock is not None:
        text = numbers_of(stated.stock)
        what = Finding(
            severity=Severity.NOTE,
            message=f"the stock is that of the program: {text} mm",
            line=stated.line,
        )
        return CodeSetup(library=library, stock=text, findings=(*stated.findings, what))
    if program.machine is not MachineType.MILL or not library.tools:
        return CodeSetup(library=library, stock="", findings=stated.findings)
    guessed = _around_cuts(program, library)
    if guessed is None:
        return CodeSetup(library=library, stock="", findings=stated.findings)
    text, top = numbers_of(guessed.box), guessed.box.high[2]
    line = 0 if guessed.top_row < 0 else _line(program, guessed.top_row)
    what = Finding(
        severity=Severity.WARNING,
        message=f"no stock is given: a box around the cutting moves is taken, {text} mm"
        f"{f'; line {line} goes down from its top, Z {top:g}' if line else ''}; no feed falls "
        "because of it, and what meets nothing keeps its feed; give the true one with --stock",
        line=line,
    )
    return CodeSetup(
        library=library,
        stock=text,
        is_stock_guessed=True,
        findings=(*stated.findings, what),
    )


def _line(program: NcProgram, row: int) -> int:
    return program.text.line(int(program.moves.block[row]))


def _around_cuts(program: NcProgram, library: ToolLibrary) -> CutExtents | None:
    """Box around the cutting moves of tools that are known."""
    moves, tools = with_called_tools(program, library).moves, library.by_number
    rows = is_in_frame(moves)
    is_offset = bool((moves.flags & int(MoveFlag.COMPENSATED)).any())
    largest = max((_diameter(tool) for tool in tools.values()), default=0.0)

    def radius(number: int) -> float:
        # With cutter compensation the tool goes beside the contour by its radius.
        own = 0.5 * (_diameter(tools[number]) if number in tools else largest)
        return 2.0 * own if is_offset else own

    drills = frozenset(number for number, tool in tools.items() if tool.kind in ENDS)
    return cut_extents(moves, rows, radius=radius, drills=drills)


def _diameter(tool: TableTool) -> float:
    return tool.shape.diameter if isinstance(tool.shape, Cutter) else 0.0


def _uses(program: NcProgram, library: ToolLibrary) -> Iterator[tuple[int, ToolUse]]:
    """Use of each tool in a program; depths count from the highest cut."""
    moves = with_called_tools(program, library).moves
    is_fed = np.isin(moves.kind, (MoveKind.LINE, MoveKind.ARC)) & moves.is_known
    is_fed &= is_in_frame(moves)
    for number in np.unique(moves.tool[is_fed]).tolist():
        own = is_fed & (moves.tool == number)
        speeds = np.abs(moves.spindle[own])
        fastest = 0.0 if np.isnan(speeds).any() else float(speeds.max(initial=0.0))
        heights = moves.end[own, 2], moves.start[own, 2]
        depth = float(max(heights[1].max(), 0.0) - heights[0].min())
        yield number, ToolUse(speed=fastest, depth=max(depth, 0.0))


def numbers_of(stock: Stock) -> str:
    """Numbers of a stock as ``--stock`` takes them, mm."""
    low, high = stock.low, stock.high
    if stock.radius is None:
        # Rounded outward: a guess does not lose what it was grown by.
        least, most = (floor(1e3 * each) for each in low), (ceil(1e3 * each) for each in high)
        values = tuple(1e-3 * each for each in (*least, *most))
    else:
        middle = (0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]))
        values = (*middle, 2.0 * stock.radius, low[2], high[2])
    return ",".join(f"{each:.9g}" for each in values)


def _missing_tools(
    program: NcProgram, library: ToolLibrary, known: GivenSetup
) -> Iterator[str]:
    if known.tools is not None or library.tools:
        return
    moves = program.moves
    cutting = np.isin(moves.kind, (MoveKind.LINE, MoveKind.ARC))
    used = [f"T{number}" for number in np.unique(moves.tool[cutting]).tolist() if number >= 0]
    which = f" of {', '.join(used)}" if used else ""
    yield f"tools (no comment gives a diameter{which})"


def _missing(program: NcProgram, known: GivenSetup, setup: CodeSetup) -> Iterator[str]:
    can_guess = program.machine is MachineType.MILL and not setup.library.tools
    if not setup.stock and not can_guess:
        yield "stock (the code states none)"
    if not known.material:
        yield "material (`stepnc materials`)"


def _command(
    program: NcProgram, known: GivenSetup, setup: CodeSetup, *, lacks_tools: bool
) -> str:
    """Command that optimises the program, with names in capitals for what is missing."""
    is_lathe = program.machine is MachineType.LATHE
    words = ["stepnc optimise", quote(known.file.name)]
    if known.tools is not None:
        words.append(f"--tools {quote(str(known.tools))}")
    elif lacks_tools:
        words.append("--tools TABLE")
    if isinstance(known.stock, StockFile):
        words.append(f"--stock {quote(str(known.stock.path))}")
    elif known.stock:
        words.append(f"--stock={known.stock}")
    # A guessed stock is not named: it would come back as a given one.
    elif not setup.stock and (is_lathe or setup.library.tools):
        words.append(f"--stock={BAR if is_lathe else BOX}")
    words += [
        f"--material {quote(known.material) if known.material else 'MATERIAL'}",
        f"--machine {quote(known.machine or default_machine(program))}",
    ]
    return " ".join(words)


def _notes(program: NcProgram, known: GivenSetup, setup: CodeSetup) -> Iterator[Finding]:
    """Say what guesses mean, and which machine is taken where none was named either."""
    if setup.guesses:
        yield Finding(
            severity=Severity.NOTE,
            message="feeds rise only as far as holds for all usual teeth, edges and lengths of "
            "the tools; a tool table (--tools) or a setup file (`stepnc setup`) says which "
            "they have",
        )
    if not known.machine and (setup.guesses or setup.is_stock_guessed):
        yield Finding(
            severity=Severity.NOTE,
            message=f"no machine is named: {setup.machine} is taken; name yours with --machine",
        )
