"""Role needed for each request, shared by the access check and the OpenAPI document."""

from service.errors import Forbidden
from service.storage.jobs import JobKind
from service.storage.keys import Key, Role

OPERATED = ("/v1/control-runs", "/v1/trials")
"""Paths of runs that steer a machine; changes need the role operator."""

SEEN = ("/v1/evaluations",)
"""Paths whose requests only compute tables and change nothing; they need the role viewer."""

JOBS = "/v1/jobs/"
"""Path of jobs of all kinds."""

LOOKING = frozenset({"GET", "HEAD", "OPTIONS"})

KEPT = ("/v1/", "/metrics", "/mtconnect")
"""Paths that need a key; the dashboard's files and the health checks are public."""

DOCUMENT = "/v1/openapi.json"
"""Path of the OpenAPI document, which is public because it only describes the API."""


def role_for(method: str, path: str) -> Role | None:
    """Return the role that a request needs; None if its route decides by the kind of job."""
    if method in LOOKING or path.startswith(SEEN):
        return Role.VIEWER
    if path.startswith(JOBS):
        return None
    return Role.OPERATOR if path.startswith(OPERATED) else Role.PLANNER


def role_to_end(kind: JobKind) -> Role:
    """Return the role that may cancel or delete a job of a kind."""
    return Role.OPERATOR if kind.is_live else Role.PLANNER


def is_protected(path: str) -> bool:
    """True if a path needs a key, where the service requires keys."""
    return path.startswith(KEPT) and path != DOCUMENT


def require(key: Key, role: Role | None) -> None:
    """Refuse a key that lacks the role.

    Raises
    ------
    Forbidden
    """
    if role is not None and not key.opens(role):
        has = ", ".join(sorted(key.roles))
        raise Forbidden(f"this request needs the role {role.value}; the key has {has}")
