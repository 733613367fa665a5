"""Files of a run that people name: a program, or NC code with the data that it lacks."""

from pathlib import Path

from service.requests.code_files import CodeFiles
from service.requests.stock import RawPart
from service.simulation.of_code import CodeRequest
from service.simulation.run import RunFiles
from stepnc_model.errors import StepNcError


def run_files(files: CodeFiles, program: Path | None, *, stock: RawPart) -> RunFiles:
    """Return the program or the NC code that is run; neither output nor report.

    Parameters
    ----------
    files : CodeFiles
    program : Path or None
    stock : RawPart
        Raw part, which is that of NC code if some is named.

    Raises
    ------
    StepNcError
        When data of NC code are given without it.
    """
    if files.nc is None and (files.dialect or files.tools):
        raise StepNcError("--dialect and --tools need NC code: name it with --nc")
    if files.tools_unit is not None and files.tools is None:
        raise StepNcError("--tools-unit needs a tool table: name it with --tools")
    if files.nc is None:
        return RunFiles(file=program)
    code = CodeRequest(
        code=files.nc,
        dialect=files.dialect,
        tools=files.tools,
        tools_unit=files.tools_unit,
        stock=stock,
        most_repeats=files.most_repeats,
    )
    return RunFiles(file=program, code=code)
