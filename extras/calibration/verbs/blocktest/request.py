"""Request of ``blocktest``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from annotated_types import Interval

from extras.calibration.length_unit import LengthUnit
from service.requests.fields import About, FileUse, Request


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockTestRequest(Request):
    """Request of a test program for the block rate; lists are in the unit of ``unit``."""

    machine: Annotated[
        str, About("one of `stepnc machines`, or your own file", flag="--machine")
    ] = ""  # fmt: skip
    dialect: Annotated[
        str,
        About("dialect of the NC code (default: by the file extension)", flag="--dialect",
              metavar="NAME"),
    ] = ""  # fmt: skip
    unit: Annotated[
        LengthUnit, About("unit of the lists and the feed: in or mm", flag="--unit")
    ] = LengthUnit.INCH
    spacing: Annotated[
        tuple[float, ...] | None,
        About(
            "distances between points (default: those of paper 004, 0.0001 to 0.01 in)",
            flag="--spacing", metavar="S,S,…",
        ),
    ] = None  # fmt: skip
    radius: Annotated[
        tuple[float, ...] | None,
        About("radii of the circles (default: 0.5, 1 and 2 in)", flag="--radius",
              metavar="R,R,…"),
    ] = None  # fmt: skip
    feed: Annotated[
        float | None,
        Interval(gt=0.0, le=300_000.0),
        About("commanded feed in units a minute (default: the machine's greatest)",
              flag="--feed", metavar="F"),
    ] = None  # fmt: skip
    lines: Annotated[
        int,
        Interval(ge=50, le=100_000),
        About("lines of each circle", flag="--lines", metavar="N"),
    ] = 1000


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockTestFiles(Request):
    """Files of ``blocktest``."""

    output: Annotated[
        Path,
        About("NC code to write", flag="--output", short="-o", use=FileUse.OUTPUT,
              metavar="FILE"),
    ]  # fmt: skip


REQUEST, FILES = BlockTestRequest, BlockTestFiles
