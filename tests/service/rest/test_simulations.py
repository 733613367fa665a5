"""``/v1/simulations``: a program on the virtual machine."""

import io

import httpx
from pyarrow import parquet

from simulator.library import DATA
from tests.service.rest.conftest import Done
from tests.service.rest.samples import SAMPLE
from tests.service.rest.server import is_problem, made, over


def test_result_samples_and_report(client: httpx.Client, done: Done) -> None:
    path = f"/v1/simulations/{done.simulation}"
    result = client.get(path).json()
    assert result["total"]["time_s"] > 100.0
    samples = client.get(f"{path}/samples")
    assert samples.headers["content-type"] == "application/vnd.apache.parquet"
    assert parquet.read_table(io.BytesIO(samples.content)).num_rows == result["samples"]
    report = client.get(f"{path}/report")
    assert report.text.startswith("<!DOCTYPE html>")
    assert "sandbox" in report.headers["content-security-policy"]
    assert done.simulation in {
        job["id"] for job in client.get("/v1/simulations").json()["items"]
    }


def test_what_an_advice_made_is_simulated_under_its_name(
    client: httpx.Client, done: Done
) -> None:
    id = made(client.post("/v1/simulations", json={"advice_id": done.advice}))
    job = over(client, id)
    assert (job["state"], job["program_id"], job["advice_id"]) == (
        "succeeded", done.program, done.advice,
    )  # fmt: skip
    result = client.get(f"/v1/simulations/{id}").json()
    assert result["program"] == "part.optimised.stpnc"
    before = client.get(f"/v1/simulations/{done.simulation}").json()
    assert result["total"]["time_s"] < before["total"]["time_s"]


def test_one_of_program_and_advice_is_named(client: httpx.Client, done: Done) -> None:
    both = {"program_id": done.program, "advice_id": done.advice}
    for body in ({}, both):
        is_problem(client.post("/v1/simulations", json=body), 400, "unreadable")
        is_problem(client.post("/v1/control-runs", json=body), 400)
    for body in ({"program_id": "0" * 26}, {"advice_id": done.simulation}):
        is_problem(client.post("/v1/simulations", json=body), 404, "not-found")
    is_problem(client.post("/v1/simulations", json={"program_id": "../x"}), 422)


def test_the_path_of_the_tool_is_bounded(client: httpx.Client, done: Done) -> None:
    found = client.get(f"/v1/simulations/{done.simulation}/path?points=100").json()
    assert 2 < len(found["time_s"]) <= 100 < found["rows"]
    columns = {name: column for name, column in found.items() if isinstance(column, list)}
    names = columns.pop("workingsteps")
    assert {len(column) for column in columns.values()} == {len(found["time_s"])}
    assert set(found["workingstep"]) <= set(range(len(names) + 1))
    assert not found["is_growing"]
    is_problem(client.get(f"/v1/simulations/{done.simulation}/path?points=1"), 422)
    is_problem(client.get(f"/v1/simulations/{'0' * 26}/path"), 404)


def test_what_did_not_run_has_no_path(client: httpx.Client) -> None:
    unusable = SAMPLE.read_bytes().replace(b"WORKPLAN(", b"NO_WORKPLAN(")
    program = made(client.post("/v1/programs", content=unusable), 201)
    id = made(client.post("/v1/simulations", json={"program_id": program}))
    assert over(client, id)["state"] == "failed"
    found = is_problem(client.get(f"/v1/simulations/{id}/path"), 409, "conflict")
    assert "failed" in found["detail"]
    assert client.get(f"/v1/simulations/{id}/series").json()["rows"] == 0


def test_unknown_machines_and_materials_are_refused_at_once(
    client: httpx.Client, done: Done
) -> None:
    before = client.get("/v1/jobs").json()
    run = {"program_id": done.program}
    for path, body in (
        (f"/v1/programs/{done.program}/advice", {}),
        ("/v1/simulations", run),
        ("/v1/control-runs", run),
    ):
        for words, kind in (
            ({"machine": "no-such"}, "unknown-machine"),
            ({"material": "unobtainium"}, "unknown-material"),
        ):
            answer = client.post(path, json={**body, **words})
            found = is_problem(answer, 422, kind)
            assert next(iter(words.values())) in found["detail"]
        is_problem(client.post(path, json={**body, "material": "../../x.toml"}), 400)
    assert client.get("/v1/jobs").json() == before


def test_what_was_asked_for_before_is_told_though_it_could_not_begin_now(
    client: httpx.Client, done: Done
) -> None:
    headers = {"idempotency-key": "simulation-of-ours"}
    machine = (DATA / "machines" / "vmc15.toml").read_bytes()
    client.put("/v1/machines/ours-2", content=machine)
    body = {"program_id": done.program, "machine": "ours-2"}
    id = made(client.post("/v1/simulations", json=body, headers=headers))
    over(client, id)
    client.delete("/v1/machines/ours-2")
    assert made(client.post("/v1/simulations", json=body, headers=headers)) == id
    is_problem(client.post("/v1/simulations", json=body), 422, "unknown-machine")
    assert client.delete(f"/v1/jobs/{id}").status_code == 204
    found = is_problem(client.post("/v1/simulations", json=body, headers=headers), 409)
    assert "was deleted" in found["detail"]
