"""NC code that people name for a run, with the data that it lacks."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.requests.fields import About, FileUse, Request
from service.requests.files import MostRepeats, ToolsUnit
from service.requests.given import Name


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeFiles(Request):
    """NC code and its tool table."""

    nc: Annotated[
        Path | None,
        About(
            "run this NC code instead of the program's own", flag="--nc", use=FileUse.INPUT,
            metavar="CODE",
        ),
    ] = None  # fmt: skip
    dialect: Annotated[
        Name,
        About(
            "dialect of the NC code: linuxcnc, fanuc, haas, sinumerik, heidenhain or canonical",
            flag="--dialect", metavar="NAME",
        ),
    ] = ""  # fmt: skip
    tools: Annotated[
        Path | None,
        About(
            "tool table, for NC code without a program: TOML or CSV, LinuxCNC's tool.tbl, a "
            "library of Fusion (.json, .tools), HSMWorks (.hsmlib) or FreeCAD (.fctl)",
            flag="--tools", use=FileUse.INPUT, metavar="TABLE",
        ),
    ] = None  # fmt: skip
    tools_unit: ToolsUnit = None
    most_repeats: MostRepeats = None
