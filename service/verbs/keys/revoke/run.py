"""Revocation of an API key."""

from service.progress import Tell, silent
from service.storage import keys
from service.verbs.keys.places import ServiceFiles
from service.verbs.keys.revoke.request import RevokeKeyRequest
from service.verbs.keys.revoke.result import RevokedResult


def run(
    request: RevokeKeyRequest, files: ServiceFiles, *, tell: Tell = silent
) -> RevokedResult:
    """Revoke a key; it stays in the list.

    Raises
    ------
    StepNcError
        When the key does not exist or was revoked before, or the data folder cannot be written.
    """
    keys.revoke(files.opened(), request.id)
    return RevokedResult(revoked=request.id)
