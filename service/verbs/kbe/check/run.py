"""Check of a knowledge base."""

from service.knowledge.verbs import check, shown
from service.progress import Tell, silent
from service.requests.fields import Request
from service.verbs.kbe.content import ContentResult
from service.verbs.kbe.places import KnowledgeFiles


def run(_request: Request, files: KnowledgeFiles, *, tell: Tell = silent) -> ContentResult:
    """Read every page of a knowledge base.

    Raises
    ------
    StepNcError
        When it is damaged or cannot be read.
    """
    content = check(files.place)
    tell("no damage found: every page was read")
    return ContentResult(place=shown(files.place), content=content)
