"""Request of ``record``: the values are those of a recording, the files are named by people."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.recording.request import RecordingRequest
from service.requests.fields import About, FileUse, Request


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingFiles(Request):
    """Agent and file of ``record``."""

    url: Annotated[
        str,
        About(
            "the agent, http://HOST:PORT or http://HOST:PORT/DEVICE", use=FileUse.INPUT,
            metavar="URL",
        ),
    ]  # fmt: skip
    output: Annotated[
        Path,
        About(
            ".parquet or .csv", flag="--output", short="-o", use=FileUse.OUTPUT,
            metavar="FILE",
        ),
    ]  # fmt: skip


REQUEST, FILES = RecordingRequest, RecordingFiles
