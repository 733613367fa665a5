"""Which role a request needs."""

import pytest

from service.errors import Forbidden
from service.rest.rights import is_protected, require, role_for, role_to_end
from service.storage.jobs import JobKind
from service.storage.keys import Key, Role
from tests.every_case import every_case


@every_case(
    ("method", "path", "role"),
    [
        ("GET", "/v1/trials", Role.VIEWER),
        ("HEAD", "/v1/programs", Role.VIEWER),
        ("GET", "/v1/monitors/vmc15/events", Role.VIEWER),
        ("POST", "/v1/evaluations", Role.VIEWER),
        ("POST", "/v1/programs", Role.PLANNER),
        ("DELETE", "/v1/jobs/x", None),
        ("POST", "/v1/jobs/x/cancel", None),
        ("GET", "/v1/jobs/x", Role.VIEWER),
        ("PUT", "/v1/machines/x", Role.PLANNER),
        ("POST", "/v1/corrections/1/accept", Role.PLANNER),
        ("POST", "/v1/trials", Role.OPERATOR),
        ("POST", "/v1/trials/x/changes", Role.OPERATOR),
        ("POST", "/v1/control-runs/x/cancel", Role.OPERATOR),
        ("PATCH", "/v1/anything", Role.PLANNER),
    ],
)
def test_looking_is_for_all_and_machines_are_for_operators(
    method: str, path: str, role: Role | None
) -> None:
    assert role_for(method, path) is role


@every_case("kind", list(JobKind))
def test_who_may_begin_a_job_may_end_it(kind: JobKind) -> None:
    path = {"control-run": "/v1/control-runs", "trial": "/v1/trials"}.get(kind, "/v1/programs")
    assert role_to_end(kind) is role_for("POST", path)


def test_a_key_that_does_not_open_is_told_what_it_lacks() -> None:
    key = Key(id="x", name="Anna", roles=frozenset({Role.PLANNER}), created=0.0, revoked=None)
    require(key, Role.PLANNER)
    require(key, Role.VIEWER)
    require(key, None)
    with pytest.raises(Forbidden, match="needs the role operator; the key has planner"):
        require(key, Role.OPERATOR)


def test_pages_and_signs_of_life_are_everybodys() -> None:
    for path in ("/", "/dashboard/plan.html", "/healthz", "/readyz", "/v1/openapi.json"):
        assert not is_protected(path)
    for path in ("/v1/about", "/v1/jobs", "/v1/openapi.json/", "/metrics"):
        assert is_protected(path)
