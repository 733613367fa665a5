"""Setup of a simulation from NC code, of our own or of any origin.

What cannot be run is refused, or left out with a finding.

Tools of NC code that a table knows otherwise than by a number in the code.

Sinumerik and Heidenhain may call a tool by its name, which is then the ``id`` of the table.
Code of small machines, on which tools are changed by hand, calls none.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from service.files import read_bytes
from service.programs.machine_choice import load_material_named, machine_for, material_for
from service.programs.reading import one_of, read_completed
from service.requests.program_facts import RawPart
from service.requests.runs import RunRequest
from service.simulation.code_paths import CodePaths
from service.simulation.setup import ClampedStock, CountedIterator, PreparedRun, loaded_tools
from service.simulation.spindle_hand import turned_against
from simulator.library import load_machine
from simulator.machine.interpreter import Numbered
from simulator.spec import Machine, MachineKind, MaterialMatch
from simulator.tool_files.file_unit import FileUnit
from simulator.tool_files.read import ToolLibrary, read_tools
from stepnc_model.errors import Finding, PostError, Severity, StepNcError
from stepnc_model.nc.control_guess import recognise
from stepnc_model.nc.exact_reading import read_exactly
from stepnc_model.nc.moves import ModalSetting
from stepnc_model.nc.neutral_blocks import UNKNOWN, stream_blocks
from stepnc_model.nc.program import NcProgram, read_program
from stepnc_model.nc.remarks import NOT_UNDERSTOOD
from stepnc_model.post.blocks import Comment, MachineType
from stepnc_model.post.dialect import SUFFIXES, Dialect
from stepnc_model.toolpath.task import stock_of


def with_called_tools(program: NcProgram, library: ToolLibrary) -> NcProgram:
    """Return the program with numbers for the tools that it names or leaves out."""
    names = _numbers_by_name(library)
    settings = program.moves.settings
    if _is_without_tools(program) and len(library.tools) == 1:
        only = library.tools[0].number
        found = tuple(replace(each, tool=only) for each in settings)
    else:
        found = tuple(_numbered(each, names) for each in settings)
    return replace(program, stream=replace(program.stream, settings=found))


def called_tool_findings(program: NcProgram, library: ToolLibrary) -> Iterator[Finding]:
    """Findings on tools that the program calls by name, or not at all."""
    names = _numbers_by_name(library)
    for name in dict.fromkeys(each.tool_name for each in program.moves.settings):
        if not name:
            continue
        number = names.get(name.casefold())
        if number is None:
            text = f"tool '{name}' is the id of no tool of the table: its feeds stay"
            yield Finding(severity=Severity.WARNING, message=text)
        else:
            text = f"tool '{name}' is T{number} of the table, by its id"
            yield Finding(severity=Severity.NOTE, message=text)
    if _is_without_tools(program):
        if len(library.tools) == 1:
            text = (
                f"the program calls no tool: T{library.tools[0].number}, the only one of the "
                "table, is taken"
            )
        else:
            text = (
                f"the program calls no tool, and the table has {len(library.tools)}: name a "
                "table with the one that cuts"
            )
        yield Finding(severity=Severity.WARNING, message=text)


def _numbers_by_name(library: ToolLibrary) -> dict[str, int]:
    """Numbers of the tools by their ids in small letters; ids of several tools are left out."""
    found: dict[str, int] = {}
    several = set()
    for tool in library.tools:
        name = tool.id.casefold()
        if name in found:
            several.add(name)
        found[name] = tool.number
    return {name: number for name, number in found.items() if name not in several}


def _numbered(setting: ModalSetting, names: dict[str, int]) -> ModalSetting:
    """Return the setting with the number of the tool that it names, if there is one."""
    if setting.tool is not None:
        return setting
    return replace(setting, tool=names.get(setting.tool_name.casefold()))


def _is_without_tools(program: NcProgram) -> bool:
    """True if the program calls no tool at all."""
    return all(each.tool is None and not each.tool_name for each in program.moves.settings)


IDLE = Finding(
    severity=Severity.WARNING,
    message="no material is removed without stock, tool table and material: idle power only",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeRequest:
    """NC code, with the data that it lacks."""

    code: Path
    dialect: str = ""
    """Dialect of the code; empty: by the file extension, or as its words show."""
    tools: Path | None = None
    """Tool table, in any format that is read."""
    tools_unit: FileUnit | None = None
    """Unit of a tool table that names none; None: mm."""
    library: ToolLibrary | None = None
    """Tools of the code's setup, in place of a table."""
    stock: RawPart = ""
    """Raw part, as :func:`service.programs.raw_stock.raw_stock_of` reads it; empty: unknown."""
    most_repeats: int | None = None
    """Blocks and moves that may be executed beyond those of the file; None: as usual."""
    keeps_state: frozenset[int] = frozenset()
    """Numbers of programs outside the file that leave the modal state as it was."""
    is_stock_guessed: bool = False
    findings: tuple[Finding, ...] = ()
    """Findings on the code's setup."""


def from_code(
    request: CodeRequest, run: RunRequest, *, program: Path | None, keep_going: bool = False
) -> PreparedRun:
    """Prepare NC code, with tools and stock of its program or as the user specifies.

    Parameters
    ----------
    program : Path, optional
        STEP-NC program of which the code was made.
    keep_going : bool
        Whether what cannot be run is left out; else it is refused.

    Raises
    ------
    StepNcError
        When a file or a name is invalid.
    """
    if program is not None:
        return _code_of_program(request, program, run)
    if not run.machine:
        raise StepNcError("NC code without a program: name a machine with --machine")
    machine = load_machine(run.machine)
    material = load_material_named(run.material) if run.material else None
    library = request.library
    if library is None and request.tools is not None:
        if material is None:
            raise StepNcError("a tool table without a material: name one with --material")
        library = read_tools(request.tools, unit=request.tools_unit)
    paths = _paths_of_any_origin(request, machine, material, library)
    error = _fault(paths)
    if error is not None and not keep_going:
        raise StepNcError(f"{request.code.name}: {error} (--keep-going leaves it out)")
    prepared = _prepared(paths)
    findings = (*request.findings, *prepared.findings)
    if library is not None:
        wrong = (each for _, each in turned_against(paths.program, paths.tools))
        findings = (*library.findings, *findings, *wrong)
    if library is None or not request.stock:
        findings += (IDLE,)
    return replace(prepared, findings=findings, is_stock_guessed=request.is_stock_guessed)


