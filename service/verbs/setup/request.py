"""Request of ``setup``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.requests.advice import MachineName, MaterialName
from service.requests.fields import About, FileUse, Request
from service.requests.files import CodeControl, KeepsState, MostRepeats, ToolsUnit
from service.requests.program_facts import RawPart, raw_part_in


@dataclass(frozen=True, slots=True, kw_only=True)
class SetupRequest(Request):
    """Request of the setup of NC code."""

    dialect: CodeControl = None
    material: MaterialName = ""
    machine: MachineName = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class SetupFiles(Request):
    """Files of ``setup``."""

    file: Annotated[Path, About("NC code", use=FileUse.PROGRAM, metavar="FILE")]
    tools: Annotated[
        Path | None,
        About(
            "tool table, instead of comments", flag="--tools", use=FileUse.INPUT,
            metavar="TABLE",
        ),
    ] = None  # fmt: skip
    tools_unit: ToolsUnit = None
    stock: Annotated[
        RawPart,
        About(
            "raw part in mm, X0,Y0,Z0,X1,Y1,Z1 or DIAMETER,Z0,Z1; or a file",
            flag="--stock", metavar="NUMBERS|FILE", read=raw_part_in,
        ),
    ] = ""  # fmt: skip
    most_repeats: MostRepeats = None
    keeps_state: KeepsState = ()
    output: Annotated[
        Path | None,
        About(
            "default: FILE.setup.toml beside it, where there is none yet",
            flag="--output", short="-o", use=FileUse.OUTPUT, metavar="TOML",
        ),
    ] = None  # fmt: skip
    dry_run: Annotated[bool, About("write nothing", flag="--dry-run")] = False


REQUEST, FILES = SetupRequest, SetupFiles
