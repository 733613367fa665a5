"""``/v1/jobs``: how far they are, their end."""

import httpx

from tests.service.rest.conftest import Done
from tests.service.rest.server import is_problem, made, over
from tests.service.waiting import until


def test_jobs_are_listed_by_kind_and_state(client: httpx.Client, done: Done) -> None:
    found = client.get("/v1/jobs?kind=trial&state=succeeded").json()["items"]
    assert done.trial in {job["id"] for job in found}
    assert {(job["kind"], job["state"]) for job in found} == {("trial", "succeeded")}
    is_problem(client.get("/v1/jobs?kind=x"), 422)
    is_problem(client.get("/v1/jobs?state=x"), 422)


def test_a_job_tells_where_its_result_is(client: httpx.Client, done: Done) -> None:
    for id in (done.advice, done.simulation, done.control, done.trial, done.evaluation):
        job = client.get(f"/v1/jobs/{id}").json()
        assert (job["state"], job["share"], job["problem"]) == ("succeeded", 1.0, None)
        assert client.get(job["result"]).status_code == 200


def test_a_running_simulation_is_cancelled_within_seconds_and_deleted(
    client: httpx.Client, done: Done
) -> None:
    answer = client.post("/v1/simulations", json={"program_id": done.program, "pace": 0.1})
    assert answer.headers["location"] == f"/v1/jobs/{answer.json()['id']}"
    id = made(answer)
    is_problem(client.get(f"/v1/simulations/{id}"), 409)
    is_problem(client.delete(f"/v1/jobs/{id}"), 409)
    until(lambda: client.get(f"/v1/jobs/{id}").json()["state"] == "running")
    until(lambda: client.get(f"/v1/simulations/{id}/series").status_code == 200)
    assert client.get(f"/v1/simulations/{id}/series").json()["is_growing"]
    assert client.post(f"/v1/jobs/{id}/cancel").json()["is_cancelling"]
    job = over(client, id)
    assert (job["state"], job["problem"]) == ("cancelled", None)
    found = is_problem(client.get(f"/v1/simulations/{id}"), 409, "conflict")
    assert "cancelled" in found["detail"]
    assert client.delete(f"/v1/jobs/{id}").status_code == 204
    is_problem(client.get(f"/v1/jobs/{id}"), 404)
    is_problem(client.get(f"/v1/simulations/{id}"), 404)


def test_what_is_over_is_not_cancelled(client: httpx.Client, done: Done) -> None:
    is_problem(client.post(f"/v1/jobs/{done.simulation}/cancel"), 409, "conflict")


def test_a_bad_program_is_a_job_that_says_why(client: httpx.Client, done: Done) -> None:
    lines = client.get(f"/v1/programs/{done.program}/file").content.splitlines(keepends=True)
    toolless = b"".join(line for line in lines if b"=MILLING_CUTTING_TOOL(" not in line)
    program = made(client.post("/v1/programs", content=toolless), 201)
    job = over(client, made(client.post(f"/v1/programs/{program}/advice", json={})))
    assert job["state"] == "failed"
    assert job["problem"]["type"] == "urn:stepnc:problem:schema-error"
    assert job["problem"]["entity"] == "#50"
    is_problem(client.get(f"/v1/advice/{job['id']}"), 409)
