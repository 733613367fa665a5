"""Request of ``post``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.requests.fields import About, FileUse, Request
from service.requests.files import KeepsGoing, NamedTools
from service.requests.program_facts import ProgramRequest
from stepnc_model.post.dialect import Dialect


@dataclass(frozen=True, slots=True, kw_only=True)
class PostRequest(ProgramRequest):
    """Request to write NC code for a control."""

    control: Annotated[
        Dialect,
        About(
            "linuxcnc, fanuc, haas, sinumerik, heidenhain or canonical",
            flag="--control", metavar="NAME",
        ),
    ]  # fmt: skip
    cycles: Annotated[bool, About("use the control's own drilling cycles", flag="--cycles")] = (
        False
    )
    exact_path: Annotated[
        bool,
        About(
            "exact stops at corners, instead of rounding them within the path tolerance",
            flag="--exact-path",
        ),
    ] = False
    adaptive_feed: Annotated[
        bool,
        About(
            "let an outer loop change the feed (M52 P1 of linuxcnc), as "
            "`control --linuxcnc` needs it",
            flag="--adaptive-feed",
        ),
    ] = False
    keep_going: KeepsGoing = False


@dataclass(frozen=True, slots=True, kw_only=True)
class PostFiles(Request):
    """Files of ``post``."""

    file: Annotated[
        Path, About("a STEP-NC program (Part 21)", use=FileUse.INPUT, metavar="FILE")
    ]
    tools: NamedTools = None
    output: Annotated[
        Path | None,
        About(
            "default: next to the program, with the control's file extension",
            flag="--output", short="-o", use=FileUse.OUTPUT, metavar="FILE",
        ),
    ] = None  # fmt: skip


REQUEST, FILES = PostRequest, PostFiles
