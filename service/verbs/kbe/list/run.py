"""Latest outcomes of the knowledge base."""

from service.knowledge.verbs import newest
from service.progress import Tell, silent
from service.verbs.kbe.empty_answer import why_empty
from service.verbs.kbe.list.request import ListingRequest
from service.verbs.kbe.list.result import OutcomesResult
from service.verbs.kbe.places import KnowledgeFiles


def run(
    request: ListingRequest, files: KnowledgeFiles, *, tell: Tell = silent
) -> OutcomesResult:
    """List the outcomes of a selection, newest first.

    Raises
    ------
    StepNcError
        When the knowledge base cannot be read.
    """
    listing = newest(files.place, request.selection, limit=request.limit)
    if not listing.total:
        tell(why_empty(files.place))
    return OutcomesResult(outcomes=listing.outcomes, total=listing.total)
