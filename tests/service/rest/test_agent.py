"""The agent of the service: a device for each machine, with its runs."""

from itertools import pairwise
from pathlib import Path
from typing import Any

import httpx
import pytest

from service.recording.request import RecordingRequest
from service.recording.run import record
from tests.extras.agent.model.conftest import observations, require_valid
from tests.service.rest.conftest import Done
from tests.service.rest.server import Server, create_key, is_problem, made, over
from tests.service.waiting import until

BROWSER = "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8"


def values(client: httpx.Client, path: str) -> dict[str, str]:
    root = require_valid(client.get(f"/mtconnect/{path}").content, "2.7")
    return {each.get("dataItemId"): each.text for each in observations(root)}


def test_each_machine_is_a_device(client: httpx.Client) -> None:
    root = require_valid(client.get("/mtconnect/probe").content, "2.7")
    names = {each.get("name") for each in root.iter() if str(each.tag).endswith("}Device")}
    assert {"vmc15", "lathe22", "paper000", "paper002", "paper003"} <= names
    state = values(client, "paper002/current")
    assert (state["paper002_avail"], state["paper002_exec"]) == ("AVAILABLE", "READY")
    page = client.get("/mtconnect/current", headers={"accept": BROWSER})
    assert page.headers["content-type"] == "text/html; charset=utf-8"
    assert "vmc15_exec" in page.text
    unknown = client.get("/mtconnect/nobody/current")
    require_valid(unknown.content, "2.7")
    assert unknown.status_code == 404


def test_a_run_under_control_is_published_and_kept(
    client: httpx.Client, service: Server, done: Done, tmp_path: Path
) -> None:
    body = {"program_id": done.program, "pace": 20.0, "is_recorded": False, "machine": "vmc15"}
    id = made(client.post("/v1/control-runs", json=body))
    seen: list[dict[str, str]] = []

    def is_cutting() -> bool:
        seen.append(values(client, "vmc15/current"))
        force = seen[-1]["vmc15_cutforce"]
        return force != "UNAVAILABLE" and float(force) > 10.0

    until(is_cutting)
    assert seen[-1]["vmc15_exec"] == "ACTIVE"
    assert seen[-1]["vmc15_workingstep"] not in {None, "UNAVAILABLE"}
    found = record(
        f"{service.url}/mtconnect/vmc15",
        tmp_path / "run.parquet",
        RecordingRequest(duration_s=1.0),
    )
    assert found.rows > 5
    client.post(f"/v1/control-runs/{id}/cancel")
    over(client, id)
    until(lambda: values(client, "vmc15/current")["vmc15_exec"] == "PROGRAM_STOPPED")

    def kept() -> list[Any]:
        return list(client.get("/mtconnect/runs?machine=vmc15").json()["runs"])

    # The next run begins, which ends the one before.
    id = made(client.post("/v1/control-runs", json={**body, "pace": 0.0}))
    assert over(client, id)["state"] == "succeeded"
    until(lambda: len(kept()) >= 1)
    run = kept()[-1]
    assert run["machine"] == "vmc15"
    document = client.get(f"/mtconnect/runs/{run['id']}/sample?count=5000").content
    stamps = [each.get("timestamp") for each in observations(require_valid(document, "2.7"))]
    assert all(before <= after for before, after in pairwise(stamps))


def test_several_web_processes_have_no_agent(tmp_path: Path) -> None:
    with Server(tmp_path, "--workers", "2") as server, server.client() as client:
        is_problem(client.get("/mtconnect/probe"), 503)


@pytest.mark.parametrize("path", ["/mtconnect/probe", "/mtconnect/runs"])
def test_the_agent_needs_a_key_where_keys_are_needed(tmp_path: Path, path: str) -> None:
    server = Server(tmp_path, "--keys")
    secret = create_key(server, "A. Smith")
    with server, server.client() as client:
        is_problem(client.get(path), 401)
        answer = client.get(path, headers={"authorization": f"Bearer {secret}"})
        assert answer.status_code == 200
