"""Request of ``kbe read``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.requests.fields import About, FileUse, Request


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedFiles(Request):
    """Files of ``kbe read``."""

    file: Annotated[Path, About("as written by `write`", use=FileUse.INPUT, metavar="FILE")]


REQUEST, FILES = Request, RecordedFiles
