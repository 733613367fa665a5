"""Request of ``toolpath``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.requests.fields import About, FileUse, Request
from service.requests.files import (
    CodeControl,
    KeepsGoing,
    KeepsState,
    MostRepeats,
    NamedTools,
    ProgramFile,
)
from service.requests.program_facts import ProgramRequest


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolPathRequest(ProgramRequest):
    """Request of the tool paths of a program."""

    dialect: CodeControl = None
    keep_going: KeepsGoing = False


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolPathFiles(Request):
    """Files of ``toolpath``."""

    file: ProgramFile
    tools: NamedTools = None
    most_repeats: MostRepeats = None
    keeps_state: KeepsState = ()
    plot: Annotated[
        Path | None,
        About(
            "draw the paths, coloured by type",
            flag="--plot", use=FileUse.OUTPUT, metavar="PNG",
        ),
    ] = None  # fmt: skip


REQUEST, FILES = ToolPathRequest, ToolPathFiles
