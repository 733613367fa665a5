"""Request of ``kbe add``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.requests.fields import About, FileUse, Request
from service.verbs.kbe.places import KnowledgeFiles


@dataclass(frozen=True, slots=True, kw_only=True)
class AddFiles(KnowledgeFiles):
    """Files of ``kbe add``."""

    file: Annotated[Path, About("outcomes", use=FileUse.INPUT, metavar="FILE.json")]


REQUEST, FILES = Request, AddFiles
