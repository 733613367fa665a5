"""Request of ``kbe list``."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval

from service.requests.fields import About
from service.requests.knowledge import SelectionRequest
from service.verbs.kbe.places import KnowledgeFiles


@dataclass(frozen=True, slots=True, kw_only=True)
class ListingRequest(SelectionRequest):
    """Request of the latest outcomes of a selection."""

    limit: Annotated[
        int,
        Interval(ge=0, le=1_000_000_000),
        About("most rows to show", flag="--limit", metavar="N"),
    ] = 50


REQUEST, FILES = ListingRequest, KnowledgeFiles
