"""``/v1/verifications``: a log against a program, from an upload, a run or a machine."""

import io
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from pyarrow import csv, parquet

from extras.verification.views import SurfaceMapView, VerificationView
from tests.extras.agent.test_run import run_of
from tests.extras.brep.shapes import block, first_face, write_step
from tests.extras.verification.files import write_log
from tests.extras.verification.logs import SLOT_MACHINE, slot_log
from tests.extras.verification.test_step_parts import pocketed
from tests.extras.verification.test_without_program import (
    MILL,
    OFFSET,
    POCKET,
    pocket_inputs,
)
from tests.service.monitor.played import PlayedAgent
from tests.service.rest.conftest import Done
from tests.service.rest.samples import SLOT
from tests.service.rest.server import Server, create_key, is_problem, made, over
from tests.service.waiting import until

PATH = "/v1/verifications"
NOBODY = "0" * 26


@pytest.fixture(scope="module")
def slot(service: Server) -> str:
    """The program of the slot."""
    with service.client() as client:
        return made(client.post("/v1/programs?name=slot.stpnc", content=SLOT.read_bytes()), 201)


@pytest.fixture(scope="module")
def usual(slot: str) -> dict[str, Any]:
    """What every request of this module has."""
    return {"program_id": slot, "machine": SLOT_MACHINE, "cell_mm": 0.5}


def test_the_result_names_the_error_with_its_place(client: httpx.Client, done: Done) -> None:
    found = client.get(f"{PATH}/{done.verification}").json()
    assert VerificationView.model_validate(found).model_dump(mode="json") == found
    assert (found["program"], found["log"]) == ("slot.stpnc", "run.parquet")
    assert found["has_errors"]
    [floor] = [row for row in found["surfaces"] if row["workingstep"] == "MILL SLOT"
               and row["surface"] == "floor"]  # fmt: skip
    assert floor["gouge_mm"] == pytest.approx(0.1, abs=floor["gouge_uncertainty_mm"])
    assert floor["gouge_at_mm"][2] == pytest.approx(-6.0)
    job = client.get(f"/v1/jobs/{done.verification}").json()
    assert (job["kind"], job["result"]) == ("verification", f"{PATH}/{done.verification}")
    assert done.verification in {each["id"] for each in client.get(PATH).json()["items"]}


def test_the_map_is_bounded_and_says_what_it_leaves_out(
    client: httpx.Client, done: Done
) -> None:
    path = f"{PATH}/{done.verification}/map"
    found = client.get(f"{path}?places=300").json()
    assert SurfaceMapView.model_validate(found).model_dump(mode="json") == found
    assert found["places"] == len(found["x_mm"]) <= 300
    whole = client.get(f"{path}?places=50000").json()
    assert found["places"] + found["left_out"] == whole["places"] + whole["left_out"]
    assert found["left_out_beyond_mm"] == pytest.approx(0.099, abs=1e-3)
    assert min(found["deviation_mm"]) == pytest.approx(-0.1, abs=1e-3)
    assert client.get(path).headers["etag"]
    for places in ("99", "50001", "x"):
        is_problem(client.get(f"{path}?places={places}"), 422)


def test_places_and_report_are_downloaded(client: httpx.Client, done: Done) -> None:
    path = f"{PATH}/{done.verification}"
    table = client.get(f"{path}/places")
    assert table.headers["content-type"] == "text/csv; charset=utf-8"
    rows = csv.read_csv(io.BytesIO(table.content))
    packed = client.get(f"{path}/places?form=parquet")
    assert parquet.read_table(io.BytesIO(packed.content)).num_rows == rows.num_rows > 100
    report = client.get(f"{path}/report")
    assert report.text.startswith("<!DOCTYPE html>")
    assert "sandbox" in report.headers["content-security-policy"]
    is_problem(client.get(f"{path}/log"), 404, "not-found")
    is_problem(client.get(f"{path}/places?form=xlsx"), 422)


