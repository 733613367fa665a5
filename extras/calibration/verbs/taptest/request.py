"""Request of ``taptest``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from annotated_types import Interval

from service.requests.fields import About, FileUse, Request
from service.requests.program_facts import Name
from simulator.spec import ModeDirection


@dataclass(frozen=True, slots=True, kw_only=True)
class TapTestRequest(Request):
    """Request of the modes of a tapped structure."""

    direction: Annotated[
        ModeDirection,
        About("direction of the tap: x, y, z, or xy for a round tool", flag="--direction"),
    ]
    tool: Annotated[
        Name,
        About("tool that was tapped, as programs name it", flag="--tool", metavar="ID"),
    ] = ""
    tool_diameter_mm: Annotated[
        float | None,
        Interval(ge=0.01, le=2000.0),
        About(
            "tool diameter, for round tools", unit="mm", name="tool diameter",
            flag="--tool-diameter-mm", metavar="MM",
        ),
    ] = None  # fmt: skip
    workpiece: Annotated[bool, About("the workpiece was tapped", flag="--workpiece")] = False
    modes: Annotated[
        int | None,
        Interval(ge=1, le=1000),
        About("number of modes (default: by peaks)", flag="--modes", metavar="N"),
    ] = None
    source: Annotated[
        str, About("who measured, with which holder and overhang", flag="--source")
    ] = ""
    machine: Annotated[
        str, About("one of `stepnc machines`, or your own file", flag="--machine")
    ] = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class TapTestFiles(Request):
    """Files of ``taptest``."""

    response: Annotated[
        Path, About("measured frequency response", use=FileUse.INPUT, metavar="FRF.csv")
    ]
    output: Annotated[
        Path | None,
        About(
            "write the machine with its modes", flag="--output", short="-o",
            use=FileUse.OUTPUT, metavar="TOML",
        ),
    ] = None  # fmt: skip


REQUEST, FILES = TapTestRequest, TapTestFiles
