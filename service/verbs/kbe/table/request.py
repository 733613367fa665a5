"""Request of ``kbe table``."""

from dataclasses import dataclass
from typing import Annotated

from service.requests.fields import About
from service.requests.knowledge import EvaluationRequest
from service.requests.output import OutputFiles
from service.verbs.kbe.places import KnowledgePlace

IsSummary = Annotated[
    bool,
    About(
        "only counts, means and spreads by machine, material, tool and kind of feature: a "
        "million outcomes in about a second",
        flag="--summary",
    ),
]


@dataclass(frozen=True, slots=True, kw_only=True)
class TableFiles(OutputFiles):
    """Knowledge base of ``kbe table``, and its file."""

    kb: KnowledgePlace = ""
    name: str = ""
    """Name of the knowledge base in the result; empty: its place."""
    summary: IsSummary = False


REQUEST, FILES = EvaluationRequest, TableFiles
