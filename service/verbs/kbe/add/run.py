"""Outcomes of a file for the knowledge base."""

from service.knowledge.outcome_import import add_outcomes
from service.progress import Tell, silent
from service.requests.fields import Request
from service.verbs.kbe.add.request import AddFiles
from service.verbs.kbe.add.result import AddResult


def run(_request: Request, files: AddFiles, *, tell: Tell = silent) -> AddResult:
    """Add the outcomes of a file, all or none.

    Raises
    ------
    StepNcError
        With row, key and value of the first error; or when the place cannot be written.
    """
    count = add_outcomes(files.place, files.file)
    return AddResult(added=count.new, outcomes=count.total)
