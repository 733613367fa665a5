"""Canonical commands of a STEP-NC program or of NC code."""

from pathlib import Path

from service.files import read_bytes
from service.inputs.program_kind import NO_TABLE, ProgramKind, kind_for
from service.programs.reading import read_completed, tool_library
from service.programs.toolpaths import paths_for_code
from service.progress import Tell, silent
from service.requests.kind_options import require_served
from service.verbs.canonical.request import CanonicalFiles, CanonicalRequest
from service.verbs.canonical.result import CanonicalResult
from stepnc_model.errors import PostError, StepNcError
from stepnc_model.nc.control_guess import RecognisedControl, recognise
from stepnc_model.nc.exact_reading import read
from stepnc_model.post.blocks import MachineType
from stepnc_model.post.canonical import commands
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.neutral import blocks_of


def run(
    request: CanonicalRequest, files: CanonicalFiles, *, tell: Tell = silent
) -> CanonicalResult:
    """Convert a program to canonical commands.

    Raises
    ------
    StepNcError
        When an option does not serve the program, a line of NC code cannot be read, or a path
        cannot be generated.
    """
    kind = kind_for(files.file, request.dialect or "")
    require_served(request, kind)
    if kind is ProgramKind.NC_CODE:
        if files.tools is not None:
            raise StepNcError(NO_TABLE)
        if request.stock:
            raise StepNcError("--stock cannot be used with NC code: its moves are in the code")
        return _of_code(request, files.file, tell)
    if request.is_lathe:
        raise StepNcError("--lathe cannot be used with a STEP-NC program: it says what turns")
    return _of_program(request, files, tell)


def _of_program(
    request: CanonicalRequest, files: CanonicalFiles, tell: Tell
) -> CanonicalResult:
    program = read_completed(
        files.file, request, tools=tool_library(files.tools), tell=tell
    ).program
    paths = paths_for_code(program, keep_going=request.keep_going, tell=tell)
    blocks = blocks_of(program, paths.items, name=files.file.stem)
    return CanonicalResult(
        name=program.name, control=None, commands=tuple(commands(blocks)), faults=paths.faults
    )


def _of_code(request: CanonicalRequest, file: Path, tell: Tell) -> CanonicalResult:
    data = read_bytes(file)
    found = _control(request, data)
    if found.hints:
        tell(f"control: {found.dialect.value}, guessed from {', '.join(found.hints)}")
    elif request.dialect is None:
        tell(f"control: {found.dialect.value}, as nothing in the code says which")
    lines = data.decode("utf-8", errors="replace").splitlines()
    try:
        read_commands = read(lines, found.dialect, machine=found.machine)
    except PostError as error:
        is_mill = found.machine is MachineType.MILL
        may_be_lathe = is_mill and found.dialect in {Dialect.FANUC, Dialect.HAAS}
        hint = " (use --lathe for lathe code)" if may_be_lathe else ""
        raise StepNcError(f"{file.name}: {error}{hint}") from error
    return CanonicalResult(name=file.name, control=found.dialect, commands=read_commands)


def _control(request: CanonicalRequest, data: bytes) -> RecognisedControl:
    """Control and machine: as named, or as the code shows."""
    if request.dialect is None:
        found = recognise(data)
        machine = MachineType.LATHE if request.is_lathe else found.machine
        return RecognisedControl(dialect=found.dialect, machine=machine, hints=found.hints)
    machine = MachineType.LATHE if request.is_lathe else MachineType.MILL
    return RecognisedControl(dialect=request.dialect, machine=machine, hints=())
