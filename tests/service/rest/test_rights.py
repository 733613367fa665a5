"""Which role a request needs."""

import pytest

from service.depot.keys import Role
from service.rest.rights import is_protected, role_for


@pytest.mark.parametrize(
    ("method", "path", "role"),
    [
        ("GET", "/v1/trials", Role.VIEWER),
        ("HEAD", "/v1/programs", Role.VIEWER),
        ("POST", "/v1/evaluations", Role.VIEWER),
        ("POST", "/v1/programs", Role.PLANNER),
        ("DELETE", "/v1/jobs/x", Role.PLANNER),
        ("PUT", "/v1/machines/x", Role.PLANNER),
        ("POST", "/v1/corrections/1/accept", Role.PLANNER),
        ("POST", "/v1/trials", Role.OPERATOR),
        ("POST", "/v1/trials/x/changes", Role.OPERATOR),
        ("POST", "/v1/control-runs/x/cancel", Role.OPERATOR),
        ("PATCH", "/v1/anything", Role.PLANNER),
    ],
)
def test_looking_is_for_all_and_machines_are_for_operators(
    method: str, path: str, role: Role
) -> None:
    assert role_for(method, path) is role


def test_pages_and_signs_of_life_are_everybodys() -> None:
    for path in ("/", "/dashboard/plan.html", "/healthz", "/readyz", "/v1/openapi.json"):
        assert not is_protected(path)
    for path in ("/v1/about", "/v1/jobs", "/v1/openapi.json/", "/metrics"):
        assert is_protected(path)
