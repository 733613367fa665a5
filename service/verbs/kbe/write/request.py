"""Request of ``kbe write``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from annotated_types import MaxLen

from service.requests.fields import LONGEST_NAME, About, FileUse, Request
from service.verbs.kbe.places import KnowledgeFiles


@dataclass(frozen=True, slots=True, kw_only=True)
class WriteRequest(Request):
    """Request to write a run into its program."""

    run: Annotated[
        str,
        MaxLen(LONGEST_NAME),
        About("id of the run (default: the newest run)", flag="--run", metavar="ID"),
    ] = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class WriteFiles(KnowledgeFiles):
    """Files of ``kbe write``."""

    file: Annotated[Path, About("the program that was run", use=FileUse.INPUT, metavar="FILE")]
    output: Annotated[
        Path | None,
        About(
            "default: FILE.recorded.stpnc",
            flag="--output", short="-o", use=FileUse.OUTPUT, metavar="FILE",
        ),
    ] = None  # fmt: skip


REQUEST, FILES = WriteRequest, WriteFiles
