"""Role that a request needs: one table, for the access check and for the OpenAPI document."""

from service.errors import Forbidden
from service.storage.jobs import JobKind
from service.storage.keys import Key, Role

OPERATED = ("/v1/control-runs", "/v1/trials")
"""where a machine is steered"""

SEEN = ("/v1/evaluations",)
"""tables that are made on demand, and change nothing"""

JOBS = "/v1/jobs/"
"""of all kinds"""

LOOKING = frozenset({"GET", "HEAD", "OPTIONS"})

KEPT = ("/v1/", "/metrics")
"""what keys protect; the dashboard's files and the signs of life are everybody's"""

DOCUMENT = "/v1/openapi.json"
"""tells how to ask, and nothing else"""


def role_for(method: str, path: str) -> Role | None:
    """The role that opens a path; None: the route asks, as the kind of the job says."""
    if method in LOOKING or path.startswith(SEEN):
        return Role.VIEWER
    if path.startswith(JOBS):
        return None
    return Role.OPERATOR if path.startswith(OPERATED) else Role.PLANNER


def role_to_end(kind: JobKind) -> Role:
    """The role that may end a job, and delete what it made."""
    return Role.OPERATOR if kind.is_live else Role.PLANNER


def is_protected(path: str) -> bool:
    """Whether a key is asked for, where keys are asked for at all."""
    return path.startswith(KEPT) and path != DOCUMENT


def require(key: Key, role: Role | None) -> None:
    """Refuse who may not.

    Raises
    ------
    Forbidden
    """
    if role is not None and not key.opens(role):
        has = ", ".join(sorted(key.roles))
        raise Forbidden(f"this needs the role {role.value}; the key has {has}")
