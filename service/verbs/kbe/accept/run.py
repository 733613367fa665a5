"""Decision of a person on corrections: accept."""

from service.knowledge.verbs import accept
from service.progress import Tell, silent
from service.verbs.kbe.corrections.result import CorrectionsResult
from service.verbs.kbe.decider import decider
from service.verbs.kbe.places import DeciderFiles, DecisionRequest


def run(
    request: DecisionRequest, files: DeciderFiles, *, tell: Tell = silent
) -> CorrectionsResult:
    """Accept corrections, all or none.

    Raises
    ------
    StepNcError
        When an id is unknown, or the knowledge base cannot be written.
    """
    entries = accept(files.place, request.ids, by=decider(files, tell=tell))
    return CorrectionsResult(entries=entries)
