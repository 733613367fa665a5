"""API keys of the service."""

from service.progress import Tell, silent
from service.requests.fields import Request
from service.storage import keys
from service.verbs.keys.list.result import KeysResult
from service.verbs.keys.places import ServiceFiles


def run(_request: Request, files: ServiceFiles, *, tell: Tell = silent) -> KeysResult:
    """List all keys, oldest first.

    Raises
    ------
    StepNcError
        When the data folder does not exist or cannot be read.
    """
    return KeysResult(keys=keys.listed(files.opened()))
