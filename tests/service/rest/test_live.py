"""``/v1/trials`` and ``/v1/control-runs``: changed while they go on."""

from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from tests.service.rest.conftest import Done
from tests.service.rest.server import is_problem, made, over
from tests.service.waiting import until


@pytest.fixture
def trial(client: httpx.Client) -> Iterator[str]:
    """A trial that goes on, until the test is over."""
    id = made(client.post("/v1/trials", json={"pace": 10.0}))
    until(lambda: client.get(f"/v1/trials/{id}/status").json() is not None)
    yield id
    client.post(f"/v1/trials/{id}/cancel")
    over(client, id)


def test_inputs_change_while_it_runs(client: httpx.Client, trial: str) -> None:
    path = f"/v1/trials/{trial}"
    answer = client.post(
        f"{path}/changes", json={"inputs": {"axial_depth_mm": 4.0}, "pace": 50}
    )
    assert (answer.status_code, answer.json()["asked"][0]["axial_depth_mm"]) == (202, 4.0)

    def is_changed() -> bool:
        status = client.get(f"{path}/status").json()
        return bool(status["inputs"]["axial_depth_mm"] == 4.0 and status["pace"] == 50.0)

    until(is_changed)
    until(lambda: client.get(f"{path}/log").json()["events"])
    assert client.get(f"{path}/series").json()["is_growing"]
    is_problem(client.get(path), 409)
    assert client.post(f"{path}/changes", json={"end": True}).status_code == 202
    assert over(client, trial)["state"] == "succeeded"
    assert client.get(path).json()["status"]["inputs"]["axial_depth_mm"] == 4.0
    is_problem(client.post(f"{path}/changes", json={"pace": 1.0}), 409, "conflict")


def test_a_change_that_cannot_be_is_refused_and_nothing_changes(
    client: httpx.Client, trial: str
) -> None:
    path = f"/v1/trials/{trial}"
    before = client.get(f"{path}/status").json()["inputs"]
    for inputs in (
        {"teeth": 0}, {"axial_depth_mm": -1}, {"material": "../../etc/passwd"},
        {"material": "unobtainium"}, {"radial_width_mm": 1e9}, {"surprise": 1},
    ):  # fmt: skip
        is_problem(client.post(f"{path}/changes", json={"inputs": inputs}), 422)
    for pace in (0, -1, 1001, "x"):
        is_problem(client.post(f"{path}/changes", json={"pace": pace}), 422)
    assert client.get(f"{path}/status").json()["inputs"] == before


def test_a_run_under_control_is_changed_and_ends(client: httpx.Client, done: Done) -> None:
    body = {"program_id": done.program, "pace": 1.0, "is_recorded": False}
    id = made(client.post("/v1/control-runs", json=body))
    path = f"/v1/control-runs/{id}"
    until(lambda: client.get(f"{path}/status").json() is not None)
    changes = {"mode": "QC", "motor_power_percent": 50.0, "depth_percent": 120.0}
    assert client.post(f"{path}/changes", json=changes).status_code == 202
    until(lambda: client.get(f"{path}/status").json()["criterion"] == "QC")
    for bad in (
        {"depth_percent": 0}, {"mode": "X"}, {"material": "x" * 201}, {"material": "butter"},
    ):  # fmt: skip
        is_problem(client.post(f"{path}/changes", json=bad), 422)
    assert client.post(f"{path}/cancel").status_code == 200
    job = over(client, id)
    assert job["state"] == "cancelled"
    is_problem(client.post(f"{path}/changes", json={"is_on": False}), 409)


def test_what_a_run_under_control_has_left(client: httpx.Client, done: Done) -> None:
    path = f"/v1/control-runs/{done.control}"
    result = client.get(path).json()
    assert result["is_good"] in {True, False}
    # The log of the cuts, which `--cut-log` writes.
    assert {"workingstep", "time_s", "least_override_percent", "done"} <= set(result["cuts"][0])
    assert client.get(f"{path}/samples").content.startswith(b"PAR1")
    assert client.get(f"{path}/report").text.startswith("<!DOCTYPE html>")
    assert client.get(f"{path}/status").json()["is_done"]
    assert client.get(f"{path}/log").json()["events"]
    is_problem(client.get(f"/v1/control-runs/{done.trial}/samples"), 404)
    for kind, id in (("trials", done.trial), ("control-runs", done.control)):
        listed = client.get(f"/v1/{kind}").json()["items"]
        assert id in {job["id"] for job in listed}
        is_problem(client.post(f"/v1/{kind}/{'0' * 26}/changes", json={}), 404)
        is_problem(client.post(f"/v1/{kind}/{'0' * 26}/cancel"), 404)


def test_a_trial_is_asked_for_within_its_bounds(client: httpx.Client) -> None:
    bodies: tuple[dict[str, Any], ...] = (
        {"inputs": {"teeth": 0}}, {"inputs": {"material": "unobtainium"}}, {"pace": 0},
        {"seed": -1}, {"seed": 2**40}, {"inputs": None}, {"inputs": []},
    )  # fmt: skip
    for body in bodies:
        is_problem(client.post("/v1/trials", json=body), 422)
