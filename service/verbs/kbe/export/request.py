"""Request of ``kbe export``."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated

from service.requests.fields import About, FileUse
from service.requests.knowledge import EvaluationRequest
from service.requests.output import Format
from service.verbs.kbe.places import KnowledgeFiles
from service.verbs.kbe.table.request import IsSummary


class ExportedContent(StrEnum):
    """Content of an exported file."""

    OUTCOMES = "outcomes"
    CORRECTIONS = "corrections"
    TABLE = "table"


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportRequest(EvaluationRequest):
    """Request of a file for other programs; how a table is made, for a table alone."""

    what: Annotated[
        ExportedContent, About("outcomes, corrections or table", is_word=True, metavar="WHAT")
    ]


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportFiles(KnowledgeFiles):
    """Knowledge base of ``kbe export``, and the file."""

    output: Annotated[
        Path,
        About("the file", flag="--output", short="-o", use=FileUse.OUTPUT, metavar="FILE"),
    ]
    format: Format = None
    summary: IsSummary = False


REQUEST, FILES = ExportRequest, ExportFiles