def test_the_samples_of_a_run_bring_their_program(
    client: httpx.Client, slot: str, usual: dict[str, Any]
) -> None:
    asked = {"program_id": slot, "machine": SLOT_MACHINE, "rate_hz": 5.0}
    run = made(client.post("/v1/simulations", json=asked))
    is_problem(client.post(PATH, json={"run_id": run}), 409, "conflict")
    over(client, run)
    headers = {"idempotency-key": "verify-1"}
    body = {"run_id": run, "cell_mm": 0.5}
    ids = {made(client.post(PATH, json=body, headers=headers)) for _ in range(2)}
    [id] = ids
    job = over(client, id)
    assert (job["state"], job["program_id"]) == ("succeeded", slot)
    assert job["request"]["machine"] == SLOT_MACHINE
    found = client.get(f"{PATH}/{id}").json()
    assert found["log"] == f"samples of simulation {run}"
    assert not found["has_errors"]
    assert client.delete(f"/v1/jobs/{run}").status_code == 204
    is_problem(client.post(PATH, json={**usual, "run_id": run}), 404)
    assert client.get(f"{PATH}/{id}").status_code == 200
    assert client.delete(f"/v1/jobs/{id}").status_code == 204
    is_problem(client.get(f"{PATH}/{id}"), 404)
    is_problem(client.get(f"{PATH}/{id}/map"), 404)


def test_measured_tools_are_used(
    client: httpx.Client, done: Done, usual: dict[str, Any]
) -> None:
    tools = b'[[tool]]\nnumber = 1\nkind = "endmill"\ndiameter_mm = 8.1\n'
    tools_id = made(client.post("/v1/files?kind=tools&name=t.toml", content=tools), 201)
    body = {**usual, "log_id": done.file, "tools_id": tools_id}
    job = over(client, made(client.post(PATH, json=body)))
    assert job["state"] == "succeeded", job
    rows = client.get(f"{PATH}/{job['id']}").json()["surfaces"]
    wall = next(row for row in rows if row["feature"] and row["surface"] == "wall")
    assert wall["gouge_mm"] == pytest.approx(0.05, abs=wall["gouge_uncertainty_mm"])


def test_a_required_part_takes_the_place_of_a_program(
    client: httpx.Client, tmp_path: Path
) -> None:
    inputs = pocket_inputs(tmp_path)
    log = write_log(tmp_path / "log.csv", POCKET + OFFSET)
    assert inputs.tools is not None
    assert inputs.required is not None
    ids = {
        name: made(
            client.post(f"/v1/files?kind={kind}&name={path.name}", content=path.read_bytes()),
            201,
        )
        for name, kind, path in (
            ("log_id", "log", log),
            ("tools_id", "tools", inputs.tools),
            ("required_id", "required-part", inputs.required),
        )
    }
    body = {**ids, "machine": MILL.machine, "stock": MILL.stock, "cell_mm": MILL.cell_mm}
    job = over(client, made(client.post(PATH, json=body)))
    assert (job["state"], job["program_id"]) == ("succeeded", None), job
    found = client.get(f"{PATH}/{job['id']}").json()
    assert found["program"] == inputs.required.name
    assert found["has_errors"]
    assert {row["tool"] for row in found["surfaces"]} >= {1}
    for name in ("machine", "stock", "tools_id", "required_id"):
        less = {key: value for key, value in body.items() if key != name}
        refused = is_problem(client.post(PATH, json=less), 400, "unreadable")
        assert name in refused["detail"]


def test_a_solid_of_a_step_file_is_the_required_part(
    client: httpx.Client, tmp_path: Path
) -> None:
    tools = pocket_inputs(tmp_path).tools
    assert tools is not None
    lid = block((0.0, 0.0, 5.0), (40.0, 30.0, 9.0))
    files = {
        "log_id": ("log", write_log(tmp_path / "log.csv", POCKET + OFFSET)),
        "tools_id": ("tools", tools),
        "required_id": ("required-part", write_step(tmp_path / "part.step", lid, pocketed())),
    }
    ids = {
        name: made(
            client.post(f"/v1/files?kind={kind}&name={path.name}", content=path.read_bytes()),
            201,
        )
        for name, (kind, path) in files.items()
    }
    body = {**ids, "machine": MILL.machine, "stock": MILL.stock, "cell_mm": MILL.cell_mm}
    refused = over(client, made(client.post(PATH, json=body)))
    assert refused["state"] == "failed"
    assert (
        "part.step: 2 solids: choose one by its place or name" in refused["problem"]["detail"]
    )
    job = over(client, made(client.post(PATH, json={**body, "required_solid": "2"})))
    assert job["state"] == "succeeded", job
    found = client.get(f"{PATH}/{job['id']}").json()
    assert (found["program"], found["has_errors"]) == ("part.step", True)
    surface = write_step(tmp_path / "surface.step", first_face(lid))
    path = "/v1/files?kind=required-part&name=surface.step"
    told = is_problem(client.post(path, content=surface.read_bytes()), 422)
    assert told["detail"].startswith("surface.step: no closed solid")


