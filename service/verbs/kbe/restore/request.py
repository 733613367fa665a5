"""Request of ``kbe restore``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.requests.fields import About, FileUse, Request
from service.verbs.kbe.places import KnowledgeFiles


@dataclass(frozen=True, slots=True, kw_only=True)
class RestoreFiles(KnowledgeFiles):
    """Files of ``kbe restore``."""

    file: Annotated[Path, About("the backup", use=FileUse.INPUT, metavar="FILE")]


REQUEST, FILES = Request, RestoreFiles
