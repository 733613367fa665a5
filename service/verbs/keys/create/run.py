"""Creation of an API key."""

from service.progress import Tell, silent
from service.storage import keys
from service.verbs.keys.create.request import CreateKeyRequest
from service.verbs.keys.create.result import NewKeyResult
from service.verbs.keys.places import ServiceFiles
from stepnc_model.errors import StepNcError


def run(request: CreateKeyRequest, files: ServiceFiles, *, tell: Tell = silent) -> NewKeyResult:
    """Create a key.

    Raises
    ------
    StepNcError
        When the owner has no name, or the data folder cannot be written.
    """
    if not request.owner.strip():
        raise StepNcError("--for is empty: name the owner of the key")
    roles = frozenset(request.roles)
    key = keys.create(files.opened(is_made=True), name=request.owner, roles=roles)
    tell("store this key, it is not shown again; send it as  Authorization: Bearer …")
    return NewKeyResult(key=key)
