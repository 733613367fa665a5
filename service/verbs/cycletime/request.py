"""Request of ``cycletime``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from annotated_types import Interval

from service.requests.advice import MachineName
from service.requests.fields import About, FileUse, Request
from service.requests.files import KeepsState, MostRepeats, NamedTools, Report, SetupOfCode
from service.requests.program_facts import Name, ProgramRequest
from service.requests.runs import JUNCTION_DEVIATION
from simulator.motion.model_name import ControlModelName
from stepnc_model.errors import Finding


@dataclass(frozen=True, slots=True, kw_only=True)
class CycleTimeRequest(ProgramRequest):
    """Request of the cycle time of a program."""

    machine: MachineName = ""
    dialect: Annotated[
        Name,
        About(
            "dialect of NC code that is read or written (default: by the file extension)",
            flag="--dialect", metavar="NAME",
        ),
    ] = ""  # fmt: skip
    control: Annotated[
        ControlModelName,
        About(
            "motion control: exact-stop, junction, fir or linuxcnc",
            flag="--control", metavar="NAME",
        ),
    ] = ControlModelName.FIR  # fmt: skip
    deviation_mm: Annotated[
        float,
        Interval(gt=0.0, le=10.0),
        About(
            "path deviation of the junction control, mm", unit="mm", name="deviation",
            flag="--deviation-mm", metavar="MM",
        ),
    ] = JUNCTION_DEVIATION  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class CycleTimeFiles(Request):
    """Files of ``cycletime``."""

    file: Annotated[
        Path,
        About("a STEP-NC program (Part 21), or NC code", use=FileUse.PROGRAM, metavar="FILE"),
    ]
    tools: NamedTools = None
    log: Annotated[
        str | None,
        About(
            "recorded run (.parquet, .csv), MTConnect document (.xml) or address of an agent",
            use=FileUse.INPUT, metavar="LOG",
        ),
    ] = None  # fmt: skip
    log_findings: tuple[Finding, ...] = ()
    """What is to be said of the log by those who got it."""
    setup: SetupOfCode = None
    most_repeats: MostRepeats = None
    keeps_state: KeepsState = ()
    output: Annotated[
        Path | None,
        About(
            "write NC code with each feed lowered to what will be reached",
            flag="--output", short="-o", use=FileUse.OUTPUT, metavar="CODE",
        ),
    ] = None  # fmt: skip
    report: Report = None


REQUEST, FILES = CycleTimeRequest, CycleTimeFiles
