"""Request of ``keys revoke``."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import MaxLen

from service.requests.fields import LONGEST_NAME, About, Request
from service.verbs.keys.places import ServiceFiles


@dataclass(frozen=True, slots=True, kw_only=True)
class RevokeKeyRequest(Request):
    """Request to revoke a key."""

    id: Annotated[
        str,
        MaxLen(LONGEST_NAME),
        About("id of the key, as listed", is_word=True, metavar="ID"),
    ]


REQUEST, FILES = RevokeKeyRequest, ServiceFiles
