"""Decision of a person on corrections: withdraw."""

from service.knowledge.verbs import withdraw
from service.progress import Tell, silent
from service.verbs.kbe.corrections.result import CorrectionsResult
from service.verbs.kbe.decider import decider
from service.verbs.kbe.places import DeciderFiles, DecisionRequest


def run(
    request: DecisionRequest, files: DeciderFiles, *, tell: Tell = silent
) -> CorrectionsResult:
    """Withdraw corrections, all or none.

    Raises
    ------
    StepNcError
        When an id is unknown, or the knowledge base cannot be written.
    """
    entries = withdraw(files.place, request.ids, by=decider(files, tell=tell))
    return CorrectionsResult(entries=entries)