def test_what_cannot_be_verified_is_refused_before_there_is_a_job(
    client: httpx.Client, done: Done, usual: dict[str, Any]
) -> None:
    before = client.get("/v1/jobs").json()
    log = {**usual, "log_id": done.file}
    for body, status, kind in (
        (usual, 400, "unreadable"),
        ({**log, "run_id": done.simulation}, 400, "unreadable"),
        ({**log, "monitor": "mill"}, 404, "not-found"),
        ({**log, "advice_id": done.advice}, 400, "unreadable"),
        ({"log_id": done.file}, 400, "unreadable"),
        ({**log, "log_id": NOBODY}, 404, "not-found"),
        ({**log, "program_id": NOBODY}, 404, "not-found"),
        ({**log, "tools_id": done.file}, 404, "not-found"),
        ({**log, "required_id": NOBODY}, 404, "not-found"),
        ({**usual, "run_id": NOBODY}, 404, "not-found"),
        ({**usual, "run_id": done.trial}, 404, "not-found"),
        ({**usual, "monitor": "mill"}, 404, "not-found"),
        ({**usual, "monitor": "http://127.0.0.1:1/mill"}, 404, "not-found"),
        ({**log, "log_id": "../../etc/passwd"}, 422, "invalid-request"),
        ({**log, "agent_url": "http://127.0.0.1:1"}, 422, "invalid-request"),
        ({**log, "tolerance_mm": 0}, 422, "invalid-request"),
        ({**log, "cell_mm": 0.01}, 422, "invalid-request"),
        ({**log, "zero": "1,2"}, 422, ""),
        ({**log, "stock": "0,0,0"}, 422, ""),
        ({**log, "machine": "no-such"}, 422, "unknown-machine"),
        ({**log, "material": "unobtainium"}, 422, "unknown-material"),
    ):
        is_problem(client.post(PATH, json=body), status, kind)
    assert client.get("/v1/jobs").json() == before


def test_a_log_of_another_program_and_one_in_inches_say_so(
    client: httpx.Client, usual: dict[str, Any], tmp_path: Path
) -> None:
    for change, told in (("elsewhere", "is it a run of this program"), ("inches", "in inches")):
        content = slot_log(tmp_path / "log.parquet", change=change).read_bytes()
        log = made(client.post("/v1/files?name=Tuesday.parquet", content=content), 201)
        id = made(client.post(PATH, json={**usual, "log_id": log}))
        job = over(client, id)
        assert job["state"] == "failed"
        assert job["problem"]["status"] == 422
        assert job["problem"]["detail"].startswith("Tuesday.parquet: ")
        assert told in job["problem"]["detail"]
        found = is_problem(client.get(f"{PATH}/{id}"), 409, "conflict")
        assert "failed" in found["detail"]
        is_problem(client.get(f"{PATH}/{id}/map"), 409)
        is_problem(client.get(f"{PATH}/{id}/report"), 404)


