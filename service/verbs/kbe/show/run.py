"""A run or a correction of the knowledge base."""

from service.knowledge.verbs import corrections, outcomes_of_run, shown
from service.progress import Tell, silent
from service.verbs.kbe.corrections.result import CorrectionsResult
from service.verbs.kbe.places import KnowledgeFiles
from service.verbs.kbe.show.request import ShowRequest
from service.verbs.kbe.show.result import RunResult
from stepnc_model.errors import StepNcError


def run(
    request: ShowRequest, files: KnowledgeFiles, *, tell: Tell = silent
) -> RunResult | CorrectionsResult:
    """Show the outcomes of a run, or a correction.

    Raises
    ------
    StepNcError
        When there is neither, several runs begin so, or the knowledge base cannot be read.
    """
    outcomes = outcomes_of_run(files.place, request.id)
    if outcomes:
        return RunResult(outcomes=outcomes)
    entries = [each for each in corrections(files.place) if str(each.id) == request.id]
    if not entries:
        raise StepNcError(
            f"{shown(files.place)}: no run or correction '{request.id}'; list them with "
            "`stepnc kbe list` or `stepnc kbe corrections`"
        )
    return CorrectionsResult(entries=entries)
