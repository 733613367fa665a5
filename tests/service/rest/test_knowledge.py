"""What was learned: tables, reviews, decisions in somebody's name."""

import csv
import io

import httpx
import pytest
from pyarrow import parquet

from tests.service.rest.conftest import Done
from tests.service.rest.server import is_problem


def test_a_table_comes_in_all_forms(client: httpx.Client, done: Done) -> None:
    path = f"/v1/evaluations/{done.evaluation}"
    found = client.get(path).json()
    assert found["rows"]
    text = client.get(f"{path}/table?form=csv")
    assert text.headers["content-type"] == "text/csv; charset=utf-8"
    lines = [line for line in text.text.splitlines() if not line.startswith("#")]
    rows = list(csv.reader(lines))
    table = client.get(f"{path}/table?form=parquet")
    assert parquet.read_table(io.BytesIO(table.content)).num_rows == len(rows) - 1
    assert client.get(f"{path}/report").text.startswith("<!DOCTYPE html>")
    is_problem(client.get(f"{path}/table?form=xls"), 422)
    is_problem(client.get(f"/v1/evaluations/{done.review}/table"), 404)
    listed = client.get("/v1/evaluations").json()["items"]
    assert done.evaluation in {job["id"] for job in listed}


def test_a_correction_is_accepted_and_withdrawn_in_a_name(
    client: httpx.Client, done: Done
) -> None:
    assert client.get(f"/v1/reviews/{done.review}").status_code == 200
    corrections = client.get("/v1/corrections").json()
    number = next(iter(corrections["corrections"]))["id"]
    for verb in ("accept", "withdraw"):
        answer = client.post(f"/v1/corrections/{number}/{verb}", json={"by": "Ä. Smith"})
        assert answer.status_code == 200
        assert "Ä. Smith" in answer.text


@pytest.mark.parametrize("verb", ["accept", "withdraw"])
def test_a_decision_that_cannot_be_is_refused(client: httpx.Client, verb: str) -> None:
    is_problem(client.post(f"/v1/corrections/99999/{verb}", json={"by": "A"}), 404)
    for number in ("0", "-1", "x", str(2**31)):
        is_problem(client.post(f"/v1/corrections/{number}/{verb}", json={"by": "A"}), 422)
    for body in ({}, {"by": ""}, {"by": "x" * 101}, {"by": 1}, {"by": "a\0b"}, {"by": " "}):
        answer = client.post(f"/v1/corrections/1/{verb}", json=body)
        is_problem(answer, answer.status_code)
        assert answer.status_code in {400, 422}, body


def test_outcomes_are_found_by_what_they_are_of(client: httpx.Client, done: Done) -> None:
    found = client.get("/v1/outcomes?limit=5").json()
    assert len(found["outcomes"]) == 5
    machine = found["outcomes"][0]["machine"]
    of_machine = client.get("/v1/outcomes", params={"machine": machine, "limit": 2000}).json()
    assert {each["machine"] for each in of_machine["outcomes"]} == {machine}
    run = found["outcomes"][0]["run"]
    assert client.get(f"/v1/outcomes/runs/{run}").status_code == 200
    is_problem(client.get("/v1/outcomes/runs/none"), 404)
    contexts = client.get("/v1/outcomes/contexts").json()["contexts"]
    assert machine in {each["machine"] for each in contexts}
    assert client.get("/v1/outcomes?machine=' OR 1=1 --").json()["outcomes"] == []
    assert client.get("/v1/outcomes?machine=%00").status_code in {200, 400, 422}
    is_problem(client.get("/v1/outcomes?limit=2001"), 422)


def test_a_time_that_ends_before_it_starts_is_refused_before_a_job_exists(
    client: httpx.Client,
) -> None:
    times = {"since": "2026-03-06T00:00:00Z", "until": "2026-03-05T00:00:00Z"}
    for path in ("/v1/evaluations", "/v1/reviews"):
        is_problem(client.post(path, json=times), 400)
    is_problem(client.get("/v1/outcomes", params=times), 400)


@pytest.mark.parametrize("moment", ["2026-01-01", "x", "0001-01-01T00:00:00+23:59", "1e400"])
def test_a_moment_that_no_clock_shows_is_refused(client: httpx.Client, moment: str) -> None:
    for path in ("/v1/evaluations", "/v1/reviews"):
        answer = client.post(path, json={"since": moment})
        is_problem(answer, answer.status_code)
        assert answer.status_code in {400, 422}
    answer = client.get("/v1/outcomes", params={"since": moment})
    is_problem(answer, answer.status_code)
