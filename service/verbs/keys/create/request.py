"""Request of ``keys create``."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import MaxLen

from service.requests.fields import LONGEST_NAME, About, Request
from service.storage.keys import Role
from service.verbs.keys.places import ServiceFiles


@dataclass(frozen=True, slots=True, kw_only=True)
class CreateKeyRequest(Request):
    """Request of a new key."""

    owner: Annotated[
        str,
        MaxLen(LONGEST_NAME),
        About("the owner of the key", flag="--for", metavar="NAME"),
    ]
    roles: Annotated[
        tuple[Role, ...],
        About(
            "viewer reads, planner plans, operator runs; repeatable (default: viewer)",
            name="role", flag="--role", metavar="ROLE",
        ),
    ] = ()  # fmt: skip


REQUEST, FILES = CreateKeyRequest, ServiceFiles
