"""Request of ``kbe backup``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.requests.fields import About, FileUse, Request
from service.verbs.kbe.places import KnowledgeFiles


@dataclass(frozen=True, slots=True, kw_only=True)
class BackupFiles(KnowledgeFiles):
    """Files of ``kbe backup``."""

    file: Annotated[Path, About("the new file", use=FileUse.OUTPUT, metavar="FILE")]


REQUEST, FILES = Request, BackupFiles
