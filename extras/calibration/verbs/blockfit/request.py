"""Request of ``blockfit``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.requests.fields import About, FileUse, Request
from service.requests.files import Report
from service.requests.program_facts import Name


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockFitRequest(Request):
    """Request of the block time of a control."""

    dialect: Annotated[
        Name,
        About(
            "dialect of the program: linuxcnc, fanuc, haas, sinumerik, heidenhain or canonical",
            flag="--dialect", metavar="NAME",
        ),
    ] = ""  # fmt: skip
    zero: Annotated[
        Name,
        About(
            "position of the program's zero in the log, in mm (default: 0,0,0, or searched)",
            flag="--zero", metavar="X,Y,Z",
        ),
    ] = ""  # fmt: skip
    machine: Annotated[
        str, About("one of `stepnc machines`, or your own file", flag="--machine")
    ] = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockFitFiles(Request):
    """Files of ``blockfit``."""

    log: Annotated[
        str,
        About(
            "recorded run (.parquet, .csv), MTConnect document (.xml), address of an agent; or "
            "a table with columns spacing_in and feed_in_min, or spacing_mm and feed_mm_min",
            use=FileUse.INPUT, metavar="LOG",
        ),
    ]  # fmt: skip
    program: Annotated[
        Path | None,
        About(
            "the test program that was run", flag="--program", use=FileUse.INPUT,
            metavar="CODE",
        ),
    ] = None  # fmt: skip
    output: Annotated[
        Path | None,
        About(
            "write the machine with its block time", flag="--output", short="-o",
            use=FileUse.OUTPUT, metavar="TOML",
        ),
    ] = None  # fmt: skip
    report: Report = None


REQUEST, FILES = BlockFitRequest, BlockFitFiles
