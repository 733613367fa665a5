"""Evaluation of recorded outcomes."""

from dataclasses import replace

from service.knowledge.evaluation_table import summary, table
from service.knowledge.place import require_apart, usual_place
from service.progress import Tell, silent
from service.requests.knowledge import EvaluationRequest
from service.verbs.kbe.empty_answer import why_empty
from service.verbs.kbe.table.request import TableFiles
from service.verbs.kbe.table.result import EvaluationResult, SummaryResult


def run(
    request: EvaluationRequest, files: TableFiles, *, tell: Tell = silent
) -> EvaluationResult | SummaryResult:
    """Compare planned with measured values of the selected outcomes.

    Raises
    ------
    StepNcError
        When the knowledge base cannot be read, or would be overwritten.
    """
    place = usual_place(files.kb)
    require_apart(place, files.output)
    if files.summary:
        summed = summary(place, request.selection)
        if not summed.groups:
            tell(why_empty(place))
        return SummaryResult(summary=summed)
    found = table(place, request, tell=tell)
    if not found.outcomes:
        tell(why_empty(place))
    return EvaluationResult(evaluation=replace(found, place=files.name or found.place))
