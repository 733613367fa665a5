"""Request of ``kbe show``."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import MaxLen

from service.requests.fields import LONGEST_NAME, About, Request
from service.verbs.kbe.places import KnowledgeFiles


@dataclass(frozen=True, slots=True, kw_only=True)
class ShowRequest(Request):
    """Request of one run or correction."""

    id: Annotated[
        str,
        MaxLen(LONGEST_NAME),
        About("see `list` and `corrections`", is_word=True, metavar="RUN|ID"),
    ]


REQUEST, FILES = ShowRequest, KnowledgeFiles
