"""Restoration of a knowledge base."""

from service.knowledge.verbs import restore, shown
from service.progress import Tell, silent
from service.requests.fields import Request
from service.verbs.kbe.content import ContentResult
from service.verbs.kbe.restore.request import RestoreFiles


def run(_request: Request, files: RestoreFiles, *, tell: Tell = silent) -> ContentResult:
    """Fill an empty knowledge base from a backup.

    Raises
    ------
    StepNcError
        When it is not empty, or one of both cannot be read or written.
    """
    content = restore(files.file, files.place)
    return ContentResult(place=shown(files.place), content=content)
