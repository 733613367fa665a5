"""Which role a request needs: one table, for the gate and for the OpenAPI document."""

from service.depot.keys import Role

OPERATED = ("/v1/control-runs", "/v1/trials")
"""where a machine is steered"""

SEEN = ("/v1/evaluations",)
"""tables that are made on demand, and change nothing"""

LOOKING = frozenset({"GET", "HEAD", "OPTIONS"})

KEPT = ("/v1/", "/metrics")
"""what keys protect; the dashboard's files and the signs of life are everybody's"""

DOCUMENT = "/v1/openapi.json"
"""tells how to ask, and nothing else"""


def role_for(method: str, path: str) -> Role:
    """The role that opens a path."""
    if method in LOOKING or path.startswith(SEEN):
        return Role.VIEWER
    return Role.OPERATOR if path.startswith(OPERATED) else Role.PLANNER


def is_protected(path: str) -> bool:
    """Whether a key is asked for, where keys are asked for at all."""
    return path.startswith(KEPT) and path != DOCUMENT
