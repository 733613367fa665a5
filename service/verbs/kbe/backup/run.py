"""Backup of a knowledge base."""

from service.knowledge.verbs import back_up
from service.progress import Tell, silent
from service.requests.fields import Request
from service.verbs.kbe.backup.request import BackupFiles
from service.verbs.kbe.content import ContentResult


def run(_request: Request, files: BackupFiles, *, tell: Tell = silent) -> ContentResult:
    """Copy a knowledge base to a new file.

    Raises
    ------
    StepNcError
        When it cannot be read, or the file exists or cannot be written.
    """
    return ContentResult(place=str(files.file), content=back_up(files.place, files.file))
