"""Knowledge base of a command, and who decides on its corrections."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval

from service.knowledge.place import usual_place
from service.requests.fields import About, Request

KnowledgePlace = Annotated[
    str,
    About(
        "a file, or postgresql://USER@HOST/DATABASE (default: $STEPNC_KB, else "
        "~/.local/share/stepnc/knowledge.db)",
        flag="--kb", metavar="PLACE",
    ),
]  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class KnowledgeFiles(Request):
    """Knowledge base of a command."""

    kb: KnowledgePlace = ""

    @property
    def place(self) -> str:
        """Return the file or address of the knowledge base.

        Raises
        ------
        StepNcError
            When none is named and the user has no home folder.
        """
        return usual_place(self.kb)


@dataclass(frozen=True, slots=True, kw_only=True)
class DeciderFiles(KnowledgeFiles):
    """Knowledge base, and the name of the person who decides on corrections."""

    by: Annotated[str, About("your name (default: the login)", flag="--by", metavar="NAME")] = (
        ""
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionRequest(Request):
    """Corrections that a person decides on."""

    ids: Annotated[
        tuple[Annotated[int, Interval(ge=1, le=2**31 - 1)], ...],
        About("see `corrections`", is_word=True, metavar="ID"),
    ]
