"""Request of ``convert``."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated

from service.requests.fields import About, FileUse, Request
from stepnc_model.editing.file_profile import FileProfile

WAY = "way"
"""Set of options of which exactly one is given."""


class Standard(StrEnum):
    """Standard by which a program is written."""

    ISO14649 = "iso14649"
    AP238 = "ap238"


@dataclass(frozen=True, slots=True, kw_only=True)
class ConvertRequest(Request):
    """Request to write a program in another form."""

    to: Annotated[
        Standard | None,
        About(
            "write the program by another standard: ap238 or iso14649",
            name="standard", flag="--to", metavar="STANDARD", one_of=WAY,
        ),
    ] = None  # fmt: skip
    profile: Annotated[
        FileProfile | None,
        About(
            "write the optimisation records in profile optimisation or standard",
            flag="--profile", one_of=WAY,
        ),
    ] = None  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class ConvertFiles(Request):
    """Files of ``convert``."""

    file: Annotated[
        Path, About("a STEP-NC program (Part 21)", use=FileUse.INPUT, metavar="FILE")
    ]
    output: Annotated[
        Path,
        About(
            "program to be written",
            flag="--output", short="-o", use=FileUse.OUTPUT, metavar="FILE",
        ),
    ]  # fmt: skip


REQUEST, FILES = ConvertRequest, ConvertFiles