def _paths_of_any_origin(
    request: CodeRequest,
    machine: Machine,
    material: MaterialMatch | None,
    library: ToolLibrary | None,
) -> CodePaths:
    """Moves of code of any origin, of which some may not run."""
    data = read_bytes(request.code)
    guess, dialect = recognise(data), None
    if request.dialect or not guess.hints:
        dialect = dialect_of(request.code, request.dialect)
    found, most = guess.machine, request.most_repeats
    kept = request.keeps_state
    program = read_program(
        data, dialect=dialect, machine=found, most_repeats=most, keeps_state=kept
    )
    is_without_y = bool((np.nan_to_num(program.moves.end[:, 1]) == 0.0).all())
    if is_without_y and found is MachineType.MILL and machine.kind is MachineKind.LATHE:
        # Nothing else may show that code is for a lathe.
        program = read_program(
            data,
            dialect=dialect,
            machine=MachineType.LATHE,
            most_repeats=most,
            keeps_state=kept,
        )
    if program.machine is not _kind(machine):
        raise StepNcError(
            f"{request.code.name}: this is code for a {found.value}, and {machine.name} is a "
            f"{machine.kind.value}"
        )
    if library is not None:
        called = called_tool_findings(program, library)
        program = replace(
            with_called_tools(program, library), findings=(*program.findings, *called)
        )
    return CodePaths(
        program,
        machine,
        material,
        name=request.code.name,
        tools=None if library is None else library.by_number,
        stock=request.stock,
    )


def _fault(paths: CodePaths) -> str | None:
    """First fault that prevents code from running, in the most specific words, or None."""
    faults = {each.line: each.message for each in reversed(paths.left_out)}
    for each in reversed(paths.program.findings):
        if each.message.startswith(NOT_UNDERSTOOD):
            faults[each.line] = f"line {each.line}: {each.message}"
    return faults[min(faults)] if faults else None


def _prepared(paths: CodePaths) -> PreparedRun:
    """Prepare code without the moves that cannot be run."""
    code = paths.program
    findings = (*code.findings, *paths.left_out, *paths.contour_remarks)
    if code.hints and code.dialect is not _dialect_by_suffix(Path(paths.name)):
        text = f"read as code for {code.dialect.value}, guessed from {', '.join(code.hints)}"
        findings = (Finding(severity=Severity.NOTE, message=text), *findings)
    return replace(paths.prepared(0.0), code=code, findings=findings)


def _code_of_program(request: CodeRequest, file: Path, run: RunRequest) -> PreparedRun:
    """Prepare NC code made from a program; tools are numbered in the order of their use."""
    program = read_completed(file, run).program
    match = material_for(run.material, program)
    machine = machine_for(run.machine, program)
    used = dict.fromkeys(step.tool_ref for step in program.workingsteps)
    numbers = {ref: number for number, ref in enumerate(used, 1)}
    ids = {_plain(step.id): step.id for step in program.workingsteps}
    dialect = dialect_of(request.code, request.dialect)
    try:
        code = read_exactly(
            read_bytes(request.code), dialect, machine=_kind(machine), start=UNKNOWN
        )
    except PostError as error:
        raise StepNcError(f"{request.code.name}: {error}") from error
    blocks = CountedIterator(_named_workingsteps(code, ids))
    setup = next((step.setup for step in program.workingsteps), None)
    return PreparedRun(
        name=request.code.name,
        machine=machine,
        material=match,
        blocks=iter(blocks),
        tools=loaded_tools(program, numbers, match),
        stock=ClampedStock(program, machine).stock,
        raw=stock_of(program, setup),
        done=lambda: blocks.share(len(code.stream)),
        read=lambda: blocks.count,
        program=program,
    )


def _named_workingsteps(code: NcProgram, ids: dict[str, str]) -> Iterator[Numbered]:
    """Yield the blocks of NC code; comments that name a workingstep start it."""
    for line, block in stream_blocks(code):
        if isinstance(block, Comment) and _plain(block.text) in ids:
            yield line, replace(block, workingstep=ids[_plain(block.text)])
        else:
            yield line, block


def _kind(machine: Machine) -> MachineType:
    return MachineType.LATHE if machine.kind is MachineKind.LATHE else MachineType.MILL


def dialect_of(code: Path, named: str) -> Dialect:
    """Dialect of NC code: as named, or by the file extension.

    Raises
    ------
    StepNcError
        When the name or the extension is unknown.
    """
    if named:
        return one_of(Dialect, named.lower(), "dialect")
    found = _dialect_by_suffix(code)
    if found is None:
        known = ", ".join(control.value for control in Dialect)
        raise StepNcError(f"{code}: unknown file extension; add --dialect: {known}")
    return found


def _dialect_by_suffix(code: Path) -> Dialect | None:
    name = code.name.lower()
    return next((each for each, suffix in SUFFIXES.items() if name.endswith(suffix)), None)


def _plain(text: str) -> str:
    """Normalise a comment, which controls may spell differently, to capitals and digits."""
    return "".join(filter(str.isalnum, text)).upper()
