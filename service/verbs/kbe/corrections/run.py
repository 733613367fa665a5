"""Corrections of the knowledge base."""

from service.knowledge.verbs import corrections, shown
from service.progress import Tell, silent
from service.requests.fields import Request
from service.verbs.kbe.corrections.result import CorrectionsResult
from service.verbs.kbe.places import KnowledgeFiles


def run(_request: Request, files: KnowledgeFiles, *, tell: Tell = silent) -> CorrectionsResult:
    """List all corrections in the order of their proposal.

    Raises
    ------
    StepNcError
        When the knowledge base cannot be read.
    """
    entries = corrections(files.place)
    if not entries:
        tell(f"{shown(files.place)}: no corrections yet; `stepnc kbe review` proposes them")
    return CorrectionsResult(entries=entries)