def test_a_damaged_log_fails_with_its_name(
    client: httpx.Client, log: bytes, usual: dict[str, Any]
) -> None:
    damaged = log[:50] + bytes(len(log) // 4) + log[50 + len(log) // 4 :]
    id = made(client.post("/v1/files?name=run.parquet", content=damaged), 201)
    job = over(client, made(client.post(PATH, json={**usual, "log_id": id})))
    assert job["state"] == "failed"
    assert job["problem"]["detail"].startswith("run.parquet: ")


def test_a_program_deleted_since_is_not_found(
    client: httpx.Client, done: Done, usual: dict[str, Any]
) -> None:
    program = made(client.post("/v1/programs?name=a.stpnc", content=SLOT.read_bytes()), 201)
    assert client.delete(f"/v1/programs/{program}").status_code == 204
    body = {**usual, "program_id": program, "log_id": done.file}
    is_problem(client.post(PATH, json=body), 404, "not-found")


@pytest.fixture(scope="module")
def watched(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A service with keys that monitors a machine on which the slot was cut."""
    request = run_of("paper003_case1", SLOT_MACHINE, rate_hz=5.0, speed=0.0)
    folder = tmp_path_factory.mktemp("watched")
    with PlayedAgent(*request) as agent:
        words = ("--keys", "--agent", f"{SLOT_MACHINE}={agent.url}")
        (folder / "data").mkdir()
        server = Server(folder, *words)
        create_key(server, "first", "viewer")
        with server:
            yield server
            assert server.faults() == ""


def test_the_latest_run_of_a_monitored_machine_is_verified(watched: Server) -> None:
    with watched.client(create_key(watched, "Petra", "planner")) as client:
        program = made(client.post("/v1/programs", content=SLOT.read_bytes()), 201)
        state = f"/v1/monitors/{SLOT_MACHINE}"
        until(lambda: client.get(state).json()["execution"] == "PROGRAM_COMPLETED")
        body = {"program_id": program, "monitor": SLOT_MACHINE, "cell_mm": 0.5}
        id = made(client.post(PATH, json={**body, "machine": SLOT_MACHINE}))
        job = over(client, id)
        assert job["state"] == "succeeded", job
        found = client.get(f"{PATH}/{id}").json()
        assert found["log"] == f"latest run of {SLOT_MACHINE}"
        assert not found["has_errors"]
        told = [each["message"] for each in found["findings"]]
        assert "the machine names the program 'paper003_case1.stpnc'" in told
        assert not any("not whole" in each for each in told)
        kept = client.get(f"{PATH}/{id}/log")
        rows = parquet.read_table(io.BytesIO(kept.content))
        assert rows.num_rows == found["samples"]["count"]


def test_who_may_plan_may_verify_and_who_may_see_may_look(watched: Server, log: bytes) -> None:
    anna, petra = create_key(watched, "Anna", "viewer"), create_key(watched, "Paul", "planner")
    with watched.client(petra) as client:
        file = made(client.post("/v1/files?name=run.parquet", content=log), 201)
        program = made(client.post("/v1/programs", content=SLOT.read_bytes()), 201)
        body = {"program_id": program, "log_id": file, "machine": SLOT_MACHINE, "cell_mm": 0.5}
        id = made(client.post(PATH, json=body))
        assert over(client, id)["owner"] == "Paul"
    with watched.client(anna) as client:
        assert client.get(f"{PATH}/{id}").json()["has_errors"]
        assert client.get(f"/v1/files/{file}").json()["owner"] == "Paul"
        is_problem(client.post("/v1/files?name=run.parquet", content=log), 403, "forbidden")
        is_problem(client.post(PATH, json=body), 403, "forbidden")
        is_problem(client.delete(f"/v1/files/{file}"), 403, "forbidden")
        is_problem(client.delete(f"/v1/jobs/{id}"), 403, "forbidden")
    with watched.client() as client:
        for path in (f"{PATH}/{id}", f"{PATH}/{id}/map", "/v1/files", f"/v1/files/{file}"):
            is_problem(client.get(path), 401, "unauthorised")
    with watched.client(create_key(watched, "Olga", "planner")) as client:
        # As programs are, logs and results are those of the whole shop.
        assert over(client, made(client.post(PATH, json=body)))["state"] == "succeeded"


def test_the_document_tells_role_and_units(client: httpx.Client) -> None:
    document = client.get("/v1/openapi.json").json()
    asked = document["paths"][PATH]["post"]
    assert asked["x-role"] == "planner"
    fields = document["components"]["schemas"]["StoredVerificationRequest"]["properties"]
    assert "mm" in fields["tolerance_mm"]["description"]
    assert "agent_url" not in json.dumps(fields)
