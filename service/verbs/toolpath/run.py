"""Tool paths of a STEP-NC program, or the moves of NC code."""

from pathlib import Path

from service.files import read_bytes, require_place, write_atomically
from service.inputs.numbers import program_numbers_in
from service.inputs.program_kind import NO_TABLE, ProgramKind, kind_for
from service.programs.raw_stock import raw_stock_of
from service.programs.reading import read_completed, tool_library
from service.programs.toolpaths import paths_of, with_remarks
from service.progress import Tell, silent
from service.requests.kind_options import require_served
from service.verbs.toolpath.request import ToolPathFiles, ToolPathRequest
from service.verbs.toolpath.result import CodePathResult, ToolPathResult
from stepnc_model.errors import StepNcError, WriteError
from stepnc_model.nc.program import read_program


def run(
    request: ToolPathRequest, files: ToolPathFiles, *, tell: Tell = silent
) -> ToolPathResult | CodePathResult:
    """Generate the tool paths of a program, or take those that it contains; draw them.

    Raises
    ------
    StepNcError
        At the first executable for which no path can be generated, unless it keeps going;
        when the file or an option is invalid.
    """
    kind = kind_for(files.file, request.dialect or "")
    require_served(request, kind)
    require_served(files, kind)
    if files.plot is not None:
        _require_picture(files.plot, apart_from=files.file)
    is_program = kind is ProgramKind.STEP_NC
    found = _program(request, files, tell) if is_program else _code(request, files)
    if files.plot is not None:
        write_atomically(files.plot, found.picture())
        tell(f"picture: {files.plot}")
    return found


def _require_picture(picture: Path, *, apart_from: Path) -> None:
    if picture.suffix.lower() != ".png":
        raise WriteError("the name of a picture must end with .png", path=str(picture))
    require_place(picture, apart_from=apart_from)


def _program(request: ToolPathRequest, files: ToolPathFiles, tell: Tell) -> ToolPathResult:
    program = read_completed(
        files.file, request, tools=tool_library(files.tools), tell=tell
    ).program
    paths = paths_of(program, keep_going=request.keep_going, tell=tell)
    return ToolPathResult(paths=with_remarks(paths, tell))


def _code(request: ToolPathRequest, files: ToolPathFiles) -> CodePathResult:
    if files.tools is not None:
        raise StepNcError(NO_TABLE)
    if request.stock and files.plot is None:
        raise StepNcError("--stock of NC code is only drawn: name a picture with --plot")
    stock = raw_stock_of(request.stock).bounds if request.stock else None
    program = read_program(
        read_bytes(files.file),
        dialect=request.dialect,
        most_repeats=files.most_repeats,
        keeps_state=program_numbers_in(files.keeps_state),
    )
    return CodePathResult(name=files.file.name, program=program, stock=stock)
