"""Setup of a simulation from NC code, of our own or of any origin.

Code that is made of plain words is read line by line. Any other is read as a whole by the
tolerant reader that ``optimise`` uses, which leaves out what cannot be run and says so.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from service.chosen import load_material_named, machine_for, material_for
from service.files import open_lines, read_bytes
from service.raw_stock import raw_stock_of, stock_map
from service.reading import one_of, read_given
from service.requests.runs import RunRequest
from service.requests.stock import RawPart
from service.simulation.called_tools import called_tool_findings, with_called_tools
from service.simulation.code_paths import CodePaths
from service.simulation.setup import (
    ClampedStock,
    CountedIterator,
    PreparedRun,
    loaded_tools,
)
from simulator.library import load_machine
from simulator.machine.interpreter import Numbered
from simulator.machine.tooling import table_tool
from simulator.spec import Machine, MachineKind, MaterialMatch
from simulator.tool_files.file_unit import FileUnit
from simulator.tool_files.read import ToolLibrary, read_tools
from stepnc_model.errors import Finding, PostError, Severity, StepNcError
from stepnc_model.nc.program import read_program
from stepnc_model.nc.recognise import recognise
from stepnc_model.nc.remarks import NOT_UNDERSTOOD
from stepnc_model.post.blocks import Comment, MachineType
from stepnc_model.post.dialect import SUFFIXES, Dialect
from stepnc_model.post.dialects import read_blocks
from stepnc_model.toolpath.task import stock_of

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
    stock: RawPart = ""
    """Raw part, as :func:`service.raw_stock.raw_stock_of` reads it; empty: unknown."""
    most_repeats: int | None = None
    """Blocks and moves that may be executed beyond those of the file; None: as usual."""


def from_code(
    request: CodeRequest, run: RunRequest, *, program: Path | None, keep_going: bool = False
) -> PreparedRun:
    """Prepare NC code, with tools and stock of its program or as the user specifies.

    Parameters
    ----------
    request : CodeRequest
    run : RunRequest
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
    library = None
    if request.tools is not None:
        if material is None:
            raise StepNcError("a tool table without a material: name one with --material")
        library = read_tools(request.tools, unit=request.tools_unit)
    refusal = _refusal(request, machine)
    if refusal is None:
        prepared = _plain_code(request, machine, material, library)
    else:
        if request.dialect.lower() == Dialect.CANONICAL.value:
            raise StepNcError(f"{request.code.name}: {refusal}")
        paths = _paths_of_any_origin(request, machine, material, library)
        error = _fault(paths, refusal)
        if error is not None and not keep_going:
            raise StepNcError(f"{request.code.name}: {error} (--keep-going leaves it out)")
        prepared = _foreign_code(paths, refusal)
    findings = prepared.findings if library is None else (*library.findings, *prepared.findings)
    if library is None or not request.stock:
        findings += (IDLE,)
    return replace(prepared, findings=findings)


def _refusal(request: CodeRequest, machine: Machine) -> PostError | None:
    """Why code is not plain; None if it is."""
    _size(request.code)
    if not request.dialect and _dialect_by_suffix(request.code) is None:
        return PostError("the file extension names no control")
    try:
        for _ in _read(request, CountedIterator(_lines(request.code)), machine, {}):
            pass
    except PostError as error:
        return error
    return None


def _plain_code(
    request: CodeRequest,
    machine: Machine,
    material: MaterialMatch | None,
    library: ToolLibrary | None,
) -> PreparedRun:
    """Prepare code of plain words, which is read while it runs."""
    tools = None
    if library is not None and material is not None:
        tools = {tool.number: table_tool(tool, material.material) for tool in library.tools}
    raw = raw_stock_of(request.stock) if request.stock else None
    size = _size(request.code)
    lines = CountedIterator(_lines(request.code), len)
    clamped = None if raw is None else stock_map(machine, raw)
    return PreparedRun(
        name=request.code.name,
        machine=machine,
        material=material,
        blocks=_read(request, lines, machine, {}),
        tools=tools,
        stock=lambda _: clamped,
        raw=None if raw is None else raw.bounds,
        done=lambda: lines.share(size),
        read=lambda: lines.count,
    )


def _paths_of_any_origin(
    request: CodeRequest,
    machine: Machine,
    material: MaterialMatch | None,
    library: ToolLibrary | None,
) -> CodePaths:
    """Moves of code of any origin, of which some may not run."""
    dialect = one_of(Dialect, request.dialect.lower(), "dialect") if request.dialect else None
    data = read_bytes(request.code)
    found = recognise(data).machine
    most = request.most_repeats
    program = read_program(data, dialect=dialect, machine=found, most_repeats=most)
    is_without_y = bool((np.nan_to_num(program.moves.end[:, 1]) == 0.0).all())
    if is_without_y and found is MachineType.MILL and machine.kind is MachineKind.LATHE:
        # Nothing else may show that code is for a lathe.
        program = read_program(
            data, dialect=dialect, machine=MachineType.LATHE, most_repeats=most
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


def _fault(paths: CodePaths, refusal: PostError) -> str | None:
    """What cannot be run of code of any origin, in the words that say most; None: nothing."""
    faults = {each.line: each.message for each in reversed(paths.left_out)}
    for each in reversed(paths.program.findings):
        if each.message.startswith(NOT_UNDERSTOOD):
            faults[each.line] = f"line {each.line}: {each.message}"
    if not faults:
        return None
    first = min(faults)
    return str(refusal) if first == refusal.line else faults[first]


def _foreign_code(paths: CodePaths, refusal: PostError) -> PreparedRun:
    """Prepare code of any origin, without the moves that cannot be run."""
    code = paths.program
    text = f"read as code of any origin, for {code.dialect.value}: {refusal}"
    how = Finding(severity=Severity.NOTE, message=text)
    findings = (how, *code.findings, *paths.left_out, *paths.beside)
    return replace(paths.prepared(0.0), code=code, findings=findings)


def _code_of_program(request: CodeRequest, file: Path, run: RunRequest) -> PreparedRun:
    """Prepare NC code made from a program; tools are numbered in the order of their use."""
    program = read_given(file, run).program
    match = material_for(run.material, program)
    machine = machine_for(run.machine, program)
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
        blocks=_named(request.code, _read(request, lines, machine, ids)),
        tools=loaded_tools(program, numbers, match),
        stock=ClampedStock(program, machine).stock,
        raw=stock_of(program, setup),
        done=lambda: lines.share(size),
        read=lambda: lines.count,
        program=program,
    )


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
    dialect = dialect_of(request.code, request.dialect)
    for block in read_blocks(lines, dialect, machine=_kind(machine)):
        if isinstance(block, Comment) and _plain(block.text) in ids:
            name = ids[_plain(block.text)]
            yield lines.count, Comment(text=block.text, workingstep=name)
        else:
            yield lines.count, block


def _named(code: Path, blocks: Iterator[Numbered]) -> Iterator[Numbered]:
    """Blocks of a file that its errors name."""
    try:
        yield from blocks
    except PostError as error:
        raise StepNcError(f"{code.name}: {error}") from error


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
