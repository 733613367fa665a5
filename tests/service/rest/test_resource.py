"""A resource has the routes that its declaration says, and each kind of job has one."""

from pkgutil import resolve_name
from typing import Any

from fastapi import FastAPI

from service.jobs.child import VERB, WORK
from service.jobs.verb_job import STORED
from service.requests.runs import SimulationRequest
from service.rest.resource import Creation, Download, Resource, Shown, TableFormat, routes_of
from service.rest.resources import RESOURCES
from service.rest.rights import role_for, role_to_end
from service.rest.views import PLACES, SimulationView
from service.storage.jobs import JobKind
from service.verbs.call import verbs

KIND = JobKind.SIMULATION

BARE = Resource(kind=KIND, tag="t", plural="runs", report="")


def paths_of(resource: Resource) -> dict[str, Any]:
    """Paths below the resource, as the document shows them."""
    app = FastAPI()
    app.include_router(routes_of(resource))
    paths = app.openapi()["paths"]
    return {path.removeprefix("/v1/simulations"): item for path, item in paths.items()}


def test_every_kind_of_job_has_a_resource_a_path_and_work() -> None:
    assert sorted(each.kind for each in RESOURCES) == sorted(JobKind)
    assert set(PLACES) == set(STORED) | set(WORK) == set(JobKind)
    assert not set(STORED) & set(WORK)
    assert {each.name for each in STORED.values()} <= set(verbs())
    assert len(set(PLACES.values())) == len(PLACES)
    assert all(callable(resolve_name(work)) for work in (VERB, *WORK.values()))


def test_who_may_begin_a_job_may_cancel_it() -> None:
    for each in RESOURCES:
        if each.status:
            assert role_for("POST", f"{each.prefix}/x/cancel") is role_to_end(each.kind)


def test_what_is_not_declared_has_no_route() -> None:
    assert set(paths_of(BARE)) == {""}
    assert set(paths_of(BARE)[""]) == {"get"}


def test_each_declaration_has_its_routes() -> None:
    whole = Resource(
        kind=KIND,
        tag="t",
        plural="runs",
        creation=Creation(name="ask", body=SimulationRequest, summary="Run", about="Run it."),
        shown=Shown(summary="Show", about="Show it.", view=SimulationView),
        downloads=(Download(path="rows", file="rows.bin", summary="Rows", about="All rows."),),
        status="Show it.",
        has_series=True,
    )
    paths = paths_of(whole)
    watched = {"/{id}/status", "/{id}/log", "/{id}/events", "/{id}/cancel", "/{id}/series"}
    assert set(paths) == {"", "/{id}", "/{id}/report", "/{id}/rows", *watched}
    body = paths[""]["post"]["requestBody"]["content"]["application/json"]["schema"]
    assert body == {"$ref": "#/components/schemas/SimulationRequest"}
    shown = paths["/{id}"]["get"]["responses"]["200"]["content"]["application/json"]["schema"]
    assert shown == {"$ref": "#/components/schemas/SimulationView"}


def test_a_client_chooses_among_several_formats() -> None:
    for forms, asked in (
        ((TableFormat.PARQUET,), ["id"]),
        ((TableFormat.CSV, TableFormat.PARQUET), ["id", "form"]),
    ):
        table = Download(path="rows", file="rows", forms=forms, summary="Rows", about="All.")
        bare = Resource(kind=KIND, tag="t", plural="runs", report="", downloads=(table,))
        found = paths_of(bare)["/{id}/rows"]["get"]
        assert [each["name"] for each in found["parameters"]] == asked
        assert len(found["responses"]["200"]["content"]) == len(forms)
