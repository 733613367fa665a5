"""Request of ``verify``: the values are those of REST, the files are named by people."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from extras.verification.requests import VerificationRequest
from service.requests.fields import About, FileUse, Request
from service.requests.files import Report
from stepnc_model.errors import Finding


@dataclass(frozen=True, slots=True, kw_only=True)
class VerificationFiles(Request):
    """Files of ``verify``."""

    log: Annotated[
        str,
        About(
            "positions as logged: .parquet, .csv, MTConnect .xml, SHDR, or the address of an "
            "agent, http://HOST:PORT, whose buffer is read",
            use=FileUse.INPUT, metavar="LOG",
        ),
    ]  # fmt: skip
    log_findings: tuple[Finding, ...] = ()
    """What is to be said of the log by those who got it."""
    program: Annotated[
        Path | None,
        About(
            "a STEP-NC program; without one, name --tools, --stock, --required and --machine",
            flag="--program", use=FileUse.INPUT, metavar="FILE",
        ),
    ] = None  # fmt: skip
    tools: Annotated[
        Path | None,
        About(
            "tool table with the measured tools, by the program's numbers; without a program, "
            "all tools by the numbers of the log",
            flag="--tools", use=FileUse.INPUT, metavar="TABLE",
        ),
    ] = None  # fmt: skip
    required: Annotated[
        str,
        About(
            "required part in coordinates of the setup, in place of the features: an STL file "
            "in mm, or a STEP file, part.step#SOLID where it has several solids",
            flag="--required", short="--part", use=FileUse.INPUT, metavar="FILE",
        ),
    ] = ""  # fmt: skip
    output: Annotated[
        Path | None,
        About(
            "write the deviations of places on the surface, .parquet or .csv",
            flag="--output", short="-o", use=FileUse.OUTPUT, metavar="FILE",
        ),
    ] = None  # fmt: skip
    report: Report = None


REQUEST, FILES = VerificationRequest, VerificationFiles
