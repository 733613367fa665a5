"""``/v1/cycle-times``: the time of a program by block, beside that of a log."""

from typing import Any

import httpx
import pytest

from service.rest.cycle_time_views import CycleTimeView
from tests.extras.verification.logs import SLOT_MACHINE
from tests.service.rest.conftest import Done
from tests.service.rest.samples import SLOT
from tests.service.rest.server import is_problem, made, over

PATH = "/v1/cycle-times"


@pytest.fixture
def usual(client: httpx.Client) -> dict[str, Any]:
    program = made(client.post("/v1/programs?name=slot.stpnc", content=SLOT.read_bytes()), 201)
    return {"program_id": program, "machine": SLOT_MACHINE}


def test_a_log_stands_beside_the_prediction(client: httpx.Client, done: Done) -> None:
    found = client.get(f"{PATH}/{done.cycle}").json()
    assert CycleTimeView.model_validate(found).model_dump(mode="json") == found
    assert (found["program"], found["log"]) == ("slot.stpnc", "run.parquet")
    total = found["total"]
    assert total["theoretical_s"] <= total["predicted_s"]
    assert total["predicted_s"] == pytest.approx(total["actual_s"], rel=0.01)
    assert [row["workingstep"] for row in found["rows"]] == ["MILL SLOT"]
    assert found["stretches"]
    report = client.get(f"{PATH}/{done.cycle}/report")
    assert report.text.startswith("<!DOCTYPE html>")
    assert done.cycle in {each["id"] for each in client.get(PATH).json()["items"]}


def test_a_program_alone_is_timed(client: httpx.Client, usual: dict[str, Any]) -> None:
    id = made(client.post(PATH, json={**usual, "control": "exact-stop"}))
    job = over(client, id)
    assert (job["state"], job["result"]) == ("succeeded", f"{PATH}/{id}")
    found = client.get(f"{PATH}/{id}").json()
    assert (found["log"], found["total"]["actual_s"]) == (None, None)
    assert found["control"] == "exact-stop"


def test_what_cannot_be_timed_is_refused(
    client: httpx.Client, done: Done, usual: dict[str, Any]
) -> None:
    lines = b"2026-01-05T06:00:00Z|x_axis_position|12.5\n"
    shdr = made(client.post("/v1/files?name=a.shdr", content=lines), 201)
    for body, status in (
        ({}, 400),
        ({"log_id": done.file}, 400),
        ({**usual, "log_id": done.file, "run_id": done.simulation}, 400),
        ({**usual, "advice_id": done.advice}, 400),
        ({**usual, "log_id": shdr}, 422),
        ({**usual, "log_id": "0" * 26}, 404),
        ({**usual, "monitor": "http://127.0.0.1:1"}, 404),
        ({**usual, "agent_url": "http://127.0.0.1:1"}, 422),
        ({**usual, "machine": "no-such"}, 422),
        ({**usual, "control": "no-such"}, 422),
    ):
        is_problem(client.post(PATH, json=body), status)
