"""Review of the knowledge base."""

from kbe.acceptance import AcceptanceBounds
from service.knowledge.review import Acceptance, review
from service.progress import Tell, silent
from service.requests.knowledge import ReviewRequest
from service.verbs.kbe.decider import decider
from service.verbs.kbe.empty_answer import why_empty
from service.verbs.kbe.review.request import ReviewFiles
from service.verbs.kbe.review.result import ReviewReport


def run(request: ReviewRequest, files: ReviewFiles, *, tell: Tell = silent) -> ReviewReport:
    """Propose corrections from the selected outcomes; accept those within bounds if asked to.

    Raises
    ------
    StepNcError
        When the knowledge base cannot be read or written.
    """
    acceptance = Acceptance(
        by=decider(files, tell=tell) if files.auto_accept else "",
        bounds=AcceptanceBounds(
            least_confidence=files.least_confidence,
            fewest_outcomes=files.fewest_outcomes,
            greatest_change=files.greatest_change,
        ),
    )
    found = review(files.place, request, acceptance)
    if not found:
        tell(why_empty(files.place))
    return ReviewReport(contexts=found)
