"""Files of runs on the virtual machine: a program of any kind, and what NC code lacks."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Generic, TypeVar

from service.inputs.numbers import program_numbers_in
from service.inputs.program_kind import ProgramKind, kind_of_file
from service.programs.reading import tool_library
from service.requests.fields import About, FileUse, Request
from service.requests.files import KeepsState, MostRepeats, Report, SetupOfCode, ToolsUnit
from service.requests.runs import RunRequest
from service.simulation.code_simulation import CodeRequest
from service.simulation.run import RunFiles
from stepnc_model.errors import StepNcError

N = TypeVar("N", bound=RunRequest)

ProgramOfRun = Annotated[
    Path | None,
    About("a STEP-NC program (Part 21), or NC code", use=FileUse.INPUT, metavar="FILE"),
]

RunOutput = Annotated[
    Path | None,
    About(
        "write the run, .parquet or .csv",
        flag="--output", short="-o", use=FileUse.OUTPUT, metavar="FILE",
    ),
]  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeOfRun(Request):
    """Program of a run, and NC code with the data that it lacks."""

    file: ProgramOfRun = None
    name: str = ""
    """Name of the program; empty: the name of its file."""
    nc: Annotated[
        Path | None,
        About(
            "run this NC code instead of the program's own",
            flag="--nc", use=FileUse.INPUT, metavar="CODE", group="NC code",
        ),
    ] = None  # fmt: skip
    dialect: Annotated[
        str,
        About(
            "dialect of the NC code: linuxcnc, fanuc, haas, sinumerik, heidenhain or canonical",
            flag="--dialect", metavar="NAME", group="NC code",
        ),
    ] = ""  # fmt: skip
    tools: Annotated[
        Path | None,
        About(
            "tool table, of NC code, or of tools that a program only names: TOML "
            "or CSV, LinuxCNC's tool.tbl, a library of Fusion (.json, .tools), HSMWorks "
            "(.hsmlib) or FreeCAD (.fctl)",
            flag="--tools", use=FileUse.INPUT, metavar="TABLE", group="NC code",
        ),
    ] = None  # fmt: skip
    tools_unit: ToolsUnit = None
    setup: SetupOfCode = None
    most_repeats: MostRepeats = None
    keeps_state: KeepsState = ()

    @property
    def code(self) -> Path | None:
        """NC code that runs: that of ``nc``, or the file if it is NC code."""
        if self.nc is not None or self.file is None:
            return self.nc
        return self.file if kind_of_file(self.file) is ProgramKind.NC_CODE else None


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOutputs(CodeOfRun):
    """Files of a run, and what it writes."""

    output: RunOutput = None
    report: Report = None


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedRun(Generic[N]):
    """Files of a run, and its request without what belongs to NC code."""

    files: RunFiles
    request: N


def placed_run(files: CodeOfRun, request: N) -> PlacedRun[N]:
    """Return the files and the request of a run, with the setup of its NC code.

    Raises
    ------
    StepNcError
        When options of NC code alone are given without it, or its setup is not valid.
    """
    code = files.code
    if code is None and files.dialect:
        raise StepNcError("--dialect needs NC code: name it with --nc")
    if code is None and files.setup is not None:
        raise StepNcError("--setup needs NC code: a STEP-NC program has its own setup")
    if code is None and files.keeps_state:
        raise StepNcError("--keeps-state needs NC code: a STEP-NC program calls no other one")
    if files.tools_unit and files.tools is None:
        raise StepNcError("--tools-unit needs a tool table: name it with --tools")
    places = RunFiles(
        name=files.name,
        output=getattr(files, "output", None),
        report=getattr(files, "report", None),
    )
    if code is None:
        tools = tool_library(files.tools, files.tools_unit)
        return PlacedRun(files=replace(places, file=files.file, tools=tools), request=request)
    given = CodeRequest(
        code=code,
        dialect=files.dialect,
        tools=files.tools,
        tools_unit=files.tools_unit,
        stock=request.stock,
        most_repeats=files.most_repeats,
        keeps_state=program_numbers_in(files.keeps_state),
    )
    request = replace(request, stock="")
    if code != files.file and files.file is not None:
        places = replace(places, file=files.file, code=given)
        return PlacedRun(files=places, request=request)
    return _with_setup(given, request, files.setup, places)


def _with_setup(
    code: CodeRequest, request: N, named: Path | None, places: RunFiles
) -> PlacedRun[N]:
    """Add what the setup file, or the code itself, says of tools, stock, material, machine."""
    from service.simulation.code_run import code_of_run  # noqa: PLC0415 (numpy)

    found = code_of_run(code, material=request.material, machine=request.machine, named=named)
    return PlacedRun(
        files=replace(places, code=found.code),
        request=replace(request, material=found.material, machine=found.machine),
    )
