"""Files of runs on the virtual machine: a program of any kind, and what NC code lacks."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, TypeVar

from service.program_kind import ProgramKind, kind_of_file
from service.requests.fields import About, FileUse, Request
from service.requests.files import MostRepeats, Report, ToolsUnit
from service.requests.runs import RunRequest
from service.simulation.of_code import CodeRequest
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
            "tool table, for NC code without a program: TOML or CSV, LinuxCNC's tool.tbl, a "
            "library of Fusion (.json, .tools), HSMWorks (.hsmlib) or FreeCAD (.fctl)",
            flag="--tools", use=FileUse.INPUT, metavar="TABLE", group="NC code",
        ),
    ] = None  # fmt: skip
    tools_unit: ToolsUnit = None
    most_repeats: MostRepeats = None

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


def run_files(files: CodeOfRun, request: RunRequest) -> RunFiles:
    """Return the files of a run; a stock that is named for NC code goes with the code.

    Raises
    ------
    StepNcError
        When options of NC code alone are given without it.
    """
    code = files.code
    if code is None and (files.dialect or files.tools):
        raise StepNcError("--dialect and --tools need NC code: name it with --nc")
    if files.tools_unit and files.tools is None:
        raise StepNcError("--tools-unit needs a tool table: name it with --tools")
    return RunFiles(
        file=None if code == files.file else files.file,
        code=None
        if code is None
        else CodeRequest(
            code=code,
            dialect=files.dialect,
            tools=files.tools,
            tools_unit=files.tools_unit,
            stock=request.stock,
            most_repeats=files.most_repeats,
        ),
        output=getattr(files, "output", None),
        report=getattr(files, "report", None),
    )


def run_request(request: N, files: CodeOfRun) -> N:
    """Return the request of a run, without the stock that is named for NC code."""
    return request if files.code is None else replace(request, stock="")
